//! What the search for the contact foot needs to know of a profile.

use crate::scalar::Scalar;

/// Height of the ground at one place and its derivatives along x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<S = f64> {
    /// Height z, m.
    pub height: S,
    /// dz/dx.
    pub slope: S,
    /// d2z/dx2, 1/m; at a jump of it the value of one side.
    pub curvature: S,
}

/// A C1 profile z = h(x) with a piecewise continuous, bounded second derivative.
pub(super) trait Curve<S: Scalar> {
    /// Height, slope and curvature at `x`.
    fn at(&self, x: S) -> Sample<S>;

    /// A bound from above on side * d2z/dx2 over `from..to`, for a side of 1 or -1; `middle` is the sample halfway.
    fn bend(&self, side: f64, from: f64, to: f64, middle: &Sample<f64>) -> f64;

    /// The same bound for all x, where it costs less than looking closer.
    fn bend_anywhere(&self, _side: f64) -> f64 {
        f64::INFINITY
    }

    /// A bound on |d2z/dx2| within `reach` of `x`, or for all x where that costs less, side by side.
    fn most_bend(&self, _x: S, _reach: S) -> S {
        S::from(f64::INFINITY)
    }

    /// Where to cut `from..to` in two; best at a jump of the curvature.
    fn cut(&self, from: f64, to: f64) -> f64 {
        0.5 * (from + to)
    }
}

/// The first of `places` inside `from..to`, or the middle: a [`cut`](Curve::cut) at jumps of the curvature.
pub(super) fn cut_at(places: [f64; 2], from: f64, to: f64) -> f64 {
    let inside = |x: &&f64| **x > from && **x < to;
    places.iter().find(inside).copied().unwrap_or(0.5 * (from + to))
}
