//! Experiments: their format, what is read from them and what is doubted.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod columns;
mod doubts;
mod format;
mod import;
mod record;
mod straight;
mod sums;
