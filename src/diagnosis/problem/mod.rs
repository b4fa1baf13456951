//! What a diagnosis works on: an experiment, the model placed on each of its runs, the parameters that a calibration
//! moves, and the effects that may be added.

mod joint;
mod own_soil;
mod parameters;
mod placed;
mod saved;
mod scatter;
mod shared;
mod sharing;
mod windows;

use super::compare::CompareError;
use super::diagnose::{Sensitivities, Task};
use super::free::Free;
use super::given::Given;
use super::halt::Halt;
use super::kinds::{Strategy, strategy};
use super::layout::Layout;
use super::precedence::{Resolved, resolve};
use super::prediction::{Predict, PredictionError};
use super::prior_rows::{JointPrior, PriorRows};
use super::readings::{Readings, Sensors};
use super::windows::Windows;
use crate::carriage::Rig;
use crate::measurement::Experiment;
use crate::model::{Model, ModelKind};
use bekker_modeldescription::{Lookup, Parameters};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

pub(super) use joint::name_in_part;
pub use joint::plain_effect;
pub(super) use parameters::class_priors;
use parameters::{base_parameters, library};
pub(super) use placed::Placed;
pub(super) use scatter::{LARGEST as LARGEST_SCATTER, USUAL as USUAL_SCATTER};
pub(crate) use sharing::written_down;

/// An effect that is not in the baseline, with its free parameters at their neutral values.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    pub id: String,
    pub free: Vec<Free>,
}

/// An experiment and all that may be fitted to it.
#[derive(Clone, Debug)]
pub(crate) struct Problem<'a> {
    pub experiment: Cow<'a, Experiment>,
    pub layout: Layout,
    /// The model with what is known of the rig.
    pub known: Model,
    /// The same with what is known of each run.
    pub(super) models: Vec<Model>,
    /// Inner steps that may be taken, s, the longest first, which is taken; and those of each run's own model.
    steps: Vec<f64>,
    own_steps: Vec<f64>,
    /// How runs are cut into windows; empty where they are replayed as a whole.
    pub windows: Windows,
    /// Windows that take no part in the fits, by run; empty where all do.
    pub(super) spared: Windows,
    /// Whether rovers are led at the measured velocity, for a first look.
    pub guided: bool,
    /// When simulations end early.
    pub halt: Halt<'a>,
    /// What is known of the soil from other experiments, its parameters together.
    pub joint: Option<JointPrior>,
    /// Parameters of a baseline calibration.
    pub base: Vec<Free>,
    /// Effects that may be added, in the vocabulary's order.
    pub library: Vec<Candidate>,
    /// Values of the baseline and what was found of the sensitivities there, once it is calibrated.
    sensitivities: Option<Arc<(Vec<f64>, Sensitivities)>>,
    /// What was taken from where, in words; see [`Given`].
    pub sources: Vec<String>,
    /// What the model that is found is of: of a single wheel that was measured without naming a rover a wheel on a carriage.
    found: ModelKind,
    /// Values that were set by hand.
    set: BTreeMap<String, f64>,
    /// The experiments that are fitted together, each as it is posed by itself; none where there is one.
    parts: Vec<Arc<Problem<'static>>>,
}

impl<'a> Problem<'a> {
    /// `added` effects are part of the baseline: their parameters are free in it.
    ///
    /// # Errors
    /// [`CompareError`] where the experiment, `given` or `added` names something that the model does not have, or the model
    /// of the experiment cannot be found.
    pub fn new(given: impl Into<Given>, experiment: &'a Experiment, added: &[String]) -> Result<Self, CompareError> {
        let given = given.into();
        if !experiment.parts.is_empty() {
            return Self::of_parts(&given, experiment, added);
        }
        Self::single(&given, experiment, added, false)
    }

    /// Of one experiment; `other_widths` where k_c is told from k_phi by other experiments.
    fn single(
        given: &Given,
        experiment: &'a Experiment,
        added: &[String],
        other_widths: bool,
    ) -> Result<Self, CompareError> {
        let Resolved { mut known, runs: models, held, priors, joint, found, sources } = resolve(given, experiment)?;
        let strategy = strategy(experiment);
        let many_widths = other_widths || strategy.many_widths(experiment, &models);
        let mut base = base_parameters(&mut known, experiment, &held, &priors, joint.as_ref(), many_widths);
        base.retain(|free| strategy.calibrates(&free.variable.name));
        let mut library = library(&mut known, &held, &base);
        library.retain(|candidate| strategy.may_act(known.facts_of(&candidate.id).as_ref()));
        base.extend(Free::of_sensors(experiment));
        let kept = add(added, library, &mut base)?;
        Ok(Self {
            experiment: Cow::Borrowed(experiment),
            layout: Layout::new(experiment),
            known,
            models,
            steps: Vec::new(),
            own_steps: Vec::new(),
            windows: Windows::new(),
            spared: Windows::new(),
            guided: false,
            halt: Halt::default(),
            joint,
            base,
            library: kept,
            sensitivities: None,
            sources,
            found,
            set: given.values().clone(),
            parts: Vec::new(),
        })
    }

