//! Wheels that are not of their nominal radius, and odometry with a wrong scale.

use super::{Advice, Effect, Facts};
use crate::scalar::{Scalar, lanes};
use crate::signals::{BodySignals, WheelSignals};
use crate::wheel::Wheel;
use bekker_modeldescription::{Unit, parameters};

/// Where the wheel does not sink, its radius is read directly, and how it changes with the load.
pub(super) const HARD_PLATE: Advice = Advice::carriage(
    "roll the wheel over a hard plate under two loads and count its turns a metre: without sinkage the radius, and how it changes with load, is read directly",
);
/// The same of a rover, and the force that it takes.
pub(super) const TOWED_OVER_FLOOR: Advice = Advice::rover(
    "tow the rover over a hard floor and count wheel turns a metre: without sinkage the radius and the resistance are read directly",
);

parameters! {
    /// The true radius is (1 + d) r. Recorded slip is computed with r, so it is off everywhere.
    pub struct RadiusScale {
        /// Deviation d of the true radius.
        deviation: [Unit::ONE] = 0.0, -0.1..=0.1, Effect, "tape measure, tread, lugs: 1-3 %";
        /// Deviation of the odometry's scale: recorded way since the start and speed grow by this share.
        odometry: [Unit::ONE] = 0.0, -0.1..=0.1, Effect, "usual calibration error of odometry: 1-3 %";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for RadiusScale<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["drawbar_pull"],
            seen_on_rover: &["x"],
            advice: &[HARD_PLATE, TOWED_OVER_FLOOR],
            tunable: false,
            ..Facts::USUAL
        }
    }

    fn wheel(&self, wheel: &Wheel<S>) -> Option<Wheel<S>> {
        if self.deviation.is_exactly(0.0) {
            return None;
        }
        Some(Wheel { radius: wheel.radius * (self.deviation + 1.0), ..*wheel })
    }

    fn recorded_radius(&self, radius: &mut S) {
        if !self.deviation.is_exactly(0.0) {
            *radius /= self.deviation + 1.0;
        }
    }

    fn record(&self, start_x: S, body: &mut BodySignals<S>, _wheels: &mut [WheelSignals<S>]) {
        if !self.odometry.is_exactly(0.0) {
            body.x += self.odometry * (body.x - start_x);
            body.velocity *= self.odometry + 1.0;
        }
    }
}
