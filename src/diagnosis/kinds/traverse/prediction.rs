//! A rover on a profile: the recorded commands replayed through the simulation.
//!
//! The rover starts at rest, settled above `x0`, at the time of the first row. The commands of a row hold until the
//! next row's time; signals are compared at their rows, before the row's own command acts. Rows are met to half an inner
//! step (1 ms by default).
//!
//! Runs that repeat another (the same model, ground and commands at the same times) are simulated once. Different runs,
//! and chunks of derivatives, are computed in parallel; nothing is summed between them, so the bits do not depend on the
//! number of threads.

use super::place::place;
use crate::diagnosis::free::Free;
use crate::diagnosis::guide::Guide;
use crate::diagnosis::halt::Halt;
use crate::diagnosis::layout::Layout;
use crate::diagnosis::prediction::{Derivatives, Predict, PredictionError};
use crate::diagnosis::recorded::{Drives, Recorded, Traced};
use crate::diagnosis::unanswered::{Answers, Unanswered, all_answered};
use crate::diagnosis::windows::Windows;
use crate::measurement::Experiment;
use crate::model::Model;
use crate::parallel::map_in_order;
use crate::rover::Rover;
use crate::scalar::{Dual, Scalar};
use bekker_modeldescription::Parameters;
use std::ops::Range;

/// Central differences, where there is a feedback loop, over this share of a parameter's range or value, whichever is
/// smaller: the error of the integrator, about 1e-9, divided by it stays under 1e-4.
const DIFFERENCE: f64 = 1e-4;

/// Replays of all runs.
pub(crate) struct TraversePrediction<'a> {
    pub(super) layout: &'a Layout,
    experiment: &'a Experiment,
    /// Different runs, on their ground, commanded as they were.
    pub(super) runs: Vec<Recorded>,
    /// For each run of the experiment, which of these it is; a run that is left out is none.
    pub(super) places: Vec<Option<usize>>,
    free: &'a [Free],
    pub(super) halt: Halt<'a>,
}

/// Part of the derivatives of one run.
struct SlopeTask<'a> {
    run: &'a Recorded,
    /// Free parameters that this part covers.
    covered: &'a [usize],
}

/// Rows that a run did not reach, and why.
type Ended = Vec<(Range<usize>, PredictionError)>;

/// What a task gives: the recorded signals, row by row, and their derivatives in the covered parameters.
struct Traces {
    values: Vec<f64>,
    slopes: Vec<Vec<f64>>,
    /// Rows that the run did not reach, and how it ended.
    ended: Ended,
}

impl<'a> TraversePrediction<'a> {
    /// `models` has one model a run, with what is known of that run. A free parameter that a run sets itself stays as
    /// it is in that run. `guided` runs are led at the measured velocity, where it was measured and no loop drives them.
    /// `windows` says how runs are cut, if any are.
    pub fn new(
        experiment: &'a Experiment,
        layout: &'a Layout,
        models: Vec<Model>,
        free: &'a [Free],
        guided: bool,
        windows: &Windows,
    ) -> Result<Self, PredictionError> {
        let mut runs: Vec<Recorded> = Vec::new();
        let mut places = Vec::new();
        for (k, (model, run)) in models.into_iter().zip(&experiment.runs).enumerate() {
            if layout.is_left_out(k) {
                places.push(None);
                continue;
            }
            let own = |free: &Free| run.parameters.contains_key(&free.variable.name);
            let felt = (0..free.len()).filter(|at| !own(&free[*at])).collect();
            let mut model = place(model, run)?;
            let guide = if guided { Guide::of(run, &mut model) } else { None };
            let recorded =
                Recorded::new(model, run, layout.of_run(k), felt, guide, windows.get(k).map_or(&[], Vec::as_slice))?;
            let first = runs.iter().position(|other| other.repeats(&recorded));
            places.push(Some(first.unwrap_or(runs.len())));
            match first {
                Some(first) => runs[first].take(recorded),
                None => runs.push(recorded),
            }
        }
        Ok(Self { layout, experiment, runs, places, free, halt: Halt::default() })
    }

    /// The same, whose simulations end where `halt` asks for it.
    pub fn until(self, halt: Halt<'a>) -> Self {
        Self { halt, ..self }
    }

    /// The run's model with the free parameters at these values.
    pub(super) fn model(&self, run: &Recorded, free: &[f64]) -> Result<Model, PredictionError> {
        let mut model = run.model.clone();
        model.visit("", &mut |variable, value| {
            if let Some(at) = self.position(run, &variable.name) {
                *value = free[at];
            }
        });
        model.check_start().map_err(|source| run.failed(source))?;
        model.in_joint_coordinates("a diagnosis").map_err(|source| run.failed(source))?;
        Ok(model)
    }

    /// Which free parameter has this name, if the run leaves it free.
    fn position(&self, run: &Recorded, name: &str) -> Option<usize> {
        run.felt.iter().copied().find(|at| self.free[*at].variable.name == name)
    }

