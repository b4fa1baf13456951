//! Errors of an experiment folder: where, and what was expected.

use std::fmt;
use std::path::{Path, PathBuf};

/// What is wrong in an experiment folder, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct ExperimentError {
    /// The file, as it was opened.
    pub file: PathBuf,
    /// Line in that file, counted from 1, where there is one.
    pub line: Option<u64>,
    /// Column of a CSV file, or key of `experiment.toml`.
    pub column: Option<String>,
    /// What is wrong.
    pub problem: Box<Problem>,
}

/// What can be wrong in an experiment folder.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The file cannot be opened, or is not text.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// `experiment.toml` is not valid, or has a key or a value that it may not have.
    #[error("{0}")]
    Setting(String),
    /// A required column is missing.
    #[error("a `{kind}` experiment needs this column{instead}; found {found}")]
    MissingColumn {
        /// The experiment's kind.
        kind: &'static str,
        /// What may stand in its place; empty, or ` or ..`.
        instead: &'static str,
        /// The columns that are there.
        found: String,
    },
    /// Columns are neither known nor ignored.
    #[error("unknown {unknown}; known are {known} (map others under [columns], or list them under `ignore = [..]`)")]
    UnknownColumns {
        /// The columns, each with what it may be meant for.
        unknown: String,
        /// Columns known for this kind of experiment.
        known: String,
    },
    /// A column appears twice, or has no name.
    #[error("{0}")]
    Header(&'static str),
    /// Two columns, or a column and a constant input, give one signal.
    #[error("gives {signal}, as {other} does; list one of them under `ignore = [..]`")]
    Twice {
        /// The signal.
        signal: String,
        /// What else gives it.
        other: String,
    },
    /// The file says itself that a column has another unit than the one it is read with.
    #[error("the file gives its unit as `{found}`, and it is read in {read}; write under [columns]: {mend}")]
    OtherUnit {
        /// The unit in the file.
        found: String,
        /// The unit with which it is read.
        read: &'static str,
        /// The line that says so.
        mend: String,
    },
    /// A cell is no time stamp, or not one like that of the first row.
    #[error("`{text}` is not a time stamp: expected {expected}")]
    NotAStamp {
        /// The cell.
        text: String,
        /// What was expected.
        expected: String,
    },
    /// A value cannot be computed from others.
    #[error("{0}")]
    Derived(String),
    /// A row has more or fewer cells than the header.
    #[error("{found} cells where the header has {expected}")]
    Ragged {
        /// Cells in this row.
        found: usize,
        /// Cells in the header.
        expected: usize,
    },
    /// A cell is not a finite number.
    #[error("`{text}` is not a finite number (a missing value is an empty cell){understood}")]
    NotANumber {
        /// The cell.
        text: String,
        /// How the file was read, where that may be the reason.
        understood: String,
    },
    /// An input is missing; inputs cannot be.
    #[error("an input may not be missing")]
    MissingInput,
    /// A measured wheel speed is missing that drives the rover.
    #[error(
        "no command was recorded, so this measured wheel speed drives the rover and may be missing only between values at most {longest} s apart; give commands, or leave such rows out by `where`"
    )]
    MissingSpeed {
        /// Longest time between values over which a speed is interpolated, s.
        longest: f64,
    },
    /// Time does not increase.
    #[error("time {time} s does not come after {previous} s")]
    TimeOrder {
        /// This row's time, s.
        time: f64,
        /// The time of the row before, s.
        previous: f64,
    },
    /// There are too few rows to compare with.
    #[error("{found} rows; at least {needed} are needed")]
    TooFewRows {
        /// Rows found.
        found: usize,
        /// Rows needed.
        needed: usize,
    },
    /// A value that the unit of its column makes impossible.
    #[error("{value} cannot be right: expected {expected}")]
    Implausible {
        /// The value.
        value: f64,
        /// Unit and range that were expected, and the likely mistake.
        expected: String,
    },
    /// All values of a signal have a sign or size that it cannot have.
    #[error("{0}")]
    Suspicious(String),
    /// No column of the run is a measured signal with a value.
    #[error("nothing is measured yet: expected values in at least one of {known}")]
    NothingMeasured {
        /// Signals that may be measured.
        known: String,
    },
    /// Runs of one group do not repeat each other.
    #[error("not a repeat: {0}")]
    NotARepeat(String),
}

impl ExperimentError {
    pub(super) fn in_file(file: &Path, problem: Problem) -> Self {
        Self { file: file.to_owned(), line: None, column: None, problem: Box::new(problem) }
    }

    pub(super) fn at_line(mut self, line: u64) -> Self {
        self.line = Some(line);
        self
    }

    pub(super) fn at_column(mut self, column: impl Into<String>) -> Self {
        self.column = Some(column.into());
        self
    }
}

impl fmt::Display for ExperimentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        if let Some(column) = &self.column {
            let word = if self.file.extension().is_some_and(|e| e == "toml") { "key" } else { "column" };
            write!(f, ", {word} `{column}`")?;
        }
        write!(f, ": {}", self.problem)
    }
}

impl std::error::Error for ExperimentError {}
