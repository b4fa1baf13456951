//! Derivatives of the modelled values of a traverse.
//!
//! Derivatives of a run that is cut into windows are differences: windows under several values go side by side, eight at a time,
//! faster than one with exact derivatives. Derivatives in an effect's parameter at its neutral value are exact, since beside it another
//! law may begin, and so are those of a run that is replayed as a whole, since errors of differences grow with the length of a replay.

use super::prediction::{Ended, TraversePrediction};
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::recorded::{Drives, Recorded, Traced, Variant, traced};
use crate::diagnosis::unanswered::Unanswered;
use crate::parallel::map_in_order;
use crate::rover::Rover;
use crate::scalar::{Dual, Scalar};
use bekker_modeldescription::{Parameters, Role, Variable};

/// Forward differences, where a run is cut into windows, over this share of a parameter's range or value, whichever is smaller, but no
/// less than [`LEAST_DIFFERENCE`] of the range: rounding of a window, about 1e-12, and the curvature over the difference both stay near
/// 1e-6 of a derivative.
const SMALL_DIFFERENCE: f64 = 1e-6;
const LEAST_DIFFERENCE: f64 = 1e-9;
/// The same for the place (m) and the velocity (m/s) in which a window begins.
pub(super) const SHIFT: f64 = 1e-6;

/// Central differences, where there is a feedback loop, over this share of a parameter's range or value, whichever is
/// smaller: the error of the integrator, about 1e-9, divided by it stays under 1e-4.
const DIFFERENCE: f64 = 1e-4;

/// Exact derivatives that are computed at a time.
const WIDTH: usize = 8;

/// Part of the derivatives of one run.
struct SlopeTask<'a> {
    run: &'a Recorded,
    /// Free parameters that this part covers.
    covered: Vec<usize>,
}

/// What a task gives: the recorded signals, row by row, and their derivatives in the covered parameters.
struct Traces {
    values: Vec<f64>,
    slopes: Vec<Vec<f64>>,
    /// Rows that the run did not reach, and how it ended.
    ended: Ended,
}

/// Values and their derivatives, and the rows that were not reached.
pub(super) type Slopes = ((Vec<f64>, Vec<Vec<f64>>), Vec<Unanswered>);

/// Parameters whose derivatives are differences between windows side by side, and by how much they are changed.
type Changes = Vec<(usize, f64)>;

