//! Models as Functional Mock-up Units.

use crate::error::{self, ModelError};
use crate::model::Model;
use bekker_fmu_package::{ExportError, Options, Version, export};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Writes `model` as an FMU of version `fmi` (2 or 3) to `path`, for this system and, with a library for it, for 64 bit
/// Windows. The same arguments give the same bytes.
#[pyfunction]
#[pyo3(signature = (model, path, fmi=3, windows=None))]
pub fn export_fmu(py: Python<'_>, model: &Model, path: PathBuf, fmi: u32, windows: Option<PathBuf>) -> PyResult<()> {
    let version = match fmi {
        2 => Version::Fmi2,
        3 => Version::Fmi3,
        other => return Err(PyValueError::new_err(format!("fmi is {other}, expected 2 or 3"))),
    };
    let options = Options { version, windows, date: None };
    py.detach(|| error::fenced(|| export(&model.core, &options, &path)))?.map_err(|failed| match &failed {
        ExportError::Read { error, .. } | ExportError::Write { error, .. } => {
            error::unreachable_file(error, failed.to_string())
        }
        ExportError::Model(_) | ExportError::Archive(_) => ModelError::new_err(failed.to_string()),
    })
}
