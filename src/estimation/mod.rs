//! Estimators: what a rover can tell of its surroundings from its sensors. They see a
//! [`Measurement`](crate::signals::Measurement) and a [`Nominal`](crate::control::Nominal), never the true state.

mod error;
pub mod soil;

pub use error::EstimationError;
