//! A wheel that flattens under its load.

use super::radius_scale::HARD_PLATE;
use super::{Effect, Facts, Local, Place};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// The wheel deflects by f = C N under the normal force N, and its contact is the arc of a larger circle (Schmid 1995).
    /// The circle here enters the soil where the undeformed outline does: r* = r (z + f)/z at the soil's sinkage z. Schmid's
    /// own circle adds the flattened half behind the axle, with sqrt(f/z), which has no derivative at f = 0.
    pub struct FlexibleWheel {
        /// Radial compliance C of the wheel.
        compliance: [Unit::METRE_PER_NEWTON] = 0.0, 0.0..=3e-4, Effect, "Schmid 1995, J. Terramechanics 32; 5 mm at 50 N: 1e-4";
        /// Where the arm of the torque lies between the wheel's radius (0, as the axle's height demands) and the arc's (1, as
        /// where the wheel is replaced by a larger one in all formulas).
        arm_share: [Unit::ONE] = 0.0, 0.0..=1.0, Effect, "both are in use";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for FlexibleWheel<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["sinkage"],
            seen_on_rover: &["wheel[1].sinkage"],
            smooth_at_neutral: &["arm_share"],
            advice: &[HARD_PLATE],
            ..Facts::USUAL
        }
    }

    fn surface(&self, _place: &Place<S>, local: &mut Local<S>) {
        if self.compliance.is_exactly(0.0) {
            return;
        }
        local.surface.compliance += self.compliance;
        local.surface.arm_share = self.arm_share;
    }
}
