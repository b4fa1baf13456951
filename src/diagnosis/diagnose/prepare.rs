//! Before the search: the noise model, the calibrated baseline, and which effects can be seen at all.

use super::discrepancy;
use super::fits::{Noise, run};
use super::signature::prune;
use crate::diagnosis::calibrate::{Calibration, better};
use crate::diagnosis::compare::{CompareError, own_scatter};
use crate::diagnosis::linear_algebra::Basis;
use crate::diagnosis::noise::{FloorSource, NoiseFloor, NoiseModel, Repeats, estimate, estimate_alone, noise_floors};
use crate::diagnosis::problem::Problem;
use std::collections::BTreeMap;

/// A whitened residual beyond this many robust standard deviations is a bad sample: Huber's loss starts there.
const BAD: f64 = 4.5;

/// Median of |x| of a normal variable with unit variance.
const MEDIAN: f64 = 0.674_489_750_196_081_7;

/// Degrees of freedom from which repeats may contradict a stated noise, and by which ratio they must differ.
const ENOUGH_REPEATS: usize = 10;
const CONTRADICTION: f64 = 1.3;

/// Degrees of freedom beyond calibration and flexible curve that tell an unknown noise to about a tenth.
const ENOUGH_SCATTER: usize = 50;

/// What the search starts from.
pub(crate) struct Prepared {
    pub noise: Noise,
    pub repeats: Option<Repeats>,
    pub floors: BTreeMap<String, NoiseFloor>,
    pub source: FloorSource,
    pub baseline: Calibration,
    pub flexible: Vec<Vec<f64>>,
    /// Smooth functions of the conditions by which the strength of an effect may vary, by run and row.
    pub modulations: Vec<Vec<Vec<f64>>>,
    pub invisible: Vec<String>,
    pub cautions: Vec<String>,
    /// Whether the noise is known well enough for a verdict.
    pub noise_is_known: bool,
}

/// Finds noise and baseline; takes out of the problem's library what cannot be seen.
pub(crate) fn prepare(problem: &mut Problem) -> Result<Prepared, CompareError> {
    let values = problem.layout.present();
    if values == 0 {
        return Err(CompareError::NothingMeasured);
    }
    if values <= problem.base.len() {
        return Err(CompareError::TooFewMeasurements { values, free: problem.base.len() });
    }
    let repeats = Repeats::new(&problem.experiment);
    let mut cautions = Vec::new();
    let measured = problem.layout.measured.clone();
    let mut noise = Noise { models: first_guess(problem, &repeats, &measured), robust: None };
    let first = run(problem, &noise, &problem.task(&[], Vec::new())).ok_or_else(|| no_start(problem))?;
    let predicted = modelled(problem, &first)?;
    let residual = minus(&measured, &predicted);
    let flexible = discrepancy::columns(&problem.experiment, &problem.layout, &predicted);
    let modulations = discrepancy::modulations(&problem.experiment, &problem.layout, &predicted);
    noise.models = from_repeats(problem, &repeats, &residual, &flexible, &mut cautions);
    noise.robust = Some(threshold(problem, &noise, &residual));
    let again = problem.task(&[], vec![first.values()]);
    let again = run(problem, &noise, &again).ok_or_else(|| no_start(problem))?;
    let mut baseline = Calibration { searches: first.searches, agreeing: first.agreeing, ..again };
    // Under a first guess of the noise a fit may have looked near that is far.
    if baseline.is_far() && !first.is_far() {
        let anew = run(problem, &noise, &problem.task(&[], Vec::new()));
        baseline = better(Some(baseline), anew).ok_or_else(|| no_start(problem))?;
    }
    let floors = noise_floors(&problem.experiment, &problem.layout, &modelled(problem, &baseline)?);
    let invisible = prune(problem, &baseline.values())?;
    let source =
        floors.values().map(NoiseFloor::source).max_by_key(|source| *source as u8).unwrap_or(FloorSource::Unknown);
    if source == FloorSource::Unknown {
        cautions.push(
            "noise floor unknown: some signals have neither repeats nor a stated noise; the scatter about a flexible curve stands in for it"
                .to_owned(),
        );
    }
    let rank = Basis::of(&flexible).rank();
    let noise_is_known = source != FloorSource::Unknown || values >= problem.base.len() + rank + ENOUGH_SCATTER;
    if !noise_is_known {
        cautions.push(
            "the noise is unknown and there are too few measurements to judge it by their scatter: nothing is decided; repeat some conditions or state the noise"
                .to_owned(),
        );
    }
    let from_repeats = source == FloorSource::Replicates;
    Ok(Prepared {
        noise,
        repeats: from_repeats.then_some(repeats),
        floors,
        source,
        baseline,
        flexible,
        modulations,
        invisible,
        cautions,
        noise_is_known,
    })
}

fn no_start(problem: &Problem) -> CompareError {
    let start: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
    match problem.predict(&problem.base, |predict| predict.values(&start)) {
        Ok(Err(error)) | Err(error) => CompareError::NoStart(error),
        Ok(Ok(_)) => CompareError::NoFit,
    }
}

