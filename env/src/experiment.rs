//! Experiments: a folder, or arrays of Python's.

use crate::error::{self, InputError, ModelError};
use bekker::measurement::{Cells, Columns, Experiment, ExperimentError, Kind, Problem, Proposal, WriteError};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyFileExistsError;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What Python gives for an experiment.
#[derive(FromPyObject)]
pub enum Source<'py> {
    /// Settings as in `experiment.toml`, and the columns of each table that they name.
    Arrays(String, BTreeMap<String, Vec<(String, Column<'py>)>>),
    Folder(PathBuf),
    /// Several experiments on one soil.
    Several(Vec<Source<'py>>),
}

/// A column of Python's.
#[derive(FromPyObject)]
pub enum Column<'py> {
    Numbers(PyReadonlyArray1<'py, f64>),
    Labels(Vec<String>),
}

impl Source<'_> {
    /// The experiment, and what it was read from.
    pub fn read(self, py: Python<'_>) -> PyResult<(Experiment, Material)> {
        let material = match self {
            Self::Folder(folder) => Material::Folder(folder),
            Self::Several(sources) => {
                let mut read = sources.into_iter().map(|source| source.read(py)).collect::<PyResult<Vec<_>>>()?;
                if read.len() == 1 {
                    return Ok(read.remove(0));
                }
                let (experiments, materials): (Vec<_>, Vec<_>) = read.into_iter().unzip();
                let joint =
                    Experiment::joint(experiments).map_err(|refused| InputError::new_err(refused.to_string()))?;
                let names = joint.parts.iter().map(|part| part.name.clone());
                let materials = names.zip(materials).collect();
                return Ok((joint, Material::Several(materials)));
            }
            Self::Arrays(settings, tables) => {
                let cells = |(name, column)| match column {
                    Column::Numbers(array) => (name, Cells::Numbers(array.as_array().to_vec())),
                    Column::Labels(labels) => (name, Cells::Labels(labels)),
                };
                let columns = |columns: Vec<_>| columns.into_iter().map(cells).collect();
                let tables = tables.into_iter().map(|(file, table)| (file, columns(table))).collect();
                Material::Arrays { settings, tables }
            }
        };
        let read = py.detach(|| error::fenced(|| material.read()))?;
        match read {
            Ok(read) => Ok((read, material)),
            Err(refused) => Err(material.refused(&refused)),
        }
    }
}

/// What an experiment is made of.
#[derive(Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Material {
    Folder(PathBuf),
    /// The texts of a folder's files.
    Texts(BTreeMap<String, String>),
    Arrays {
        settings: String,
        tables: BTreeMap<String, Columns>,
    },
    /// Several experiments on one soil, with the names that they have there.
    Several(Vec<(String, Material)>),
}

impl Material {
    /// The same without a folder, for other machines.
    pub fn portable(&self) -> PyResult<Self> {
        match self {
            Self::Folder(folder) => {
                Experiment::texts(folder).map(Self::Texts).map_err(|refused| self.refused(&refused))
            }
            Self::Texts(_) | Self::Arrays { .. } => Ok(self.clone()),
            Self::Several(parts) => {
                let portable = |(name, part): &(String, Self)| Ok((name.clone(), part.portable()?));
                parts.iter().map(portable).collect::<PyResult<_>>().map(Self::Several)
            }
        }
    }

    pub fn read(&self) -> Result<Experiment, ExperimentError> {
        match self {
            Self::Folder(folder) => Experiment::read(folder),
            Self::Texts(texts) => Experiment::from_texts(texts),
            Self::Arrays { settings, tables } => Experiment::from_arrays(settings, tables),
            Self::Several(parts) => {
                let read = |(name, part): &(String, Self)| Ok((name.clone(), part.read()?));
                let parts = parts.iter().map(read).collect::<Result<_, ExperimentError>>()?;
                Experiment::joint_named(parts).map_err(|refused| ExperimentError {
                    file: PathBuf::new(),
                    line: None,
                    column: None,
                    problem: Box::new(Problem::Setting(refused.to_string())),
                })
            }
        }
    }

    fn refused(&self, refused: &ExperimentError) -> PyErr {
        match self {
            Self::Arrays { .. } => InputError::new_err(in_memory(refused)),
            Self::Folder(_) | Self::Texts(_) | Self::Several(_) => ModelError::new_err(refused.to_string()),
        }
    }
}

/// Checks an experiment; returns the names of its measured signals, and what is doubtful.
#[pyfunction]
pub fn check_experiment(py: Python<'_>, experiment: Source<'_>) -> PyResult<(Vec<String>, Vec<String>)> {
    let (experiment, _) = experiment.read(py)?;
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
            let all = Kind::ALL.map(Kind::name).join(", ");
            let message = || format!("kind is `{name}`, expected {all} or None");
            Some(Kind::named(name).ok_or_else(|| InputError::new_err(message()))?)
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
