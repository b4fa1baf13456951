//! Smooth switches.

use super::{Scalar, lanes};

/// A smooth step: 0 below 0, 1 above 1, with continuous first derivative.
#[must_use]
#[lanes]
pub fn smooth_step<S: Scalar>(x: S) -> S {
    let within = x * x * (S::from(3.0) - x * 2.0);
    let upper = S::select(x.at_most(S::from(0.0)), S::from(0.0), within);
    S::select(S::from(1.0).at_most(x), S::from(1.0), upper)
}

/// Derivative of [`smooth_step`].
#[must_use]
#[lanes]
pub fn smooth_step_slope<S: Scalar>(x: S) -> S {
    let outside = x.at_most(S::from(0.0)) | S::from(1.0).at_most(x);
    S::select(outside, S::from(0.0), x * (S::from(1.0) - x) * 6.0)
}
