//! Before the search: the noise model, the calibrated baseline, and which effects can be seen at all. [`compare`] takes noise
//! and baseline from here too.
//!
//! [`compare`]: crate::diagnosis::compare()

use super::baseline::{fitted, fitted_again, refitted};
use super::discrepancy::{self, Shape};
use super::fits::Noise;
use super::inner_step::is_coarse;
use super::moved::MovedStarts;
use super::signature::{prune, sensitivities};
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::layout::Layout;
use crate::diagnosis::linear_algebra::Basis;
use crate::diagnosis::noise::{
    Decided, FittedResidual, FloorSource, NoiseFloor, NoiseModel, Repeats, decide, estimate, noise_floors,
};
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::{BAD_SAMPLE, ENOUGH_SCATTER, LEAST_SHARE_LEFT};
use crate::diagnosis::unanswered::{Answers, UnansweredRows, listed};
use std::collections::BTreeMap;

/// Median of |x| of a normal variable with unit variance.
const MEDIAN: f64 = 0.674_489_750_196_081_7;

/// What the search starts from.
#[derive(Clone)]
pub(crate) struct Prepared {
    pub noise: Noise,
    pub repeats: Option<Repeats>,
    pub floors: BTreeMap<String, NoiseFloor>,
    pub source: FloorSource,
    pub baseline: Calibration,
    /// What the baseline gives, in the layout's order; NaN in rows that are left out and without an answer.
    pub modelled: Vec<f64>,
    /// Columns of a flexible discrepancy, in the layout's order.
    pub flexible: Vec<Vec<f64>>,
    /// Smooth functions of the conditions by which the strength of an effect may vary.
    pub modulations: Vec<Shape>,
    pub invisible: Vec<String>,
    pub cautions: Vec<String>,
    /// Whether the noise is known well enough for a verdict.
    pub noise_is_known: bool,
    /// Rows that are left out, since the baseline has no answer there.
    pub unanswered: Vec<UnansweredRows>,
}

/// Finds noise and baseline; takes out of the problem's library what cannot be seen, and out of its rows those that the
/// baseline cannot answer.
pub(crate) fn prepare(problem: &mut Problem) -> Result<Prepared, CompareError> {
    let mut prepared = calibrated_baseline(problem)?;
    prepared.invisible = prune(problem, &prepared.baseline.values())?;
    Ok(prepared)
}

/// The same once more, where further rows do not count since: the search begins where the first one ended.
pub(super) fn prepare_again(problem: &mut Problem, before: &Prepared) -> Result<Prepared, CompareError> {
    let mut prepared = calibrated_from(problem, Some(before))?;
    prepared.invisible = before.invisible.clone();
    prepared.invisible.extend(prune(problem, &prepared.baseline.values())?);
    Ok(prepared)
}

/// The baseline over windows whose starts were found with other effects. The noise stays; rows without an answer from there are left out.
///
/// # Errors
/// [`CompareError`] where the baseline has too few answers there.
pub(super) fn prepare_under(
    problem: &mut Problem,
    before: &Prepared,
    moved: &MovedStarts,
) -> Result<Prepared, CompareError> {
    let under = (moved.effects.as_slice(), moved.values.as_slice());
    problem.begin_windows(moved.windows.clone(), under)?;
    let mut prepared = before.clone();
    prepared.noise.begin_at(problem, under);
    let mut unanswered = Vec::new();
    prepared.baseline = fitted_again(problem, &prepared.noise, &prepared.baseline, &mut unanswered)?;
    if !unanswered.is_empty() {
        prepared.unanswered.extend(listed(unanswered));
        prepared.cautions.extend(of_unanswered(problem, &prepared.unanswered));
    }
    let values = prepared.baseline.values();
    prepared.modelled = modelled(problem, &values)?.values;
    let found = sensitivities(problem, &[], &values)?;
    problem.know_sensitivities(&values, found);
    Ok(prepared)
}

/// Finds noise and baseline, and takes out of the problem's rows those that the baseline cannot answer.
///
/// # Errors
/// [`CompareError`] where there is too little to compare, or the model has too few answers.
pub(crate) fn calibrated_baseline(problem: &mut Problem) -> Result<Prepared, CompareError> {
    calibrated_from(problem, None)
}

