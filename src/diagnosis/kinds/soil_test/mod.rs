//! Tests of a soil without a wheel: a plate that is pressed into it, and a shear ring or box. Rows are cheap: a formula each.

mod plan;
mod plates;
mod prediction;
mod shapes;
mod variations;

use super::{Alikes, Budget, Strategy};
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::curves::Axis;
use crate::diagnosis::diagnose::{Phase, Shape};
use crate::diagnosis::effort::Effort;
use crate::diagnosis::free::Free;
use crate::diagnosis::halt::Halt;
use crate::diagnosis::layout::Layout;
use crate::diagnosis::least_squares::Pace;
use crate::diagnosis::noise::{Scale, Whitening};
use crate::diagnosis::precedence::{Choice, Rank};
use crate::diagnosis::prediction::{Predict, PredictionError};
use crate::diagnosis::problem::Problem;
use crate::diagnosis::separate::variation::Variation;
use crate::diagnosis::thresholds::{EMPIRICAL, REACH_ALIKE, SMALLEST_SCALE, SOIL_SCATTER};
use crate::effects::Facts;
use crate::measurement::Experiment;
use crate::model::{Model, ModelKind};
use crate::soil_test::{SoilTest as Tested, TestRig};
use bekker_modeldescription::{Lookup, Variable};
use std::collections::BTreeMap;

pub use plan::{PlatePlan, ShearPlan};
use prediction::SoilTestPrediction;

/// The strategy for a test of the soil.
#[derive(Debug)]
pub(super) struct SoilTest {
    /// Inputs of a row.
    inputs: &'static [&'static str],
    /// Signals that may be measured.
    signals: &'static [&'static str],
    /// Parameters of the soil that such a test tells.
    soil: &'static [&'static str],
    /// The model's value of a signal at the inputs of a row.
    pressed: bool,
}

/// A plate.
pub(super) static PLATE: SoilTest = SoilTest {
    inputs: &["sinkage"],
    signals: &["force", "pressure"],
    soil: &["soil.k_c", "soil.k_phi", "soil.exponent"],
    pressed: true,
};

/// A shear ring or box.
pub(super) static SHEAR: SoilTest = SoilTest {
    inputs: &["displacement", "normal_stress"],
    signals: &["shear_stress"],
    soil: &["soil.cohesion", "soil.friction_angle", "soil.shear_modulus"],
    pressed: false,
};

impl Strategy for SoilTest {
    /// A rover or a wheel that is named stays one, on the soil that was tested.
    fn finds(&self, choice: &Choice) -> Result<ModelKind, CompareError> {
        Ok(if choice.rank == Rank::Nobody { ModelKind::SoilTest } else { choice.model.kind })
    }

    fn prepare(&self, model: &mut Model) {
        model.test.get_or_insert_with(TestRig::default);
    }

    fn check_rig(&self, experiment: &Experiment, models: &[Model]) -> Result<(), CompareError> {
        for (run, model) in experiment.runs.iter().zip(models).filter(|_| self.pressed) {
            let plate = model.tested_soil().rig.plate;
            plate.check().map_err(|source| {
                let name = &run.name;
                CompareError::Vehicle(format!(
                    "run {name}: {source} (under [parameters], the run's `parameters`, or as a column)"
                ))
            })?;
        }
        Ok(())
    }

    fn calibrates(&self, name: &str) -> bool {
        !name.starts_with("soil.") || self.soil.contains(&name)
    }

    fn contact_widths(&self, _: &Experiment, models: &[Model]) -> Vec<f64> {
        plates::widths(models)
    }

    fn many_widths(&self, _: &Experiment, models: &[Model]) -> bool {
        plates::widths(models).len() > 1
    }

    fn may_act(&self, facts: Option<&Facts>) -> bool {
        facts.is_some_and(|facts| facts.seen_in_soil_test.iter().any(|signal| self.signals.contains(signal)))
    }

    fn commanded_wheels(&self, _: &Experiment) -> usize {
        0
    }

    /// A rover that was given the soil of a test may not be able to stand or drive on it.
    fn unfit(&self, improved: &Model) -> Option<String> {
        let unfit = improved.check_drive().err()?;
        Some(format!("the improved model puts a rover on a soil that does not carry it: {unfit}"))
    }

    fn coarse_steps(&self, _: &Experiment) -> Vec<f64> {
        Vec::new()
    }