    /// The same with an experiment of its own, which nothing asks to end.
    pub fn owned(self) -> Problem<'static> {
        Problem {
            experiment: Cow::Owned(self.experiment.into_owned()),
            layout: self.layout,
            known: self.known,
            models: self.models,
            steps: self.steps,
            own_steps: self.own_steps,
            windows: self.windows,
            spared: self.spared,
            guided: self.guided,
            halt: Halt::default(),
            joint: self.joint,
            base: self.base,
            library: self.library,
            sensitivities: self.sensitivities,
            sources: self.sources,
            found: self.found,
            set: self.set,
            parts: self.parts,
        }
    }

    /// Sensitivities of the baseline at `values`, where they are known.
    pub fn known_sensitivities(&self, effects: &[String], values: &[f64]) -> Option<&Sensitivities> {
        let (at, known) = self.sensitivities.as_deref().filter(|_| effects.is_empty())?;
        (at == values).then_some(known)
    }

    /// Keeps the sensitivities of the baseline at `values`; nothing that they depend on changes from now on.
    pub fn know_sensitivities(&mut self, values: &[f64], sensitivities: Sensitivities) {
        self.sensitivities = Some(Arc::new((values.to_vec(), sensitivities)));
    }

    /// What depends on the kind of the experiment.
    pub fn strategy(&self) -> &'static dyn Strategy {
        strategy(&self.experiment)
    }

    /// Keeps only the candidates named; of several experiments each wherever it may act, unless its name says where.
    ///
    /// # Errors
    /// [`CompareError::UnknownEffect`], [`CompareError::EffectTwice`].
    pub fn keep_candidates(&mut self, ids: &[String]) -> Result<(), CompareError> {
        refuse_twice(ids)?;
        if let Some(id) = ids.iter().find(|id| !self.library.iter().any(|candidate| candidate.id == **id)) {
            return Err(unknown_effect(id, &self.library));
        }
        let asked = |id: &str| ids.iter().any(|asked| asked == id);
        self.library.retain(|candidate| asked(&candidate.id) || asked(plain_effect(&candidate.id)));
        Ok(())
    }

    /// The candidate called `id`.
    pub fn candidate(&self, id: &str) -> Option<&Candidate> {
        self.library.iter().find(|candidate| candidate.id == id)
    }

    /// Free parameters of the baseline with these effects added, in the library's order whatever the order of `effects`.
    pub fn free(&self, effects: &[String]) -> Vec<Free> {
        let added = self.library.iter().filter(|candidate| effects.contains(&candidate.id));
        self.base.iter().cloned().chain(added.flat_map(|candidate| candidate.free.clone())).collect()
    }

    /// What is known of free parameters before the experiment.
    pub fn prior_rows(&self, free: &[Free]) -> PriorRows {
        PriorRows::new(free, self.joint.as_ref(), 1.0, None)
    }

    /// Names of the baseline's parameters, for a reader.
    pub fn names_of_base(&self) -> String {
        let own = self.base.iter().filter(|free| !free.is_factor());
        own.map(|free| free.variable.name.as_str()).collect::<Vec<_>>().join(", ")
    }

    /// Values of the parameters of effect `id` among those of a fit with `effects`.
    pub fn part<'v>(&self, effects: &[String], values: &'v [f64], id: &str) -> &'v [f64] {
        let mut at = self.base.len();
        for candidate in self.library.iter().filter(|candidate| effects.contains(&candidate.id)) {
            if candidate.id == id {
                return &values[at..at + candidate.free.len()];
            }
            at += candidate.free.len();
        }
        &[]
    }

    /// Values of a fit put together from those of the baseline and of each effect, in the order of [`Self::free`].
    pub fn assemble(&self, base: &[f64], parts: &[(&str, &[f64])]) -> Vec<f64> {
        let mut values = base[..self.base.len()].to_vec();
        for candidate in &self.library {
            if let Some((_, part)) = parts.iter().find(|(id, _)| *id == candidate.id) {
                values.extend_from_slice(part);
            }
        }
        values
    }

    /// Calls `f` with what the model predicts as a function of `free`, as the sensors record it.
    ///
    /// # Errors
    /// [`PredictionError`] where the model cannot be placed on the experiment's runs.
    pub fn predict<R>(&self, free: &[Free], f: impl FnOnce(&dyn Predict) -> R) -> Result<R, PredictionError> {
        if self.experiment.sensors.is_empty() {
            return Ok(f(&*self.strategy().prediction(self, free)?));
        }
        let sensors = Sensors::of(self, free);
        let of_model = sensors.model_part(free);
        let signals = &*self.strategy().prediction(self, &of_model)?;
        Ok(f(&Readings { signals, sensors: &sensors }))
    }

    /// The wheel, soil and effects on a run, with these values of parameters; what the run itself states holds against them.
    pub fn rig(&self, run: usize, values: &[(String, f64)]) -> Rig {
        let mut rig = Rig::of(&self.models[run].rover);
        let own = &self.experiment.recorded_run(run).parameters;
        rig.visit("", &mut |variable, place| {
            let value = values.iter().find(|(name, _)| *name == variable.name && !own.contains_key(name));
            if let Some((_, value)) = value {
                *place = *value;
            }
        });
        rig
    }

    /// Sets a parameter on every run that does not state its own value.
    pub fn fix(&mut self, name: &str, value: f64) {
        if !self.parts.is_empty() {
            return self.fix_in_parts(name, value);
        }
        for (model, run) in self.models.iter_mut().zip(&self.experiment.runs) {
            if !run.parameters.contains_key(name) {
                set_unchecked(model, name, value);
            }
        }
    }

    /// Takes another value for a parameter that is known.
    pub fn set_known(&mut self, name: &str, value: f64) {
        set_unchecked(&mut self.known, name, value);
        self.fix(name, value);
        self.sensitivities = None;
    }

    /// Value of a parameter on the first run that does not state its own.
    fn value_of(&self, name: &str) -> f64 {
        let own = |run: &usize| self.experiment.runs[*run].parameters.contains_key(name);
        let run = (0..self.models.len()).find(|run| !own(run));
        let model = run.map_or(&self.known, |run| &self.models[run]);
        model.clone().get(name).unwrap_or(f64::NAN)
    }

    /// The same for some of the runs.
    pub fn only(&self, runs: &[usize]) -> Problem<'a> {
        let experiment = self.experiment.with_runs(runs);
        Problem {
            layout: self.layout.of_runs(&experiment, runs),
            experiment: Cow::Owned(experiment),
            known: self.known.clone(),
            steps: self.steps.clone(),
            own_steps: runs.iter().filter_map(|run| self.own_steps.get(*run).copied()).collect(),
            windows: runs.iter().filter_map(|run| self.windows.get(*run).cloned()).collect(),
            spared: runs.iter().filter_map(|run| self.spared.get(*run).cloned()).collect(),
            guided: self.guided,
            halt: self.halt,
            models: runs.iter().map(|run| self.models[*run].clone()).collect(),
            joint: self.joint.clone(),
            base: self.base.clone(),
            library: self.library.clone(),
            sensitivities: None,
            sources: self.sources.clone(),
            found: self.found,
            set: self.set.clone(),
            parts: self.parts.clone(),
        }
    }

    /// The task of fitting the baseline with these effects added.
    pub fn task(&self, effects: &[String], starts: Vec<Vec<f64>>) -> Task {
        let parameters = self.free(effects)[self.base.len()..].iter().map(|free| free.variable.name.clone()).collect();
        Task {
            effects: effects.to_vec(),
            parameters,
            starts,
            scouting: None,
            guided: false,
            left_out: Vec::new(),
            unanswered: self.layout.left_out().to_vec(),
            prior_factor: 1.0,
        }
    }
}

