//! Derivatives of the modelled values of a traverse.
//!
//! Derivatives of a run that is cut into windows are differences: windows under several values go side by side, eight at a time,
//! faster than one with exact derivatives. Derivatives in an effect's parameter at its neutral value are exact, since beside it another
//! law may begin, unless the effect acts by another parameter and lists this one as smooth there. Exact are also those of a run with
//! open-loop commands that is replayed as a whole, since errors of differences grow with the length of a replay. A run with feedback loops has differences to both sides, larger ones.

use super::differences::Changes;
use super::prediction::{Ended, TraversePrediction};
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::recorded::{Drives, Recorded};
use crate::diagnosis::replay::Replay;
use crate::diagnosis::unanswered::Unanswered;
use crate::parallel::map_in_order;
use crate::rover::Rover;
use crate::scalar::{Dual, Scalar};
use bekker_modeldescription::Parameters;

/// Exact derivatives that are computed at a time.
const WIDTH: usize = 8;

/// Part of the exact derivatives of one run with open-loop commands.
struct SlopeTask<'a> {
    run: &'a Recorded,
    replay: &'a Replay,
    /// Free parameters that this part covers.
    covered: Vec<usize>,
}

/// What a task gives: the recorded signals, row by row, and their derivatives in the covered parameters.
pub(super) struct Traces {
    pub values: Vec<f64>,
    pub slopes: Vec<Vec<f64>>,
    /// Rows that the run did not reach, and how it ended.
    pub ended: Ended,
}

/// Values and their derivatives, and the rows that were not reached.
pub(super) type Slopes = ((Vec<f64>, Vec<Vec<f64>>), Vec<Unanswered>);

