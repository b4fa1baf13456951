//! An experiment held ready, so that models can be tried on it at once: for interfaces in which people move parameters by hand.
//!
//! Reading, placing and cutting an experiment is done once. Each [`trial`](Workbench::trial) then costs one simulation of it.
//! Of several experiments on one soil a trial is one simulation of all of them; see [`Workbench::parts`].
//! Runs of a traverse are cut into windows as in a diagnosis, so that trials, calibrations and diagnoses judge alike.

mod parts;
mod settable;

use super::calibrate::Calibration;
use super::compare::CompareError;
use super::curves::{Axis, Curves, sketch};
use super::diagnose::{Noise, Prepared, WINDOWS, calibrated_baseline, run_fit};
use super::failure::{Failure, failures};
use super::fit::Fit;
use super::free::Free;
use super::given::Given;
use super::halt::Halt;
use super::noise::{NoiseFloor, noise_floors};
use super::problem::Problem;
use super::unanswered::{UnansweredRows, listed};
use super::uncounted::{UncountedRows, uncounted};
use crate::measurement::Experiment;
use crate::model::Model;
pub use settable::Adjustable;
use settable::{Settable, typical};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Values of parameters by name, SI units.
type Values = BTreeMap<String, f64>;

/// The model with some values of its parameters beside the measurements.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Measured, modelled and residual values, and their errors.
    pub fit: Fit,
    /// Rows that this model leaves without an answer; they do not count in the errors.
    pub unanswered: Vec<UnansweredRows>,
    /// Where the model fails most, by signal and condition, the worst first.
    pub failures: Vec<Failure>,
}

/// A calibrated baseline: the one that `compare` and `diagnose` find, to the bit.
#[derive(Clone, Debug)]
pub struct Calibrated {
    /// Values, standard errors, bounds.
    pub calibration: Calibration,
    /// What a reader should beware of, in words.
    pub cautions: Vec<String>,
    noise: Noise,
    unanswered: Vec<UnansweredRows>,
}

/// An experiment with the model placed on its runs.
#[derive(Clone, Debug)]
pub struct Workbench {
    problem: Problem<'static>,
    settable: Arc<Settable>,
    floors: BTreeMap<String, NoiseFloor>,
    baseline: Option<Calibrated>,
    parts: Arc<[Self]>,
}

impl Workbench {
    /// Places the model on the runs of an experiment.
    ///
    /// # Errors
    /// [`CompareError`] where the experiment does not fit the model, or nothing is measured.
    pub fn open(given: impl Into<Given>, experiment: &Experiment) -> Result<Self, CompareError> {
        let mut problem = Problem::new(given, experiment, &[])?.owned();
        if problem.layout.present() == 0 {
            return Err(CompareError::NothingMeasured);
        }
        problem.coarsen();
        problem.cut();
        _ = problem.spare(WINDOWS);
        let opened = Self::new(problem, BTreeMap::new(), None);
        let modelled = opened.modelled(&Values::new())?.1;
        let floors = noise_floors(experiment, &opened.problem.layout, &modelled);
        Ok(Self::new(opened.problem, floors, None))
    }

    fn new(problem: Problem<'static>, floors: BTreeMap<String, NoiseFloor>, baseline: Option<Calibrated>) -> Self {
        let parts = Self::parts_of(&problem, &floors);
        Self { settable: Arc::new(Settable::of_parts(&problem, &parts)), problem, floors, baseline, parts }
    }

    /// Of a comparison without a calibration.
    pub(super) fn given(problem: &Problem, floors: BTreeMap<String, NoiseFloor>) -> Self {
        Self::new(problem.clone().owned(), floors, None)
    }

    /// Of a calibrated baseline.
    pub(super) fn prepared(problem: &Problem, prepared: &Prepared) -> Self {
        let baseline = Calibrated {
            calibration: prepared.baseline.clone(),
            cautions: prepared.cautions.clone(),
            noise: prepared.noise.clone(),
            unanswered: prepared.unanswered.clone(),
        };
        Self::new(problem.clone().owned(), prepared.floors.clone(), Some(baseline))
    }

    /// The experiment.
    #[must_use]
    pub fn experiment(&self) -> &Experiment {
        &self.problem.experiment
    }

