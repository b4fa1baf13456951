//! A resistance at the chassis reference point, constant or growing with speed.

use super::radius_scale::TOWED_OVER_FLOOR;
use super::{Advice, BodyMotion, Effect, Facts};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

/// Speed over which the resistance changes its sign, m/s.
const REVERSAL_SPEED: f64 = 0.001;

parameters! {
    /// A horizontal force against the motion, F = F_0 + B |v|. A calibration of the soil takes a constant drag up almost
    /// whole, as less drawbar pull; the soil's stresses do not depend on the speed, so the growth B shows where a wheel or
    /// rover is driven at two speeds or more.
    pub struct Drag {
        /// Force F_0 near standstill.
        force: [Unit::NEWTON] = 0.0, 0.0..=100.0, Effect, "cable or sled: 0.5-3 N";
        /// Growth B of the force with speed.
        growth: [Unit::NEWTON_SECOND_PER_METRE] = 0.0, 0.0..=100.0, Effect, "linear in speed as rolling resistance is in Gillespie 1992, ch. 4; greased rails, hydraulic or cable drums: 1-10 N at 0.1 m/s";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for Drag<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["drawbar_pull"],
            seen_on_rover: &["wheel[1].torque"],
            typical: &[("force", 2.0), ("growth", 8.0)],
            advice: const {
                &[
                    Advice::carriage(
                        "move the carriage with the wheel lifted, slowly and fast: the force that remains is the resistance of the carriage",
                    ),
                    TOWED_OVER_FLOOR,
                ]
            },
            ..Facts::USUAL
        }
    }

    fn body_force(&self, motion: &BodyMotion<S>) -> Option<S> {
        let (constant, grows) = (!self.force.is_exactly(0.0), !self.growth.is_exactly(0.0));
        let near_standstill = constant.then(|| {
            let norm = (motion.velocity * motion.velocity + REVERSAL_SPEED * REVERSAL_SPEED).sqrt();
            -(self.force * motion.velocity / norm)
        });
        let with_speed = grows.then(|| -(self.growth * motion.velocity));
        match (near_standstill, with_speed) {
            (Some(constant), Some(growing)) => Some(constant + growing),
            (one, other) => one.or(other),
        }
    }
}
