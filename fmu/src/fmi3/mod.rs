//! The C border of FMI 3.0: every function of the standard's header `fmi3Functions.h`, by its name.
//!
//! Each function translates its arguments, calls the [lifecycle](crate::lifecycle) under a guard
//! (module `border`) and translates back. What the FMU does not offer answers with an error and a message.
//!
//! # Safety
//! The importer promises what a C header can only ask for: that pointers are NULL or valid for the stated
//! number of values, and texts NUL-terminated, while a call lasts. NULL where it is not allowed, wrong
//! alignment, unknown or freed instances and states, and wrong order are found out and refused.
#![allow(non_snake_case, clippy::missing_safety_doc)]

mod access;
mod create;
mod derivatives;
mod events;
mod exchange;
mod instances;
mod simulate;
mod state;
mod types;
mod unsupported;

pub use crate::border::Status;
pub use crate::border::instance::Instance;
pub use access::*;
pub use create::*;
pub use derivatives::*;
pub use events::*;
pub use exchange::*;
pub use simulate::*;
pub use state::*;
pub use types::{IntermediateUpdate, LogMessage};
pub use unsupported::*;
