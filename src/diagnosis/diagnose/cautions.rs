//! What to beware of in fitted parameters, in words.

use crate::diagnosis::calibrate::{CalibratedParameter, Calibration};
use crate::diagnosis::thresholds::{NAMED, PRIOR_CONTRADICTED};

/// Parameters on a bound, and those that left their priors.
pub(crate) fn of_parameters(fit: &Calibration) -> Vec<String> {
    let mut cautions = Vec::new();
    for parameter in &fit.parameters {
        let name = &parameter.variable.name;
        if parameter.at_bound && !parameter.is_off() {
            let bound = bound(parameter);
            cautions
                .push(format!("{name} sits on its bound ({bound}): the fit wanted to go further than is believable"));
        }
        cautions.extend(left_prior(parameter));
    }
    cautions
}

/// The bound on which a parameter sits, with its unit.
fn bound(parameter: &CalibratedParameter) -> String {
    let (value, variable) = (parameter.value, &parameter.variable);
    let upper = (variable.max - value).abs() < (value - variable.min).abs();
    let bound = if upper { variable.max } else { variable.min };
    match variable.unit.symbol {
        "1" => bound.to_string(),
        unit => format!("{bound} {unit}"),
    }
}

/// A parameter that left its prior.
pub(crate) fn left_prior(parameter: &CalibratedParameter) -> Option<String> {
    let shift = parameter.prior_shift().filter(|shift| shift.abs() > PRIOR_CONTRADICTED)?;
    Some(format!("{} moved by {shift:+.1} standard deviations of its prior", parameter.variable.name))
}

/// Draws too few to name anything.
pub(crate) fn of_draws(draws: usize) -> Option<String> {
    let smallest = 1.0 / (draws as f64 + 1.0);
    (smallest >= NAMED).then(|| {
        format!(
            "{draws} bootstrap draws cannot give a p-value below {smallest:.3}: nothing can be named; take 199 or more"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::of_parameters;
    use crate::diagnosis::calibrate::{CalibratedParameter, Calibration};
    use crate::rover::Rover;
    use crate::soil_test::{SoilTest, TestRig};
    use bekker_modeldescription::Lookup;
    use std::collections::BTreeMap;

    /// What is said of a parameter of a test of a soil that a fit puts on its bound `value`.
    fn said(name: &str, value: f64) -> Vec<String> {
        let (variable, start) = SoilTest::of(&Rover::two_wheeled(), &TestRig::default())
            .list()
            .into_iter()
            .find(|(variable, _)| variable.name == name)
            .expect("such a test has it");
        let parameter = CalibratedParameter { variable, start, value, deviation: None, at_bound: true, prior: None };
        of_parameters(&Calibration {
            parameters: vec![parameter],
            weights: BTreeMap::new(),
            chi_square: 1.0,
            degrees_of_freedom: 1,
            steps: 1,
            converged: true,
            searches: 1,
            agreeing: 1,
        })
    }

    #[test]
    fn property_a_law_that_is_left_off_needs_no_caution() {
        assert_eq!(said("box_bottom.growth", 0.0), [""; 0]);
        assert_eq!(
            said("box_walls.strength", 50.0),
            ["box_walls.strength sits on its bound (50): the fit wanted to go further than is believable"]
        );
        // A soil's parameter on its bound always counts.
        assert_eq!(said("soil.cohesion", 0.0).len(), 1);
    }
}
