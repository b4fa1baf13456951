//! A wheel that flattens under its load.

use super::radius_scale::HARD_PLATE;
use super::{Effect, Facts, Local, Place};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// The wheel deflects by f = C N under the normal force N, and its contact is the arc of a larger circle,
    /// r* = r (1 + a f/z + b f/r) at the soil's sinkage z. With a = 1 and b = 0 it enters the soil where the undeformed outline
    /// does, r* = r (z + f)/z; with a = 0 the arc grows with the load alone. Schmid's own circle (1995) adds the flattened half behind
    /// the axle, with sqrt(f/z), which has no derivative at f = 0.
    pub struct FlexibleWheel {
        /// Radial compliance C of the wheel.
        compliance: [Unit::METRE_PER_NEWTON] = 0.0, 0.0..=3e-4, Effect, "Schmid 1995, J. Terramechanics 32; 5 mm at 50 N: 1e-4";
        /// Where the arm of the torque lies between the wheel's radius (0, as the axle's height demands) and the arc's (1, as
        /// where the wheel is replaced by a larger one in all formulas).
        arm_share: [Unit::ONE] = 0.0, 0.0..=1.0, Effect, "both are in use";
        /// a: growth of the arc's radius with the ratio of the deflection to the sinkage.
        arc_by_sinkage: [Unit::ONE] = 1.0, 0.0..=1.0, Effect, "1: the arc enters the soil where the undeformed outline does";
        /// b: growth of the arc's radius over the deflection, whatever the sinkage.
        arc_by_load: [Unit::ONE] = 0.0, 0.0..=20.0, Effect, "r/z of usual sinkages: 5 to 20";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for FlexibleWheel<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["sinkage"],
            seen_on_rover: &["wheel[1].sinkage"],
            smooth_at_neutral: &["arm_share", "arc_by_sinkage", "arc_by_load"],
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
        local.surface.arc_by_sinkage = self.arc_by_sinkage;
        local.surface.arc_by_load = self.arc_by_load;
    }
}
