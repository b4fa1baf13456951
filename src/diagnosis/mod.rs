//! Comparing the model with measurements.
//!
//! [`compare`] runs the model on an experiment's inputs and returns measured, modelled and residual values beside the
//! scatter between repeats, on request after a calibration of the soil.

mod bounds;
mod calibrate;
mod compare;
mod failure;
mod fit;
mod layout;
mod least_squares;
mod noise;
mod prediction;
mod recorded;
mod replay;
mod sensitivity;
mod single_wheel;
mod traverse;

pub use calibrate::{CalibratedParameter, Calibration, Prior};
pub use compare::{CompareError, CompareOptions, Comparison, compare};
pub use failure::{Failure, Level, levels};
pub use fit::{Fit, RunFit, SignalFit};
pub use noise::{FloorSource, NoiseFloor, Pooled};
pub use prediction::{Derivatives, PredictionError};
pub use replay::{Replay, ReplayError};
pub use sensitivity::{Sensitivity, modelled, sensitivity};
pub use single_wheel::{Rig, SteadyError, SteadyPoint, steady_point};
