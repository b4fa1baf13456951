//! Strength of the soil that grows with its water content.

use super::{Effect, Facts, Local, Place};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Water binds the grains: c grows by s w, with the water content w measured for each run. A straight line stands
    /// for the rising branch, up to about half of saturation (Fredlund and Rahardjo 1993 for the cause).
    pub struct Moisture {
        /// Water content w, mass of water over mass of grains; a measurement, set for each run.
        content: [Unit::ONE] = 0.0, 0.0..=0.6, Fixed, "measured";
        /// Growth s of the cohesion with the water content.
        cohesion_slope: [Unit::PASCAL] = 0.0, 0.0..=50_000.0, Effect, "sand from dry to moist: 0.2 to 2.4 kPa over 0.1-0.2";
    }
}

impl<S: Scalar> Moisture<S> {
    /// What the water adds to the cohesion, Pa.
    pub(crate) fn added_cohesion(&self) -> S {
        self.cohesion_slope * self.content
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for Moisture<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["drawbar_pull", "torque"],
            seen_on_rover: &["wheel[1].torque"],
            seen_in_soil_test: &["shear_stress"],
            typical: &[("content", 0.1)],
            ..Facts::USUAL
        }
    }

    fn contact(&self, _place: &Place<S>, local: &mut Local<S>) {
        if !self.cohesion_slope.is_exactly(0.0) {
            local.soil.cohesion += self.cohesion_slope * self.content;
        }
    }
}
