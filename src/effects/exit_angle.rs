//! Exit angle of the contact.

use super::{Effect, Facts, Local, Place};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// The soil rebounds behind the wheel: theta_2 = -acos(1 - lambda z/r).
    pub struct ExitAngle {
        /// Height lambda of the rut's rear edge over the wheel's bottom, as a share of the sinkage.
        lambda: [Unit::ONE] = 0.0, 0.0..=1.2, Effect, "Ishigami et al. 2007: 0.05-1.2, over 1 with lugs";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for ExitAngle<S> {
    fn facts(&self) -> Facts {
        Facts { seen_on_carriage: &["drawbar_pull", "sinkage"], seen_on_rover: &["wheel[1].sinkage"], ..Facts::USUAL }
    }

    fn contact(&self, _place: &Place<S>, local: &mut Local<S>) {
        local.surface.exit_ratio += self.lambda;
    }
}
