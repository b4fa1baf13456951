//! Packs models as Functional Mock-up Units.
//!
//! Two libraries serve every model, and this crate carries them: a small one for rovers in joint coordinates, and one
//! that also has the plant of rigid bodies. Packing is writing the model file and its description and zipping, so
//! a user of this crate needs no compiler.

mod archive;
mod documentation;
mod layout;
mod platform;
mod ssp;

pub use bekker_fmu::{Kind, Offer};
pub use layout::Version;
pub use platform::Platform;
pub use ssp::pack_system;

use archive::Archive;
use bekker::model::{Model, ModelKind, Plant};
use bekker_modeldescription::xml::{Description, DescriptionError};
use std::path::{Path, PathBuf};

/// The library that most FMUs carry, built for this crate's target: rovers without the plant of rigid bodies.
pub const LIBRARY: &[u8] = include_bytes!(env!("BEKKER_FMU_LIBRARY"));

/// The library with all that the small one leaves out: the plant of rigid bodies, wheels on a carriage; `None` without the
/// feature `large-library`.
#[cfg(feature = "large-library")]
pub const RIGID_LIBRARY: Option<&[u8]> = Some(include_bytes!(env!("BEKKER_FMU_RIGID_LIBRARY")));
/// The library with all that the small one leaves out, which this build was made without: the feature `large-library` is off.
#[cfg(not(feature = "large-library"))]
pub const RIGID_LIBRARY: Option<&[u8]> = None;

/// The icon of an FMU, a rover in profile on its ground: as a picture of points, and as the drawing of which that was made.
const ICON_PNG: &[u8] = include_bytes!("icon.png");
const ICON_SVG: &[u8] = include_bytes!("icon.svg");

/// Notices of the crates in the libraries, made by `fmu/scripts/third_party.py`.
const THIRD_PARTY: &str = include_str!("../third-party.txt");

/// The licences of the project, as they are packed.
const LICENSE: &str = concat!(
    "The model and the library of this FMU are licensed under either of the MIT License or the Apache License,\n\
     Version 2.0, at your option. Both follow.\n\n",
    include_str!("../../../LICENSE-MIT"),
    "\n\n",
    include_str!("../../../LICENSE-APACHE"),
);

/// How a model is packed.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Version of the standard; where missing 3.0, and 2.0 in a system.
    pub version: Option<Version>,
    /// What of the model it offers; where missing, what the model file says.
    pub kind: Option<Kind>,
    /// Whether FMI 3.0 shows the same quantity of every wheel, link or obstacle as one array; FMI 2.0 has no arrays.
    pub arrays: bool,
    /// Libraries for other platforms, packed besides the one for this crate's target. Each file says itself for which
    /// platform it is. Models with obstacles and wheels on a carriage need libraries with all features.
    pub libraries: Vec<PathBuf>,
    /// Of a system: whether the inputs that no FMU feeds also become inputs of the system, see
    /// [`System`](bekker_modeldescription::xml::System).
    pub system_inputs: bool,
    /// When the FMU was made, UTC in seconds since 1970, where it is to say so. Without it the same model gives the
    /// same bytes at any time.
    pub date: Option<u64>,
}