/// Sets a parameter that is known to exist and to be within its bounds.
fn set_unchecked(model: &mut Model, name: &str, value: f64) {
    model.visit("", &mut |variable, place| {
        if variable.name == name {
            *place = value;
        }
    });
}

/// Adds effects to the baseline's free parameters; what is left are the candidates.
fn add(added: &[String], library: Vec<Candidate>, base: &mut Vec<Free>) -> Result<Vec<Candidate>, CompareError> {
    refuse_twice(added)?;
    for id in added {
        let Some(candidate) = library.iter().find(|candidate| candidate.id == *id) else {
            return Err(unknown_effect(id, &library));
        };
        base.extend(candidate.free.iter().cloned());
    }
    // An effect that the given model has switched on is part of the baseline, at its value.
    let neutral = |candidate: &Candidate| candidate.free.iter().all(|free| free.start == free.variable.default);
    Ok(library.into_iter().filter(|candidate| neutral(candidate) && !added.contains(&candidate.id)).collect())
}

fn refuse_twice(ids: &[String]) -> Result<(), CompareError> {
    let twice = (1..ids.len()).find(|k| ids[..*k].contains(&ids[*k]));
    twice.map_or(Ok(()), |k| Err(CompareError::EffectTwice { id: ids[k].clone() }))
}

fn unknown_effect(id: &str, library: &[Candidate]) -> CompareError {
    let plain = library.iter().map(|candidate| candidate.id.as_str()).filter(|id| plain_effect(id) == *id);
    let known = plain.collect::<Vec<_>>().join(", ");
    CompareError::UnknownEffect { id: id.to_owned(), known }
}
