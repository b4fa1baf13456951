//! The same slip at all wheels, by a controller that receives the true slip: no rover can measure it. It is a reference, not a
//! bound: other slips for each wheel may need less power or pull more.

use super::error::{ControlError, finite, same_count, same_links, within_bounds};
use super::{Controller, Nominal, VelocityControl, VelocityController};
use crate::signals::{Command, Measurement, Reference};
use crate::snapshot::Moving;
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Slip control that is told the true slip.
    pub struct SlipControl {
        /// Gain of the common slip on (v_desired - v) / |v_desired|.
        gain: [Unit::ONE] = 0.5, 0.0..=100.0, Fixed, "assumption: half the missing speed is made up for at once";
        /// Gain of the common slip on the integral of (v_desired - v) / |v_desired|.
        integral_gain: [Unit::PER_SECOND] = 1.0, 0.0..=100.0, Fixed, "assumption: the rest within a second or two, slower than the wheels' loops";
        /// Largest slip that is asked for, either way.
        largest_slip: [Unit::ONE] = 0.6, 0.01..=0.95, Fixed, "assumption: beyond it sand gives little more pull";
        /// Speed of a wheel's centre below which its own is not relied on.
        slowest: [Unit::METRE_PER_SECOND] = 0.02, 1e-4..=1.0, Fixed, "assumption: at rest a slip says nothing";
    }
}

/// What no rover can measure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Privileged {
    /// True slip of every wheel, rear to front.
    pub slip: Vec<f64>,
}

/// Holds the same slip at all wheels, as much of it as the body's speed needs, knowing every wheel's true slip.
///
/// With it goes the true speed V of every wheel's centre over the ground, so that the goal r omega = V / (1 - i) of
/// each wheel's speed loop fits the ground under it: no wheel works against another. [`reveal`](Self::reveal) has to
/// be called before every [`Controller::command`].
#[derive(Clone, Debug, PartialEq, Moving)]
pub struct SlipController {
    #[not_moving]
    nominal: Nominal,
    #[not_moving]
    parameters: SlipControl,
    inner: VelocityController,
    /// Integral part of the common slip.
    integral: f64,
    #[not_moving]
    privileged: Privileged,
    /// Goals of the wheels' loops, relative to the carrying bodies, rad/s.
    #[not_moving]
    goals: Vec<f64>,
}

impl SlipController {
    /// A controller at rest for the nominal rover, with the gains `wheels` for the loops of the wheels' speeds.
    ///
    /// # Errors
    /// [`ControlError`] where the rover or a parameter makes no sense.
    pub fn new(nominal: Nominal, parameters: SlipControl, wheels: VelocityControl) -> Result<Self, ControlError> {
        let inner = VelocityController::new(&nominal, wheels)?;
        within_bounds("slip_control", parameters)?;
        let goals = vec![0.0; nominal.wheels()];
        let privileged = Privileged { slip: Vec::with_capacity(nominal.wheels()) };
        Ok(Self { nominal, parameters, inner, integral: 0.0, privileged, goals })
    }

    /// Tells the true state for the next command.
    pub fn reveal(&mut self, slip: impl Iterator<Item = f64>) {
        self.privileged.slip.clear();
        self.privileged.slip.extend(slip);
    }

    /// Rate at which the body that carries wheel `index` turns, nose up, rad/s.
    fn body_rate(&self, measured: &Measurement, index: usize) -> f64 {
        let (mut rate, mut body) = (measured.pitch_rate, self.nominal.wheel_bodies[index]);
        while body > 0 {
            rate += measured.links[body - 1].rate;
            body = self.nominal.links[body - 1].parent;
        }
        rate
    }

    /// The common slip for a relative error of the body's speed; moves the integral on.
    fn slip(&mut self, error: f64) -> f64 {
        let SlipControl { gain, integral_gain, largest_slip, .. } = self.parameters;
        let (direct, step) = (gain * error, integral_gain * self.inner.period() * error);
        let room = (largest_slip - step.signum() * (direct + self.integral)).max(0.0);
        self.integral += step.signum() * step.abs().min(room);
        (direct + self.integral).clamp(-largest_slip, largest_slip)
    }
}

impl Controller for SlipController {
    fn command(&mut self, measured: &Measurement, goal: &Reference, command: &mut Command) -> Result<(), ControlError> {
        let wheels = self.nominal.wheels();
        same_count(wheels, measured.wheels.len())?;
        same_links(self.nominal.links.len(), measured.links.len())?;
        let wanted = finite("the goal's velocity", None, goal.velocity)?;
        let speed = finite("measured velocity", None, measured.velocity)?;
        finite("measured pitch rate", None, measured.pitch_rate)?;
        if self.privileged.slip.len() != wheels {
            return Err(ControlError::Privileged { expected: wheels, found: self.privileged.slip.len() });
        }
        for (index, (wheel, &slip)) in measured.wheels.iter().zip(&self.privileged.slip).enumerate() {
            finite("measured speed", Some(index), wheel.speed)?;
            finite("true slip", Some(index), slip)?;
        }
        for link in &measured.links {
            finite("measured joint rate", None, link.rate)?;
        }
        let slowest = self.parameters.slowest;
        // Slip is counted forward; where the goal is backward, more of it is more backward.
        let slip = self.slip((wanted - speed) * wanted.signum() / wanted.abs().max(slowest));
        let radius = self.nominal.wheel.radius;
        for index in 0..wheels {
            let turning = self.body_rate(measured, index);
            let rim = radius * (measured.wheels[index].speed - turning);
            let true_slip = self.privileged.slip[index];
            let over_ground =
                if true_slip >= 0.0 { rim * (1.0 - true_slip) } else { rim / (1.0 + true_slip).max(0.05) };
            let along = (over_ground * wanted.signum()).max(slowest) * wanted.signum();
            // (r omega) = V / (1 - i) driving, V (1 + i) braking.
            let rim_goal = if slip >= 0.0 { along / (1.0 - slip) } else { along * (1.0 + slip) };
            self.goals[index] = if wanted == 0.0 { turning } else { rim_goal / radius + turning };
        }
        self.inner.hold(measured, |index| self.goals[index], command)?;
        self.privileged.slip.clear();
        Ok(())
    }

    fn reset(&mut self) {
        self.integral = 0.0;
        self.privileged.slip.clear();
        self.inner.reset();
    }
}
