//! Rough-terrain rovers on deformable soil, from physics to insight.
pub mod contact;
pub mod control;
pub mod diagnosis;
pub mod effects;
mod integrator;
pub mod linear_stress;
pub mod measurement;
pub mod model;
pub mod motor;
#[cfg(feature = "report")]
pub mod report;
pub mod rover;
pub mod scalar;
pub mod sensors;
pub mod signals;
pub mod simulation;
pub mod soil;
pub mod terrain;
pub mod wheel;

pub use bekker_modeldescription as modeldescription;
