//! A model in motion: simulation, sensors and controller on one clock.

use super::ahead::{Ahead, ReadingOf};
use super::closed_loop::ActiveController;
use super::origin::Origin;
use super::start_checks::whole_multiple;
use super::{AnyPlant, ControlKind, Inputs, Model, RunError};
use crate::control::{Rtc, SpeedRtc};
use crate::sensors::SensorSuite;
use crate::signals::{Command, Drive, Measurement, Reference, Signals};
use crate::simulation::{Simulation, Status, check_command};

/// A model in motion. Cloning it is a snapshot: the clone goes on to the same bits.
#[derive(Clone, Debug)]
pub struct Run {
    pub(super) simulation: AnyPlant,
    pub(super) sensors: SensorSuite,
    pub(super) controller: Option<ActiveController>,
    /// Inner steps a control period.
    period: u64,
    /// Inner steps between readings of the sensors, where they are read without a controller.
    sensing: Option<u64>,
    pub(super) inputs: Inputs,
    /// What the controller commands; where there is none, the inputs are the command, see [`Run::command_of`].
    pub(super) command: Command,
    pub(super) measurement: Measurement,
    pub(super) origin: Origin,
}

impl Run {
    pub(super) fn new(model: &Model) -> Result<Self, RunError> {
        model.check_start()?;
        Self::with_plant(model, AnyPlant::new(model)?)
    }

    /// A run of `model`, which has passed its checks, from where `simulation` stands.
    ///
    /// # Errors
    /// As for a run from the model's start.
    #[cfg(feature = "experiments")]
    pub(crate) fn from_simulation(model: &Model, simulation: Simulation) -> Result<Self, RunError> {
        Self::with_plant(model, AnyPlant::JointCoordinates(Box::new(simulation)))
    }

    fn with_plant(model: &Model, simulation: AnyPlant) -> Result<Self, RunError> {
        let step_size = model.stepping.step_size;
        let zeros = vec![0.0; model.rover.wheels.len()];
        let command = match model.control.kind {
            ControlKind::Speed => Command::speed(zeros),
            _ => Command::torque(zeros),
        };
        let seconds = model.control_period().unwrap_or(step_size);
        let mut run = Self {
            simulation,
            sensors: SensorSuite::new(model.sensors, u64::from(model.stepping.seed)),
            controller: ActiveController::new(model).map_err(|source| RunError::Control { time: 0.0, source })?,
            period: whole_multiple(seconds, step_size)?,
            sensing: None,
            inputs: Inputs::new(model),
            command,
            measurement: Measurement::default(),
            origin: Origin::new(model),
        };
        if run.controller.is_some() {
            run.sensors.read(0.0, run.simulation.signals(), &mut run.measurement);
        }
        Ok(run)
    }

    /// Makes `steps` inner steps with the present inputs.
    ///
    /// # Errors
    /// [`RunError`]; the state is then that of the last good step.
    pub fn advance(&mut self, steps: u64) -> Result<Status, RunError> {
        self.advance_from(steps, false)
    }

    /// The same where the present decision is made already ([`Run::decided`]): a controller decides once, and draws the noise of its
    /// sensors once.
    pub(crate) fn advance_from(&mut self, steps: u64, mut is_decided: bool) -> Result<Status, RunError> {
        let mut left = steps;
        let mut status = self.simulation.status();
        while left > 0 && status == Status::Running {
            let decides = !std::mem::replace(&mut is_decided, false);
            if decides && self.simulation.ticks().is_multiple_of(self.period) {
                self.decide()?;
            }
            let some = self.until_decision(left);
            self.apply_command()?;
            status = self.simulation.go_on(some)?;
            left -= some;
            self.sense();
        }
        Ok(status)
    }

    /// Inner steps before the next decision or reading of sensors, at most `left`.
    fn until_decision(&self, left: u64) -> u64 {
        let ticks = self.simulation.ticks();
        let some = if self.controller.is_some() { left.min(self.period - ticks % self.period) } else { left };
        self.sensing.map_or(some, |every| some.min(every - ticks % every))
    }

    /// Decides on the command ([`Run::command_of`]), and for how many inner steps, of `left`, it holds: what [`Run::advance`]
    /// begins with.
    pub(crate) fn decided(&mut self, left: u64) -> Result<u64, RunError> {
        if self.simulation.ticks().is_multiple_of(self.period) {
            self.decide()?;
        }
        Ok(self.until_decision(left))
    }

    /// The command that holds now for wheel `k`.
    pub(crate) fn command_of(&self, k: usize) -> f64 {
        command_of(&self.inputs, self.controller.as_ref(), &self.command, k)
    }

    /// Gives the plant the command that holds now.
    pub(crate) fn apply_command(&mut self) -> Result<(), RunError> {
        let Self { simulation, inputs, controller, command, .. } = self;
        if controller.is_some() {
            check_command(command, simulation.rover().wheels.len())?;
        }
        Ok(simulation.hold(command.drive, &|k| command_of(inputs, controller.as_ref(), command, k))?)
    }

    /// What is commanded: torques or speeds.
    pub(crate) fn drive(&self) -> Drive {
        self.command.drive
    }

    /// The plant in joint coordinates, where it is this one.
    pub(crate) fn in_joint_coordinates(&self) -> Option<&Simulation> {
        match &self.simulation {
            AnyPlant::JointCoordinates(simulation) => Some(simulation),
            #[cfg(feature = "rigid")]
            AnyPlant::RigidBodies(_) => None,
        }
    }

    /// The same, to be written.
    pub(crate) fn in_joint_coordinates_mut(&mut self) -> Option<&mut Simulation> {
        match &mut self.simulation {
            AnyPlant::JointCoordinates(simulation) => Some(simulation),
            #[cfg(feature = "rigid")]
            AnyPlant::RigidBodies(_) => None,
        }
    }

