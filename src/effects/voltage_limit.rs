//! Back-EMF and a limited supply voltage.

use super::{Advice, Effect, Facts, Needs};
use crate::motor::{Motor, TorqueRange};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// |R I + K_t N omega| stays within the supply voltage, so a loaded motor cannot hold its speed.
    pub struct VoltageLimit {
        /// One over the supply voltage; 0 is no limit.
        inverse_voltage: [Unit::PER_VOLT] = 0.0, 0.0..=10.0, Effect, "supply data";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for VoltageLimit<S> {
    fn facts(&self) -> Facts {
        Facts {
            needs: Needs::CommandedTorque,
            seen_on_rover: &["wheel[1].speed"],
            typical: &[("inverse_voltage", 0.15)],
            advice: const {
                &[Advice::rover(
                    "drive under load with the wheel speeds recorded beside their commands: a limited supply lets them sag",
                )]
            },
            ..Facts::USUAL
        }
    }

    fn torque_range(&self, motor: &Motor<S>, speed: S) -> Option<TorqueRange<S>> {
        if self.inverse_voltage.is_exactly(0.0) {
            return None;
        }
        let voltage = self.inverse_voltage.recip();
        let constant = motor.gear_ratio * motor.torque_constant; // wheel side, N m/A = V s/rad
        let reachable = |sign: f64| constant * (voltage * sign - constant * speed) / motor.resistance;
        let slope = -(constant * constant / motor.resistance);
        Some(TorqueRange { least: reachable(-1.0), most: reachable(1.0), least_slope: slope, most_slope: slope })
    }

    fn share_of_limit(&self, motor: &Motor<S>, speed: S, torque: S) -> Option<S> {
        if self.inverse_voltage.is_exactly(0.0) {
            return None;
        }
        let constant = motor.gear_ratio * motor.torque_constant;
        Some((torque / constant * motor.resistance + constant * speed).abs() * self.inverse_voltage)
    }
}
