//! Measurements: experiment folders and time series.
//!
//! An [`Experiment`] is a folder with `experiment.toml` and CSV files. All keys, units and forms of files stand on one page,
//! `examples/experiments.md`; in short:
//!
//! ```toml
//! name = "sand box, wheel 2"
//! kind = "single_wheel"            # or "traverse", "plate_sinkage", "shear"
//! [columns]                        # columns that are not called as the model calls them, or are not in SI units
//! "DP [kN]" = { signal = "drawbar_pull", unit = "kN" }
//! [parameters]                     # what is known of the rig; the rest keeps the model's value or is calibrated
//! "wheel.radius" = 0.10
//! [priors]                         # mean and deviation of a parameter from a separate test; a calibration then moves it
//! "soil.exponent" = { mean = 1.31, sd = 0.09 }
//! [[run]]
//! file = "run1.csv"
//! ```
//!
//! A single wheel has the inputs `load` (N), `slip`, `wheel_speed` (rad/s) and any of `drawbar_pull` (N), `torque` (N m),
//! `sinkage` (m), one steady point a row; a `condition` column of labels may replace `group`. A traverse has `time` (s),
//! `wheel[k].speed_command` (rad/s) or `wheel[k].torque_command` (N m), or where none were recorded the measured
//! `wheel[k].speed` of every wheel, and any of the rover's [signals](crate::signals), also sums of them over wheels. A plate test has
//! `sinkage` (m) with `force` (N) or `pressure` (Pa), a shear test `displacement` (m) and `normal_stress` (Pa) with `shear_stress`
//! (Pa). A missing measurement is an empty cell.
//!
//! Reading is strict: whatever cannot be right is an [`ExperimentError`] that names the file, the line and the column and says
//! what was expected; what is unlikely is among [`Experiment::doubts`]. Nothing is repaired silently. The way of a file:
//! text (`dialect`, `sheet`) or columns of a program (`arrays`) → which column is what (`mapping`, `recognise`) → rows that count and the runs that they form
//! (`filter`, `convert`) → SI values (`grid`, `derive`) → checks by the physics (`columns`, `suspicion`) → [`Run`].
//!
//! A drive that also turns becomes its straight stretches in `straight`.
//!
//! What the files of one kind of experiment hold stands in `kinds`.
//!
//! A [`Proposal`] is a folder for files whose columns are not mapped yet.
//!
//! [`Experiment::write`] makes such a folder, also of an experiment that is only planned: measured columns are empty there,
//! and [`Experiment::read_plan`] reads it.
//!
//! A [`Table`] holds the columns; [`Record`] fills one from a running simulation.

mod around;
mod arrays;
mod checker;
mod columns;
mod convert;
mod course;
mod derive;
mod dialect;
mod doubts;
mod drive;
mod error;
mod experiment;
mod files;
mod filter;
mod grid;
mod import;
mod joint;
mod kinds;
mod mapping;
mod reading;
mod recognise;
mod record;
mod replicates;
mod sensor;
mod settings;
mod share;
mod sheet;
mod stamps;
mod straight;
mod suggestion;
mod suspicion;
mod table;
mod table_file;
mod vocabulary;
mod write;
mod written;

pub(crate) use around::around;
pub use arrays::{Cells, Columns};
pub use error::{ExperimentError, Problem};
pub use experiment::{Experiment, Kind, Prior, Run};
pub use files::decoded;
pub use import::{ImportError, Imported, Meaning, Proposal, ProposedColumn};
pub use joint::{JointError, Part};
pub use mapping::Side;
pub use record::Record;
pub use replicates::Sample;
pub use sensor::{Sensor, SensorError};
pub use share::Share;
pub use table::{Table, TableError};
pub use vocabulary::summands;
pub use write::WriteError;
