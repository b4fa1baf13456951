//! Individual-wheel velocity control: a PID law on every encoder, blind to the other wheels (4.4.1).

use super::error::{ControlError, finite, same_count, within_bounds};
use super::{Controller, Nominal};
use crate::signals::{Command, Drive, Measurement, Reference};
use crate::snapshot::Moving;
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Velocity control of each wheel by itself. On soil the wheel is a nearly static plant, dT/domega = 1..10 N m s/rad,
    /// off the ground an inertia of 0.01 kg m2; the defaults are stable on both with the torque held over a period.
    pub struct VelocityControl {
        /// Proportional gain on the error of the wheel speed.
        kp: [Unit::SPEED_GAIN] = 0.5, 0.0..=1e3, Fixed, "assumption, not in the thesis: a spinning wheel's error halves in a period";
        /// Integral gain: (dT/domega + kp)/ki is the settling time on soil, 0.08 to 0.5 s.
        ki: [Unit::NEWTON_METRE_PER_RADIAN] = 20.0, 0.0..=1e5, Fixed, "assumption, not in the thesis: settles on soil within 2 s";
        /// Derivative gain, on the measured speed alone, so that a step of the goal gives no kick.
        kd: [Unit::NEWTON_METRE_SECOND2_PER_RADIAN] = 0.0, 0.0..=1e3, Fixed, "assumption: the plant is of first order";
        /// Time constant of the derivative's first-order filter; 0 is no filter.
        derivative_filter: [Unit::SECOND] = 0.0, 0.0..=10.0, Fixed, "neutral";
        /// Control period, over which the torque is held.
        period: [Unit::SECOND] = 0.01, 1e-4..=1.0, Fixed, "assumption: 100 Hz";
    }
}

/// History of one wheel's loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Moving)]
struct Loop {
    /// Integral part, N m.
    integral: f64,
    /// Filtered derivative part, N m.
    derivative: f64,
    /// Speed one period ago, rad/s.
    speed: Option<f64>,
}

impl Loop {
    /// Torque for the next period, N m; `goal` and `speed` in rad/s, `limit` in N m.
    ///
    /// Against wind-up the integral takes of a period's step only what brings the torque to its limit, and
    /// nothing beyond (conditional integration). Unlike back-calculation it needs no tracking gain, which
    /// on so stiff a plant would have to be tuned against the period, and it never drives the integral
    /// away from the torque that the soil asks for.
    fn torque(&mut self, gains: &VelocityControl, limit: f64, goal: f64, speed: f64) -> f64 {
        let error = goal - speed;
        let change = speed - self.speed.unwrap_or(speed);
        self.speed = Some(speed);
        let filter = gains.derivative_filter;
        self.derivative = (filter * self.derivative - gains.kd * change) / (filter + gains.period);
        let direct = gains.kp * error + self.derivative;
        let step = gains.ki * gains.period * error;
        let room = (limit - step.signum() * (direct + self.integral)).max(0.0);
        self.integral += step.signum() * step.abs().min(room);
        (direct + self.integral).clamp(-limit, limit)
    }
}

/// Holds each wheel at the speed goal / r by its own PID loop; commands torques within the nominal limit.
#[derive(Clone, Debug, PartialEq, Moving)]
pub struct VelocityController {
    #[not_moving]
    gains: VelocityControl,
    #[not_moving]
    radius: f64,
    #[not_moving]
    limit: f64,
    loops: Vec<Loop>,
}

impl VelocityController {
    /// A controller at rest for the nominal rover, of which it uses wheel radius, torque limit and number of wheels.
    ///
    /// # Errors
    /// [`ControlError`] where the rover or a parameter makes no sense.
    pub fn new(nominal: &Nominal, gains: VelocityControl) -> Result<Self, ControlError> {
        nominal.check()?;
        within_bounds("velocity_control", gains)?;
        let limit = nominal.torque_limit().unwrap_or(f64::INFINITY);
        Ok(Self { gains, radius: nominal.wheel.radius, limit, loops: vec![Loop::default(); nominal.wheels()] })
    }

    /// The period at which [`Controller::command`] is to be called, s.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.gains.period
    }

    /// The integral parts of the loops, rear to front, N m.
    pub fn integrals(&self) -> impl Iterator<Item = f64> + '_ {
        self.loops.iter().map(|wheel| wheel.integral)
    }
}

impl VelocityController {
    /// Torques that hold each wheel at the speed `goal` gives for it, rad/s; `goal` counts wheels from 0.
    ///
    /// # Errors
    /// As [`Controller::command`]; nothing has changed then.
    pub fn hold(
        &mut self,
        measured: &Measurement,
        goal: impl Fn(usize) -> f64,
        command: &mut Command,
    ) -> Result<(), ControlError> {
        let limit = self.limit;
        self.hold_within(measured, goal, |_| limit, command)
    }

    /// The same with torques within `limit` (N m, not negative) of each wheel, either way.
    ///
    /// # Errors
    /// As [`Controller::command`]; nothing has changed then.
    pub(super) fn hold_within(
        &mut self,
        measured: &Measurement,
        goal: impl Fn(usize) -> f64,
        limit: impl Fn(usize) -> f64,
        command: &mut Command,
    ) -> Result<(), ControlError> {
        same_count(self.loops.len(), measured.wheels.len())?;
        for (index, (wheel, seen)) in self.loops.iter().zip(&measured.wheels).enumerate() {
            finite("measured speed", Some(index), seen.speed)?;
            let goal = finite("commanded speed", Some(index), goal(index))?;
            // On a copy: a reading so large that the law overflows must not spoil the history.
            let torque = wheel.clone().torque(&self.gains, limit(index), goal, seen.speed);
            finite("commanded torque", Some(index), torque)?;
        }
        command.drive = Drive::Torque;
        command.values.clear();
        let wheels = self.loops.iter_mut().zip(&measured.wheels).enumerate();
        command.values.extend(
            wheels.map(|(index, (wheel, seen))| wheel.torque(&self.gains, limit(index), goal(index), seen.speed)),
        );
        Ok(())
    }
}

impl Controller for VelocityController {
    fn command(&mut self, measured: &Measurement, goal: &Reference, command: &mut Command) -> Result<(), ControlError> {
        let speed = finite("the goal's velocity", None, goal.velocity)? / self.radius;
        self.hold(measured, |_| speed, command)
    }

    fn reset(&mut self) {
        self.loops.fill(Loop::default());
    }
}
