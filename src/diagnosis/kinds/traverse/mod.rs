//! A rover on a profile: every run is a time series, whose simulation takes tenths of a second.

mod differences;
mod place;
mod plan;
mod prediction;
mod shapes;
mod slopes;
mod starts;
#[cfg(test)]
pub(crate) mod synthetic;
mod variations;

use super::{Alikes, Budget, LeftOut, Strategy};
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::curves::Axis;
use crate::diagnosis::diagnose::{Phase, Shape};
use crate::diagnosis::effort::Effort;
use crate::diagnosis::free::Free;
use crate::diagnosis::halt::Halt;
use crate::diagnosis::layout::Layout;
use crate::diagnosis::least_squares::Pace;
use crate::diagnosis::precedence::Choice;
use crate::diagnosis::prediction::{Predict, PredictionError};
use crate::diagnosis::problem::Problem;
use crate::diagnosis::readings::Sensors;
use crate::diagnosis::separate::variation::Variation;
use crate::diagnosis::thresholds::REACH_ALIKE;
use crate::diagnosis::windows::free::FreeStart;
use crate::diagnosis::windows::{Windows, cut};
use crate::measurement::Experiment;
use crate::model::{Model, ModelKind};
use bekker_modeldescription::{Lookup, Variable};

pub use plan::TraversePlan;
use prediction::TraversePrediction;

/// Inner steps of a diagnosis, s, the longest first.
/// A diagnosis simulates the experiment hundreds of times. On drives over hills 5 ms change signals by under 0.002 of a noise of 2 %,
/// 10 ms by under 0.01, and 20 ms by more than the noise: heave and pitch on their soil ring. Whether the first is exact enough
/// is tried on the experiment itself, see `prepare`.
const COARSE: [f64; 2] = [0.01, 0.005];

/// The start of a fit, as a share of a parameter's range, where the sensitivities predict no gain.
const STARTS: [f64; 1] = [0.1];

/// The strategy for a traverse.
#[derive(Debug)]
pub(super) struct Traverse;

impl Strategy for Traverse {
    fn finds(&self, choice: &Choice) -> Result<ModelKind, CompareError> {
        let what = match choice.model.kind {
            ModelKind::Rover => return Ok(ModelKind::Rover),
            ModelKind::Carriage => "a wheel on a carriage",
            ModelKind::SoilTest => "a test of a soil",
        };
        Err(CompareError::Vehicle(format!("a traverse needs a rover, and {} is {what}", choice.label)))
    }

    fn commanded_wheels(&self, experiment: &Experiment) -> usize {
        experiment.runs.iter().map(|run| run.inputs.len()).max().unwrap_or(0)
    }

    /// The rover that was measured could drive.
    fn unfit(&self, _: &Model) -> Option<String> {
        None
    }

    fn uncounted_rows(&self, experiment: &Experiment) -> Vec<usize> {
        experiment.runs.iter().map(cut::uncounted).collect()
    }

    /// Rows off the grid are met to half a step, which the comparison with the next finer step judges too.
    fn coarse_steps(&self, _: &Experiment) -> Vec<f64> {
        COARSE.to_vec()
    }

    fn prediction<'p>(&self, problem: &'p Problem, free: &'p [Free]) -> Result<Box<dyn Predict + 'p>, PredictionError> {
        Ok(Box::new(prediction(problem, free)?))
    }

    fn windows(&self, experiment: &Experiment, models: &[Model]) -> Windows {
        cut::cut(experiment, models)
    }

    fn free_starts(&self, problem: &Problem, free: &[Free], values: &[f64]) -> Result<Vec<FreeStart>, PredictionError> {
        let mut starts = prediction(problem, free)?.free_starts(values)?;
        Sensors::of(problem, free).record_starts(&mut starts, values);
        Ok(starts)
    }

    fn conditions(&self, experiment: &Experiment) -> Vec<String> {
        let mut names = vec!["time".to_owned()];
        names.extend(experiment.runs.first().into_iter().flat_map(|run| run.inputs.clone()));
        names.extend(["x", "pitch"].map(str::to_owned));
        names
    }

    fn alikes(&self, _: &Problem, _: &str) -> Option<Alikes> {
        Some(Alikes { chi_square: REACH_ALIKE, share: 0.0 })
    }

    fn parameters(&self, model: &Model) -> Vec<(Variable, f64)> {
        model.clone().list()
    }

    /// A run has a course of its own: there is no curve over an input.
    fn axes(&self) -> &'static [Axis] {
        &[]
    }

    fn discrepancy(&self, experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Vec<Shape> {
        shapes::discrepancy(experiment, layout, modelled)
    }

    fn modulations(&self, experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Vec<Shape> {
        shapes::modulations(experiment, layout, modelled)
    }

    /// Fits are dear: a second search shows whether the first has found the least cost, and more are made only where they differ.
    /// One search alone may end in a soil of another kind, whose misfit then looks like a missing effect; and where a soil
    /// lets the rover get stuck the cost is flat, so that draws are needed to find one that gets through.
    fn budget(&self) -> Budget {
        Budget {
            calibration: Effort { draws: 0, searches: 0, pace: Pace::BRISK, until_agreed: Some((24, 6)) },
            singles: Some(8),
            pairs: 4,
            soil_classes: 1,
            profiles_of_calibrated: false,
            refits_from_larger: true,
            by_products: true,
            predicts_whole: false,
        }
    }

    /// The number of fits, and what other work takes in fits on a reduced traverse of the generator.
    fn work(&self, phase: Phase) -> f64 {
        match phase {
            Phase::Noise => 1.0,
            Phase::Baseline | Phase::LeftOut => 2.0,
            Phase::Rivals => 3.0,
            Phase::Profiles | Phase::Next => 6.0,
            Phase::Singles | Phase::Sets => 8.0,
            Phase::Done => 0.0,
        }
    }

    fn further_starts(&self, promised: bool) -> &'static [f64] {
        if promised { &[] } else { &STARTS }
    }

    /// Near the measurements a rover needs no lead, and in windows it begins anew every few seconds.
    fn can_be_led(&self, problem: &Problem, fit: &Calibration) -> bool {
        fit.is_far() && !problem.is_cut()
    }

    /// Far from the measurements a linear step means little where errors add up over a whole replay.
    fn left_out(&self, problem: &Problem, fit: &Calibration) -> LeftOut {
        if fit.is_far() && !problem.is_cut() { LeftOut::ShortRefit } else { LeftOut::Step }
    }

    fn variations(&self, model: &Model, experiment: &Experiment, halt: Halt) -> Vec<Variation> {
        variations::variations(model, experiment, halt)
    }
}

fn prediction<'p>(problem: &'p Problem, free: &'p [Free]) -> Result<TraversePrediction<'p>, PredictionError> {
    let (experiment, models) = (&problem.experiment, problem.models.clone());
    let prediction =
        TraversePrediction::new(experiment, &problem.layout, models, free, problem.guided, &problem.windows)?;
    Ok(prediction.until(problem.halt))
}
