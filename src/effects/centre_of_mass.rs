//! A centre of mass that is not where the data sheet has it.

use super::payload::WEIGHED;
use super::pitch_bias::REVERSED_HEADING;
use super::{Effect, Facts};
use crate::scalar::{Scalar, lanes};
use crate::vehicle::Body;
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// The chassis' centre of mass lies elsewhere along x.
    pub struct CentreOfMass {
        /// Shift dx, forward positive.
        shift: [Unit::METRE] = 0.0, -0.2..=0.2, Effect, "batteries and instruments: 1-5 cm";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for CentreOfMass<S> {
    fn facts(&self) -> Facts {
        Facts { seen_on_rover: &["wheel[1].torque"], advice: &[WEIGHED, REVERSED_HEADING], ..Facts::USUAL }
    }

    fn chassis(&self, body: &mut Body<S>) {
        if !self.shift.is_exactly(0.0) {
            body.centre_of_mass_x += self.shift;
        }
    }
}
