//! What a diagnosis does differently for each kind of experiment: one [`Strategy`] a kind, chosen once by [`strategy`] where a
//! [`Problem`] is posed. All other code of the diagnosis is the same for all kinds.
//!
//! A further kind is a folder beside these, a line in [`strategy`], and a format of its files in
//! [`measurement`](crate::measurement).

mod joint;
mod single_wheel;
mod soil_test;
mod traverse;

#[cfg(test)]
pub(crate) use traverse::synthetic;

use super::calibrate::Calibration;
use super::compare::CompareError;
use super::curves::Axis;
use super::diagnose::{Phase, Shape};
use super::effort::Effort;
use super::free::Free;
use super::halt::Halt;
use super::layout::Layout;
use super::noise::{Scale, Whitening};
use super::precedence::Choice;
use super::prediction::{Predict, PredictionError};
use super::problem::Problem;
use super::separate::additions::Test;
use super::separate::variation::Variation;
use super::windows::Windows;
use super::windows::free::FreeStart;
use crate::effects::Facts;
use crate::measurement::{Experiment, Kind};
use crate::model::{Model, ModelKind};
use bekker_modeldescription::Variable;
use std::collections::BTreeMap;
use std::fmt::Debug;

pub use single_wheel::SingleWheelPlan;
pub(crate) use single_wheel::signal;
pub use soil_test::{PlatePlan, ShearPlan};
pub use traverse::TraversePlan;

/// The strategy for an experiment.
pub(crate) fn strategy(experiment: &Experiment) -> &'static dyn Strategy {
    if !experiment.parts.is_empty() {
        let driven = experiment.parts.iter().any(|part| part.experiment.kind == Kind::Traverse);
        return if driven { &joint::DRIVEN } else { &joint::STEADY };
    }
    match experiment.kind {
        Kind::SingleWheel => &single_wheel::SingleWheel,
        Kind::Traverse => &traverse::Traverse,
        Kind::PlateSinkage => &soil_test::PLATE,
        Kind::Shear => &soil_test::SHEAR,
    }
}

/// How far a diagnosis searches: what is affordable at the price of one fit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    /// Starts of a calibration, and how long these are followed.
    pub calibration: Effort,
    /// Most single effects that are refitted, in the order of the gain that their sensitivities predict; `None` for all.
    pub singles: Option<usize>,
    /// Most pairs that are refitted; the others are screened by their sensitivities.
    pub pairs: usize,
    /// Most classes of soil within which a fit is repeated, the nearest first.
    pub soil_classes: usize,
    /// Whether likelihoods are profiled over the calibrated parameters too, or over those of the effects only.
    pub profiles_of_calibrated: bool,
    /// Whether a set is fitted once more from where a larger set ended, whose further effect may have helped the search only, and from the
    /// given soil before a second effect is taken.
    pub refits_from_larger: bool,
    /// Whether what noise alone gives is told from products of columns rather than from orthonormal ones: rows are many.
    pub by_products: bool,
    /// Whether left-out rows are predicted by simulating the whole experiment, or only the runs in which they stand.
    pub predicts_whole: bool,
}

/// How far behind an effect a look-alike may be and tie with it, whatever left-out data say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Alikes {
    /// Fall of chi-square.
    pub chi_square: f64,
    /// Share of what the effect gains.
    pub share: f64,
}

impl Alikes {
    /// Fall of chi-square within which a look-alike ties with an effect that gains so much.
    pub fn reach(&self, gain: f64) -> f64 {
        self.chi_square.max(self.share * gain)
    }
}

/// How the fit to everything becomes the fit without a fold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LeftOut {
    /// A refit; what the kept rows leave open around it widens the prediction.
    Refit,
    /// One Gauss-Newton step to the optimum without the fold; what the kept rows leave open widens the prediction.
    Step,
    /// A refit of a few steps, whose values are taken as known.
    ShortRefit,
}

/// What depends on the kind of an experiment.
pub(crate) trait Strategy: Debug + Sync {
    /// What the model that is found is of.
    ///
    /// # Errors
    /// [`CompareError::Vehicle`] where the chosen model cannot make such an experiment.
    fn finds(&self, choice: &Choice) -> Result<ModelKind, CompareError>;

    /// Gives the chosen model the rig of such an experiment, where that is no part of every model.
    fn prepare(&self, model: &mut Model) {
        model.test = None;
    }

    /// Fails where what is known of a run does not describe its rig.
    ///
    /// # Errors
    /// [`CompareError::Vehicle`] says what is missing.
    fn check_rig(&self, _experiment: &Experiment, _models: &[Model]) -> Result<(), CompareError> {
        Ok(())
    }

    /// Whether such an experiment can tell anything of a parameter that a calibration moves by default.
    fn calibrates(&self, _name: &str) -> bool {
        true
    }

