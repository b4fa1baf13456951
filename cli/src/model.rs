//! Which model a command works on: a preset or a file, with parameters set on the command line.

use anyhow::{Context, Result, anyhow};
use bekker::diagnosis::Given;
use bekker::effects::EffectDefinition;
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use std::path::PathBuf;

/// The model of a command that has no experiment, where none is named.
const USUAL: &str = "gentle_velocity";

/// Model and changes to it.
#[derive(clap::Args)]
pub struct ModelArguments {
    /// A model file (TOML) or the name of a built-in model, see `bekker parameters --models`. Where missing: with an
    /// experiment the model that `experiment.toml` names, or a plain rover or wheel; else gentle_velocity.
    model: Option<String>,
    /// Add effects of your own: a TOML file with `[[effect]]` tables; may be given several times.
    #[arg(long, value_name = "FILE")]
    effects_from: Vec<PathBuf>,
    /// Set a parameter by its name, SI units; may be given several times. With an experiment it goes before the model and
    /// the experiment's [parameters], and a calibration leaves it as it is unless it has a prior.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    changes: Vec<String>,
}

/// Changes to a model that is named otherwise.
#[derive(clap::Args)]
pub struct ModelChanges {
    /// Add effects of your own: a TOML file with `[[effect]]` tables; may be given several times.
    #[arg(long, value_name = "FILE")]
    effects_from: Vec<PathBuf>,
    /// Set a parameter by its name, SI units; may be given several times. It goes before the model and the experiment's
    /// [parameters], and a calibration leaves it as it is unless it has a prior.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    changes: Vec<String>,
}

impl ModelChanges {
    /// The changes with the model that is named; `None` for that of the experiment or a plain one.
    pub fn with(self, model: Option<String>) -> ModelArguments {
        ModelArguments::of(model, self.effects_from, self.changes)
    }
}

impl ModelArguments {
    /// The same of a command on which the model is an option.
    pub fn of(model: Option<String>, effects_from: Vec<PathBuf>, changes: Vec<String>) -> Self {
        Self { model, effects_from, changes }
    }

    /// The model, with its changes, for commands that have no experiment.
    pub fn load(&self) -> Result<Model> {
        let (mut model, _) = Model::find(self.model.as_deref().unwrap_or(USUAL), None)?;
        for file in &self.effects_from {
            model.add_effects(&read(file)?).with_context(|| format!("in `{}`", file.display()))?;
        }
        for change in &self.changes {
            let (name, value) = assignment(change)?;
            model.set(name, value)?;
        }
        Ok(model)
    }

    /// What is given beside an experiment, which decides what of it holds.
    pub fn given(&self) -> Result<Given> {
        let mut given = Given::default();
        if let Some(name) = &self.model {
            given = given.with_model(Model::find(name, None)?.0, name);
        }
        for file in &self.effects_from {
            let effects = EffectDefinition::all_from_toml(&read(file)?);
            given = given.with_effects(effects.with_context(|| format!("in `{}`", file.display()))?);
        }
        for change in &self.changes {
            let (name, value) = assignment(change)?;
            given = given.with_value(name, value);
        }
        Ok(given)
    }
}

fn read(file: &std::path::Path) -> Result<String> {
    std::fs::read_to_string(file).with_context(|| format!("cannot read `{}`", file.display()))
}

/// Splits `NAME=VALUE`.
pub fn assignment(text: &str) -> Result<(&str, f64)> {
    let (name, value) = text.split_once('=').ok_or_else(|| anyhow!("`{text}`: expected NAME=VALUE"))?;
    let value = value.trim().parse().map_err(|_| anyhow!("`{text}`: `{value}` is not a number"))?;
    Ok((name.trim(), value))
}
