//! The library of effects, and effects that a user writes.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "../effects_support/mod.rs"]
mod support;

mod body;
mod contract;
mod custom;
mod custom_experiment;
mod drive;
mod formulas;
mod registered;
mod sensors;
mod slip_sinkage;
