//! Dry friction of the drive between the motor and the rim.

use super::{Advice, Effect, Facts};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

/// Wheel speed over which losses of the drive change their sign, rad/s: small beside working speeds (2.5 rad/s).
pub(super) const REVERSAL_SPEED: f64 = 0.01;

/// Where friction of the drive acts alone, dry or viscous.
pub(super) const SPUN_FREELY: &[Advice] = &[
    Advice::carriage(
        "spin the lifted wheel at two or more speeds and record its torque: without soil only the friction of the drive is left",
    ),
    Advice::rover(
        "lift the rover, spin its wheels at two or more speeds and record their torques: without soil only the friction of the drives is left",
    ),
];

parameters! {
    /// Dry friction: the motor's torque exceeds the rim's by T_c sgn(omega).
    pub struct CoulombFriction {
        /// Friction torque T_c, wheel side.
        torque: [Unit::NEWTON_METRE] = 0.0, 0.0..=5.0, Effect, "usual for geared rover drives: 0.02-0.2 N m";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for CoulombFriction<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["torque"],
            seen_on_rover: &["wheel[1].torque"],
            typical: &[("torque", 0.1)],
            advice: SPUN_FREELY,
            ..Facts::USUAL
        }
    }

    fn drive_friction(&self, speed: S) -> Option<(S, S)> {
        if self.torque.is_exactly(0.0) {
            return None;
        }
        let norm = (speed * speed + REVERSAL_SPEED * REVERSAL_SPEED).sqrt();
        let slope = self.torque * (REVERSAL_SPEED * REVERSAL_SPEED) / (norm * norm * norm);
        Some((self.torque * speed / norm, slope))
    }
}
