//! Errors of the sensors that record a drive.

use super::Effect;
use crate::scalar::Scalar;
use crate::signals::{BodySignals, WheelSignals};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// The recorded pitch is off by a constant, fixed to the rover: seen from the ground it is opposite after
    /// the rover has turned round.
    pub struct PitchBias {
        /// Offset d of the recorded pitch, nose up positive.
        angle: [Unit::RADIAN] = 0.0, -0.1..=0.1, Effect, "mounting of an inclinometer: 0.3-1 deg";
    }
}

parameters! {
    /// What is recorded follows the truth with a first-order lag and a dead time; energies are not lagged.
    pub struct SensorLag {
        /// Time constant of the first-order lag.
        time_constant: [Unit::SECOND] = 0.0, 0.0..=1.0, Effect, "filters of sensors and drives: 20-200 ms";
        /// Dead time.
        dead_time: [Unit::SECOND] = 0.0, 0.0..=0.5, Effect, "sampling and transmission: 20-200 ms";
    }
}

impl<S: Scalar> Effect<S> for PitchBias<S> {
    fn record(&self, _start_x: S, body: &mut BodySignals<S>, _wheels: &mut [WheelSignals<S>]) {
        if !self.angle.is_exactly(0.0) {
            body.pitch += self.angle;
        }
    }
}

/// Acts through the memory in `recording.rs`.
impl<S: Scalar> Effect<S> for SensorLag<S> {}

impl<S: Scalar> SensorLag<S> {
    /// Whether anything is lagged.
    #[cfg_attr(feature = "batch", inline(always))]
    pub(crate) fn acts(&self) -> bool {
        !(self.time_constant.is_exactly(0.0) && self.dead_time.is_exactly(0.0))
    }
}
