//! Estimators: what a rover finds out about itself and its ground, from measurements.
//!
//! They see a [`Measurement`](crate::signals::Measurement) and a [`Nominal`](crate::control::Nominal) rover, its data
//! sheet, never the true state. An update allocates nothing and depends on its readings alone.
//!
//! | module | what it finds |
//! |---|---|
//! | [`contact_angle`] | the slope of the ground under every wheel (2.5) |
//! | [`soil`] | the soil's strength from what a driven wheel feels (2.3, 2.4) |
//! | [`consistency`] | whether an estimator's covariance is that of its errors |

pub mod consistency;
pub mod contact_angle;
mod error;
pub mod soil;

pub use contact_angle::{ContactAngleEstimation, ContactAngles};
pub use error::EstimationError;
