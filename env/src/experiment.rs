//! Experiments: a folder, or the texts of its files where the data come from Python.

use crate::error::{self, InputError, ModelError};
use bekker::measurement::{Experiment, ExperimentError, Kind, Proposal, WriteError};
use pyo3::exceptions::PyFileExistsError;
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

/// Checks the texts of an experiment; returns the names of its measured signals, and what is doubtful.
#[pyfunction]
pub fn check_experiment(py: Python<'_>, texts: BTreeMap<String, String>) -> PyResult<(Vec<String>, Vec<String>)> {
    let experiment = Source::Texts(texts).read(py)?;
    Ok((experiment.signals(), experiment.doubts))
}

/// Kind, what is to be checked, what is to be filled in, what is doubtful, and what keeps the folder from being read.
type Found = (&'static str, Vec<String>, Vec<String>, Vec<String>, Option<String>);

/// Makes an experiment folder for CSV files; returns its kind, what is to be checked, what is to be filled in, what is
/// doubtful, and what keeps it from being read.
#[pyfunction]
#[pyo3(signature = (files, folder, kind=None))]
pub fn import_experiment(py: Python<'_>, files: Vec<PathBuf>, folder: PathBuf, kind: Option<&str>) -> PyResult<Found> {
    let kind = match kind {
        None => None,
        Some(name) => {
            let found = [Kind::SingleWheel, Kind::Traverse].into_iter().find(|kind| kind.name() == name);
            let message = || format!("kind is `{name}`, expected single_wheel, traverse or None");
            Some(found.ok_or_else(|| InputError::new_err(message()))?)
        }
    };
    let proposal = py.detach(|| error::fenced(|| Proposal::of(&files, kind)))?;
    let proposal = proposal.map_err(|refused| InputError::new_err(refused.to_string()))?;
    let imported = proposal.write(&folder).map_err(|failed| match &failed {
        WriteError::File { source, .. } => error::unreachable_file(source, failed.to_string()),
        WriteError::Exists { .. } => PyFileExistsError::new_err(failed.to_string()),
        WriteError::Settings { .. } => InputError::new_err(failed.to_string()),
    })?;
    let (doubts, problem) = match imported.read {
        Ok(experiment) => (experiment.doubts, None),
        Err(refused) => (Vec::new(), Some(refused.to_string())),
    };
    Ok((proposal.kind.name(), proposal.unsure, proposal.missing, doubts, problem))
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
