//! What a comparison is given beside the experiment: a model and values.

use super::compare::CompareError;
use super::precedence;
use super::problem::{LARGEST_SCATTER, USUAL_SCATTER};
use crate::effects::EffectDefinition;
use crate::known_soil::KnownSoil;
use crate::measurement::{Experiment, Share};
use crate::model::Model;
use std::collections::BTreeMap;

/// A model, where one is named, and values that are set by hand.
///
/// For each parameter the first that gives a value holds: a run's own `parameters`, a value set here, what the named model
/// states ([`Model::stated`]), the experiment's `[parameters]`, the mean of a prior, the built-in model. The dimensions and
/// masses of the rig ([`Role::Rig`](bekker_modeldescription::Role::Rig)) are the exception: those in `[parameters]` hold
/// against the model's. What is set here, or stands in `[parameters]`, stays as it is in a calibration unless it has a
/// prior; a model's value of a free parameter is where the search starts, and never moves the mean of a prior.
///
/// A plain [`&Model`](Model) given in its place is a model that is named: a model that was read from a file, or an improved
/// one, states its parameters; a built-in model states none, so that the experiment's `[parameters]` hold against it.
/// `Given::default()` names no model: the experiment's own is taken or, where it names none, the built-in one.
#[derive(Clone, Debug)]
pub struct Given {
    pub(super) named: Option<Named>,
    pub(super) set: BTreeMap<String, f64>,
    /// How the values that are set are called in messages.
    pub(super) set_by: &'static str,
    pub(super) effects: Vec<EffectDefinition>,
    /// What is known of the soil from other experiments, and how it is called in messages.
    pub(super) soil: Option<(KnownSoil, String)>,
    /// Relative standard deviation of the soil from one of several experiments to the next.
    pub(super) soil_scatter: f64,
    /// What several experiments share, where it is said by hand.
    pub(super) share: Option<Vec<Share>>,
    /// Parameters of the known soil that another of several experiments calibrates.
    pub(super) calibrated_elsewhere: Vec<String>,
}

/// A model and the name that it was given by.
#[derive(Clone, Debug)]
pub(super) struct Named {
    pub model: Model,
    /// For people: the name of a file or of a built-in model.
    pub name: String,
    /// Whether the experiment names it, so that its values rank below `[parameters]`.
    pub by_experiment: bool,
}

impl Default for Given {
    fn default() -> Self {
        Self {
            named: None,
            set: BTreeMap::new(),
            set_by: "--set",
            effects: Vec::new(),
            soil: None,
            soil_scatter: USUAL_SCATTER,
            share: None,
            calibrated_elsewhere: Vec::new(),
        }
    }
}

impl Given {
    /// How the values that are set are called in messages: the option or the argument; `--set` unless said otherwise.
    #[must_use]
    pub fn values_by(mut self, name: &'static str) -> Self {
        self.set_by = name;
        self
    }

    /// Names a model; `name` is how it was asked for, a file or a built-in model.
    #[must_use]
    pub fn with_model(mut self, model: Model, name: &str) -> Self {
        self.named = Some(Named { model, name: name.to_owned(), by_experiment: false });
        self
    }

    /// Sets a parameter by its name.
    #[must_use]
    pub fn with_value(mut self, name: &str, value: f64) -> Self {
        self.set.insert(name.to_owned(), value);
        self
    }

    /// Adds effects of the user's own to whichever model is taken.
    #[must_use]
    pub fn with_effects(mut self, effects: Vec<EffectDefinition>) -> Self {
        self.effects.extend(effects);
        self
    }

    /// What is known of the soil from other experiments: a joint prior of its parameters. It goes before the priors of a class of soil and
    /// after the experiment's own `[priors]`; a value that is set, or stands in `[parameters]`, is taken for known. `name` is how
    /// it is called in messages, such as the name of a file.
    #[must_use]
    pub fn with_soil(mut self, soil: KnownSoil, name: &str) -> Self {
        self.soil = Some((soil, name.to_owned()));
        self
    }

    /// Relative standard deviation of the soil from one of several experiments to the next, 0 to 0.5: of its stiffness, cohesion and
    /// shear modulus, and a fifth of it of the angle of friction. 0 where all were made in one bed; 0.05 where nothing is said.
    ///
    /// # Errors
    /// [`CompareError::Vehicle`] where the number is outside of that.
    pub fn with_soil_scatter(mut self, deviation: f64) -> Result<Self, CompareError> {
        if !(0.0..=LARGEST_SCATTER).contains(&deviation) {
            return Err(CompareError::Vehicle(format!(
                "scatter of the soil from one experiment to the next: expected a share from 0 to {LARGEST_SCATTER}, found {deviation}"
            )));
        }
        self.soil_scatter = deviation;
        Ok(self)
    }

    /// What several experiments share, whatever their folders say: of what is not in `share` each has its own. One vehicle has one drive, too.
    #[must_use]
    pub fn with_share(mut self, share: &[Share]) -> Self {
        self.share = Some(share.to_vec());
        self
    }

    /// What is given for several experiments together that were given something each by itself.
    ///
    /// # Errors
    /// [`CompareError::Vehicle`] where they are given different models, values, effects or soils: together they have one of each.
    pub fn of_several(all: &[Self]) -> Result<Self, CompareError> {
        // A model that cannot be written as a file is like no other.
        let model = |given: &Self| given.named.as_ref().and_then(|named| named.model.to_toml().ok());
        let alike = |a: &Self, b: &Self| model(a).is_some_and(|a| model(b) == Some(a));
        let named: Vec<&Self> = all.iter().filter(|given| given.named.is_some()).collect();
        let differ = |what: &str| {
            Err(CompareError::Vehicle(format!(
                "the experiments are given different {what}; together they have one of each: open them as a set from the command line"
            )))
        };
        if named.windows(2).any(|pair| !alike(pair[0], pair[1])) {
            return differ("models");
        }
        if all.windows(2).any(|pair| pair[0].set != pair[1].set) {
            return differ("values");
        }
        if all.windows(2).any(|pair| pair[0].effects != pair[1].effects || pair[0].soil != pair[1].soil) {
            return differ("effects or soils");
        }
        Ok(named.first().copied().or(all.first()).cloned().unwrap_or_default())
    }

    /// The known soil.
    #[must_use]
    pub fn soil(&self) -> Option<&KnownSoil> {
        self.soil.as_ref().map(|(soil, _)| soil)
    }

    /// The values that are set.
    #[must_use]
    pub fn values(&self) -> &BTreeMap<String, f64> {
        &self.set
    }

    /// The same with the model that is taken for `experiment` in its place, so that nothing has to be looked up any more:
    /// the model, and whether the experiment names it. For sending the work to another machine.
    ///
    /// # Errors
    /// [`CompareError`] where the experiment's model cannot be found or does not fit.
    pub fn chosen(&self, experiment: &Experiment) -> Result<(Model, bool), CompareError> {
        let choice = precedence::choose(self, experiment)?;
        Ok((choice.model, choice.rank != precedence::Rank::Command))
    }

    /// Puts together what [`chosen`](Self::chosen) gave and the values that are set.
    #[must_use]
    pub fn again(model: Model, by_experiment: bool, values: BTreeMap<String, f64>) -> Self {
        let name = model.name.clone();
        Self { named: Some(Named { model, name, by_experiment }), set: values, ..Self::default() }
    }
}

impl From<&Model> for Given {
    fn from(model: &Model) -> Self {
        Self::default().with_model(model.clone(), &model.name)
    }
}

impl From<&Self> for Given {
    fn from(given: &Self) -> Self {
        given.clone()
    }
}
