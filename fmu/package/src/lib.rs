//! Packs models as Functional Mock-up Units.
//!
//! One library serves every model, and this crate carries it: packing is writing the model file and its
//! description and zipping, so whoever uses this crate needs no compiler.

mod archive;
mod documentation;

use archive::Archive;
use bekker::model::Model;
use std::path::{Path, PathBuf};

/// The library that FMUs carry, built for this crate's target.
pub const LIBRARY: &[u8] = include_bytes!(env!("BEKKER_FMU_LIBRARY"));

/// The target's name in FMI 3.0: the folder below `binaries`.
pub const PLATFORM: &str = env!("BEKKER_FMU_PLATFORM");

const EXTENSION: &str = env!("BEKKER_FMU_EXTENSION");

/// Why an FMU could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The model cannot be described or does not start.
    #[error("the model cannot be exported: {0}")]
    Model(String),
    /// The archive could not be made.
    #[error("the FMU could not be packed: {0}")]
    Archive(#[from] zip::result::ZipError),
    /// The file could not be written.
    #[error("cannot write `{}`: {error}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
}

/// Writes `model` as an FMU (FMI 3.0, co-simulation) to `path`. The same model gives the same bytes.
///
/// # Errors
/// An [`ExportError`] where the model does not start, or the file cannot be written.
pub fn export(model: &Model, path: &Path) -> Result<(), ExportError> {
    let bytes = pack(model)?;
    std::fs::write(path, bytes).map_err(|error| ExportError::Write { path: path.to_owned(), error })
}

/// The FMU of `model`, as [`export`] writes it.
///
/// # Errors
/// As [`export`], but for writing.
pub fn pack(model: &Model) -> Result<Vec<u8>, ExportError> {
    let (file, description) = bekker_fmu::describe(model).map_err(ExportError::Model)?;
    let xml = description.fmi3().map_err(|error| ExportError::Model(error.to_string()))?;
    let library = format!("binaries/{PLATFORM}/{}.{EXTENSION}", description.identifier);
    let mut archive = Archive::default();
    archive.file("modelDescription.xml", xml.as_bytes())?;
    archive.program(&library, LIBRARY)?;
    archive.file("documentation/index.html", documentation::html(&description).as_bytes())?;
    archive.file(&format!("resources/{}", bekker_fmu::MODEL_FILE), file.as_bytes())?;
    Ok(archive.finish()?)
}