    /// Noise by signal: as repeats and statements tell it beside the given model, after a calibration beside the calibrated one.
    #[must_use]
    pub fn noise_floor(&self) -> &BTreeMap<String, NoiseFloor> {
        &self.floors
    }

    /// What was taken from where, in words, where two places disagree; see [`Given`].
    #[must_use]
    pub fn sources(&self) -> &[String] {
        &self.problem.sources
    }

    /// The calibrated baseline, where there is one.
    #[must_use]
    pub fn baseline(&self) -> Option<&Calibrated> {
        self.baseline.as_ref()
    }

    /// Rows that no error counts whatever the parameters are, and why.
    #[must_use]
    pub fn uncounted(&self) -> Vec<UncountedRows> {
        let (odd, unanswered) =
            self.baseline.as_ref().map_or((&[][..], &[][..]), |found| (&found.noise.odd, &found.unanswered));
        uncounted(&self.problem, odd, unanswered)
    }

    /// All that a trial may set: what a calibration moves, then the parameters of the effects that may be added.
    #[must_use]
    pub fn parameters(&self) -> &[Adjustable] {
        &self.settable.movable
    }

    /// What a trial may set besides: parameters that no calibration of this experiment moves, since they are taken as known.
    /// Of several experiments those of the soil stand there once, all others for each of them.
    #[must_use]
    pub fn known_parameters(&self) -> &[Adjustable] {
        &self.settable.known
    }

    /// The problem with those of `values` that are taken as known in the place of what was given.
    fn placed(&self, values: &Values) -> Cow<'_, Problem<'static>> {
        let mut problem = Cow::Borrowed(&self.problem);
        for (name, value) in values.iter().filter(|(name, _)| !self.settable.is_movable(name)) {
            let problem = problem.to_mut();
            match self.settable.places(name) {
                None => problem.set_known(name, *value),
                Some((parts, own)) => parts.iter().for_each(|k| problem.set_known_in_part(*k, own, *value)),
            }
        }
        problem
    }

    /// Runs the model with these values of [parameters](Self::parameters), by name in SI units; all others are as given. With
    /// `in_motion` the fit also says how the model's rover moves.
    ///
    /// # Errors
    /// [`CompareError`] where a name or a value is not allowed, or the model has no answer anywhere.
    pub fn trial(&self, values: &Values, in_motion: bool) -> Result<Trial, CompareError> {
        self.check(values)?;
        let mut trial = self.tried(values)?;
        if in_motion {
            trial.fit = self.moving(trial.fit, values)?;
        }
        Ok(trial)
    }

    /// Refuses names and values that are not allowed.
    pub(super) fn check(&self, values: &Values) -> Result<(), CompareError> {
        self.settable.check(&self.problem, values)
    }

    /// A trial at values that are allowed.
    pub(super) fn tried(&self, values: &Values) -> Result<Trial, CompareError> {
        let (answers, modelled) = self.modelled(values)?;
        let fit = Fit::new(&self.problem.experiment, &self.problem.layout, &modelled);
        let failures = failures(&self.problem.experiment, &fit, &self.floors);
        Ok(Trial { fit, unanswered: answers, failures })
    }

    /// The same fit with how the model's rover moves at these values, which are allowed.
    fn moving(&self, fit: Fit, values: &Values) -> Result<Fit, CompareError> {
        let (effects, all) = self.all_values(values);
        Ok(fit.in_motion(&self.placed(values), &effects, &all)?)
    }

    /// The model over one input at the typical other inputs of each group of rows, in a few milliseconds; `None` for a traverse, and
    /// where the input was not varied.
    ///
    /// # Errors
    /// [`CompareError`] where a name or a value is not allowed.
    pub fn sketch(&self, axis: Axis, values: &Values) -> Result<Option<Curves>, CompareError> {
        self.check(values)?;
        Ok(self.sketched(axis, values))
    }

    /// The same at values that are allowed.
    pub(super) fn sketched(&self, axis: Axis, values: &Values) -> Option<Curves> {
        let all = values.iter().map(|(name, value)| (name.clone(), *value)).collect();
        sketch(&self.placed(values), axis, all)
    }

