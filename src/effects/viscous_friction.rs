//! Viscous friction of the drive between the motor and the rim.

use super::coulomb_friction::SPUN_FREELY;
use super::{Effect, Facts};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Viscous friction: the motor's torque exceeds the rim's by B omega.
    pub struct ViscousFriction {
        /// Friction coefficient B, wheel side.
        coefficient: [Unit::NEWTON_METRE_SECOND] = 0.0, 0.0..=5.0, Effect, "usual for geared rover drives: 0.01-0.1 N m s";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for ViscousFriction<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["torque"],
            seen_on_rover: &["wheel[1].torque"],
            typical: &[("coefficient", 0.05)],
            advice: SPUN_FREELY,
            ..Facts::USUAL
        }
    }

    fn drive_friction(&self, speed: S) -> Option<(S, S)> {
        (!self.coefficient.is_exactly(0.0)).then(|| (self.coefficient * speed, self.coefficient))
    }
}
