//! Wheels that are not of their nominal radius, and odometry with a wrong scale.

use super::Effect;
use crate::scalar::Scalar;
use crate::signals::{BodySignals, WheelSignals};
use crate::wheel::Wheel;
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// The true radius is (1 + d) r. Recorded slip is reckoned with r, so it is off everywhere.
    pub struct RadiusScale {
        /// Deviation d of the true radius.
        deviation: [Unit::ONE] = 0.0, -0.1..=0.1, Effect, "tape measure, tread, lugs: 1-3 %";
        /// Deviation of the odometry's scale: recorded way since the start and speed grow by this share.
        odometry: [Unit::ONE] = 0.0, -0.1..=0.1, Effect, "usual calibration error of odometry: 1-3 %";
    }
}

impl<S: Scalar> Effect<S> for RadiusScale<S> {
    #[cfg_attr(feature = "batch", inline(always))]
    fn wheel(&self, wheel: &mut Wheel<S>) {
        if !self.deviation.is_exactly(0.0) {
            wheel.radius *= self.deviation + 1.0;
        }
    }

    #[cfg_attr(feature = "batch", inline(always))]
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
