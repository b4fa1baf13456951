//! Which ground a wheel has passed.

use super::WheelState;
use crate::scalar::{Mask, Scalar, smooth_step};
use crate::snapshot::moving_beside;

/// Distance inside the end of a track over which its ground turns from fresh to passed, m: about the length of a
/// small wheel's contact, so that the ground under a wheel is not yet ground that it has passed.
const EDGE: f64 = 0.05;

/// The stretch along x that a wheel's foot has covered in contact since the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track<S = f64> {
    /// Its end towards the rear, m; above `high` where nothing is covered yet.
    pub low: S,
    /// Its end towards the front, m.
    pub high: S,
}

moving_beside!(Track { low, high });

impl<S: From<f64>> Default for Track<S> {
    fn default() -> Self {
        Self { low: S::from(f64::INFINITY), high: S::from(f64::NEG_INFINITY) }
    }
}

impl<S: Scalar> Track<S> {
    /// Takes the foot's place over where it is in contact.
    #[cfg_attr(feature = "batch", inline(always))]
    pub(crate) fn extend(&mut self, x: S, covers: S::Mask) {
        self.low = S::select(covers, self.low.smaller(x), self.low);
        self.high = S::select(covers, self.high.larger(x), self.high);
    }

    /// How far the ground at `x` counts as passed: 0 at the ends and outside, 1 well inside.
    #[must_use]
    #[cfg_attr(feature = "batch", inline(always))]
    pub fn covers(&self, x: S) -> S {
        let inside = self.low.below(x) & x.below(self.high);
        if !inside.any() {
            return S::from(0.0);
        }
        S::select(inside, smooth_step((x - self.low) / EDGE) * smooth_step((self.high - x) / EDGE), S::from(0.0))
    }
}

/// Number of wheels that have passed the ground at `x`. Each counts once, however often it came; a wheel counts on its
/// own track once it has reversed by the length of a contact: while it goes on, it stands at its track's end.
#[cfg_attr(feature = "batch", inline(always))]
pub(super) fn passes<S: Scalar>(wheels: &[WheelState<S>], x: S) -> S {
    wheels.iter().fold(S::from(0.0), |sum, wheel| sum + wheel.track.covers(x))
}
