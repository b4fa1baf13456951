//! Progress beside the way of the rims: whether a rover is stuck.

use crate::scalar::{LaneAccess, Mask, Plain, lanes};
use crate::snapshot::Moving;

/// Progress under this share of the rim's travel, over a window of rim travel, is being stuck.
const STUCK_SHARE: f64 = 0.02;
/// The window's length in wheel radii.
const STUCK_WINDOW: f64 = 6.0;

/// Progress since the present window of rim travel began.
#[derive(Clone, Copy, Debug, Default, Moving, LaneAccess)]
pub(crate) struct Window<R = f64> {
    start_x: R,
    /// Path of the rims, mean over the wheels: without and with sign, m.
    rim_travel: R,
    rim_progress: R,
}

#[lanes]
impl<R: Plain> Window<R> {
    /// A window that begins at `x`.
    pub fn at(x: R) -> Self {
        Self { start_x: x, rim_travel: R::from(0.0), rim_progress: R::from(0.0) }
    }

    fn restart(&mut self, mask: R::Mask, x: R) {
        let zero = R::from(0.0);
        self.start_x = R::select(mask, x, self.start_x);
        self.rim_travel = R::select(mask, zero, self.rim_travel);
        self.rim_progress = R::select(mask, zero, self.rim_progress);
    }

    /// Takes in one step that ended at `x` with these wheel `speeds`; whether it closes a window without progress.
    pub fn stuck(
        &mut self,
        x: R,
        speeds: impl ExactSizeIterator<Item = R> + Clone,
        radius: R,
        step_size: f64,
    ) -> R::Mask {
        let scale = radius * step_size / speeds.len() as f64;
        let (mut travel, mut progress) = (R::from(-0.0), R::from(-0.0));
        for speed in speeds {
            travel += speed.abs();
            progress += speed;
        }
        let (travel, progress) = (travel * scale, progress * scale);
        // Where the wheels have reversed together, the way back is not lost progress.
        let reversed = (progress * self.rim_progress).under(0.0) & (travel * 0.5).below(progress.abs());
        self.restart(reversed, x);
        self.rim_travel += travel;
        self.rim_progress += progress;
        let full = (radius * STUCK_WINDOW).at_most(self.rim_travel);
        if !full.any() {
            return full;
        }
        // Progress counts in the direction of driving: sliding back while driving on is being stuck.
        let way = x - self.start_x;
        let progress = way.abs().negative_where((way * self.rim_progress).bit(63));
        let stuck = full & progress.below(self.rim_travel * STUCK_SHARE);
        self.restart(full, x);
        stuck
    }
}
