//! A constant resistance at the chassis reference point.

use super::radius_scale::TOWED_OVER_FLOOR;
use super::{Advice, BodyMotion, Effect, Facts};
use crate::scalar::Scalar;
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

impl<S: Scalar> Effect<S> for Drag<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["drawbar_pull"],
            seen_on_rover: &["wheel[1].torque"],
            typical: &[("force", 2.0)],
            advice: const {
                &[
                    Advice::carriage(
                        "move the carriage with the wheel lifted: the force that remains is the resistance of the carriage",
                    ),
                    TOWED_OVER_FLOOR,
                ]
            },
            ..Facts::USUAL
        }
    }

    #[cfg_attr(feature = "batch", inline(always))]
    fn body_force(&self, motion: &BodyMotion<S>) -> Option<S> {
        if self.force.is_exactly(0.0) {
            return None;
        }
        let norm = (motion.velocity * motion.velocity + REVERSAL_SPEED * REVERSAL_SPEED).sqrt();
        Some(-(self.force * motion.velocity / norm))
    }
}