fn calibrated_from(problem: &mut Problem, before: Option<&Prepared>) -> Result<Prepared, CompareError> {
    let values = problem.layout.present();
    if values == 0 {
        return Err(CompareError::NothingMeasured);
    }
    if values <= problem.base.len() {
        return Err(CompareError::TooFewMeasurements { values, free: problem.base.len() });
    }
    let repeats = Repeats::new(&problem.experiment);
    let mut unanswered = Vec::new();
    let guess = Noise::new(first_guess(problem, &repeats));
    let all = problem.layout.clone();
    let mut first = match before {
        Some(before) => fitted_again(problem, &guess, &before.baseline, &mut unanswered)?,
        None => fitted(problem, &guess, &[], &mut unanswered)?,
    };
    let mut refined = before.map_or(0, |before| before.noise.refined);
    let mut known = guess.clone();
    // Under the first guess of the noise and again under each that is found, until the step does not show beside it.
    let Found { mut noise, decided, flexible, modulations } = loop {
        while is_coarse(problem, &known, &first.values())? && problem.refine_step() {
            refined += 1;
            // Rows that had no answer may have one, or end elsewhere.
            problem.layout.clone_from(&all);
            unanswered.clear();
            first = fitted_again(problem, &guess, &first, &mut unanswered)?;
        }
        if problem.is_cut() {
            problem.refine_starts(&guess, (&[], &first.values()))?;
            first = fitted_again(problem, &guess, &first, &mut unanswered)?;
        }
        let found = noise_about(problem, &repeats, &first)?;
        if !is_coarse(problem, &found.noise, &first.values())? {
            break found;
        }
        known = found.noise;
    };
    noise.refined = refined;
    let mut baseline = refitted(problem, &noise, first, &mut unanswered)?;
    if problem.is_cut() {
        let values = baseline.values();
        problem.refine_starts(&noise, (&[], &values))?;
        noise.begin_at(problem, (&[], &values));
        baseline = fitted_again(problem, &noise, &baseline, &mut unanswered)?;
    }
    let modelled = modelled(problem, &baseline.values())?.values;
    let mut floors = noise_floors(&problem.experiment, &problem.layout, &modelled);
    floors.iter_mut().for_each(|(signal, floor)| floor.contradicted = decided.contradicted.contains(signal));
    let known = before.into_iter().flat_map(|before| before.unanswered.iter().cloned());
    let unanswered = known.chain(listed(unanswered)).collect();
    let mut prepared = Prepared {
        source: source(&floors),
        repeats: None,
        noise_is_known: true,
        cautions: decided.cautions.clone(),
        invisible: Vec::new(),
        noise,
        floors,
        baseline,
        modelled,
        flexible,
        modulations,
        unanswered,
    };
    prepared.repeats = (prepared.source == FloorSource::Replicates).then_some(repeats);
    judge_noise(problem, &mut prepared, &decided);
    prepared.cautions.extend(of_unanswered(problem, &prepared.unanswered));
    if let Some(whitening) = prepared.noise.whitening(problem, &|_, _| true) {
        let remarks = problem.strategy().remarks(problem, &whitening, &prepared.baseline, &prepared.modelled);
        prepared.cautions.extend(remarks);
    }
    Ok(prepared)
}

/// The noise, and the shapes along the conditions that it was told from.
struct Found {
    noise: Noise,
    decided: Decided,
    flexible: Vec<Vec<f64>>,
    modulations: Vec<Shape>,
}

/// The noise as repeats, statements and the residual of a first fit tell it.
fn noise_about(problem: &mut Problem, repeats: &Repeats, first: &Calibration) -> Result<Found, CompareError> {
    let predicted = modelled(problem, &first.values())?.values;
    problem.layout.scale = problem.strategy().noise_scale(problem, &predicted);
    let residual = minus(&problem.layout.measured, &predicted);
    let flexible = discrepancy::columns(problem, &predicted);
    if !problem.layout.scale.is_empty() {
        // Noise grows with what is there, which the baseline may lack: a box that rubs before the soil shears.
        let expected = with_discrepancy(&problem.layout, &predicted, &residual, &flexible);
        problem.layout.scale = problem.strategy().noise_scale(problem, &expected);
    }
    let problem = &*problem;
    let modulations = problem.strategy().modulations(&problem.experiment, &problem.layout, &predicted);
    let decided = decide(&FittedResidual {
        experiment: &problem.experiment,
        layout: &problem.layout,
        repeats,
        residual: &residual,
        smooth: &modulations,
        flexible: &flexible,
        calibrated: problem.base.len(),
        assumed_scatter: problem.strategy().assumed_scatter(&problem.experiment),
    });
    let mut noise = Noise::new(decided.models.clone());
    noise.scale.clone_from(&problem.layout.scale);
    noise.robust = Some(threshold(problem, &noise, &residual));
    Ok(Found { noise, decided, flexible, modulations })
}

