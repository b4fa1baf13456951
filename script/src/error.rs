//! Why a script cannot be read.

use bekker::measurement::ExperimentError;
use bekker::model::ModelError;
use std::fmt;
use std::path::{Path, PathBuf};

/// What is wrong in a script, and in which file.
#[derive(Debug)]
pub struct ScriptError {
    /// The script, as it was opened.
    pub file: PathBuf,
    /// What is wrong.
    pub problem: Problem,
}

/// What can be wrong in a script.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The file cannot be opened, or is not text.
    #[error("cannot be read: {0}")]
    Unreadable(std::io::Error),
    /// A file beside the script cannot be written.
    #[error("cannot write `{}`: {error}", file.display())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// The text is not TOML, or has an unknown key or a value of the wrong type.
    #[error("{0}")]
    Syntax(Box<toml::de::Error>),
    /// The model cannot be read.
    #[error("key `model`: {0}")]
    Model(Box<ModelError>),
    /// A table beside the script cannot be read.
    #[error("key `{key}`: {error}")]
    Table {
        /// The key that names the table.
        key: &'static str,
        /// Where, and what was expected.
        error: Box<ExperimentError>,
    },
    /// A value that cannot be right.
    #[error("key `{key}` = {found}: expected {expected}")]
    Value {
        /// The key.
        key: String,
        /// Its value.
        found: String,
        /// What would be right.
        expected: String,
    },
    /// A row, or something else without a single value, that cannot be right.
    #[error("key `{key}`: {message}")]
    Content {
        /// The key.
        key: String,
        /// What is wrong, and what was expected.
        message: String,
    },
}

impl Problem {
    /// A value that cannot be right.
    pub(super) fn value(key: impl Into<String>, found: impl fmt::Display, expected: impl Into<String>) -> Self {
        Self::Value { key: key.into(), found: found.to_string(), expected: expected.into() }
    }

    /// Something else that cannot be right.
    pub(super) fn content(key: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Content { key: key.into(), message: message.into() }
    }

    pub(super) fn in_file(self, file: &Path) -> ScriptError {
        ScriptError { file: file.to_owned(), problem: self }
    }
}

impl fmt::Display for ScriptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file.display(), self.problem)
    }
}

impl std::error::Error for ScriptError {}
