//! Strength of the soil that falls with the slope.

use super::{Advice, Effect, Facts, Local, Place};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

/// Slope over which |gamma| is rounded, rad: sqrt(gamma^2 + e^2) - e has a derivative everywhere.
const ROUNDED_SLOPE: f64 = 0.02;

parameters! {
    /// Soil on a slope is weaker: phi - beta |gamma|. Empirical: loosening by the slope and the wheel, no standard source.
    pub struct SlopeStrength {
        /// Loss beta of the friction angle with the slope.
        beta: [Unit::ONE] = 0.0, 0.0..=0.4, Effect, "assumption: 1-3 degrees at 10-20 degrees of slope";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for SlopeStrength<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_rover: &["wheel[1].torque", "wheel[1].slip"],
            advice: const {
                &[Advice::rover(
                    "drive up and down two slopes of different steepness on the same soil, each after a level stretch",
                )]
            },
            ..Facts::USUAL
        }
    }

    fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        if self.beta.is_exactly(0.0) {
            return;
        }
        let angle = place.contact_angle;
        let slope = (angle * angle + ROUNDED_SLOPE * ROUNDED_SLOPE).sqrt() - ROUNDED_SLOPE;
        local.soil.friction_angle = (local.soil.friction_angle - self.beta * slope).larger(S::from(0.0));
    }
}
