//! A rover on a profile: the recorded commands replayed through the simulation.
//!
//! The rover starts at rest, settled above `x0`, at the time of the first row. The commands of a row hold until the
//! next row's time; signals are compared at their rows, before the row's own command acts. Rows are met to half an inner
//! step (1 ms by default).
//!
//! Runs that repeat another (the same model, ground and commands at the same times) are simulated once. Different runs,
//! windows and derivatives are computed in parallel; nothing is summed between them, so the bits do not depend on the
//! number of threads.

use super::place::place;
use crate::diagnosis::free::Free;
use crate::diagnosis::guide::Guide;
use crate::diagnosis::halt::Halt;
use crate::diagnosis::layout::Layout;
use crate::diagnosis::prediction::{Derivatives, Predict, PredictionError};
use crate::diagnosis::recorded::{Drives, Recorded, Traced, Variant, traced};
use crate::diagnosis::unanswered::{Answers, Unanswered, all_answered};
use crate::diagnosis::windows::Windows;
use crate::measurement::Experiment;
use crate::model::{ControlKind, Model};
use bekker_modeldescription::Parameters;
use std::ops::Range;

/// Replays of all runs.
pub(crate) struct TraversePrediction<'a> {
    pub(super) layout: &'a Layout,
    experiment: &'a Experiment,
    /// Different runs, on their ground, commanded as they were.
    pub(super) runs: Vec<Recorded>,
    /// For each run of the experiment, which of these it is; a run that is left out is none.
    pub(super) places: Vec<Option<usize>>,
    pub(super) free: &'a [Free],
    pub(super) halt: Halt<'a>,
}

/// Rows that a run did not reach, and why.
pub(super) type Ended = Vec<(Range<usize>, PredictionError)>;

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
            let open = matches!(model.control.kind, ControlKind::Speed | ControlKind::Torque);
            let guide = if guided && open { Guide::of(run, &mut model) } else { None };
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
    pub(super) fn position(&self, run: &Recorded, name: &str) -> Option<usize> {
        run.felt.iter().copied().find(|at| self.free[*at].variable.name == name)
    }

    /// What each run gives.
    fn all_traces(&self, free: &[f64]) -> Result<Vec<Result<Traced<f64>, PredictionError>>, PredictionError> {
        let variant = |run| Ok(Variant::new(run, self.model(run, free)?));
        Ok(traced(&self.runs.iter().map(variant).collect::<Result<Vec<_>, _>>()?, self.halt))
    }

    /// The rows of the experiment's runs that a run did not reach.
    pub(super) fn beyond(&self, ended: &[(usize, Ended)]) -> Vec<Unanswered> {
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
        for (k, (run, traced)) in self.runs.iter().zip(self.all_traces(free)?).enumerate() {
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
        for (run, traced) in self.runs.iter().zip(self.all_traces(free)?) {
            run.store(&traced?.values, &mut values);
        }
        Ok(values)
    }

    fn slopes_onward(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        Ok(self.all_slopes(free)?.0)
    }

    fn derivatives(&self) -> Derivatives {
        let whole = |run: &Recorded| matches!(run.drives, Drives::Open(_)) && run.windows.is_empty();
        if self.runs.iter().all(whole) { Derivatives::Exact } else { Derivatives::Differences }
    }
}
