//! Friction of the passive joints.

use super::{Advice, Effect, Equipment, Facts, Needs};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

/// Joint rate over which dry friction changes its sign, rad/s: small beside a rocker's on rough ground (0.1 rad/s).
const REVERSAL_RATE: f64 = 0.005;

parameters! {
    /// Dry friction in every passive joint: a moment M against its rate. Nothing on a rigid chassis.
    pub struct SuspensionFriction {
        /// Friction moment M.
        moment: [Unit::NEWTON_METRE] = 0.0, 0.0..=5.0, Effect, "bearings and seals of rockers and differentials; no standard source";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for SuspensionFriction<S> {
    fn facts(&self) -> Facts {
        Facts {
            needs: Needs::Joints,
            seen_on_rover: &["pitch"],
            advice: &[Advice {
                equipment: Equipment::JointedRover,
                text: "drive over a step on a hard floor and back: friction of the joints shows as hysteresis",
            }],
            ..Facts::USUAL
        }
    }

    fn joint_friction(&self, rate: S) -> Option<S> {
        if self.moment.is_exactly(0.0) {
            return None;
        }
        Some(self.moment / (rate * rate + REVERSAL_RATE * REVERSAL_RATE).sqrt())
    }
}
