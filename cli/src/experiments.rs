//! Which experiments a command works on: one folder, or several on one soil, and the model.

use crate::import;
use crate::model::ModelChanges;
use anyhow::{Result, bail};
use bekker::diagnosis::Given;
use bekker::measurement::Experiment;
use std::path::PathBuf;

/// Folders and the model behind them.
#[derive(clap::Args)]
pub struct Experiments {
    /// Folders of experiments, each with `experiment.toml` and CSV files. Several, made on one soil, are fitted together: they share the
    /// soil's parameters, and each keeps its rig and noise. MODEL: a model file (TOML) or the name of a built-in model; else the one that
    /// `experiment.toml` names, or a plain rover or wheel.
    #[arg(required = true, value_name = "EXPERIMENT.. [MODEL]")]
    experiments: Vec<PathBuf>,
    #[command(flatten)]
    changes: ModelChanges,
    /// Of several experiments: relative standard deviation of the soil from one to the next, 0 where all were made in one bed; 0.05 if not
    /// given.
    #[arg(long, value_name = "SHARE")]
    soil_scatter: Option<f64>,
}

impl Experiments {
    /// The experiment, or several as one, and what is given beside. What is no folder and stands last is the model.
    pub fn read(self) -> Result<(Experiment, Given)> {
        let (folders, model) = match self.experiments.as_slice() {
            [folders @ .., last] if !folders.is_empty() && !last.is_dir() => (folders, Some(last)),
            folders => (folders, None),
        };
        let mut read = folders.iter().map(|folder| import::read(folder)).collect::<Result<Vec<_>>>()?;
        let experiment = if read.len() == 1 { read.remove(0) } else { Experiment::joint(read)? };
        let model = model.map(|path| path.to_string_lossy().into_owned());
        let mut given = self.changes.with(model).given()?;
        if let Some(deviation) = self.soil_scatter {
            if experiment.parts.is_empty() {
                bail!("--soil-scatter: this is a single experiment; it says how the soils of several differ");
            }
            given = given.with_soil_scatter(deviation)?;
        }
        Ok((experiment, given))
    }
}

/// Refuses a page of several experiments.
pub fn no_page_of_several(experiment: &Experiment, page: Option<&PathBuf>) -> Result<()> {
    if page.is_some() && !experiment.parts.is_empty() {
        bail!(
            "--html: there is no page of several experiments yet; write the models with --save, and a page of each with `bekker compare FOLDER MODEL --html FILE`"
        );
    }
    Ok(())
}
