//! Models as Functional Mock-up Units.

use crate::error::{self, ModelError};
use crate::model::PyModel;
use bekker_fmu_package::{ExportError, Kind, Options, Version, export};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Writes `model` as an FMU of version `fmi` (2 or 3) and of `kind` to `path`, for this system and the
/// platforms of further `libraries`; or to a path that ends in `.ssp` as a system of rover and controller, with
/// `system_inputs` of its own. The same arguments give the same bytes.
#[pyfunction]
#[pyo3(signature = (model, path, fmi=None, kind=None, libraries=None, arrays=false, system_inputs=false))]
#[allow(clippy::too_many_arguments)]
pub fn export_fmu(
    py: Python<'_>,
    model: &PyModel,
    path: PathBuf,
    fmi: Option<u32>,
    kind: Option<&str>,
    libraries: Option<Vec<PathBuf>>,
    arrays: bool,
    system_inputs: bool,
) -> PyResult<()> {
    let version = match fmi {
        None => None,
        Some(2) => Some(Version::Fmi2),
        Some(3) => Some(Version::Fmi3),
        Some(other) => return Err(PyValueError::new_err(format!("fmi is {other}, expected 2 or 3"))),
    };
    let kind = kind
        .map(|word| {
            word.parse::<Kind>().map_err(|expected| PyValueError::new_err(format!("kind is `{word}`, {expected}")))
        })
        .transpose()?;
    let libraries = libraries.unwrap_or_default();
    let options = Options { version, kind, arrays, libraries, system_inputs, date: None };
    py.detach(|| error::fenced(|| export(&model.core, &options, &path)))?.map_err(|failed| match &failed {
        ExportError::Read { error, .. } | ExportError::Write { error, .. } => {
            error::unreachable_file(error, failed.to_string())
        }
        ExportError::Model(_)
        | ExportError::System(_)
        | ExportError::Library { .. }
        | ExportError::LargeLibrary(_)
        | ExportError::Archive(_) => ModelError::new_err(failed.to_string()),
    })
}
