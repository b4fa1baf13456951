//! A motor whose torque constant is not that of its data sheet.

use super::Effect;
use crate::motor::Motor;
use crate::scalar::Scalar;
use crate::signals::{BodySignals, WheelSignals};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// The true torque constant is (1 + d) K_t. Drives command and measure currents and reckon with K_t, so a
    /// commanded torque comes out (1 + d) times as large, and a recorded torque is the true one over 1 + d. A power that a
    /// meter of its own records tells a torque constant (it follows) from a current gain (it does not).
    pub struct TorqueScale {
        /// Deviation d of the torque constant, or of a current gain, which only a power meter tells apart.
        deviation: [Unit::ONE] = 0.0, -0.3..=0.3, Effect, "makers' tolerance and amplifier gain: 3-10 %";
    }
}

impl<S: Scalar> Effect<S> for TorqueScale<S> {
    #[cfg_attr(feature = "batch", inline(always))]
    fn motor(&self, _winding_rise: S, motor: &mut Motor<S>) {
        if !self.deviation.is_exactly(0.0) {
            motor.torque_constant *= self.deviation + 1.0;
        }
    }

    #[cfg_attr(feature = "batch", inline(always))]
    fn torque_gain(&self) -> Option<S> {
        (!self.deviation.is_exactly(0.0)).then(|| self.deviation + 1.0)
    }

    fn record(&self, _start_x: S, _body: &mut BodySignals<S>, wheels: &mut [WheelSignals<S>]) {
        if let Some(gain) = Effect::<S>::torque_gain(self) {
            wheels.iter_mut().for_each(|wheel| wheel.torque /= gain);
        }
    }
}
