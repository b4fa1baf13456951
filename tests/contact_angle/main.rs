//! Contact angles from measurements (chapter 2): in closed form, by the filter, on ground and on a rover.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod direct;
mod filter;
mod ground;
mod rover;
