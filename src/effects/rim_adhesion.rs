//! A rim smoother than the soil.

use super::{Effect, Facts, Local, Place, SOIL_TEST};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// The soil slips on the rim before it shears in itself: tau = min(c_a + sigma tan delta, (c + sigma tan phi)
    /// (1 - exp(-|j|/K))), with c_a = (1 - l) c and tan delta = (1 - l) tan phi. The shear meets a plateau where |j| is
    /// large; while exp(-|j|/K) > l all along the rim the limit is not met and changes nothing.
    ///
    /// With a rounding w the shear bends into its plateau instead: tau = (c + sigma tan phi) b
    /// (1 + (b/(1 - l))^(1/w) - b^(1/w))^(-w), where b = 1 - exp(-|j|/K) is the share of its strength that the soil has
    /// built up.
    pub struct RimAdhesion {
        /// Share l of the soil's strength that the rim does not transmit.
        loss: [Unit::ONE] = 0.0, 0.0..=0.8, Effect, "Wong 2008, 2.4; smooth steel on sand: delta/phi 0.5-0.9";
        /// Rounding w of the corner between both: 0 is sharp. It acts where the loss is not 0.
        rounding: [Unit::ONE] = 0.0, 0.0..=1.0, Effect, "blend of two asymptotes, Churchill and Usagi 1972, AIChE J. 18: exponents 1/w of 2-6 are usual";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for RimAdhesion<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["drawbar_pull", "torque"],
            seen_on_rover: &["wheel[1].torque"],
            advice: &[SOIL_TEST],
            ..Facts::USUAL
        }
    }

    fn surface(&self, _place: &Place<S>, local: &mut Local<S>) {
        if !self.loss.is_exactly(0.0) {
            local.surface.grip *= -self.loss + 1.0;
            local.surface.rounding += self.rounding;
        }
    }
}
