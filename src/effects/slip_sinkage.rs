//! Slip-sinkage.

use super::{Effect, Facts, Local, Place, SOIL_TEST};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// A slipping wheel digs itself in: n = n_0 + n_1 min(|i|, 1) (Ding et al. 2011).
    pub struct SlipSinkage {
        /// Growth n_1 of the sinkage exponent with slip.
        n1: [Unit::ONE] = 0.0, 0.0..=1.5, Effect, "Ding et al. 2011, J. Terramechanics 48: 0.35-0.5";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for SlipSinkage<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["sinkage", "drawbar_pull"],
            seen_on_rover: &["wheel[1].sinkage"],
            advice: &[SOIL_TEST],
            ..Facts::USUAL
        }
    }

    fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        if !self.n1.is_exactly(0.0) {
            local.soil.exponent += self.n1 * place.slip.abs().smaller(S::from(1.0));
        }
    }
}
