//! Models as Functional Mock-up Units.

use crate::error::{self, ModelError};
use crate::model::Model;
use bekker_fmu_package::{ExportError, export};
use pyo3::prelude::*;
use std::path::PathBuf;

/// Writes `model` as an FMU (FMI 3.0, co-simulation) to `path`. The same model gives the same bytes.
#[pyfunction]
pub fn export_fmu(py: Python<'_>, model: &Model, path: PathBuf) -> PyResult<()> {
    py.detach(|| error::fenced(|| export(&model.core, &path)))?.map_err(|failed| match &failed {
        ExportError::Write { error, .. } => error::unreachable_file(error, failed.to_string()),
        ExportError::Model(_) | ExportError::Archive(_) => ModelError::new_err(failed.to_string()),
    })
}