impl TraversePrediction<'_> {
    /// Derivatives in the task's parameters, for which [`Dual`] has room.
    fn traces<const N: usize>(&self, task: &SlopeTask, free: &[f64]) -> Result<Traces, PredictionError> {
        let SlopeTask { run, replay, .. } = task;
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

    /// The derivatives that `changes` does not cover, in parts.
    fn tasks(&self, changes: &[Option<Changes>]) -> Vec<SlopeTask<'_>> {
        let mut tasks = Vec::new();
        for (run, done) in self.runs.iter().zip(changes) {
            let Drives::Open(replay) = &run.drives else { continue };
            let is_done = |k: &usize| done.iter().flatten().any(|change| change.parameter == *k);
            let left: Vec<usize> = run.felt.iter().copied().filter(|k| !is_done(k)).collect();
            if left.is_empty() && done.is_none() {
                tasks.push(SlopeTask { run, replay, covered: Vec::new() });
            }
            tasks.extend(left.chunks(WIDTH).map(|covered| SlopeTask { run, replay, covered: covered.to_vec() }));
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
            let covered: Vec<usize> = changes.iter().flatten().map(|change| change.parameter).collect();
            traces.into_iter().for_each(|traces| store(run, &covered, traces));
        }
        Ok(((values, slopes), self.beyond(&ended)))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
mod tests {
    use super::super::differences::Change;
    use super::*;
    use crate::diagnosis::free::Free;
    use crate::diagnosis::kinds::synthetic::experiment;
    use crate::diagnosis::kinds::traverse::prediction;
    use crate::diagnosis::problem::Problem;
    use crate::model::{ControlKind, Model};
    use crate::simulation::Status;
    use bekker_modeldescription::{Lookup, Role, Variable};

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

    /// The traced signals of a run that its model drives by itself, row by row.
    fn driven(prediction: &TraversePrediction, run: &Recorded, values: &[f64]) -> Vec<f64> {
        let (Drives::Open(replay) | Drives::Loop(replay)) = &run.drives;
        let mut alone = prediction.model(run, values).unwrap().start().unwrap();
        let mut trace = vec![f64::NAN; run.traced_values()];
        let mut done = 0;
        for row in 0..run.rows() {
            let status = alone.advance(replay.due(row) - done).unwrap();
            assert_eq!(status, Status::Running, "row {row}");
            done = replay.due(row);
            run.read(alone.signals(), row, &mut trace);
            alone.inputs_mut().set_all(replay.command(row)).unwrap();
        }
        trace
    }

    #[test]
    fn agreement_runs_with_loops_go_side_by_side_as_alone_to_the_last_bit() {
        let experiment = experiment("speed_command", false);
        let mut model = model("torque_command");
        model.control.kind = ControlKind::SpeedLoop;
        let mut problem = Problem::new(&model, &experiment, &[]).unwrap();
        problem.coarsen();
        problem.cut();
        let values: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
        let prediction = prediction(&problem, &problem.base).unwrap();
        let changes = prediction.changes(&values).unwrap();
        let together = prediction.side_by_side(&values, &changes).unwrap();
        for ((run, together), changes) in prediction.runs.iter().zip(together).zip(&changes) {
            let (together, changes) = (together.unwrap(), changes.as_ref().unwrap());
            let at = |parameter: usize, value: f64| {
                let mut changed = values.clone();
                changed[parameter] = value;
                driven(&prediction, run, &changed)
            };
            assert_eq!(together.values, at(0, values[0]));
            for (Change { parameter, from, to }, slope) in changes.iter().zip(&together.slopes) {
                let (low, high) = (at(*parameter, *from), at(*parameter, *to));
                let expected: Vec<f64> = high.iter().zip(&low).map(|(a, b)| (a - b) / (to - from)).collect();
                assert_eq!(*slope, expected, "{}", prediction.free[*parameter].variable.name);
            }
        }
    }

    /// A short run is not cut; what the runs after it give stays theirs.
    #[test]
    fn agreement_a_run_that_is_not_cut_changes_nothing_of_the_others() {
        let (experiment, model) = (experiment("speed_command", false), model("speed_command"));
        let mut problem = Problem::new(&model, &experiment, &[]).unwrap();
        problem.coarsen();
        problem.cut();
        let values: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
        let all = |problem: &Problem| prediction(problem, &problem.base).unwrap().all_slopes(&values).unwrap().0;
        let cut = all(&problem);
        problem.windows[0].clear();
        let mixed = all(&problem);
        for block in (1..3).flat_map(|run| problem.layout.of_run(run)) {
            let bits = |column: &[f64]| column[block.range.clone()].iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&mixed.0), bits(&cut.0), "{} of run {}", block.signal, block.run);
            for (mixed, cut) in mixed.1.iter().zip(&cut.1) {
                assert_eq!(bits(mixed), bits(cut), "derivatives of {} of run {}", block.signal, block.run);
            }
        }
    }

    /// Compares derivatives by differences with exact ones, in each parameter that `of` asks for; how many were compared.
    fn agree(prediction: &TraversePrediction, values: &[f64], of: &dyn Fn(&str) -> bool, what: &str) -> usize {
        let mut compared = 0;
        let changes = prediction.changes(values).unwrap();
        let by_differences = prediction.side_by_side(values, &changes).unwrap();
        let none: Vec<Option<Changes>> = changes.iter().map(|_| None).collect();
        for task in prediction.tasks(&none) {
            let exact = prediction.traces::<WIDTH>(&task, values).unwrap();
            let at = prediction.runs.iter().position(|run| std::ptr::eq(run, task.run)).unwrap();
            let own = by_differences[at].as_ref().unwrap();
            for (k, exact) in task.covered.iter().zip(&exact.slopes) {
                let name = &prediction.free[*k].variable.name;
                if !of(name) {
                    continue;
                }
                let place = changes[at].as_ref().unwrap().iter().position(|change| change.parameter == *k).unwrap();
                let largest = exact.iter().fold(0.0_f64, |most, slope| most.max(slope.abs()));
                let off = exact.iter().zip(&own.slopes[place]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(largest > 0.0 && off <= CURVED * largest, "{what} {name}: off by {off} of {largest}");
                compared += 1;
            }
        }
        compared
    }

    #[test]
    fn agreement_differences_between_windows_are_exact_derivatives() {
        for drive in ["speed_command", "torque_command"] {
            checked(drive, false, |prediction, values| {
                assert!(agree(prediction, values, &|_| true, drive) > 0);
            });
        }
    }

    /// Beside the neutral value of one parameter of an effect that acts by another, where the effect lists it as smooth.
    #[test]
    fn agreement_differences_are_exact_derivatives_at_neutral_values_that_effects_list() {
        let experiment = experiment("torque_command", false);
        let mut listed = 0;
        for (id, facts) in Model::preset("two_wheeled").unwrap().rover.effects.facts() {
            for own in facts.smooth_at_neutral {
                let mut model = model("torque_command");
                let neutral = format!("{id}.{own}");
                let all = model.list().into_iter().filter(|(variable, _)| variable.name.starts_with(&format!("{id}.")));
                for (variable, _) in all.collect::<Vec<_>>() {
                    let acting = variable.default + 0.1 * (variable.max - variable.default);
                    let value = if variable.name == neutral { variable.default } else { acting };
                    model.set(&variable.name, value).unwrap();
                }
                let mut problem = Problem::new(&model, &experiment, &[]).unwrap();
                problem.coarsen();
                problem.cut();
                let mut free = problem.base.clone();
                let (variable, start) =
                    model.list().into_iter().find(|(variable, _)| variable.name == neutral).unwrap();
                free.push(Free { variable, start, prior: None, shared: None, within: None });
                let values: Vec<f64> = free.iter().map(|free| free.start).collect();
                let compared = agree(&prediction(&problem, &free).unwrap(), &values, &|name| name == neutral, "listed");
                assert_eq!(compared, experiment.runs.len(), "{neutral}: once in each run");
                listed += 1;
            }
        }
        assert!(listed >= 5, "{listed} parameters are listed");
    }
}