impl TraversePrediction<'_> {
    /// By how much each free parameter is changed for its difference, run by run; `None` for a run whose windows do not go side by side.
    fn changes(&self, free: &[f64]) -> Result<Vec<Option<Changes>>, PredictionError> {
        let of_run = |run: &Recorded| {
            if !Variant::new(run, self.model(run, free)?).is_separable() {
                return Ok(None);
            }
            let changed = run.felt.iter().filter(|k| !is_neutral(&self.free[**k].variable, free[**k]));
            Ok(Some(changed.map(|k| (*k, difference(&self.free[*k].variable, free[*k]))).collect()))
        };
        self.runs.iter().map(of_run).collect()
    }

    /// Derivatives in the task's parameters, for which [`Dual`] has room.
    fn traces<const N: usize>(&self, task: &SlopeTask, free: &[f64]) -> Result<Traces, PredictionError> {
        let run = task.run;
        let Drives::Open(replay) = &run.drives else { return self.differences(task, free) };
        let model = self.model(run, free)?;
        let seeded = |name: &str, value: f64| {
            let at = self.position(run, name).and_then(|at| task.covered.iter().position(|other| *other == at));
            at.map_or(Dual::<N>::from(value), |k| Dual::<N>::from(value).derivative(k))
        };
        let mut rover: Rover<Dual<N>> = model.rover.map(&Dual::<N>::from);
        rover.visit("", &mut |variable, value| *value = seeded(&variable.name, value.value()));
        let x0 = seeded("x0", model.start.x0);
        let traced = match run.windows.is_empty() {
            true => run.replayed(replay, rover, x0, self.halt)?,
            false => run.windowed(replay, &rover, x0, &|open| open.map(Dual::from), self.halt)?,
        };
        let partial = |k: usize| traced.values.iter().map(|value| value.eps.0.map_or(0.0, |eps| eps[k])).collect();
        Ok(Traces {
            values: traced.values.iter().map(|value| value.re).collect(),
            slopes: (0..task.covered.len()).map(partial).collect(),
            ended: traced.ended,
        })
    }

    fn differences(&self, task: &SlopeTask, free: &[f64]) -> Result<Traces, PredictionError> {
        let slope = |&k: &usize| {
            let variable = &self.free[k].variable;
            let range = DIFFERENCE * (variable.max - variable.min);
            let step = if free[k] == 0.0 { range } else { range.min(DIFFERENCE * free[k].abs()) };
            let at = |value: f64| {
                let mut shifted = free.to_vec();
                shifted[k] = value.clamp(variable.min, variable.max);
                self.trace(task.run, &shifted).map(|traced| (shifted[k], traced.values))
            };
            let ((low, below), (high, above)) = (at(free[k] - step)?, at(free[k] + step)?);
            Ok(above.iter().zip(&below).map(|(a, b)| (a - b) / (high - low)).collect())
        };
        let slopes = task.covered.iter().map(slope).collect::<Result<_, PredictionError>>()?;
        let Traced { values, ended } = self.trace(task.run, free)?;
        Ok(Traces { values, slopes, ended })
    }

    /// Values and derivatives by `changes`, run by run.
    fn side_by_side(&self, free: &[f64], changes: &[Option<Changes>]) -> Result<Vec<Option<Traces>>, PredictionError> {
        let mut variants = Vec::new();
        for (run, changes) in self.runs.iter().zip(changes) {
            let Some(changes) = changes else { continue };
            variants.push(Variant::new(run, self.model(run, free)?));
            for (k, step) in changes {
                let mut changed = free.to_vec();
                changed[*k] += step;
                variants.push(Variant::new(run, self.model(run, &changed)?));
            }
        }
        let mut all = traced(&variants, self.halt).into_iter();
        let mut of_run = |(run, changes): (&Recorded, &Option<Changes>)| {
            let (Some(changes), Some(own)) = (changes, all.next()) else { return Ok(None) };
            let own = own?;
            let mut slopes = Vec::new();
            for ((k, step), changed) in changes.iter().zip(all.by_ref()) {
                // What the sum with the step rounds to.
                slopes.push(run.slope(&own, &changed?, (free[*k] + step) - free[*k]));
            }
            Ok(Some(Traces { values: own.values, slopes, ended: own.ended }))
        };
        self.runs.iter().zip(changes).map(&mut of_run).collect()
    }

    /// The derivatives that `changes` does not cover, in parts.
    fn tasks(&self, changes: &[Option<Changes>]) -> Vec<SlopeTask<'_>> {
        let mut tasks = Vec::new();
        for (run, done) in self.runs.iter().zip(changes) {
            let is_done = |k: &usize| done.iter().flatten().any(|(other, _)| other == k);
            let left: Vec<usize> = run.felt.iter().copied().filter(|k| !is_done(k)).collect();
            if left.is_empty() && done.is_none() {
                tasks.push(SlopeTask { run, covered: Vec::new() });
            }
            tasks.extend(left.chunks(WIDTH).map(|covered| SlopeTask { run, covered: covered.to_vec() }));
        }
        tasks
    }

    /// Values and derivatives, where a run ended early as at the last row that it reached; and the rows beyond.
    pub(super) fn all_slopes(&self, free: &[f64]) -> Result<Slopes, PredictionError> {
        let changes = self.changes(free)?;
        let tasks = self.tasks(&changes);
        let mut values = vec![f64::NAN; self.layout.len()];
        let mut slopes = vec![vec![0.0; self.layout.len()]; free.len()];
        let mut ended: Vec<(usize, Ended)> = Vec::new();
        let mut store = |run: &Recorded, covered: &[usize], traces: Traces| {
            let place = self.runs.iter().position(|other| std::ptr::eq(run, other));
            ended.extend(place.map(|run| (run, traces.ended)));
            run.store(&traces.values, &mut values);
            for (k, slope) in covered.iter().zip(&traces.slopes) {
                run.store(slope, &mut slopes[*k]);
            }
        };
        for (task, traces) in tasks.iter().zip(map_in_order(&tasks, |task| self.traces::<WIDTH>(task, free))) {
            store(task.run, &task.covered, traces?);
        }
        // Values with derivatives are rounded otherwise; those of plain numbers stay.
        for ((run, changes), traces) in self.runs.iter().zip(&changes).zip(self.side_by_side(free, &changes)?) {
            let covered: Vec<usize> = changes.iter().flatten().map(|(k, _)| *k).collect();
            traces.into_iter().for_each(|traces| store(run, &covered, traces));
        }
        Ok(((values, slopes), self.beyond(&ended)))
    }
}

/// Whether an effect's parameter is where the effect does not act.
fn is_neutral(variable: &Variable, value: f64) -> bool {
    variable.role == Role::Effect && value == variable.default
}

