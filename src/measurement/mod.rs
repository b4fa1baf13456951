//! Measurements: experiment folders and time series.
//!
//! An [`Experiment`] is a folder with `experiment.toml` and CSV files whose columns carry the model's own
//! names in SI units. Reading is strict: whatever cannot be right is an [`ExperimentError`] that names the
//! file, the line and the column and says what was expected; nothing is repaired silently.
//!
//! ```toml
//! name = "sand box, wheel 2"
//! kind = "single_wheel"            # or "traverse"
//! ignore = ["note"]                # columns that are not for the model
//! soil.class = "dry sand"          # priors of the class for what is not known otherwise, see [`soil_class`](crate::soil_class)
//! model = "rocker_bogie_speed"     # the vehicle: a built-in model or a model file
//! [parameters]                     # what is known of the rig; the rest keeps the model's value or is calibrated
//! "wheel.radius" = 0.10
//! [priors]                         # what a separate test says of a parameter; frees it
//! "soil.exponent" = { mean = 1.31, sd = 0.09 }
//! "soil.cohesion" = 200.0          # a standard deviation alone: about the value in [parameters]
//! [noise]                          # standard deviation of one sample, where repeats do not tell it
//! drawbar_pull = 0.3
//! [[run]]
//! file = "run1.csv"
//! group = "a"                      # runs of a group repeat the same inputs; rows pair by index
//! parameters = { "wheel.width" = 0.05 }   # what was changed for this run
//! terrain = "hill.csv"             # traverse only: columns x, z, m; flat where missing
//! x0 = 0.6                         # traverse only: where the rover starts, m
//! ```
//! `[[effect]]` tables add effects of the user's own, see [`custom`](crate::effects::custom).
//!
//! A single wheel has the inputs `load` (N), `slip`, `wheel_speed` (rad/s) and any of `drawbar_pull` (N), `torque` (N m),
//! `sinkage` (m), one steady point a row; a `condition` column of labels may replace `group`. A traverse has `time` (s),
//! `wheel[k].speed_command` (rad/s) or `wheel[k].torque_command` (N m) and any of the rover's [signals](crate::signals).
//! A missing measurement is an empty cell.
//!
//! [`Experiment::write`] makes such a folder, also of an experiment that is only planned: measured columns are empty there,
//! and [`Experiment::read_plan`] reads it.
//!
//! A [`Table`] holds the columns; [`Record`] fills one from a running simulation.

mod columns;
mod convert;
mod derive;
mod dialect;
mod error;
mod experiment;
mod files;
mod filter;
mod grid;
mod import;
mod mapping;
mod reading;
mod recognise;
mod record;
mod replicates;
mod settings;
mod sheet;
mod stamps;
mod suggestion;
mod suspicion;
mod table;
mod table_file;
mod vocabulary;
mod write;
mod written;

pub use error::{ExperimentError, Problem};
pub use experiment::{Experiment, Kind, Prior, Run};
pub use import::{ImportError, Imported, Proposal};
pub use record::Record;
pub use replicates::Sample;
pub use table::{Table, TableError};
pub use vocabulary::summands;
pub use write::WriteError;
