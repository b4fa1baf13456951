//! Mass that the data sheet does not have.

use super::{Advice, Effect, Facts};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

/// Weights of the wheels give the mass and where it lies.
pub(super) const WEIGHED: Advice =
    Advice::rover("weigh the rover wheel by wheel: that gives its mass and its centre of mass");

parameters! {
    /// Unmodelled mass at the chassis' centre of mass; on a carriage its weight adds to the load.
    pub struct Payload {
        /// Mass dm.
        mass: [Unit::KILOGRAM] = 0.0, 0.0..=10.0, Effect, "instruments, cables, soil on board: 2-10 % of 5-50 kg";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for Payload<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["sinkage"],
            seen_on_rover: &["wheel[1].sinkage", "wheel[1].torque"],
            typical: &[("mass", 0.5)],
            advice: const {
                &[
                    Advice::carriage(
                        "weigh what the wheel carries, the wheel and its mount included: that gives the load without the model",
                    ),
                    WEIGHED,
                ]
            },
            ..Facts::USUAL
        }
    }

    fn added_mass(&self) -> Option<S> {
        (!self.mass.is_exactly(0.0)).then_some(self.mass)
    }
}
