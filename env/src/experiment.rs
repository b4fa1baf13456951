//! Experiments: a folder, or the texts of its files where the data come from Python.

use crate::error::{self, InputError, ModelError};
use bekker::measurement::{Experiment, ExperimentError};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What Python gives for an experiment.
#[derive(Clone, FromPyObject)]
pub enum Source {
    Texts(BTreeMap<String, String>),
    Folder(PathBuf),
}

impl Source {
    pub fn read(&self, py: Python<'_>) -> PyResult<Experiment> {
        py.detach(|| error::fenced(|| self.core()))?.map_err(|refused| self.refused(&refused))
    }

    /// The texts of all files, for other machines.
    pub fn texts(&self) -> PyResult<BTreeMap<String, String>> {
        match self {
            Self::Texts(texts) => Ok(texts.clone()),
            Self::Folder(folder) => Experiment::texts(folder).map_err(|refused| self.refused(&refused)),
        }
    }

    fn core(&self) -> Result<Experiment, ExperimentError> {
        match self {
            Self::Texts(texts) => Experiment::from_texts(texts),
            Self::Folder(folder) => Experiment::read(folder),
        }
    }

    fn refused(&self, refused: &ExperimentError) -> PyErr {
        match self {
            Self::Texts(_) => InputError::new_err(in_memory(refused)),
            Self::Folder(_) => ModelError::new_err(refused.to_string()),
        }
    }
}

/// Checks the texts of an experiment; returns the names of its measured signals.
#[pyfunction]
pub fn check_experiment(py: Python<'_>, texts: BTreeMap<String, String>) -> PyResult<Vec<String>> {
    Ok(Source::Texts(texts).read(py)?.signals())
}

/// Names run, row (counted from 0, as in arrays) and column where an error of a folder names file and line.
fn in_memory(refused: &ExperimentError) -> String {
    let file = refused.file.display().to_string();
    let mut place = match (file.strip_suffix(".terrain.csv"), file.strip_suffix(".csv")) {
        (Some(run), _) => format!("terrain of run `{run}`"),
        (None, Some(run)) => format!("run `{run}`"),
        (None, None) => "experiment".to_owned(),
    };
    let table = file.ends_with(".csv");
    // Line 1 is the header.
    if let Some(row) = refused.line.and_then(|line| line.checked_sub(2)).filter(|_| table) {
        place.push_str(&format!(", row {row}"));
    }
    if let Some(column) = &refused.column {
        place.push_str(&format!(", {} `{column}`", if table { "column" } else { "key" }));
    }
    format!("{place}: {}", refused.problem)
}
