//! What a diagnosis does differently for each kind of experiment: one [`Strategy`] a kind, chosen once by [`strategy`] where a
//! [`Problem`] is posed. All other code of the diagnosis is the same for all kinds.
//!
//! A further kind (a plate that sinks, a shear ring) is a folder beside these two, a line in [`strategy`], and a format of
//! its files in [`measurement`](crate::measurement).

mod single_wheel;
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
use super::precedence::Choice;
use super::prediction::{Predict, PredictionError};
use super::problem::Problem;
use super::separate::variation::Variation;
use super::windows::Windows;
use super::windows::free::FreeStart;
use crate::measurement::{Experiment, Kind, Run};
use crate::model::Model;
use bekker_modeldescription::Variable;
use std::fmt::Debug;

pub use single_wheel::SingleWheelPlan;
pub(crate) use single_wheel::signal;
pub use traverse::TraversePlan;

/// The strategy for a kind of experiment.
pub(crate) fn strategy(kind: Kind) -> &'static dyn Strategy {
    match kind {
        Kind::SingleWheel => &single_wheel::SingleWheel,
        Kind::Traverse => &traverse::Traverse,
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
    /// Whether a set is fitted once more from where a larger set ended, whose further effect may have helped the search only.
    pub refits_from_larger: bool,
    /// Whether what noise alone gives is told from products of columns rather than from orthonormal ones: rows are many.
    pub by_products: bool,
    /// Fall of chi-square within which a look-alike of an effect ties with it, whatever left-out data say; `None` where look-alikes
    /// are judged as all rivals are.
    pub alike_reach: Option<f64>,
    /// Whether left-out rows are predicted by simulating the whole experiment, or only the runs in which they stand.
    pub predicts_whole: bool,
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
    /// Whether the model that is found is a wheel on a carriage, not a rover.
    ///
    /// # Errors
    /// [`CompareError::Vehicle`] where the chosen model cannot make such an experiment.
    fn finds_carriage(&self, choice: &Choice) -> Result<bool, CompareError>;

    /// Number of wheels that the commands name; 0 where nothing is commanded wheel by wheel.
    fn commanded_wheels(&self, experiment: &Experiment) -> usize;

    /// What is said of an improved model that cannot be used as it is; `None` where it can.
    fn unfit(&self, improved: &Model) -> Option<String>;

    /// Number of rows at the start of a run that no fit counts.
    fn uncounted_rows(&self, run: &Run) -> usize;

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

    /// Shares of a candidate's ranges from which its fit starts besides where the sensitivities lead, if `promised`.
    fn further_starts(&self, promised: bool) -> &'static [f64];

    /// Values of a fit from which fits with a further effect start.
    fn origin(&self, fit: &Calibration) -> Vec<f64>;

    /// Whether rovers can be led at the measured velocity, to find a way to a better fit than this one.
    fn can_be_led(&self, problem: &Problem, fit: &Calibration) -> bool;

    /// How folds are left out of this fit.
    fn left_out(&self, problem: &Problem, fit: &Calibration) -> LeftOut;

    /// Further experiments that the model can be asked about.
    fn variations(&self, model: &Model, experiment: &Experiment, halt: Halt) -> Vec<Variation>;
}
