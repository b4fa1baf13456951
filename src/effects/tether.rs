//! A cable that the rover drags behind it.

use super::{Advice, BodyMotion, Effect, Facts};
use crate::scalar::{Mask, Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// A force that grows with the distance travelled forward: k (x - x_0).
    pub struct Tether {
        /// Stiffness k.
        stiffness: [Unit::NEWTON_PER_METRE] = 0.0, 0.0..=100.0, Effect, "dragged cable: 0.1-1 N/m";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for Tether<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_rover: &["wheel[1].torque"],
            typical: &[("stiffness", 1.0)],
            advice: const {
                &[Advice::rover("drive the same length twice, with the cable held by hand and with the cable laid out")]
            },
            ..Facts::USUAL
        }
    }

    fn body_force(&self, motion: &BodyMotion<S>) -> Option<S> {
        let pulls = motion.travelled.over(0.0);
        if self.stiffness.is_exactly(0.0) || !pulls.any() {
            return None;
        }
        Some(S::select(pulls, -(self.stiffness * motion.travelled), S::from(0.0)))
    }
}
