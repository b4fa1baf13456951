//! Ground that wheels have passed.

use super::{Effect, Local, Place};
use crate::scalar::Scalar;
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// A wheel compacts the ground for the next: k_c, k_phi and c grow by the factor 1 + g p with the number p of wheels
    /// that have passed. Holm 1969 measured the gain of repeated passes; Senatore and Sandu 2011 take density, c and
    /// K linear in their number.
    pub struct MultiPass {
        /// Growth g of the soil's moduli and cohesion with each pass.
        growth: [Unit::ONE] = 0.0, 0.0..=1.0, Effect, "Holm 1969, J. Terramechanics 6; Senatore and Sandu 2011: 0.1-0.5";
    }
}

impl<S: Scalar> Effect<S> for MultiPass<S> {
    #[cfg_attr(feature = "batch", inline(always))]
    fn remembers(&self) -> bool {
        !self.growth.is_exactly(0.0)
    }

    #[cfg_attr(feature = "batch", inline(always))]
    fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        if self.growth.is_exactly(0.0) {
            return;
        }
        let factor = self.growth * place.passes + 1.0;
        local.soil.scale_moduli(factor);
        local.soil.cohesion *= factor;
    }
}
