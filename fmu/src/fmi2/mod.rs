//! The C border of FMI 2.0: every function of the standard's header `fmi2Functions.h`, by its name, for
//! co-simulation and model exchange.
//!
//! Each function translates its arguments, calls the [lifecycle](crate::lifecycle) under a guard
//! (module `border`) and translates back. The importer's promises are those of [`fmi3`](crate::fmi3).
#![allow(non_snake_case, clippy::missing_safety_doc)]

mod access;
mod create;
mod exchange;
mod simulate;
mod state;
mod status;
mod types;

pub use crate::border::Status;
pub use crate::border::instance::Instance;
pub use access::*;
pub use create::*;
pub use exchange::*;
pub use simulate::*;
pub use state::*;
pub use status::*;
pub use types::{Boolean, Callbacks, EventInfo, Log};
