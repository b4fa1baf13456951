//! Which model a command works on: a preset or a file, with parameters set on the command line.

use anyhow::{Context, Result, anyhow};
use bekker::model::{Model, PRESETS};
use bekker::modeldescription::Lookup;
use std::path::{Path, PathBuf};

/// Model and changes to it.
#[derive(clap::Args)]
pub struct ModelArguments {
    /// A model file (TOML) or the name of a built-in model, see `bekker parameters --models`.
    #[arg(default_value = "gentle_velocity")]
    model: String,
    /// Add effects of your own: a TOML file with `[[effect]]` tables; may be given several times.
    #[arg(long, value_name = "FILE")]
    effects_from: Vec<PathBuf>,
    /// Set a parameter by its name, SI units; may be given several times.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    changes: Vec<String>,
}

impl ModelArguments {
    /// The model, with its changes.
    pub fn load(&self) -> Result<Model> {
        let mut model = if Path::new(&self.model).is_file() {
            Model::read(Path::new(&self.model)).with_context(|| format!("in `{}`", self.model))?
        } else if PRESETS.iter().any(|(name, _)| *name == self.model) {
            Model::preset(&self.model)?
        } else {
            let names: Vec<&str> = PRESETS.iter().map(|(name, _)| *name).collect();
            return Err(anyhow!("`{}` is neither a file nor a built-in model ({})", self.model, names.join(", ")));
        };
        for file in &self.effects_from {
            let text = std::fs::read_to_string(file).with_context(|| format!("cannot read `{}`", file.display()))?;
            model.add_effects(&text).with_context(|| format!("in `{}`", file.display()))?;
        }
        for change in &self.changes {
            let (name, value) = assignment(change)?;
            model.set(name, value)?;
        }
        Ok(model)
    }
}

/// Splits `NAME=VALUE`.
pub fn assignment(text: &str) -> Result<(&str, f64)> {
    let (name, value) = text.split_once('=').ok_or_else(|| anyhow!("`{text}`: expected NAME=VALUE"))?;
    let value = value.trim().parse().map_err(|_| anyhow!("`{text}`: `{value}` is not a number"))?;
    Ok((name.trim(), value))
}