    /// Different widths of the contact, m, rising.
    fn contact_widths(&self, _experiment: &Experiment, models: &[Model]) -> Vec<f64> {
        let mut all: Vec<f64> = models.iter().map(|model| model.rover.wheel.width).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// Whether runs differ in the width of the contact, so that k_c and k_phi do not act as one.
    fn many_widths(&self, experiment: &Experiment, _models: &[Model]) -> bool {
        let widths = experiment.runs.iter().filter_map(|run| run.parameters.get("wheel.width"));
        widths.collect::<Vec<_>>().windows(2).any(|pair| pair[0] != pair[1])
    }

    /// Whether an effect with these facts (none of an effect that is given as an expression) is a candidate at all.
    fn may_act(&self, _facts: Option<&Facts>) -> bool {
        true
    }

    /// When a look-alike ties with an effect; `None` where look-alikes are judged as all rivals are.
    fn alikes(&self, _problem: &Problem, _effect: &str) -> Option<Alikes> {
        None
    }

    /// Size of the noise of each value in the layout's order, by the values that are expected; empty where all have the same.
    fn noise_scale(&self, _problem: &Problem, _expected: &[f64]) -> Vec<Scale> {
        Vec::new()
    }

    /// Standard deviation of a whole run as a share of what is measured, by signal, where no repeat tells it; none for signals of which
    /// runs count as exact then.
    fn assumed_scatter(&self, _experiment: &Experiment) -> BTreeMap<String, f64> {
        BTreeMap::new()
    }

    /// What such an experiment tells, or cannot tell, of the calibrated baseline, in words.
    fn remarks(&self, _: &Problem, _: &Whitening, _: &Calibration, _modelled: &[f64]) -> Vec<String> {
        Vec::new()
    }

    /// Number of wheels that the commands name; 0 where nothing is commanded wheel by wheel.
    fn commanded_wheels(&self, experiment: &Experiment) -> usize;

    /// What is said of an improved model that cannot be used as it is; `None` where it can.
    fn unfit(&self, improved: &Model) -> Option<String>;

    /// For each run the number of rows at its start that no fit counts.
    fn uncounted_rows(&self, experiment: &Experiment) -> Vec<usize> {
        vec![0; experiment.runs.len()]
    }

    /// Inner steps of the simulation that a diagnosis may take where they are exact enough, s, the longest first; none where the
    /// model's own stays.
    fn coarse_steps(&self, experiment: &Experiment) -> Vec<f64>;

    /// The model's values of the measured rows as a function of `free`.
    ///
    /// # Errors
    /// [`PredictionError`] where the model cannot be placed on the experiment's runs.
    fn prediction<'p>(&self, problem: &'p Problem, free: &'p [Free]) -> Result<Box<dyn Predict + 'p>, PredictionError>;

    /// How the runs are cut into windows; `models` has what is known of each run.
    fn windows(&self, _experiment: &Experiment, _models: &[Model]) -> Windows {
        Windows::new()
    }

    /// How the modelled values depend on what is open of the starts of windows, with `free` at `values`.
    ///
    /// # Errors
    /// [`PredictionError`] where the model gives nothing there.
    fn free_starts(
        &self,
        _problem: &Problem,
        _free: &[Free],
        _values: &[f64],
    ) -> Result<Vec<FreeStart>, PredictionError> {
        Ok(Vec::new())
    }

    /// Columns against which residuals are held.
    fn conditions(&self, experiment: &Experiment) -> Vec<String>;

    /// Inputs over which the model is drawn as curves beside the measured points.
    fn axes(&self) -> &'static [Axis];

    /// The parameters that can change what such an experiment measures, with their values in a model.
    fn parameters(&self, model: &Model) -> Vec<(Variable, f64)>;

    /// Shapes of a flexible discrepancy, see `discrepancy`. `modelled` is what the baseline gives.
    fn discrepancy(&self, experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Vec<Shape>;

    /// Smooth functions of the conditions with which the strength of an effect may vary while it remains the same effect in
    /// another form.
    fn modulations(&self, experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Vec<Shape>;

    /// How far the search goes.
    fn budget(&self) -> Budget;

    /// Bound of the work of a stage of the diagnosis, in single fits, for the estimate of the time left.
    fn work(&self, phase: Phase) -> f64;

    /// Shares of a candidate's ranges from which its fit starts besides where the sensitivities lead, if `promised`: in case the neutral
    /// value is a poor place to look from. A flexible wheel's misfit first rises with its compliance, since the calibration leans the other
    /// way.
    fn further_starts(&self, _promised: bool) -> &'static [f64] {
        &[0.1, 0.3, 0.6]
    }

    /// Whether rovers can be led at the measured velocity, to find a way to a better fit than this one.
    fn can_be_led(&self, _problem: &Problem, _fit: &Calibration) -> bool {
        false
    }

    /// How folds are left out of this fit: where fits are cheap, by a refit.
    fn left_out(&self, _problem: &Problem, _fit: &Calibration) -> LeftOut {
        LeftOut::Refit
    }

    /// Single runs with the same rig that can be added to such an experiment.
    fn more(&self, _model: &Model, _experiment: &Experiment) -> Vec<Test> {
        Vec::new()
    }

    /// Further experiments that the model can be asked about.
    fn variations(&self, model: &Model, experiment: &Experiment, halt: Halt) -> Vec<Variation>;
}
