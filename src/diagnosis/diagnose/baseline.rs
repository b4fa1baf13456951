//! Fits of the baseline: with rows that have no answer left out, from more than one place where it ends far from the measurements.

use super::fits::{Noise, Task, run, run_open};
use super::prepare::modelled;
use super::search::SAME_FIT;
use crate::diagnosis::calibrate::{CalibratedParameter, Calibration, better};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::LEAST_ANSWERED;
use crate::diagnosis::unanswered::Unanswered;
use crate::diagnosis::undetermined::undetermined;
use crate::simulation::Event;

/// How many of the first fits are followed by a look for rows that depend on the last digits of the parameters. With other parameters these
/// are other rows, so that the look would find some again and again; a search does without their derivatives anyway.
const ROUNDS: usize = 2;

/// The baseline under the final noise, from where the first fit ended and, where that is far, from elsewhere too.
pub(super) fn refitted(
    problem: &mut Problem,
    noise: &Noise,
    first: Calibration,
    unanswered: &mut Vec<Unanswered>,
) -> Result<Calibration, CompareError> {
    let again = fitted_again(problem, noise, &first, unanswered)?;
    // A search that starts where the first one ended may find no step to make.
    let converged = again.converged || (first.converged && is_at(&again, &first));
    let mut baseline = Calibration { converged, ..again };
    // Under a first guess of the noise a fit may have looked near that is far.
    if baseline.is_far() && !first.is_far() {
        let counted = problem.layout.present();
        let anew = fitted(problem, noise, &[], unanswered)?;
        if problem.layout.present() < counted {
            baseline = settled(problem, noise, baseline);
        }
        baseline = better(Some(baseline), Some(anew), problem.strategy().budget().calibration.pace.agreeing)
            .ok_or(CompareError::NoFit)?;
    }
    Ok(led_baseline(problem, noise, baseline))
}

/// The same search once more from where it ended, since the noise or the windows' starts are others now. How many searches agreed
/// is what the first ones showed.
pub(super) fn fitted_again(
    problem: &mut Problem,
    noise: &Noise,
    known: &Calibration,
    unanswered: &mut Vec<Unanswered>,
) -> Result<Calibration, CompareError> {
    let again = fitted(problem, noise, &[known.values()], unanswered)?;
    Ok(Calibration { searches: known.searches, agreeing: known.agreeing, ..again })
}

/// Fits the baseline and leaves out the rows that have no answer at the best fit, until all that count have one. `starts` as
/// those of a [`Task`](super::Task).
pub(super) fn fitted(
    problem: &mut Problem,
    noise: &Noise,
    starts: &[Vec<f64>],
    unanswered: &mut Vec<Unanswered>,
) -> Result<Calibration, CompareError> {
    let mut round = 0;
    loop {
        let task = problem.task(&[], starts.to_vec());
        let fit = run_open(problem, noise, &task);
        let missing = match &fit {
            Some(fit) => {
                let answers = modelled(problem, &fit.values())?;
                let mut missing = answers.missing(&problem.layout);
                if missing.is_empty() && round < ROUNDS {
                    missing = undetermined(problem, &fit.values(), &answers.values)?;
                }
                missing
            }
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
        round += 1;
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