    fn prediction<'p>(&self, problem: &'p Problem, free: &'p [Free]) -> Result<Box<dyn Predict + 'p>, PredictionError> {
        let names: Vec<String> = free.iter().map(|free| free.variable.name.clone()).collect();
        let tests: Vec<Tested> = problem.models.iter().map(Model::tested_soil).collect();
        Ok(Box::new(SoilTestPrediction::new(&problem.experiment, &problem.layout, tests, names)))
    }

    /// Soils differ from one preparation to the next by a share of what they resist, and so does what is measured of one along a
    /// test: noise grows with the stress, in a run under a small plate as in one under a large plate. What a preparation adds is a share of
    /// what the soil resists and no more; a row has the noise of its instrument besides.
    fn noise_scale(&self, problem: &Problem, expected: &[f64]) -> Vec<Scale> {
        let layout = &problem.layout;
        let mut scale = vec![Scale::USUAL; layout.len()];
        for signal in self.signals {
            let blocks = || layout.blocks.iter().filter(|block| block.signal == *signal);
            let usual = root_mean_square(blocks().flat_map(|block| &expected[block.range.clone()]));
            for block in blocks().filter(|_| usual > 0.0) {
                let own = &expected[block.range.clone()];
                let smallest = SMALLEST_SCALE * root_mean_square(own) / usual;
                for (place, value) in scale[block.range.clone()].iter_mut().zip(own).filter(|(_, v)| v.is_finite()) {
                    let row = (value / usual).hypot(smallest).max(f64::MIN_POSITIVE.sqrt());
                    *place = Scale { row, weight: value.abs() / usual / row };
                }
            }
        }
        scale
    }

    fn alikes(&self, _: &Problem, _: &str) -> Option<Alikes> {
        Some(Alikes { chi_square: REACH_ALIKE, share: EMPIRICAL })
    }

    fn assumed_scatter(&self, experiment: &Experiment) -> BTreeMap<String, f64> {
        experiment.signals().into_iter().map(|signal| (signal, SOIL_SCATTER)).collect()
    }

    fn remarks(&self, problem: &Problem, whitening: &Whitening, fit: &Calibration, modelled: &[f64]) -> Vec<String> {
        if self.pressed { plates::remarks(problem, whitening, fit, modelled) } else { Vec::new() }
    }

    fn conditions(&self, _: &Experiment) -> Vec<String> {
        self.inputs.iter().map(|name| (*name).to_owned()).collect()
    }

    /// Of the soil's, those that such a test tells.
    fn parameters(&self, model: &Model) -> Vec<(Variable, f64)> {
        let mut all = model.tested_soil().list();
        all.retain(|(variable, _)| self.calibrates(&variable.name));
        all
    }

    /// Each run has a course of its own.
    fn axes(&self) -> &'static [Axis] {
        &[]
    }

    fn discrepancy(&self, experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Vec<Shape> {
        shapes::discrepancy(experiment, layout, modelled, self.inputs)
    }

    fn modulations(&self, experiment: &Experiment, layout: &Layout, _: &[f64]) -> Vec<Shape> {
        shapes::modulations(experiment, layout, self.inputs)
    }

    /// Fits are cheap: every effect is refitted, from many starts.
    fn budget(&self) -> Budget {
        Budget {
            calibration: Effort { draws: 64, searches: 5, pace: Pace::PATIENT, until_agreed: None },
            singles: None,
            pairs: 24,
            soil_classes: usize::MAX,
            profiles_of_calibrated: true,
            refits_from_larger: false,
            by_products: false,
            predicts_whole: true,
        }
    }

    /// The number of fits, and what other work takes in fits.
    fn work(&self, phase: Phase) -> f64 {
        match phase {
            Phase::Baseline | Phase::Noise => 1.0,
            Phase::Singles | Phase::Sets => 8.0,
            Phase::LeftOut => 6.0,
            Phase::Rivals | Phase::Profiles => 4.0,
            Phase::Next => 2.0,
            Phase::Done => 0.0,
        }
    }

    fn variations(&self, _: &Model, experiment: &Experiment, _: Halt) -> Vec<Variation> {
        variations::variations(experiment, self.pressed)
    }
}

/// Root mean square of the values that are there; 0 of none.
fn root_mean_square<'v>(values: impl IntoIterator<Item = &'v f64>) -> f64 {
    let (sum, count) = values
        .into_iter()
        .filter(|value| value.is_finite())
        .fold((0.0, 0_usize), |(sum, count), value| (sum + value * value, count + 1));
    (sum / count.max(1) as f64).sqrt()
}
