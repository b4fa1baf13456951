//! Mass that the data sheet does not know, or not where it is.

use super::Effect;
use crate::rover::Body;
use crate::scalar::Scalar;
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Unmodelled mass at the chassis' centre of mass; on a carriage its weight adds to the load.
    pub struct Payload {
        /// Mass dm.
        mass: [Unit::KILOGRAM] = 0.0, 0.0..=10.0, Effect, "instruments, cables, soil on board: 2-10 % of 5-50 kg";
    }
}

parameters! {
    /// The chassis' centre of mass lies elsewhere along x.
    pub struct CentreOfMass {
        /// Shift dx, forward positive.
        shift: [Unit::METRE] = 0.0, -0.2..=0.2, Effect, "batteries and instruments: 1-5 cm";
    }
}

impl<S: Scalar> Effect<S> for Payload<S> {
    #[cfg_attr(feature = "batch", inline(always))]
    fn chassis(&self, body: &mut Body<S>) {
        if !self.mass.is_exactly(0.0) {
            body.mass += self.mass;
        }
    }
}

impl<S: Scalar> Effect<S> for CentreOfMass<S> {
    #[cfg_attr(feature = "batch", inline(always))]
    fn chassis(&self, body: &mut Body<S>) {
        if !self.shift.is_exactly(0.0) {
            body.centre_of_mass_x += self.shift;
        }
    }
}
