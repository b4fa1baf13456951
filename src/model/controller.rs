//! A model's controller by itself: its measurements come from outside, its torques go there.

use super::closed_loop::ActiveController;
use super::inputs::VelocityCommand;
use super::origin::Origin;
use super::start_checks::whole_multiple;
use super::{ControlKind, Model, RunError};
use crate::control::{Rtc, SpeedRtc};
use crate::signals::{Command, Measurement, Reference, Signals};
use crate::snapshot::{Moving, Reader, SnapshotError, Writer, close, open};

/// What the bytes of a state are, and the version of their format.
const KIND: [u8; 4] = *b"BKCT";
const VERSION: u32 = 1;

/// A controller with its estimators on a clock of its own. Together with a plant that steps by the control period, and is
/// measured at the start of each, it is the [`Run`](super::Run) of the same model to the last bit.
#[derive(Clone, Debug)]
pub struct ControllerRun {
    pub(super) controller: ActiveController,
    /// Inner step of the model, s, and how many of them make a control period: times are counted as a run counts them.
    step_size: f64,
    period: u64,
    decisions: u64,
    measurement: Measurement,
    goal: VelocityCommand,
    command: Command,
    /// True signals, an argument of slip control only, which cannot run here: all zero.
    truth: Signals,
    pub(super) origin: Origin,
}

impl Model {
    /// The controller of this model, before its first decision.
    ///
    /// # Errors
    /// [`RunError::NoController`] where the model's control needs no measurements, or more than those;
    /// [`RunError::Control`] and others where a parameter makes no sense.
    pub fn start_controller(&self) -> Result<ControllerRun, RunError> {
        match self.control.kind {
            ControlKind::Velocity
            | ControlKind::VelocityTuned
            | ControlKind::Rtc
            | ControlKind::RtcSpeed
            | ControlKind::EqualTorque
            | ControlKind::Registered => {}
            kind @ (ControlKind::Torque | ControlKind::Speed | ControlKind::SpeedLoop | ControlKind::Slip) => {
                return Err(RunError::NoController { kind });
            }
        }
        self.check_start()?;
        let refused = |source| RunError::Control { time: 0.0, source };
        let missing = RunError::NoController { kind: self.control.kind };
        let step_size = self.stepping.step_size;
        let period = self.control_period().ok_or_else(|| missing.clone())?;
        let (wheels, links) = (self.rover.wheels.len(), self.rover.links.len());
        Ok(ControllerRun {
            controller: ActiveController::new(self).map_err(refused)?.ok_or(missing)?,
            step_size,
            period: whole_multiple(period, step_size)?,
            decisions: 0,
            measurement: Measurement::of(wheels, links),
            goal: VelocityCommand::default(),
            command: Command::torque(vec![0.0; wheels]),
            truth: Signals::of(wheels, links),
            origin: Origin::new(self),
        })
    }
}

impl ControllerRun {
    /// The measurement that the controller receives, to be set before each decision; its time is the controller's own.
    pub fn measurement_mut(&mut self) -> &mut Measurement {
        &mut self.measurement
    }

    /// The desired speed, to be set before each decision.
    pub fn goal_mut(&mut self) -> &mut VelocityCommand {
        &mut self.goal
    }

    /// Decides on the torques of the next control period, from the measurement and the goal.
    ///
    /// # Errors
    /// [`RunError::Control`]; the torques are then as they were.
    pub fn decide(&mut self) -> Result<&Command, RunError> {
        let time = self.time();
        self.measurement.time = time;
        let goal = Reference { velocity: self.goal.velocity_command };
        self.controller
            .command(&self.measurement, &self.truth, &goal, &mut self.command)
            .map_err(|source| RunError::Control { time, source })?;
        self.decisions += 1;
        Ok(&self.command)
    }

    /// The torques decided on last, N m.
    #[must_use]
    pub fn command(&self) -> &Command {
        &self.command
    }

    /// Time of the next decision, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        (self.decisions * self.period) as f64 * self.step_size
    }

    /// Control period, s.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.period as f64 * self.step_size
    }

    /// How many decisions have been made.
    #[must_use]
    pub fn decisions(&self) -> u64 {
        self.decisions
    }

    /// Rough-terrain control, where it decides.
    #[must_use]
    pub fn rtc(&self) -> Option<&Rtc> {
        self.controller.rtc()
    }

    /// Rough-terrain control with wheel-speed loops, where it decides.
    #[must_use]
    pub fn speed_rtc(&self) -> Option<&SpeedRtc> {
        self.controller.speed_rtc()
    }

    /// Everything that moves as bytes, as [`Run::snapshot`](super::Run::snapshot).
    #[must_use]
    pub fn snapshot(&self) -> Vec<u8> {
        let mut body = Writer::default();
        self.controller.save(&mut body);
        self.decisions.save(&mut body);
        self.measurement.save(&mut body);
        self.goal.velocity_command.save(&mut body);
        self.command.save(&mut body);
        close(KIND, VERSION, self.origin.fingerprint(), &body.finish())
    }

    /// Goes on from the bytes that the controller of the same model wrote.
    ///
    /// # Errors
    /// [`SnapshotError`]; nothing is changed then.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), SnapshotError> {
        let mut from = Reader::new(open(KIND, VERSION, self.origin.fingerprint(), bytes)?);
        let mut there = self.clone();
        there.controller.load(&mut from)?;
        there.decisions.load(&mut from)?;
        there.measurement.load(&mut from)?;
        there.goal.velocity_command.load(&mut from)?;
        there.command.load(&mut from)?;
        from.end()?;
        *self = there;
        Ok(())
    }
}
