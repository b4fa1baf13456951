//! Back-EMF and a limited supply voltage.

use super::Effect;
use crate::motor::Motor;
use crate::scalar::{Mask, Scalar};
use bekker_modeldescription::{Unit, parameters};

/// Share of the reachable torque above which the limit is near.
const NEAR: f64 = 0.5;

parameters! {
    /// |R I + K_t N omega| stays within the supply voltage, so a loaded motor cannot hold its speed.
    pub struct VoltageLimit {
        /// One over the supply voltage; 0 is no limit.
        inverse_voltage: [Unit::PER_VOLT] = 0.0, 0.0..=10.0, Effect, "supply data";
    }
}

impl<S: Scalar> VoltageLimit<S> {
    /// Share of the supply voltage that `torque` (wheel side) takes at this wheel speed.
    pub(crate) fn share(&self, motor: &Motor<S>, speed: S, torque: S) -> S {
        let constant = motor.gear_ratio * motor.torque_constant;
        (torque / constant * motor.resistance + constant * speed).abs() * self.inverse_voltage
    }
}

impl<S: Scalar> Effect<S> for VoltageLimit<S> {
    #[cfg_attr(feature = "batch", inline(always))]
    fn motor_torque(&self, motor: &Motor<S>, speed: S, torque: &mut S) -> Option<S> {
        if self.inverse_voltage.is_exactly(0.0) {
            return None;
        }
        let voltage = self.inverse_voltage.recip();
        let constant = motor.gear_ratio * motor.torque_constant; // wheel side, N m/A = V s/rad
        let reachable = |sign: f64| constant * (voltage * sign - constant * speed) / motor.resistance;
        let (most, least) = (reachable(1.0), reachable(-1.0));
        *torque = torque.smaller(most).larger(least);
        // The integrator is told of the slope before the limit binds: a step may run into it, and the slope it
        // is told changes nothing in the order of its error.
        let near = (most * NEAR).below(*torque) | torque.below(least * NEAR) | most.under(0.0) | least.over(0.0);
        near.any().then(|| S::select(near, -(constant * constant / motor.resistance), S::from(0.0)))
    }
}
