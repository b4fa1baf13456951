//! Functional Mock-up Units as doors of scripted tests: co-simulation of FMI 2.0 and 3.0 through the C functions.
//!
//! An [`Fmu`] is unpacked while it lives. A [`Slave`] is one instance of it; [`FmuDoor`] drives one through a script of
//! [`bekker_script`]. The FMU may be anyone's: it is asked for the variables that the script names, and whatever it
//! lacks is an error that says so.

mod archive;
mod description;
mod door;
mod fmi2;
mod fmi3;
mod slave;

pub use archive::Fmu;
pub use description::{Description, Kind, Variable, Version};
pub use door::FmuDoor;
pub use slave::{Progress, Slave};

use std::path::PathBuf;

/// Why an FMU cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The file cannot be read or unpacked.
    #[error("`{}` cannot be unpacked: {message}", file.display())]
    Archive {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// `modelDescription.xml` cannot be used.
    #[error("modelDescription.xml: {0}")]
    Description(String),
    /// The FMU has no library that this system can load.
    #[error("no library for this system: {0}")]
    Library(String),
    /// A function of the library refused.
    #[error("{function}: {status}{log}")]
    Call {
        /// The function.
        function: &'static str,
        /// What it returned, in words.
        status: &'static str,
        /// What the FMU said about it, after a colon.
        log: String,
    },
    /// The FMU has no such variable.
    #[error("the FMU has no variable `{0}`")]
    Unknown(String),
    /// A variable has another type.
    #[error("variable `{name}` is {found}, expected {expected}")]
    Type {
        /// The variable.
        name: String,
        /// What it is.
        found: &'static str,
        /// What was expected.
        expected: &'static str,
    },
}