/// Why an FMU could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The model cannot be described or does not start.
    #[error("the model cannot be exported: {0}")]
    Model(String),
    /// The model needs the larger library, and the feature `large-library` is off.
    #[error(
        "an FMU of {0} carries a larger library, with which this program was not built: cargo's `--features large-library` \
         adds it (two minutes of compiling, once)"
    )]
    LargeLibrary(&'static str),
    /// The archive could not be made.
    #[error("the FMU could not be packed: {0}")]
    Archive(#[from] zip::result::ZipError),
    /// The model cannot be a system of two FMUs, or not as asked.
    #[error("the system cannot be exported: {0}")]
    System(String),
    /// A given file is no library, or for a platform that has one already.
    #[error("cannot pack `{}`: {reason}", path.display())]
    Library {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A library could not be read.
    #[error("cannot read `{}`: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// The file could not be written.
    #[error("cannot write `{}`: {error}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
}

/// Writes `model` to `path`: as an FMU or, where the path ends in `.ssp`, as a system of a rover's FMU and its
/// controller's. The same model and options give the same bytes.
///
/// # Errors
/// An [`ExportError`] where the model does not start or has no controller for a system, or a file cannot be read or
/// written.
pub fn export(model: &Model, options: &Options, path: &Path) -> Result<(), ExportError> {
    let system = path.extension().is_some_and(|extension| extension == "ssp");
    let bytes = if system { pack_system(model, options)? } else { pack(model, options)? };
    std::fs::write(path, bytes).map_err(|error| ExportError::Write { path: path.to_owned(), error })
}

/// The FMU of `model`, as [`export`] writes it.
///
/// # Errors
/// As [`export`], but for writing.
pub fn pack(model: &Model, options: &Options) -> Result<Vec<u8>, ExportError> {
    Ok(pack_part(model, options)?.0)
}

/// An FMU and its variables.
fn pack_part(model: &Model, options: &Options) -> Result<(Vec<u8>, Description), ExportError> {
    let version = options.version.unwrap_or_default();
    let further = further_libraries(&options.libraries)?;
    if options.system_inputs {
        return Err(ExportError::Model("only a system (an output that ends in .ssp) has inputs of a system".into()));
    }
    if options.arrays && version == Version::Fmi2 {
        return Err(ExportError::Model("FMI 2.0 has no arrays".into()));
    }
    let offer = Offer { kind: options.kind, arrays: options.arrays };
    let (file, mut description) = bekker_fmu::describe_as(model, offer).map_err(ExportError::Model)?;
    description.date = options.date.map(layout::utc);
    let mut ready = bekker_fmu::parse(&file).map_err(ExportError::Model)?;
    let abilities = bekker_fmu::abilities(&mut *ready).map_err(ExportError::Model)?;
    let xml = match version {
        Version::Fmi2 => description.fmi2(&abilities),
        Version::Fmi3 => description.fmi3(&abilities),
    };
    let mut archive = Archive::default();
    archive.file("modelDescription.xml", xml.map_err(undescribed)?.as_bytes())?;
    archive.program(&version.library(Platform::OWN, &description.identifier), library(model)?)?;
    for (platform, library) in &further {
        archive.program(&version.library(*platform, &description.identifier), library)?;
    }
    papers(&mut archive, version, &description)?;
    archive.file(&format!("resources/{}", bekker_fmu::MODEL_FILE), file.as_bytes())?;
    Ok((archive.finish()?, description))
}

/// The given libraries with their platforms, each of which has one.
fn further_libraries(paths: &[PathBuf]) -> Result<Vec<(Platform, Vec<u8>)>, ExportError> {
    let mut found: Vec<(Platform, Vec<u8>)> = Vec::new();
    for path in paths {
        let library = std::fs::read(path).map_err(|error| ExportError::Read { path: path.clone(), error })?;
        let refused = |reason: String| ExportError::Library { path: path.clone(), reason };
        for platform in platform::platforms(&library).map_err(|reason| refused(reason.to_owned()))? {
            if platform == Platform::OWN || found.iter().any(|(other, _)| *other == platform) {
                return Err(refused(format!("the package has a library for {platform} already")));
            }
            found.push((platform, library.clone()));
        }
    }
    Ok(found)
}

/// The platforms on which an FMU with these `libraries` besides the one for this crate's target runs.
///
/// # Errors
/// As [`export`].
pub fn platforms_of(libraries: &[PathBuf]) -> Result<Vec<Platform>, ExportError> {
    let further = further_libraries(libraries)?.into_iter().map(|(platform, _)| platform);
    Ok(std::iter::once(Platform::OWN).chain(further).collect())
}

/// The library that can run the model.
fn library(model: &Model) -> Result<&'static [u8], ExportError> {
    let large = |what| RIGID_LIBRARY.ok_or(ExportError::LargeLibrary(what));
    match (model.kind, model.stepping.plant) {
        (ModelKind::Carriage, _) => large("a wheel on a carriage"),
        (_, Plant::RigidBodies) => large("rigid bodies"),
        _ => Ok(LIBRARY),
    }
}

fn undescribed(error: DescriptionError) -> ExportError {
    ExportError::Model(error.to_string())
}

/// Documentation, licence, icon and, in FMI 3.0, terminals.
fn papers(archive: &mut Archive, version: Version, description: &Description) -> Result<(), ExportError> {
    archive.file("documentation/index.html", documentation::html(description).as_bytes())?;
    archive.file("documentation/licenses/license.txt", LICENSE.as_bytes())?;
    archive.file("documentation/licenses/third-party.txt", THIRD_PARTY.as_bytes())?;
    match version {
        Version::Fmi2 => archive.file("model.png", ICON_PNG)?,
        Version::Fmi3 => {
            let terminals = description.terminals().map_err(undescribed)?;
            archive.file("terminalsAndIcons/terminalsAndIcons.xml", terminals.as_bytes())?;
            archive.file("terminalsAndIcons/icon.png", ICON_PNG)?;
            archive.file("terminalsAndIcons/icon.svg", ICON_SVG)?;
        }
    }
    Ok(())
}
