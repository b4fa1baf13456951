//! Measurements: experiment folders and time series.
//!
//! An [`Experiment`] is a folder with `experiment.toml` and CSV files whose columns carry the model's own
//! names in SI units. Reading is strict: whatever cannot be right is an [`ExperimentError`] that names the
//! file, the line and the column and says what was expected; nothing is repaired silently.
//! A [`Table`] holds the columns; [`Record`] fills one from a running simulation.

mod columns;
mod error;
mod experiment;
mod record;
mod replicates;
mod settings;
mod sheet;
mod table;
mod table_file;

pub use error::{ExperimentError, Problem};
pub use experiment::{Experiment, Kind, Run};
pub use record::Record;
pub use replicates::Sample;
pub use table::{Table, TableError};
