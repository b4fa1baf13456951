//! A model's vocabulary, written once.
//!
//! A group of parameters (or of signals) is declared with [`parameters!`]; from that one
//! declaration follow the struct, its defaults, reading and setting by name, the bounds that every
//! border checks, `modelDescription.xml`, the Python and Markdown tables and the calibration vector.

mod parameters;
mod recorded_unit;
mod unit;
mod variable;
pub mod xml;

pub use parameters::{Lookup, Over, ParameterError, Parameters, join, nearest};
pub use recorded_unit::{STANDARD_GRAVITY, UnitError};
pub use unit::{DisplayUnit, Exponents, Unit};
pub use variable::{Role, Variable};
