//! Back-EMF and a supply voltage that is lower than the data sheet says.

use super::{Advice, Effect, Facts, Needs};
use crate::motor::{self, Motor, TorqueRange};
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
        motor::supply_range(motor, self.inverse_voltage, speed)
    }

    fn share_of_limit(&self, motor: &Motor<S>, speed: S, torque: S) -> Option<S> {
        motor::share_of_supply(motor, self.inverse_voltage, speed, torque)
    }
}