    /// Rows without an answer, and the modelled values in the layout's order, at values that are allowed.
    fn modelled(&self, values: &Values) -> Result<(Vec<UnansweredRows>, Vec<f64>), CompareError> {
        let (effects, all) = self.all_values(values);
        let problem = self.placed(values);
        let answers = problem.predict(&problem.free(&effects), |predict| predict.answers(&all))??;
        let missing = answers.missing(&self.problem.layout);
        match missing.first() {
            Some(rows) if !answers.any(&self.problem.layout) => Err(rows.error.clone().into()),
            _ => Ok((listed(missing), problem.with_spared(&effects, &all, answers.values)?)),
        }
    }

    /// Effects that are not neutral, and the values of all parameters that are free with them.
    fn all_values(&self, values: &Values) -> (Vec<String>, Vec<f64>) {
        let value = |free: &Free| values.get(&free.variable.name).copied().unwrap_or(free.start);
        let on = |free: &Free| value(free).to_bits() != free.start.to_bits();
        let acting = self.problem.library.iter().filter(|candidate| candidate.free.iter().any(on));
        let effects: Vec<String> = acting.map(|candidate| candidate.id.clone()).collect();
        let all = self.problem.free(&effects).iter().map(value).collect();
        (effects, all)
    }

    /// The same with the baseline calibrated and its noise known, as `compare` finds them with `calibrate`. `stop` is asked at every
    /// row of a simulation.
    ///
    /// # Errors
    /// [`CompareError`] as from [`compare`](super::compare()); [`CompareError::Interrupted`] after a stop.
    pub fn calibrated(&self, stop: &(dyn Fn() -> bool + Sync)) -> Result<Self, CompareError> {
        let mut problem: Problem = self.problem.clone();
        problem.halt = Halt::when(stop);
        let prepared = calibrated_baseline(&mut problem)
            .map_err(|error| if stop() { CompareError::Interrupted } else { error })?;
        Ok(Self::prepared(&problem, &prepared))
    }

    /// Fits the baseline's parameters and those of `effects` together, from `values` and, where an effect is neutral there, from its
    /// typical strength: one fit of a diagnosis. `None` where no fit was found, or after a stop.
    ///
    /// # Errors
    /// [`CompareError`] where a name or a value is not allowed, or the baseline is not calibrated yet.
    pub fn fitted(
        &self,
        effects: &[String],
        values: &Values,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Calibration>, CompareError> {
        self.check(values)?;
        let Some(baseline) = &self.baseline else { return Err(CompareError::NoFit) };
        if let Some(id) = effects.iter().find(|id| self.problem.candidate(id).is_none()) {
            let known = self.problem.library.iter().map(|candidate| candidate.id.as_str()).collect::<Vec<_>>();
            return Err(CompareError::UnknownEffect { id: id.clone(), known: known.join(", ") });
        }
        let mut problem: Problem = self.placed(values).into_owned();
        problem.halt = Halt::when(stop);
        let start = |free: &Free| {
            let value = values.get(&free.variable.name).copied().unwrap_or(free.start);
            let id = free.variable.name.split('.').next().unwrap_or_default();
            let neutral = effects.iter().any(|effect| effect == id) && value.to_bits() == free.start.to_bits();
            if neutral { typical(&self.problem, id, free) } else { value }
        };
        let from: Vec<f64> = problem.free(effects).iter().map(start).collect();
        let weak = |free: &Free| match self.problem.base.iter().any(|base| base.variable.name == free.variable.name) {
            true => values.get(&free.variable.name).copied().unwrap_or(free.start),
            false => free.nearly_neutral(),
        };
        let nearly: Vec<f64> = problem.free(effects).iter().map(weak).collect();
        let starts = if effects.is_empty() { vec![from] } else { vec![from, nearly] };
        let fit = run_fit(&problem, &baseline.noise, &problem.task(effects, starts));
        Ok(fit.filter(|_| !stop()))
    }

    /// The model with these values, which it states: as `compare` and `diagnose` save it. Of several experiments each has its own,
    /// see [`model_of_part`](Self::model_of_part); this is the first one's.
    ///
    /// # Errors
    /// [`CompareError`] where a name or a value is not allowed.
    pub fn model(&self, values: &Values) -> Result<Model, CompareError> {
        self.check(values)?;
        let (effects, all) = self.all_values(values);
        let problem = self.placed(values);
        Ok(problem.saved(&problem.free(&effects), &all))
    }
}
