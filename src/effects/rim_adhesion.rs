//! A rim smoother than the soil.

use super::{Effect, Facts, Local, Place, SOIL_TEST};
use crate::scalar::Scalar;
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// The soil slips on the rim before it shears in itself: tau = min(c_a + sigma tan delta, (c + sigma tan phi)
    /// (1 - exp(-|j|/K))), with c_a = (1 - l) c and tan delta = (1 - l) tan phi. The shear meets a plateau where |j| is
    /// large; while exp(-|j|/K) > l all along the rim the limit is not met and changes nothing.
    pub struct RimAdhesion {
        /// Share l of the soil's strength that the rim does not transmit.
        loss: [Unit::ONE] = 0.0, 0.0..=0.8, Effect, "Wong 2008, 2.4; smooth steel on sand: delta/phi 0.5-0.9";
    }
}

impl<S: Scalar> Effect<S> for RimAdhesion<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["drawbar_pull", "torque"],
            seen_on_rover: &["wheel[1].torque"],
            advice: &[SOIL_TEST],
            ..Facts::USUAL
        }
    }

    #[cfg_attr(feature = "batch", inline(always))]
    fn surface(&self, _place: &Place<S>, local: &mut Local<S>) {
        if !self.loss.is_exactly(0.0) {
            local.surface.grip *= -self.loss + 1.0;
        }
    }
}
