//! What `compare` says of a model beside measurements.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "../support/hill_drive.rs"]
#[allow(dead_code, reason = "tests use parts of it")]
mod hill_drive;
#[cfg(feature = "report")]
#[path = "../support/saved_page.rs"]
#[allow(dead_code, reason = "tests use parts of it")]
mod saved_page;

mod report;
mod single_wheel;
mod traverse;
mod unanswered;
mod windows;
