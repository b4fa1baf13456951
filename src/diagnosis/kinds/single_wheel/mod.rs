//! A wheel on a carriage: every row is a steady point, which the model computes in under a millisecond.

mod plan;
mod prediction;
mod shapes;
mod variations;

use super::{Budget, Strategy};
use crate::carriage::Rig;
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::curves::Axis;
use crate::diagnosis::diagnose::{Phase, Shape};
use crate::diagnosis::effort::Effort;
use crate::diagnosis::free::Free;
use crate::diagnosis::halt::Halt;
use crate::diagnosis::layout::Layout;
use crate::diagnosis::least_squares::Pace;
use crate::diagnosis::precedence::{Choice, Rank};
use crate::diagnosis::prediction::{Predict, PredictionError};
use crate::diagnosis::problem::Problem;
use crate::diagnosis::separate::additions::Test;
use crate::diagnosis::separate::variation::Variation;
use crate::measurement::Experiment;
use crate::model::{Model, ModelKind};
use bekker_modeldescription::{Lookup, Variable};

pub use plan::SingleWheelPlan;
use prediction::SingleWheelPrediction;
pub(crate) use prediction::signal;

/// The inputs of a steady point.
const INPUTS: [&str; 3] = ["slip", "load", "wheel_speed"];

/// The strategy for a wheel on a carriage.
#[derive(Debug)]
pub(super) struct SingleWheel;

impl Strategy for SingleWheel {
    /// A rover that is named stays one, though a single wheel of it was measured.
    fn finds(&self, choice: &Choice) -> Result<ModelKind, CompareError> {
        let rover = choice.rank != Rank::Nobody && choice.model.kind == ModelKind::Rover;
        Ok(if rover { ModelKind::Rover } else { ModelKind::Carriage })
    }

    fn commanded_wheels(&self, _: &Experiment) -> usize {
        0
    }

    /// A rover that was given a wheel tested on a carriage may not be able to stand or drive with it.
    fn unfit(&self, improved: &Model) -> Option<String> {
        let unfit = improved.check_drive().err()?;
        Some(format!("the improved model puts the measured wheel and soil on a rover that cannot use them: {unfit}"))
    }

    /// Steady points have no step.
    fn coarse_steps(&self, _: &Experiment) -> Vec<f64> {
        Vec::new()
    }

    fn prediction<'p>(&self, problem: &'p Problem, free: &'p [Free]) -> Result<Box<dyn Predict + 'p>, PredictionError> {
        let names: Vec<String> = free.iter().map(|free| free.variable.name.clone()).collect();
        let rigs = problem.models.iter().map(|model| Rig::of(&model.rover)).collect();
        Ok(Box::new(SingleWheelPrediction::new(&problem.experiment, &problem.layout, rigs, names, problem.halt)))
    }

    fn conditions(&self, _: &Experiment) -> Vec<String> {
        INPUTS.map(str::to_owned).to_vec()
    }

    fn parameters(&self, model: &Model) -> Vec<(Variable, f64)> {
        Rig::of(&model.rover).list()
    }

    fn axes(&self) -> &'static [Axis] {
        &Axis::ALL
    }

    fn discrepancy(&self, experiment: &Experiment, layout: &Layout, _: &[f64]) -> Vec<Shape> {
        shapes::discrepancy(experiment, layout)
    }

    fn modulations(&self, experiment: &Experiment, layout: &Layout, _: &[f64]) -> Vec<Shape> {
        shapes::modulations(experiment, layout)
    }

    /// Fits are cheap: every effect is refitted, from many starts.
    fn budget(&self) -> Budget {
        Budget {
            calibration: Effort { draws: 64, searches: 5, pace: Pace::PATIENT, until_agreed: None },
            singles: None,
            pairs: 24,
            soil_classes: usize::MAX,
            profiles_of_calibrated: true,
            // Searches start from so many places that a refit from a larger set finds nothing.
            refits_from_larger: false,
            by_products: false,
            predicts_whole: true,
        }
    }

    /// The number of fits, and what other work takes in fits on the shipped wheel.
    fn work(&self, phase: Phase) -> f64 {
        match phase {
            Phase::Baseline | Phase::Noise => 1.0,
            Phase::Singles => 24.0,
            Phase::Sets => 30.0,
            Phase::LeftOut => 12.0,
            Phase::Rivals => 4.0,
            Phase::Profiles => 8.0,
            Phase::Next => 2.0,
            Phase::Done => 0.0,
        }
    }

    fn more(&self, model: &Model, experiment: &Experiment) -> Vec<Test> {
        variations::more_loads(model, experiment)
    }

    fn variations(&self, model: &Model, experiment: &Experiment, _: Halt) -> Vec<Variation> {
        variations::variations(model, experiment)
    }
}