/// By how much a parameter is changed for a difference: within its bounds.
fn difference(variable: &Variable, value: f64) -> f64 {
    let range = variable.max - variable.min;
    let own = if value == 0.0 { f64::INFINITY } else { SMALL_DIFFERENCE * value.abs() };
    let step = own.clamp(LEAST_DIFFERENCE * range, SMALL_DIFFERENCE * range);
    if value + step > variable.max { -step } else { step }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
mod tests {
    use super::*;
    use crate::diagnosis::free::Free;
    use crate::diagnosis::kinds::synthetic::experiment;
    use crate::diagnosis::kinds::traverse::prediction;
    use crate::diagnosis::problem::Problem;
    use crate::model::{ControlKind, Model};
    use bekker_modeldescription::Lookup;

    /// Between differences and exact derivatives, relative to the largest derivative of the run. Most agree to 1e-5; where a wheel under
    /// a torque turns round, the curvature over a difference is 2e-4.
    const CURVED: f64 = 5e-4;

    fn model(drive: &str) -> Model {
        let mut model = Model::preset("two_wheeled").unwrap();
        if drive == "speed_command" {
            model.control.kind = ControlKind::Speed;
        }
        for (name, value) in [
            ("slip_sinkage.n1", 0.2),
            ("coulomb_friction.torque", 0.05),
            ("drag.force", 0.5),
            ("exit_angle.lambda", 0.1),
        ] {
            model.set(name, value).unwrap();
        }
        model
    }

    /// The problem of an experiment, cut into windows, with everything free that is not switched off.
    fn checked(drive: &str, steep: bool, check: impl Fn(&TraversePrediction, &[f64])) {
        let (experiment, mut model) = (experiment(drive, steep), model(drive));
        let mut problem = Problem::new(&model, &experiment, &[]).unwrap();
        problem.coarsen();
        problem.cut();
        assert!(problem.windows.iter().all(|windows| windows.len() >= 3), "{:?}", problem.windows);
        let acts = |variable: &Variable, value: f64| variable.role == Role::Effect && value != variable.default;
        let effects = model.list().into_iter().filter(|(variable, value)| acts(variable, *value));
        let mut free = problem.base.clone();
        free.extend(effects.map(|(variable, start)| Free { variable, start, prior: None, shared: None, within: None }));
        let values: Vec<f64> = free.iter().map(|free| free.start).collect();
        check(&prediction(&problem, &free).unwrap(), &values);
    }

    #[test]
    fn agreement_windows_go_side_by_side_as_alone_to_the_last_bit() {
        for (drive, steep) in [("speed_command", false), ("torque_command", false), ("speed_command", true)] {
            checked(drive, steep, |prediction, values| {
                let side_by_side = prediction.side_by_side(values, &prediction.changes(values).unwrap()).unwrap();
                for (run, together) in prediction.runs.iter().zip(side_by_side) {
                    let Drives::Open(replay) = &run.drives else { panic!("commands are followed as they are") };
                    let model = prediction.model(run, values).unwrap();
                    let alone = run.windowed(replay, &model.rover, model.start.x0, &|open| open, prediction.halt);
                    let (alone, together) = (alone.unwrap(), together.unwrap());
                    let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                    assert_eq!(bits(&alone.values), bits(&together.values), "{drive}, steep {steep}");
                    assert_eq!(alone.ended, together.ended);
                }
            });
        }
    }

    #[test]
    fn agreement_differences_between_windows_are_exact_derivatives() {
        for drive in ["speed_command", "torque_command"] {
            checked(drive, false, |prediction, values| {
                let changes = prediction.changes(values).unwrap();
                let by_differences = prediction.side_by_side(values, &changes).unwrap();
                let none: Vec<Option<Changes>> = changes.iter().map(|_| None).collect();
                for task in prediction.tasks(&none) {
                    let exact = prediction.traces::<WIDTH>(&task, values).unwrap();
                    let at = prediction.runs.iter().position(|run| std::ptr::eq(run, task.run)).unwrap();
                    let own = by_differences[at].as_ref().unwrap();
                    for (k, exact) in task.covered.iter().zip(&exact.slopes) {
                        let place = changes[at].as_ref().unwrap().iter().position(|(other, _)| other == k).unwrap();
                        let largest = exact.iter().fold(0.0_f64, |most, slope| most.max(slope.abs()));
                        let off = exact.iter().zip(&own.slopes[place]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                        let name = &prediction.free[*k].variable.name;
                        assert!(off <= CURVED * largest, "{drive} {name}: off by {off} of {largest}");
                    }
                }
            });
        }
    }
}
