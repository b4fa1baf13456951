//! A constant error of the recorded pitch.

use super::{Advice, Effect, Facts};
use crate::scalar::Scalar;
use crate::signals::{BodySignals, WheelSignals};
use bekker_modeldescription::{Unit, parameters};

/// What turns with the rover is told from what stays with the ground.
pub(super) const REVERSED_HEADING: Advice = Advice::rover(
    "drive the same ground with the heading reversed: the mean of both pitches is the sensor's bias, and what stays of the split of the wheel loads is the centre of mass",
);

parameters! {
    /// The recorded pitch is off by a constant, fixed to the rover: seen from the ground it is opposite after
    /// the rover has turned round.
    pub struct PitchBias {
        /// Offset d of the recorded pitch, nose up positive.
        angle: [Unit::RADIAN] = 0.0, -0.1..=0.1, Effect, "mounting of an inclinometer: 0.3-1 deg";
    }
}

impl<S: Scalar> Effect<S> for PitchBias<S> {
    fn facts(&self) -> Facts {
        Facts { seen_on_rover: &["pitch"], advice: &[REVERSED_HEADING], ..Facts::USUAL }
    }

    fn record(&self, _start_x: S, body: &mut BodySignals<S>, _wheels: &mut [WheelSignals<S>]) {
        if !self.angle.is_exactly(0.0) {
            body.pitch += self.angle;
        }
    }
}
