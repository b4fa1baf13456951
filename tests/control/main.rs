//! Controllers (chapter 4) and the estimators that they rest on.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "../control_support/mod.rs"]
mod control_support;

mod active_set;
mod baselines;
mod constraints;
mod links;
mod oracle;
mod power;
mod readings;
mod speed_loop;
mod strength;
mod traction;
mod velocity;
mod wheel_speeds;
