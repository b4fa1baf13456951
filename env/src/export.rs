//! Models as Functional Mock-up Units.

use crate::error::{self, ModelError};
use crate::model::PyModel;
use bekker_fmu_package::{ExportError, Kind, Options, Version, export};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Writes `model` as an FMU of version `fmi` (2 or 3) and of `kind` to `path`, for this system and, with a library for
/// it, for 64 bit Windows; or to a path that ends in `.ssp` as a system of rover and controller. The same arguments give
/// the same bytes.
#[pyfunction]
#[pyo3(signature = (model, path, fmi=3, kind=None, windows=None, arrays=false))]
pub fn export_fmu(
    py: Python<'_>,
    model: &PyModel,
    path: PathBuf,
    fmi: u32,
    kind: Option<&str>,
    windows: Option<PathBuf>,
    arrays: bool,
) -> PyResult<()> {
    let version = match fmi {
        2 => Version::Fmi2,
        3 => Version::Fmi3,
        other => return Err(PyValueError::new_err(format!("fmi is {other}, expected 2 or 3"))),
    };
    let kind = kind
        .map(|word| {
            word.parse::<Kind>().map_err(|expected| PyValueError::new_err(format!("kind is `{word}`, {expected}")))
        })
        .transpose()?;
    let options = Options { version, kind, arrays, windows, date: None };
    py.detach(|| error::fenced(|| export(&model.core, &options, &path)))?.map_err(|failed| match &failed {
        ExportError::Read { error, .. } | ExportError::Write { error, .. } => {
            error::unreachable_file(error, failed.to_string())
        }
        ExportError::Model(_) | ExportError::LargeLibrary(_) | ExportError::Archive(_) => {
            ModelError::new_err(failed.to_string())
        }
    })
}
