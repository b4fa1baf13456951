//! The unpacked FMU.

use crate::ImportError;
use crate::description::{Description, Version};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// An FMU, unpacked until dropped.
pub struct Fmu {
    folder: TempDir,
    /// What `modelDescription.xml` says.
    pub description: Description,
}

impl Fmu {
    /// Unpacks a file.
    ///
    /// # Errors
    /// [`ImportError`] where it is no FMU with co-simulation of FMI 2.0 or 3.0.
    pub fn open(file: &Path) -> Result<Self, ImportError> {
        let refused = |message: String| ImportError::Archive { file: file.to_owned(), message };
        let opened = std::fs::File::open(file).map_err(|error| refused(error.to_string()))?;
        let folder = tempfile::tempdir().map_err(|error| refused(error.to_string()))?;
        let mut archive = zip::ZipArchive::new(opened).map_err(|error| refused(error.to_string()))?;
        archive.extract(folder.path()).map_err(|error| refused(error.to_string()))?;
        let text = std::fs::read_to_string(folder.path().join("modelDescription.xml"))
            .map_err(|error| refused(format!("modelDescription.xml: {error}")))?;
        Ok(Self { folder, description: Description::parse(&text)? })
    }

    /// The resources folder.
    #[must_use]
    pub fn resources(&self) -> PathBuf {
        self.folder.path().join("resources")
    }

    /// The library for this system.
    ///
    /// # Errors
    /// [`ImportError::Library`] where the FMU has none; the systems that it has libraries for are named.
    pub fn library(&self) -> Result<PathBuf, ImportError> {
        let binaries = self.folder.path().join("binaries");
        let identifier = &self.description.identifier;
        let name = format!("{identifier}.{}", std::env::consts::DLL_EXTENSION);
        let wanted = platforms(self.description.version);
        if let Some(file) = wanted.iter().map(|name_| binaries.join(name_).join(&name)).find(|file| file.is_file()) {
            return Ok(file);
        }
        let found = std::fs::read_dir(&binaries).into_iter().flatten().flatten();
        let mut found: Vec<String> = found.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        found.sort();
        let found = if found.is_empty() { "none".to_owned() } else { found.join(", ") };
        Err(ImportError::Library(format!(
            "expected binaries/{}/{name}, found libraries for {found}",
            wanted.join(" or ")
        )))
    }
}

/// Folders in which a library for this system may lie: FMI 2.0 names systems by their word length, FMI 3.0 by
/// architecture and system; tools on systems that FMI 2.0 has no name for use that of FMI 3.0.
fn platforms(version: Version) -> Vec<String> {
    let system = match std::env::consts::OS {
        "macos" => "darwin",
        other => other,
    };
    let modern = format!("{}-{system}", std::env::consts::ARCH);
    let old = match (std::env::consts::ARCH, std::env::consts::OS) {
        ("x86_64", "linux") => Some("linux64"),
        ("x86_64", "windows") => Some("win64"),
        ("x86_64", "macos") => Some("darwin64"),
        _ => None,
    };
    match version {
        Version::Fmi2 => old.map(str::to_owned).into_iter().chain([modern]).collect(),
        Version::Fmi3 => vec![modern],
    }
}