    fn trace(&self, run: &Recorded, free: &[f64]) -> Result<Traced<f64>, PredictionError> {
        let model = self.model(run, free)?;
        match &run.drives {
            Drives::Open(replay) if run.windows.is_empty() => {
                run.replayed(replay, model.rover, model.start.x0, self.halt)
            }
            Drives::Open(replay) => run.windowed(replay, &model.rover, model.start.x0, &|open| open, self.halt),
            Drives::Loop(commands) => run.driven(&model, commands, self.halt),
        }
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

    /// The derivatives of all runs in parts of `width` parameters.
    fn tasks(&self, width: usize) -> Vec<SlopeTask<'_>> {
        let mut tasks = Vec::new();
        for run in &self.runs {
            if run.felt.is_empty() {
                tasks.push(SlopeTask { run, covered: &[] });
            }
            tasks.extend(run.felt.chunks(width).map(|covered| SlopeTask { run, covered }));
        }
        tasks
    }

    /// Values and derivatives, where a run ended early as at the last row that it reached; and the rows beyond.
    fn slopes_by<const N: usize>(&self, free: &[f64]) -> Result<Slopes, PredictionError> {
        let tasks = self.tasks(N);
        let mut values = vec![f64::NAN; self.layout.len()];
        let mut slopes = vec![vec![0.0; self.layout.len()]; free.len()];
        let mut ended: Vec<(usize, Ended)> = Vec::new();
        for (task, traces) in tasks.iter().zip(map_in_order(&tasks, |task| self.traces::<N>(task, free))) {
            let traces = traces?;
            let run = self.runs.iter().position(|run| std::ptr::eq(run, task.run));
            ended.extend(run.map(|run| (run, traces.ended)));
            task.run.store(&traces.values, &mut values);
            for (k, slope) in task.covered.iter().zip(&traces.slopes) {
                task.run.store(slope, &mut slopes[*k]);
            }
        }
        Ok(((values, slopes), self.beyond(&ended)))
    }

    fn all_slopes(&self, free: &[f64]) -> Result<Slopes, PredictionError> {
        // A pass with 8 derivatives costs less than two with 4, and one with 12 less than two with 8. Two widths only: each is one more
        // copy of the physics to compile.
        match free.len() {
            9..=12 => self.slopes_by::<12>(free),
            _ => self.slopes_by::<8>(free),
        }
    }

    /// The rows of the experiment's runs that a run did not reach.
    fn beyond(&self, ended: &[(usize, Ended)]) -> Vec<Unanswered> {
        let mut unanswered = Vec::new();
        for (run, place) in self.places.iter().enumerate() {
            let own = ended.iter().find(|(ended, _)| Some(*ended) == *place);
            for (rows, error) in own.into_iter().flat_map(|(_, ended)| ended) {
                let error = error.clone().in_run(&self.experiment.runs[run].name);
                unanswered.push(Unanswered { run, rows: rows.clone(), error });
            }
        }
        unanswered
    }

    /// Takes what the model does not say out of values or derivatives.
    fn blank(&self, values: &mut [f64], unanswered: &[Unanswered], blank: f64) {
        for Unanswered { run, rows, .. } in unanswered {
            for block in self.layout.of_run(*run) {
                values[block.range.clone()][rows.clone()].fill(blank);
            }
        }
    }
}

/// Values and their derivatives, and the rows that were not reached.
type Slopes = ((Vec<f64>, Vec<Vec<f64>>), Vec<Unanswered>);

impl Predict for TraversePrediction<'_> {
    /// Hundredths of a unit of chi-square: a search costs seconds, and rounding of the runs is amplified on rough ground.
    fn tolerance(&self) -> f64 {
        1e-6
    }

    fn layout(&self) -> &Layout {
        self.layout
    }

    fn answers(&self, free: &[f64]) -> Result<Answers, PredictionError> {
        let mut values = vec![f64::NAN; self.layout.len()];
        let mut ended = Vec::new();
        let traced = map_in_order(&self.runs, |run| self.trace(run, free));
        for (k, (run, traced)) in self.runs.iter().zip(traced).enumerate() {
            match traced {
                Ok(traced) => {
                    run.store(&traced.values, &mut values);
                    ended.push((k, traced.ended));
                }
                // Where the rover cannot stand or move at all, no row of the run has an answer.
                Err(error) if error.is_of_the_motion() => ended.push((k, vec![(0..run.rows(), error)])),
                Err(error) => return Err(error),
            }
        }
        let unanswered = self.beyond(&ended);
        self.blank(&mut values, &unanswered, f64::NAN);
        Ok(Answers { values, unanswered })
    }

    fn slopes(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        let ((mut values, mut slopes), unanswered) = self.all_slopes(free)?;
        all_answered(&unanswered, self.layout)?;
        self.blank(&mut values, &unanswered, f64::NAN);
        slopes.iter_mut().for_each(|slope| self.blank(slope, &unanswered, 0.0));
        Ok((values, slopes))
    }

    fn values_onward(&self, free: &[f64]) -> Result<Vec<f64>, PredictionError> {
        let mut values = vec![f64::NAN; self.layout.len()];
        for (run, traced) in self.runs.iter().zip(map_in_order(&self.runs, |run| self.trace(run, free))) {
            run.store(&traced?.values, &mut values);
        }
        Ok(values)
    }

    fn slopes_onward(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        Ok(self.all_slopes(free)?.0)
    }

    fn derivatives(&self) -> Derivatives {
        let open = self.runs.iter().all(|run| matches!(run.drives, Drives::Open(_)));
        if open { Derivatives::Exact } else { Derivatives::Differences }
    }
}
