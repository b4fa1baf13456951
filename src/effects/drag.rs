//! Horizontal resistances at the chassis reference point.

use super::{BodyMotion, Effect};
use crate::scalar::{Mask, Scalar};
use bekker_modeldescription::{Unit, parameters};

/// Speed over which the resistance changes its sign, m/s.
const REVERSAL_SPEED: f64 = 0.001;

parameters! {
    /// A constant force against the motion.
    pub struct Drag {
        /// Force F_0.
        force: [Unit::NEWTON] = 0.0, 0.0..=100.0, Effect, "cable or sled: 0.5-3 N";
    }
}

parameters! {
    /// A force that grows with the distance travelled forward: k (x - x_0).
    pub struct Tether {
        /// Stiffness k.
        stiffness: [Unit::NEWTON_PER_METRE] = 0.0, 0.0..=100.0, Effect, "dragged cable: 0.1-1 N/m";
    }
}

impl<S: Scalar> Effect<S> for Drag<S> {
    #[cfg_attr(feature = "batch", inline(always))]
    fn body_force(&self, motion: &BodyMotion<S>) -> Option<S> {
        if self.force.is_exactly(0.0) {
            return None;
        }
        let norm = (motion.velocity * motion.velocity + REVERSAL_SPEED * REVERSAL_SPEED).sqrt();
        Some(-(self.force * motion.velocity / norm))
    }
}

impl<S: Scalar> Effect<S> for Tether<S> {
    #[cfg_attr(feature = "batch", inline(always))]
    fn body_force(&self, motion: &BodyMotion<S>) -> Option<S> {
        let pulls = motion.travelled.over(0.0);
        if self.stiffness.is_exactly(0.0) || !pulls.any() {
            return None;
        }
        Some(S::select(pulls, -(self.stiffness * motion.travelled), S::from(0.0)))
    }
}
