//! Bekker's rovers as Functional Mock-up Units (<https://fmi-standard.org>).
//!
//! Three layers, kept apart: [`model`], what a model must offer; [`lifecycle`], which calls are legal when,
//! the same for every version of the standard; [`fmi2`] and [`fmi3`], the C borders. The library serves every
//! model: it reads `model.toml` from the FMU's resources, rebuilds the vocabulary and checks that the
//! instantiation token belongs to it. `fmu/package` builds the library and packs it.

mod abilities;
mod border;
pub mod fmi2;
pub mod fmi3;
mod handles;
pub mod lifecycle;
pub mod model;
mod resources;
pub mod rover;

pub use abilities::abilities;
pub use border::Status;
pub use border::logger::LOG_CATEGORIES;
pub use rover::{Kind, MODEL_FILE, Offer, describe, describe_as, load, parse};
