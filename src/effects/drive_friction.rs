//! Friction of the drive between the motor and the rim.

use super::Effect;
use crate::scalar::Scalar;
use bekker_modeldescription::{Unit, parameters};

/// Wheel speed over which losses of the drive change their sign, rad/s: small beside working speeds (2.5 rad/s).
pub(super) const REVERSAL_SPEED: f64 = 0.01;

parameters! {
    /// Dry friction: the motor's torque exceeds the rim's by T_c sgn(omega).
    pub struct CoulombFriction {
        /// Friction torque T_c, wheel side.
        torque: [Unit::NEWTON_METRE] = 0.0, 0.0..=5.0, Effect, "usual for geared rover drives: 0.02-0.2 N m";
    }
}

parameters! {
    /// Viscous friction: the motor's torque exceeds the rim's by B omega.
    pub struct ViscousFriction {
        /// Friction coefficient B, wheel side.
        coefficient: [Unit::NEWTON_METRE_SECOND] = 0.0, 0.0..=5.0, Effect, "usual for geared rover drives: 0.01-0.1 N m s";
    }
}

impl<S: Scalar> Effect<S> for CoulombFriction<S> {
    #[cfg_attr(feature = "batch", inline(always))]
    fn drive_friction(&self, speed: S) -> Option<(S, S)> {
        if self.torque.is_exactly(0.0) {
            return None;
        }
        let norm = (speed * speed + REVERSAL_SPEED * REVERSAL_SPEED).sqrt();
        let slope = self.torque * (REVERSAL_SPEED * REVERSAL_SPEED) / (norm * norm * norm);
        Some((self.torque * speed / norm, slope))
    }
}

impl<S: Scalar> Effect<S> for ViscousFriction<S> {
    #[cfg_attr(feature = "batch", inline(always))]
    fn drive_friction(&self, speed: S) -> Option<(S, S)> {
        (!self.coefficient.is_exactly(0.0)).then(|| (self.coefficient * speed, self.coefficient))
    }
}
