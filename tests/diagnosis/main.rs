//! Diagnoses: what they name, what they leave open, and what they rest on.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "../support/hill_drive.rs"]
#[allow(dead_code, reason = "tests use parts of it")]
mod hill_drive;
#[path = "../support/noisy_wheel.rs"]
mod noisy_wheel;
#[cfg(feature = "report")]
#[path = "../support/saved_page.rs"]
#[allow(dead_code, reason = "tests use parts of it")]
mod saved_page;
#[cfg(feature = "report")]
#[path = "../support/schema.rs"]
mod schema;

mod caution;
mod curves;
mod derivatives;
mod joint;
mod long_drive;
mod noise;
mod report;
mod share;
mod single_wheel;