/// The model's values plus a smooth curve through what they miss. The curve is a sum of the `flexible` columns, the least smooth of which
/// come first; of the smoothest as many are taken as leave half of all values free, so that the curve does not pass through each.
fn with_discrepancy(layout: &Layout, modelled: &[f64], residual: &[f64], flexible: &[Vec<f64>]) -> Vec<f64> {
    let counted = |values: &[f64]| {
        let kept = values.iter().zip(residual).map(|(value, missed)| if missed.is_nan() { 0.0 } else { *value });
        layout.by_scale(kept.collect())
    };
    let most = (LEAST_SHARE_LEFT * layout.present() as f64) as usize;
    let mut basis = Basis::default();
    for column in flexible.iter().rev() {
        if basis.rank() == most {
            break;
        }
        basis.add(&counted(column));
    }
    let missed = counted(residual);
    let outside = basis.outside(&missed);
    let added = missed.iter().zip(outside).map(|(all, outside)| all - outside);
    modelled.iter().zip(added.zip(&layout.scale)).map(|(value, (added, scale))| value + added * scale.row).collect()
}

/// The weakest source among the signals.
fn source(floors: &BTreeMap<String, NoiseFloor>) -> FloorSource {
    floors.values().map(NoiseFloor::source).max_by_key(|source| *source as u8).unwrap_or(FloorSource::Unknown)
}

/// Says where the noise is not known, and whether it can be judged by the scatter of the measurements.
fn judge_noise(problem: &Problem, prepared: &mut Prepared, decided: &Decided) {
    if prepared.source != FloorSource::Unknown {
        return;
    }
    if decided.unknown.is_empty() {
        prepared.cautions.push(
            "noise floor unknown: some signals have neither repeats nor a stated noise; the scatter about a flexible curve stands in for it"
                .to_owned(),
        );
    } else {
        prepared.cautions.push(format!(
            "noise floor unknown: {} is neither repeated nor stated, and the rows are too few for a curve that does not pass through them; what the model misses stands in for the noise, which hides what the model lacks",
            decided.unknown.join(", ")
        ));
    }
    let spent = problem.base.len() + Basis::of(&prepared.flexible).rank();
    prepared.noise_is_known = decided.unknown.is_empty() && problem.layout.present() >= spent + ENOUGH_SCATTER;
    if !prepared.noise_is_known {
        prepared.cautions.push(
            "the noise is unknown and there are too few measurements to judge it by their scatter: nothing is decided; repeat some conditions or state the noise"
                .to_owned(),
        );
    }
}

/// Says how many rows are left out.
fn of_unanswered(problem: &Problem, unanswered: &[UnansweredRows]) -> Option<String> {
    let first = unanswered.first()?;
    let (all, answered) = problem.layout.rows();
    Some(format!(
        "{} of {all} rows left out, since the calibrated model has no answer there (the first: run {}, row {}): no error, noise or effect is judged by them",
        all - answered,
        first.run,
        first.rows.0
    ))
}

/// What the baseline gives row by row.
pub(super) fn modelled(problem: &Problem, values: &[f64]) -> Result<Answers, CompareError> {
    Ok(problem.predict(&problem.base, |predict| predict.answers(values))??)
}

/// Measured minus modelled.
pub(super) fn minus(measured: &[f64], modelled: &[f64]) -> Vec<f64> {
    measured.iter().zip(modelled).map(|(y, m)| y - m).collect()
}

/// Noise before any fit: repeats, else what is stated, else the signal's own scatter.
fn first_guess(problem: &Problem, repeats: &Repeats) -> BTreeMap<String, NoiseModel> {
    let guess = |signal: &String| {
        estimate(repeats, &problem.layout, signal, &problem.layout.measured)
            .or_else(|| problem.experiment.noise.get(signal).copied().map(NoiseModel::white))
            .unwrap_or_else(|| NoiseModel::white(problem.layout.scatter(signal)))
    };
    problem.experiment.signals().into_iter().map(|signal| (signal.clone(), guess(&signal))).collect()
}

/// Where a whitened residual of the baseline starts to count as a bad sample.
fn threshold(problem: &Problem, noise: &Noise, residual: &[f64]) -> f64 {
    let Some(whitening) = noise.whitening(problem, &|_, _| true) else { return f64::INFINITY };
    let mut sizes: Vec<f64> = whitening.apply(residual).into_iter().map(f64::abs).collect();
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    BAD_SAMPLE * (median / MEDIAN).max(1.0)
}
