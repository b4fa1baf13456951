//! Before the search: the noise model, the calibrated baseline, and which effects can be seen at all. [`compare`] takes noise
//! and baseline from here too.
//!
//! [`compare`]: crate::diagnosis::compare()

use super::discrepancy::{self, Shape};
use super::fits::{Noise, Task, run, run_open};
use super::inner_step::is_coarse;
use super::search::SAME_FIT;
use super::signature::prune;
use crate::diagnosis::calibrate::{CalibratedParameter, Calibration, better};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::linear_algebra::Basis;
use crate::diagnosis::noise::{
    Decided, FittedResidual, FloorSource, NoiseFloor, NoiseModel, Repeats, decide, estimate, noise_floors,
};
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::{BAD_SAMPLE, ENOUGH_SCATTER, LEAST_ANSWERED};
use crate::diagnosis::unanswered::{Answers, Unanswered, UnansweredRows, listed};
use crate::simulation::Event;
use std::collections::BTreeMap;

/// Median of |x| of a normal variable with unit variance.
const MEDIAN: f64 = 0.674_489_750_196_081_7;

/// What the search starts from.
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

/// Finds noise and baseline, and takes out of the problem's rows those that the baseline cannot answer.
///
/// # Errors
/// [`CompareError`] where there is too little to compare, or the model has too few answers.
pub(crate) fn calibrated_baseline(problem: &mut Problem) -> Result<Prepared, CompareError> {
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
    let mut first = fitted(problem, &guess, &[], &mut unanswered)?;
    let mut refined = 0;
    let mut known = guess.clone();
    // Under the first guess of the noise and again under each that is found, until the step does not show beside it.
    let Found { mut noise, decided, flexible, modulations } = loop {
        while is_coarse(problem, &known, &first.values())? && problem.refine_step() {
            refined += 1;
            // Rows that had no answer may have one, or end elsewhere.
            problem.layout.clone_from(&all);
            unanswered.clear();
            first = fitted(problem, &guess, &[first.values()], &mut unanswered)?;
        }
        if problem.is_cut() {
            problem.refine_starts(&guess, &first.values())?;
            first = fitted(problem, &guess, &[first.values()], &mut unanswered)?;
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
        noise.around = baseline.values();
        problem.refine_starts(&noise, &noise.around)?;
        noise.windows.clone_from(&problem.windows);
        baseline = fitted(problem, &noise, &[baseline.values()], &mut unanswered)?;
    }
    let modelled = modelled(problem, &baseline.values())?.values;
    let mut floors = noise_floors(&problem.experiment, &problem.layout, &modelled);
    floors.iter_mut().for_each(|(signal, floor)| floor.contradicted = decided.contradicted.contains(signal));
    let unanswered = listed(unanswered);
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
fn noise_about(problem: &Problem, repeats: &Repeats, first: &Calibration) -> Result<Found, CompareError> {
    let predicted = modelled(problem, &first.values())?.values;
    let residual = minus(&problem.layout.measured, &predicted);
    let flexible = discrepancy::columns(problem, &predicted);
    let modulations = problem.strategy().modulations(&problem.experiment, &problem.layout, &predicted);
    let decided = decide(&FittedResidual {
        experiment: &problem.experiment,
        layout: &problem.layout,
        repeats,
        residual: &residual,
        smooth: &modulations,
        flexible: &flexible,
        calibrated: problem.base.len(),
    });
    let mut noise = Noise::new(decided.models.clone());
    noise.robust = Some(threshold(problem, &noise, &residual));
    Ok(Found { noise, decided, flexible, modulations })
}

/// The baseline under the final noise, from where the first fit ended and, where that is far, from elsewhere too.
fn refitted(
    problem: &mut Problem,
    noise: &Noise,
    first: Calibration,
    unanswered: &mut Vec<Unanswered>,
) -> Result<Calibration, CompareError> {
    let again = fitted(problem, noise, &[first.values()], unanswered)?;
    // A search that starts where the first one ended may find no step to make.
    let converged = again.converged || (first.converged && is_at(&again, &first));
    let mut baseline = Calibration { searches: first.searches, agreeing: first.agreeing, converged, ..again };
    // Under a first guess of the noise a fit may have looked near that is far.
    if baseline.is_far() && !first.is_far() {
        let counted = problem.layout.present();
        let anew = fitted(problem, noise, &[], unanswered)?;
        if problem.layout.present() < counted {
            baseline = settled(problem, noise, baseline);
        }
        baseline = better(Some(baseline), Some(anew)).ok_or(CompareError::NoFit)?;
    }
    Ok(led_baseline(problem, noise, baseline))
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

/// Fits the baseline and leaves out the rows that have no answer at the best fit, until all that count have one. `starts` as
/// those of a [`Task`](super::Task).
fn fitted(
    problem: &mut Problem,
    noise: &Noise,
    starts: &[Vec<f64>],
    unanswered: &mut Vec<Unanswered>,
) -> Result<Calibration, CompareError> {
    loop {
        let task = problem.task(&[], starts.to_vec());
        let fit = run_open(problem, noise, &task);
        let missing = match &fit {
            Some(fit) => modelled(problem, &fit.values())?.missing(&problem.layout),
            None => without_a_start(problem)?,
        };
        let Some(first) = missing.first() else { return fit.ok_or_else(|| no_start(problem)) };
        if missing.iter().any(|rows| has_gone_astray(&rows.error))
            && let Some(whole) = run(problem, noise, &task)
        {
            return Ok(whole);
        }
        let rows: Vec<(usize, usize)> = missing.iter().map(|rows| (rows.run, rows.rows.start)).collect();
        problem.layout.leave_out(&rows);
        let ((all, answered), free) = (problem.layout.rows(), problem.base.len());
        if problem.layout.present() <= free || (answered as f64) < LEAST_ANSWERED * all as f64 {
            return Err(CompareError::TooFewAnswers {
                answered,
                rows: all,
                free,
                first: Box::new(first.error.clone()),
            });
        }
        unanswered.extend(missing);
    }
}

/// On a traverse far from the measurements, a second calibration of the baseline; the better of the two is returned. The second
/// starts from a fit in which a guiding force (`guide.rs`) holds the rover near the measured velocity, so that it does not get
/// stuck.
fn led_baseline(problem: &Problem, noise: &Noise, baseline: Calibration) -> Calibration {
    if !problem.strategy().can_be_led(problem, &baseline) {
        return baseline;
    }
    let led = Task { guided: true, ..problem.task(&[], Vec::new()) };
    let on = |led: Calibration| run(problem, noise, &problem.task(&[], vec![led.values()]));
    let again = run(problem, noise, &led).and_then(on);
    match again.filter(|again| again.chi_square < baseline.chi_square * (1.0 - SAME_FIT)) {
        Some(again) => Calibration { searches: baseline.searches + 1, ..again },
        None => baseline,
    }
}

/// Whether two fits have the same parameters, to a search's accuracy.
fn is_at(fit: &Calibration, other: &Calibration) -> bool {
    let near = |(a, b): (&CalibratedParameter, &CalibratedParameter)| {
        (a.value - b.value).abs() <= SAME_FIT * (a.variable.max - a.variable.min)
    };
    fit.parameters.iter().zip(&other.parameters).all(near)
}

/// Where no search has a start: the rows of the runs in which the rover cannot be put on the ground with the given parameters.
fn without_a_start(problem: &Problem) -> Result<Vec<Unanswered>, CompareError> {
    let given: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
    let mut missing = modelled(problem, &given)?.missing(&problem.layout);
    missing.retain(|rows| rows.error.is_of_the_motion());
    Ok(missing)
}

/// Whether a search that ends here has gone astray more often than not, so that a fit that answers every row comes first: on
/// a traverse, unless the rover only ran beyond the known ground, which a slower one would not.
fn has_gone_astray(error: &PredictionError) -> bool {
    matches!(error, PredictionError::Ended { event, .. } if *event != Event::LeftTerrain)
}

/// A fit seen over the rows that count now; as it is where it does not answer them.
fn settled(problem: &Problem, noise: &Noise, fit: Calibration) -> Calibration {
    let again = super::fits::settle(problem, noise, &problem.task(&[], vec![fit.values()]));
    again.map_or(fit.clone(), |again| Calibration { searches: fit.searches, agreeing: fit.agreeing, ..again })
}

fn no_start(problem: &Problem) -> CompareError {
    let start: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
    match problem.predict(&problem.base, |predict| predict.values(&start)) {
        Ok(Err(error)) | Err(error) => CompareError::NoStart(error),
        Ok(Ok(_)) => CompareError::NoFit,
    }
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
