//! Scripted tests: a drive written down with what it must give, checked in the core, an FMU and the environment alike.
//!
//! A script is one TOML file, with CSV files beside it where its rows are many; names and units are the vocabulary's:
//! ```toml
//! name = "velocity control starts on soft sand"
//! interval = 0.02                  # s between two samples: a communication step of an FMU, a step of the environment
//! duration = 2.0                   # s, whole intervals
//! seed = 3                         # of the sensors' noise; the model's own where missing
//! reset_after = 0.5                # s; drive so long, then reset, and only then begin (no reset where missing)
//! model = "gentle_velocity"        # a built-in model, a model file, or as a table what a model file says:
//! # [model]
//! # preset = "gentle_velocity"
//! # parameters = { "soil.cohesion" = 800.0, "slip_sinkage.n1" = 0.3 }
//! [inputs]                         # held; or `inputs = "drive.csv"`, or rows `[[inputs]]` with a `time`, each held on
//! velocity_command = 0.2
//! # [actions]                      # instead of inputs, within -1..1: `action[1]` ... in the order of the inputs
//! # action_scale = 2.0             # what an action of one commands
//! [expect]
//! status = "running"               # or the event that ends the run: stuck, tipped_over, belly_contact, left_terrain ...
//! # ends_within = [1.2, 1.4]       # s, where it ends
//! signals = "start.csv"            # `time` and signals by name; or rows `[[expect.signals]]`
//! tolerance = { default = { absolute = 1e-9, relative = 1e-6 }, "wheel.slip" = 1e-4 }   # `wheel.slip`: of every wheel
//! range = { pitch = [-0.2, 0.2] }  # every sample lies within
//! # record = ["x", "wheel.slip"]   # what recording writes into `signals`; the file's own columns where missing
//! # record_every = 0.1             # s, whole intervals
//! ```
//! A [`Script`] is read strictly: whatever cannot be right is a [`ScriptError`] that names file and key. Anything that is a
//! [`Door`] can be driven through it; the [`Report`] states for each signal the first and the largest deviation.
//! ```no_run
//! use bekker_script::{Core, Script};
//! let script = Script::read("start.toml".as_ref())?;
//! let report = script.check(&mut Core::new(&script))?;
//! println!("{report}");
//! assert!(report.passed());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod core;
mod door;
mod error;
mod expect;
mod file;
mod read;
mod record;
mod report;
mod rows;

pub use self::core::Core;
pub use door::{Door, DoorError, Recording, drive};
pub use error::{Problem, ScriptError};
pub use expect::{Expectation, Tolerance};
pub use read::Script;
pub use report::{Deviation, Report, SignalReport};

/// Times that only rounding keeps apart, relative to an interval.
const SAME_TIME: f64 = 1e-6;
