//! Ground that is softer around one place.

use super::{Advice, Effect, Facts, Local, Place};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Softer ground around one place: k_c and k_phi times 1 - s/(1 + ((x - x_c)/l)^4). The window has a derivative in
    /// its place and width everywhere, so a search finds them. Any empirical window would do; it has no standard source.
    pub struct SoftPatch {
        /// Share s of the moduli that is missing at the centre.
        softening: [Unit::ONE] = 0.0, 0.0..=0.9, Effect, "assumption: up to a tenth of the moduli left";
        /// Centre x_c along x.
        centre: [Unit::METRE] = 1.0, -50.0..=50.0, Effect, "somewhere on the way";
        /// Half-width l, where half of the softening is reached.
        half_width: [Unit::METRE] = 0.3, 0.05..=3.0, Effect, "from a contact's length to a few rover lengths";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for SoftPatch<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_rover: &["wheel[1].sinkage", "wheel[1].torque"],
            typical: &[("centre", 1.0), ("half_width", 0.3)],
            advice: const {
                &[Advice::rover("repeat the run on freshly prepared soil some metres aside: a patch stays where it is")]
            },
            ..Facts::USUAL
        }
    }

    fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        let Some(x) = place.x else { return };
        if self.softening.is_exactly(0.0) {
            return;
        }
        let squared = ((x - self.centre) / self.half_width).powi(2);
        local.soil.scale_moduli(-(self.softening / (squared * squared + 1.0)) + 1.0);
    }
}