    /// Inner steps since the start.
    #[cfg(feature = "experiments")]
    pub(crate) fn ticks(&self) -> u64 {
        self.simulation.ticks()
    }

    /// Goes on after an event.
    #[cfg(feature = "experiments")]
    pub(crate) fn resume(&mut self) {
        if let Some(simulation) = self.in_joint_coordinates_mut() {
            simulation.resume();
        }
    }

    /// Reads the sensors every `period` seconds, from now on, where no controller does: [`Run::measurement`] then shows what
    /// a controller with this period would see. A run with a controller is left as it is.
    ///
    /// # Errors
    /// [`RunError::Period`] where `period` is no whole number of inner steps.
    pub fn sense_every(&mut self, period: f64) -> Result<(), RunError> {
        let every = whole_multiple(period, self.step_size())?;
        if self.controller.is_none() {
            self.sensing = Some(every);
            // As a run with a controller: one reading at its start, which wakes the sensors, and one before the first step.
            self.sense();
            self.sense();
        }
        Ok(())
    }

    /// Reads the sensors where it is time and no controller does.
    pub(crate) fn sense(&mut self) {
        if self.sensing.is_some_and(|every| self.simulation.ticks().is_multiple_of(every)) {
            self.sensors.read(self.simulation.time(), self.simulation.signals(), &mut self.measurement);
        }
    }

    /// The controller's command for the next control period.
    fn decide(&mut self) -> Result<(), RunError> {
        match (&self.inputs, &mut self.controller) {
            (Inputs::Speed(wheels), Some(ActiveController::Velocity(controller))) => {
                let time = self.simulation.time();
                self.sensors.read(time, self.simulation.signals(), &mut self.measurement);
                controller
                    .hold(&self.measurement, |k| wheels[k].speed_command, &mut self.command)
                    .map_err(|source| RunError::Control { time, source })?;
            }
            (Inputs::Velocity(input), Some(controller)) => {
                let time = self.simulation.time();
                self.sensors.read(time, self.simulation.signals(), &mut self.measurement);
                let goal = Reference { velocity: input.velocity_command };
                controller
                    .command(&self.measurement, self.simulation.signals(), &goal, &mut self.command)
                    .map_err(|source| RunError::Control { time, source })?;
            }
            (Inputs::Torque(_) | Inputs::Speed(_) | Inputs::Velocity(_) | Inputs::Carriage(_), _) => {}
        }
        Ok(())
    }

    /// The inputs, to be set before [`Run::advance`].
    pub fn inputs_mut(&mut self) -> &mut Inputs {
        &mut self.inputs
    }

    /// The inputs.
    #[must_use]
    pub fn inputs(&self) -> &Inputs {
        &self.inputs
    }

    /// What the controller saw last.
    #[must_use]
    pub fn measurement(&self) -> &Measurement {
        &self.measurement
    }

    /// Rough-terrain control, where it drives: its last outcome tells loads, torques and what was missing.
    #[must_use]
    pub fn rtc(&self) -> Option<&Rtc> {
        self.controller.as_ref().and_then(ActiveController::rtc)
    }

    /// Rough-terrain control with wheel-speed loops, where it drives.
    #[must_use]
    pub fn speed_rtc(&self) -> Option<&SpeedRtc> {
        self.controller.as_ref().and_then(ActiveController::speed_rtc)
    }

    /// Signals at the present time: the true ones, but for the errors of sensors among the rover's effects.
    #[must_use]
    pub fn signals(&self) -> &Signals {
        self.simulation.signals()
    }

    /// The signals at the present time under the command of the present inputs, which else act from the next step on: torques,
    /// currents and powers of the drives as they begin. The run stays as it is; a copy decides.
    ///
    /// # Errors
    /// As [`Run::advance`].
    pub fn signals_under_inputs(&self) -> Result<Signals, RunError> {
        let mut ahead = self.clone();
        if ahead.simulation.status() == Status::Running {
            ahead.decided(1)?;
            ahead.apply_command()?;
            ahead.simulation.go_on(0)?;
        }
        Ok(ahead.simulation.signals().clone())
    }

    /// Time since the start, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.simulation.time()
    }

    /// Inner step, s.
    #[must_use]
    pub fn step_size(&self) -> f64 {
        self.simulation.step_size()
    }

    /// Whether the run goes on.
    #[must_use]
    pub fn status(&self) -> Status {
        self.simulation.status()
    }

    /// Reads the ground ahead of the rover: all heights (m), then which cells are there (1 or 0), then the relative strengths of the soil.
    ///
    /// # Panics
    /// If `out` does not hold [`Ahead::ROWS`] numbers for each distance.
    pub fn look_ahead(&self, ahead: &Ahead, out: &mut [f64]) {
        assert_eq!(out.len(), Ahead::ROWS * ahead.distances().len(), "a reading has three numbers for each distance");
        let model = self.origin.model();
        let at = ReadingOf { seed: u64::from(model.stepping.seed), tick: self.simulation.ticks() };
        ahead.read(self.simulation.rover(), &model.obstacles, self.signals().body.x, at, out);
    }

    /// The plant, which both kinds of it show in the same way.
    #[must_use]
    pub fn simulation(&self) -> &AnyPlant {
        &self.simulation
    }
}

/// The command of wheel `k`: the input itself where no controller makes one of it.
fn command_of(inputs: &Inputs, controller: Option<&ActiveController>, command: &Command, k: usize) -> f64 {
    let direct = if controller.is_none() { inputs.of_wheel(k) } else { None };
    direct.unwrap_or_else(|| command.values[k])
}