/// What the calibrated baseline gives, in the layout's order.
fn modelled(problem: &Problem, fit: &Calibration) -> Result<Vec<f64>, CompareError> {
    Ok(problem.predict(&problem.base, |predict| predict.values(&fit.values()))??)
}

/// Measured minus modelled.
fn minus(measured: &[f64], modelled: &[f64]) -> Vec<f64> {
    measured.iter().zip(modelled).map(|(y, m)| y - m).collect()
}

/// Noise before any fit: repeats, else what is stated, else the signal's own scatter.
fn first_guess(problem: &Problem, repeats: &Repeats, measured: &[f64]) -> BTreeMap<String, NoiseModel> {
    let guess = |signal: &String| {
        estimate(repeats, &problem.layout, signal, measured)
            .or_else(|| problem.experiment.noise.get(signal).copied().map(NoiseModel::white))
            .unwrap_or_else(|| NoiseModel::white(own_scatter(&problem.layout, signal)))
    };
    problem.experiment.signals().into_iter().map(|signal| (signal.clone(), guess(&signal))).collect()
}

/// The noise models that the diagnosis rests on.
fn from_repeats(
    problem: &Problem,
    repeats: &Repeats,
    residual: &[f64],
    flexible: &[Vec<f64>],
    cautions: &mut Vec<String>,
) -> BTreeMap<String, NoiseModel> {
    let layout = &problem.layout;
    let mut models = BTreeMap::new();
    for signal in problem.experiment.signals() {
        let plain = estimate(repeats, layout, &signal, &layout.measured);
        let corrected = estimate(repeats, layout, &signal, residual);
        // Where the inputs of repeats differ the residual has the model's share of that taken off; where only their
        // recording differs it adds scatter. What remains is an upper bound either way.
        let seen = match (plain, corrected) {
            (Some(plain), Some(corrected)) if corrected.deviation < plain.deviation => Some(corrected),
            (plain, _) => plain,
        };
        let alone = || {
            let rest = beyond(residual, flexible);
            estimate_alone(layout, &signal, &rest.0, rest.1 / problem.experiment.signals().len() as f64)
        };
        let stated = problem.experiment.noise.get(&signal).copied().filter(|deviation| *deviation > 0.0);
        let model = match (stated, seen) {
            (Some(stated), Some(seen)) => {
                let ratio = seen.deviation / stated;
                let freedom = repeats.degrees_of_freedom(layout, &signal);
                if freedom >= ENOUGH_REPEATS && !(1.0 / CONTRADICTION..=CONTRADICTION).contains(&ratio) {
                    cautions.push(format!(
                        "the stated noise of {signal}, {stated:.3e}, is contradicted by the repeats, which scatter by {:.3e}; the repeats are taken",
                        seen.deviation
                    ));
                    seen
                } else {
                    NoiseModel { deviation: stated, ..seen }
                }
            }
            (None, Some(seen)) => seen,
            (Some(stated), None) => match alone() {
                Some(own) if own.deviation > CONTRADICTION * stated => {
                    cautions.push(format!(
                        "the stated noise of {signal}, {stated:.3e}, is too small: measurements scatter by {:.3e} about a flexible curve, which is taken",
                        own.deviation
                    ));
                    own
                }
                Some(own) => {
                    if own.deviation * CONTRADICTION < stated {
                        cautions.push(format!(
                            "the stated noise of {signal}, {stated:.3e}, looks too large: measurements scatter by {:.3e} about a flexible curve; weak effects stay hidden",
                            own.deviation
                        ));
                    }
                    NoiseModel { deviation: stated, ..own }
                }
                None => NoiseModel::white(stated),
            },
            (None, None) => alone().unwrap_or_else(|| NoiseModel::white(own_scatter(layout, &signal))),
        };
        models.insert(signal, model);
    }
    models
}

/// What a flexible curve along the conditions leaves of a residual, and how many directions it took.
fn beyond(residual: &[f64], flexible: &[Vec<f64>]) -> (Vec<f64>, f64) {
    let blank = |values: &[f64]| -> Vec<f64> {
        values.iter().zip(residual).map(|(v, e)| if e.is_nan() { 0.0 } else { *v }).collect()
    };
    let columns: Vec<Vec<f64>> = flexible.iter().map(|column| blank(column)).collect();
    let basis = Basis::of(&columns);
    let mut rest = basis.outside(&blank(residual));
    rest.iter_mut().zip(residual).filter(|(_, e)| e.is_nan()).for_each(|(r, _)| *r = f64::NAN);
    (rest, basis.rank() as f64)
}

/// Where a whitened residual of the baseline starts to count as a bad sample.
fn threshold(problem: &Problem, noise: &Noise, residual: &[f64]) -> f64 {
    let Some(whitening) = noise.whitening(problem, &|_, _| true) else { return f64::INFINITY };
    let mut sizes: Vec<f64> = whitening.apply(residual).into_iter().map(f64::abs).collect();
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    BAD * (median / MEDIAN).max(1.0)
}
