//! The same torque for all wheels: a proportional and integral law on the body's speed, blind to the ground.

use super::error::{ControlError, finite, same_count, within_bounds};
use super::{Controller, Nominal};
use crate::signals::{Command, Drive, Measurement, Reference};
use crate::snapshot::Moving;
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Equal torque on all wheels, from the body's speed.
    pub struct EqualTorque {
        /// Gain of the commanded acceleration on v_desired - v.
        gain: [Unit::PER_SECOND] = 20.0, 0.0..=1e3, Fixed, "assumption: half the weight at a step of 0.25 m/s, which sand can answer";
        /// Gain on the integral of v_desired - v, against the soil's resistance.
        integral_gain: [Unit::PER_SECOND2] = 100.0, 0.0..=1e3, Fixed, "gain^2 / 4: a double pole of the body's speed";
        /// Control period, over which the torques are held.
        period: [Unit::SECOND] = 0.01, 1e-4..=1.0, Fixed, "assumption: 100 Hz, as velocity control";
    }
}

/// Drives all wheels by the same torque, m a r / n for the acceleration a = K (v_desired - v) + K_i integral.
///
/// The acceleration asked for stays within one g and the torques within the nominal limit; at either the integral
/// takes of a step only what leads there (conditional integration, as in velocity control).
#[derive(Clone, Debug, PartialEq, Moving)]
pub struct EqualTorqueController {
    #[not_moving]
    gains: EqualTorque,
    /// Torque of one wheel for an acceleration of the body, N m s^2/m.
    #[not_moving]
    torque_share: f64,
    /// Largest acceleration that is asked for, m/s^2.
    #[not_moving]
    limit: f64,
    #[not_moving]
    wheels: usize,
    /// Integral part of the acceleration, m/s^2.
    integral: f64,
}

impl EqualTorqueController {
    /// A controller at rest for the nominal rover, of which it uses mass, gravity, wheel radius, torque limit and
    /// number of wheels.
    ///
    /// # Errors
    /// [`ControlError`] where the rover or a parameter makes no sense.
    pub fn new(nominal: &Nominal, gains: EqualTorque) -> Result<Self, ControlError> {
        nominal.check()?;
        within_bounds("equal_torque", gains)?;
        let torque_share = nominal.mass * nominal.wheel.radius / nominal.wheels() as f64;
        let limit = nominal.torque_limit().map_or(nominal.gravity, |torque| nominal.gravity.min(torque / torque_share));
        Ok(Self { gains, torque_share, limit, wheels: nominal.wheels(), integral: 0.0 })
    }
}

impl Controller for EqualTorqueController {
    fn command(&mut self, measured: &Measurement, goal: &Reference, command: &mut Command) -> Result<(), ControlError> {
        same_count(self.wheels, measured.wheels.len())?;
        let speed = finite("measured velocity", None, measured.velocity)?;
        let error = finite("the goal's velocity", None, goal.velocity)? - speed;
        let direct = finite("the wanted acceleration", None, self.gains.gain * error)?;
        let step = self.gains.integral_gain * self.gains.period * error;
        let room = (self.limit - step.signum() * (direct + self.integral)).max(0.0);
        self.integral += step.signum() * step.abs().min(room);
        let acceleration = (direct + self.integral).clamp(-self.limit, self.limit);
        command.drive = Drive::Torque;
        command.values.clear();
        command.values.resize(self.wheels, self.torque_share * acceleration);
        Ok(())
    }

    fn reset(&mut self) {
        self.integral = 0.0;
    }
}
