//! A motor whose torque constant is not that of its data sheet.

use super::{Advice, Effect, Facts};
use crate::motor::Motor;
use crate::scalar::{Scalar, lanes};
use crate::signals::{BodySignals, WheelSignals};
use bekker_modeldescription::{Unit, parameters};

/// A scale acts the same way in both directions of the power, a loss does not.
pub(super) const BACK_DRIVEN: &[Advice] = &[
    Advice::carriage(
        "drive and back-drive the wheel against a known torque (a brake or a hanging weight): a scale acts the same way in both, an efficiency does not",
    ),
    Advice::rover(
        "drive and back-drive a lifted wheel against a known torque (a brake or a hanging weight): a scale acts the same way in both, an efficiency does not",
    ),
];

parameters! {
    /// The true torque constant is (1 + d) K_t. Drives command and measure currents and reckon with K_t, so a
    /// commanded torque comes out (1 + d) times as large, and a recorded torque is the true one over 1 + d. A power that a
    /// meter of its own records tells a torque constant (it follows) from a current gain (it does not).
    pub struct TorqueScale {
        /// Deviation d of the torque constant, or of a current gain, which only a power meter tells apart.
        deviation: [Unit::ONE] = 0.0, -0.3..=0.3, Effect, "makers' tolerance and amplifier gain: 3-10 %";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for TorqueScale<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["torque"],
            seen_on_rover: &["wheel[1].torque"],
            advice: BACK_DRIVEN,
            ..Facts::USUAL
        }
    }

    fn motor(&self, _winding_rise: S, motor: &mut Motor<S>) {
        if !self.deviation.is_exactly(0.0) {
            motor.torque_constant *= self.deviation + 1.0;
        }
    }

    fn torque_gain(&self) -> Option<S> {
        (!self.deviation.is_exactly(0.0)).then(|| self.deviation + 1.0)
    }

    fn record(&self, _start_x: S, _body: &mut BodySignals<S>, wheels: &mut [WheelSignals<S>]) {
        if let Some(gain) = Effect::<S>::torque_gain(self) {
            wheels.iter_mut().for_each(|wheel| wheel.torque /= gain);
        }
    }
}
