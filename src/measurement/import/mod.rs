//! Proposes an experiment folder for existing measurement files: `bekker import`.
//!
//! Names of columns, the units in them and the ranges of their values say what a column may be. What is proposed is written
//! with its reason, and read back at once: the folder is an experiment, or it is said what is missing.

mod choice;
mod entry;
mod propose;
mod ranges;
mod survey;
mod text;
mod wheels;

use super::error::ExperimentError;
use super::experiment::{Experiment, Kind};
use super::files::{SETTINGS, read_text};
use super::write::WriteError;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub use choice::{Meaning, ProposedColumn};
pub(super) use entry::{Entry, To};
pub(super) use ranges::falls;
pub(super) use survey::{FoundColumn, Survey};
pub(super) use wheels::USUAL_WHEELS;

/// A folder that is not written yet.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// What was done.
    pub kind: Kind,
    /// `experiment.toml`, with comments.
    pub settings: String,
    /// What is a guess: check it.
    pub unsure: Vec<String>,
    /// What the files do not say and the user must.
    pub missing: Vec<String>,
    /// Files to be copied, and their names in the folder.
    files: Vec<(PathBuf, String)>,
    survey: Survey,
    plan: Plan,
}

/// What became of a folder.
#[derive(Debug)]
pub struct Imported {
    /// The folder.
    pub folder: PathBuf,
    /// The experiment, or what keeps it from being read until the user fills it in.
    pub read: Result<Experiment, ExperimentError>,
}

/// Why nothing can be proposed.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// No file was given.
    #[error("no files; give the CSV files of one experiment")]
    NoFiles,
    /// A file cannot be read as columns.
    #[error(transparent)]
    File(#[from] ExperimentError),
    /// The columns do not tell which kind of experiment they belong to.
    #[error(
        "the columns tell neither a `single_wheel` experiment (a load or a drawbar pull) nor a `plate_sinkage` test (a pressure, or a sinkage with a force) nor a `shear` test (a shear stress) nor a `traverse` (a time); say which it is. Found are {found}"
    )]
    Kind {
        /// The columns.
        found: String,
    },
    /// A choice that a column or a number cannot have.
    #[error("{0}")]
    Choice(String),
}

impl Proposal {
    /// Proposes an experiment for these files, all of one kind; `None` finds out which.
    ///
    /// # Errors
    /// [`ImportError`] where a file cannot be read, or its columns do not tell the kind.
    pub fn of(files: &[PathBuf], kind: Option<Kind>) -> Result<Self, ImportError> {
        let mut texts = Vec::new();
        for file in files {
            texts.push((file.clone(), read_text(file)?));
        }
        Self::of_texts(&texts, kind)
    }

    /// The same for files whose texts are in memory, which [`settings`](Self::settings) names as [`names`](Self::names) does.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn of_texts(files: &[(PathBuf, String)], kind: Option<Kind>) -> Result<Self, ImportError> {
        let survey = Survey::of(files)?;
        let kind = kind.or_else(|| survey.kind()).ok_or_else(|| ImportError::Kind { found: survey.names() })?;
        let plan = propose::plan(&survey, kind);
        let files: Vec<(PathBuf, String)> = files.iter().map(|(file, _)| file.clone()).zip(survey.copies()).collect();
        let mut proposal =
            Self { kind, settings: String::new(), unsure: Vec::new(), missing: Vec::new(), files, survey, plan };
        proposal.tell();
        Ok(proposal)
    }

    /// Names of the files in the folder, in the order in which they were given.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|(_, copy)| copy.as_str())
    }

    /// Writes down what the plan says.
    fn tell(&mut self) {
        self.settings =
            text::settings(&self.survey, self.kind, &self.plan, self.files.iter().map(|(_, copy)| copy.as_str()));
        self.unsure.clone_from(&self.plan.unsure);
        let open = |missing: &&String| !self.plan.filled.keys().any(|name| missing.contains(name.as_str()));
        self.missing = self.plan.missing.iter().filter(open).cloned().collect();
    }

    /// Makes the folder, copies the files and reads what was written.
    ///
    /// # Errors
    /// [`WriteError`] where the folder is there already, or the system refuses a file.
    pub fn write(&self, folder: impl AsRef<Path>) -> Result<Imported, WriteError> {
        let folder = folder.as_ref();
        let failed = |file: &Path| {
            let file = file.to_owned();
            move |source| WriteError::File { file, source }
        };
        if folder.exists() {
            return Err(WriteError::Exists { file: folder.to_owned() });
        }
        std::fs::create_dir_all(folder).map_err(failed(folder))?;
        for (file, copy) in &self.files {
            let text = std::fs::read(file).map_err(failed(file))?;
            let copy = folder.join(copy);
            std::fs::write(&copy, text).map_err(failed(&copy))?;
        }
        let settings = folder.join(SETTINGS);
        std::fs::write(&settings, &self.settings).map_err(failed(&settings))?;
        Ok(Imported { folder: folder.to_owned(), read: Experiment::read(folder) })
    }
}

/// What becomes of all columns.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub entries: Vec<(String, Entry)>,
    pub ignored: Vec<(String, String)>,
    pub unsure: Vec<String>,
    pub missing: Vec<String>,
    /// Numbers of `[parameters]` and `[inputs]` that a person has filled in.
    pub filled: BTreeMap<String, f64>,
}
