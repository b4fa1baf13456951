//! Which experiments a command works on: one folder, or several on one soil, and the model.

use crate::import;
use crate::model::ModelChanges;
use crate::output::write;
use anyhow::{Result, bail};
use bekker::diagnosis::Given;
use bekker::measurement::Experiment;
use bekker::model::Model;
use bekker::report::part_page;
use std::path::{Path, PathBuf};

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
        let (folders, model) = folders_and_model(&self.experiments);
        let experiment = read_together(folders)?;
        let given = self.changes.with(model).given()?;
        let given = scattered(given, &experiment, self.soil_scatter)?;
        Ok((experiment, given))
    }
}

/// Folders, and the model behind them: what is no folder and stands last.
pub fn folders_and_model(paths: &[PathBuf]) -> (&[PathBuf], Option<String>) {
    match paths {
        [folders @ .., last] if !folders.is_empty() && !last.is_dir() => {
            (folders, Some(last.to_string_lossy().into_owned()))
        }
        folders => (folders, None),
    }
}

/// The experiment of a folder, or several as one.
pub fn read_together(folders: &[PathBuf]) -> Result<Experiment> {
    let mut read = folders.iter().map(|folder| import::read(folder)).collect::<Result<Vec<_>>>()?;
    Ok(if read.len() == 1 { read.remove(0) } else { Experiment::joint(read)? })
}

/// What is given, with how much the soils of several experiments differ, where that is said.
pub fn scattered(given: Given, experiment: &Experiment, deviation: Option<f64>) -> Result<Given> {
    let Some(deviation) = deviation else { return Ok(given) };
    if experiment.parts.is_empty() {
        bail!("--soil-scatter: this is a single experiment; it says how the soils of several differ");
    }
    Ok(given.with_soil_scatter(deviation)?)
}

/// Writes a page of each of several experiments with its model, whose first line says what was found of all; the name of the experiment
/// stands behind that of the file.
pub fn write_pages(experiment: &Experiment, models: &[(String, Model)], found: &str, page: &Path) -> Result<()> {
    for (part, (name, model)) in models.iter().enumerate() {
        write(&beside(page, name), &part_page(experiment, part, model, found)?)?;
    }
    Ok(())
}

/// The files that are written for `file`: itself or, of several experiments, one of each.
pub fn files(experiment: &Experiment, file: &Path) -> Vec<PathBuf> {
    match experiment.parts.as_slice() {
        [] => vec![file.to_path_buf()],
        parts => parts.iter().map(|part| beside(file, &part.name)).collect(),
    }
}

/// The file `page`, with a name behind its own.
pub fn beside(page: &Path, name: &str) -> PathBuf {
    let stem = page.file_stem().unwrap_or_default().to_string_lossy();
    let ending = page.extension().map(|ending| format!(".{}", ending.to_string_lossy())).unwrap_or_default();
    page.with_file_name(format!("{stem}-{name}{ending}"))
}
