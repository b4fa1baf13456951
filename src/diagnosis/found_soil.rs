//! The soil that a calibration found, with its covariance, for other experiments.

use super::calibrate::Calibration;
use super::information::Information;
use super::kinds::strategy;
use super::prior_rows::JointPrior;
use super::problem::Problem;
use super::thresholds::PRIOR_CONTRADICTED;
use crate::known_soil::{KnownParameter, KnownSoil, Scale};

/// Quantile of the normal distribution to one side that leaves 4.55 %, as two standard deviations leave to both.
const ONE_SIDED: f64 = 1.690;

/// What a calibrated baseline says of the soil; `None` where no parameter of it was free.
pub(crate) fn found_soil(problem: &Problem, fit: &Calibration, information: &Information) -> Option<KnownSoil> {
    let (free, values) = (&problem.base, fit.values());
    let covariance = information.after().cholesky()?.inverse();
    let of_soil: Vec<usize> = (0..free.len()).filter(|k| free[*k].variable.name.starts_with("soil.")).collect();
    // From search coordinates to those of the file.
    let scale = |k: usize| if free[k].is_logarithmic() { Scale::Logarithm } else { Scale::Linear };
    let factor = |k: usize| scale(k).slope(values[k]) * free[k].slope(values[k]);
    let parameter = |k: &usize| {
        let covariance: Vec<f64> = of_soil.iter().map(|j| covariance[(*k, *j)] * factor(*k) * factor(*j)).collect();
        let own = of_soil.iter().position(|j| j == k)?;
        Some(KnownParameter {
            name: free[*k].variable.name.clone(),
            value: values[*k],
            unit: free[*k].variable.unit.symbol.to_owned(),
            scale: scale(*k),
            sd: covariance[own].sqrt() / scale(*k).slope(values[*k]),
            at_bound: fit.parameters[*k].at_bound,
            covariance,
        })
    };
    let parameters: Vec<KnownParameter> = of_soil.iter().filter_map(parameter).collect();
    let contact_widths = strategy(&problem.experiment).contact_widths(&problem.experiment, &problem.models);
    (!parameters.is_empty()).then(|| KnownSoil { name: problem.experiment.name.clone(), contact_widths, parameters })
}

/// Cautions on a fit that moved further from a known soil than that allows, by one parameter or all together.
pub(crate) fn moved(joint: Option<&JointPrior>, fit: &Calibration) -> Vec<String> {
    let Some(joint) = joint else { return Vec::new() };
    let value = |name: &str| fit.parameters.iter().find(|p| p.variable.name == name).map(|p| p.value);
    let (chi_square, count) = joint.distance(value);
    if count == 0 || chi_square <= limit(count) {
        return Vec::new();
    }
    vec![format!(
        "together the soil moved further from {} than two standard deviations (chi-square {chi_square:.1} for {count} parameters, {:.1} would be): this may be another soil, or an effect is missing",
        joint.label,
        limit(count)
    )]
}

/// The chi-square beyond which 4.55 % lie (Wilson and Hilferty 1931), as beyond two standard deviations of one number.
fn limit(count: usize) -> f64 {
    if count == 1 {
        return PRIOR_CONTRADICTED * PRIOR_CONTRADICTED;
    }
    let size = count as f64;
    let spread = 2.0 / (9.0 * size);
    size * (1.0 - spread + ONE_SIDED * spread.sqrt()).powi(3)
}
