//! Where the files of an experiment are: in a folder, or in memory.

use super::arrays::Columns;
use super::dialect::Dialect;
use super::error::{ExperimentError, Problem};
use super::experiment::Experiment;
use super::settings::Settings;
use super::sheet::Sheet;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Name of the settings in an experiment's folder.
pub(super) const SETTINGS: &str = "experiment.toml";

/// The files of an experiment.
pub(super) enum Files<'a> {
    /// Below a folder.
    Folder(&'a Path),
    /// By their names below a folder that need not exist.
    Memory(&'a BTreeMap<String, String>),
    /// The settings as text, the tables as columns by their names.
    Arrays { settings: &'a str, tables: &'a BTreeMap<String, Columns> },
}

impl Files<'_> {
    pub fn folder(&self) -> PathBuf {
        match self {
            Self::Folder(folder) => folder.to_path_buf(),
            Self::Memory(_) | Self::Arrays { .. } => PathBuf::new(),
        }
    }

    /// How errors name a file.
    pub fn path(&self, name: &str) -> PathBuf {
        match self {
            Self::Folder(folder) => folder.join(name),
            Self::Memory(_) | Self::Arrays { .. } => PathBuf::from(name),
        }
    }

    pub fn text(&self, name: &str) -> Result<String, ExperimentError> {
        let path = self.path(name);
        match self {
            Self::Folder(_) => read_text(&path),
            Self::Memory(texts) => texts.get(name).cloned().ok_or_else(|| no_such_file(&path)),
            Self::Arrays { settings, .. } if name == SETTINGS => Ok((*settings).to_owned()),
            Self::Arrays { .. } => Err(no_such_file(&path)),
        }
    }

    /// The table in a file, which is written as `dialect` says where it is text.
    pub fn sheet(&self, name: &str, dialect: &Dialect) -> Result<Sheet, ExperimentError> {
        let path = self.path(name);
        match self {
            Self::Arrays { tables, .. } => {
                Sheet::of_columns(&path, tables.get(name).ok_or_else(|| no_such_file(&path))?)
            }
            Self::Folder(_) | Self::Memory(_) => Sheet::parse(&path, &self.text(name)?, dialect),
        }
    }
}

fn no_such_file(path: &Path) -> ExperimentError {
    ExperimentError::in_file(path, Problem::Unreadable("there is no such file".to_owned()))
}

/// The text of a file in UTF-8.
pub(super) fn read_text(path: &Path) -> Result<String, ExperimentError> {
    let refused = |message: String| ExperimentError::in_file(path, Problem::Unreadable(message));
    decoded(path, std::fs::read(path).map_err(|error| refused(error.to_string()))?)
}

/// The bytes of a file as text, which has to be UTF-8; `path` is for errors.
///
/// # Errors
/// [`ExperimentError`] with the line of the first byte that is no UTF-8.
pub fn decoded(path: &Path, bytes: Vec<u8>) -> Result<String, ExperimentError> {
    let refused = |message: String| ExperimentError::in_file(path, Problem::Unreadable(message));
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let before = &error.as_bytes()[..at];
        let line = before.iter().filter(|byte| **byte == b'\n').count() as u64 + 1;
        let message =
            "a character is not in UTF-8 (a degree or micro sign of an older program?); save the file as UTF-8";
        refused(message.to_owned()).at_line(line)
    })
}

impl Experiment {
    /// An experiment from the texts of its files, by their names below the folder: `experiment.toml` and the CSV files
    /// that it names. For data that are not on disk, and for sending an experiment to another machine; it goes through
    /// the same checks as a folder, and gives the same bits, since numbers are written so that they read back exactly.
    ///
    /// # Errors
    /// As [`read`](Self::read); files are named as in `texts`.
    pub fn from_texts(texts: &BTreeMap<String, String>) -> Result<Self, ExperimentError> {
        Self::read_from(&Files::Memory(texts), false)
    }

    /// The texts of all files of the experiment in `folder`, for [`from_texts`](Self::from_texts).
    ///
    /// # Errors
    /// [`ExperimentError`] where the settings are refused or a file cannot be read; the tables are not checked.
    pub fn texts(folder: impl AsRef<Path>) -> Result<BTreeMap<String, String>, ExperimentError> {
        let files = Files::Folder(folder.as_ref());
        let settings = Settings::read(&files)?;
        let tables = settings.runs.iter().flat_map(|run| std::iter::once(&run.file).chain(&run.terrain));
        let names = std::iter::once(SETTINGS).chain(tables.map(String::as_str));
        names.map(|name| Ok((name.to_owned(), files.text(name)?))).collect()
    }
}
