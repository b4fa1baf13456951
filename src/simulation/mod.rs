//! The simulation: a rover in motion, stepped with a fixed inner step.

mod energies;
mod moving;
mod settle;
mod status;
mod step_state;
mod truth;
mod window;

pub(crate) use energies::Energies;
pub use settle::SettleError;
pub use status::{Event, Status, StatusEntry};
pub(crate) use step_state::{StepState, TIPPED, belly_clearance};
pub(crate) use window::Window;

use crate::integrator::Integrator;
use crate::recording::Recorder;
use crate::rover::dynamics::DynamicsError;
use crate::rover::{Rover, State};
use crate::scalar::{Mask, Scalar};
use crate::signals::{Command, Drive, Signals};
use crate::snapshot::Moving;
use crate::terrain::TerrainError;

/// Why a simulation cannot start or go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The command has the wrong number of values.
    #[error("the command has {got} values, the rover has {expected} wheels")]
    CommandLength {
        /// Values in the command.
        got: usize,
        /// Wheels of the rover.
        expected: usize,
    },
    /// A value of the command is NaN or infinite.
    #[error("the command of wheel {wheel} is {value}, expected a finite number")]
    CommandNotFinite {
        /// Wheel, from 1 at the rear.
        wheel: usize,
        /// The value.
        value: f64,
    },
    /// The inner step is not a positive finite number, or larger than 20 ms.
    #[error("the inner step is {0} s, expected more than 0 and at most 0.02 s")]
    StepSize(f64),
    /// An obstacle stands where the rover starts.
    #[error(
        "obstacle {obstacle} at x = {x} m overlaps the rover at its start, expected it clear of wheels and chassis"
    )]
    ObstacleAtStart {
        /// Obstacle, from 1.
        obstacle: usize,
        /// Its place, m.
        x: f64,
    },
    /// The rover cannot be put on the ground.
    #[error(transparent)]
    Settle(#[from] SettleError),
    /// The equations of motion failed.
    #[error("at t = {time} s: {source}")]
    Dynamics {
        /// Time, s.
        time: f64,
        /// Why.
        source: DynamicsError,
    },
}

/// A rover in motion. Cloning it is a snapshot: the clone goes on to the same bits.
///
/// Over dual numbers every signal carries its derivatives in whatever the rover and its start were seeded with; events
/// are decided on real parts.
#[derive(Clone, Debug, Moving)]
pub struct Simulation<S: Scalar = f64> {
    #[not_moving]
    rover: Rover<S>,
    motion: StepState<S>,
    command: Command,
    /// The command before the last change, to which a change that fails goes back.
    #[not_moving]
    before: Command,
    #[not_moving]
    step_size: f64,
    ticks: u64,
    status: Status,
    recorder: Recorder<S>,
    signals: Signals<S>,
}

impl<S: Scalar> Simulation<S> {
    /// A rover at rest above `x0` (m), settled on its soil, stepped by `step_size` (s).
    ///
    /// # Errors
    /// [`StepError::Settle`] where it finds no rest, [`StepError::StepSize`].
    pub fn new(rover: Rover<S>, x0: S, step_size: f64) -> Result<Self, StepError> {
        let state = rover.settled_at(x0)?;
        Self::from_state(rover, state, step_size)
    }

    /// A rover in a given state.
    ///
    /// # Errors
    /// [`StepError::StepSize`], [`StepError::Dynamics`].
    pub fn from_state(rover: Rover<S>, state: State<S>, step_size: f64) -> Result<Self, StepError> {
        if !(step_size > 0.0 && step_size <= 0.02) {
            return Err(StepError::StepSize(step_size));
        }
        let command = Command::torque(vec![0.0; rover.wheels.len()]);
        let motion =
            StepState::new(&rover, state, &command).map_err(|source| StepError::Dynamics { time: 0.0, source })?;
        let signals = Signals::of(rover.wheels.len(), rover.links.len());
        let recorder = Recorder::new(&rover.effects, &signals, step_size);
        let mut simulation = Self {
            rover,
            motion,
            before: command.clone(),
            command,
            step_size,
            ticks: 0,
            status: Status::Running,
            recorder,
            signals,
        };
        simulation.observe(Recorder::step);
        simulation.refresh();
        Ok(simulation)
    }

    /// Applies `command` and makes `steps` inner steps with it.
    ///
    /// # Errors
    /// [`StepError`]; the state is then that of the last good step.
    pub fn advance(&mut self, command: &Command, steps: u64) -> Result<Status, StepError> {
        self.apply(command)?;
        self.go_on(steps)
    }

    /// Makes `steps` inner steps with the command that holds.
    ///
    /// # Errors
    /// As [`Simulation::advance`].
    pub(crate) fn go_on(&mut self, steps: u64) -> Result<Status, StepError> {
        for _ in 0..steps {
            if self.status != Status::Running {
                break;
            }
            self.step()?;
        }
        self.refresh();
        Ok(self.status)
    }

    /// Takes `command` over; it holds from now on.
    ///
    /// # Errors
    /// [`StepError`].
    fn apply(&mut self, command: &Command) -> Result<(), StepError> {
        check_command(command, self.rover.wheels.len())?;
        self.hold(command.drive, &|k| command.values[k])
    }

    /// Takes the command `value(k)` of each wheel k over, which must be finite; it holds from now on.
    ///
    /// # Errors
    /// [`StepError::Dynamics`].
    pub(crate) fn hold(&mut self, drive: Drive, value: &dyn Fn(usize) -> f64) -> Result<(), StepError> {
        if self.command.is(drive, value) || self.status != Status::Running {
            return Ok(());
        }
        std::mem::swap(&mut self.command, &mut self.before);
        self.command.set(drive, value);
        self.take_command_over().map_err(|source| {
            std::mem::swap(&mut self.command, &mut self.before);
            StepError::Dynamics { time: self.time(), source }
        })
    }

    fn take_command_over(&mut self) -> Result<(), DynamicsError> {
        self.motion.change_command(&self.rover, &self.command, S::Mask::from_lanes(|_| true))?;
        self.observe(Recorder::jump);
        Ok(())
    }

    /// Goes on with other constants of the rover, whose structure stays.
    ///
    /// # Errors
    /// [`StepError::Dynamics`]; nothing is changed then.
    pub(crate) fn retune(&mut self, rover: Rover<S>) -> Result<(), StepError> {
        let mut state = self.motion.state.clone();
        let mut integrator = Integrator::new(&rover, &state);
        integrator
            .evaluate(&rover, &mut state, &self.command)
            .map_err(|source| StepError::Dynamics { time: self.time(), source })?;
        (self.rover, self.motion.state, self.motion.integrator) = (rover, state, integrator);
        self.observe(Recorder::jump);
        self.refresh();
        Ok(())
    }

    /// Goes on with other values of the effects' parameters, as under a new command.
    ///
    /// # Errors
    /// [`StepError::Dynamics`].
    #[cfg(feature = "experiments")]
    pub(crate) fn adjust(&mut self, change: impl FnOnce(&mut crate::effects::Effects<S>)) -> Result<(), StepError> {
        change(&mut self.rover.effects);
        self.take_command_over().map_err(|source| StepError::Dynamics { time: self.time(), source })
    }

    /// Goes on after an event: the rest of a recorded drive on which the simulated rover got stuck.
    #[cfg(feature = "experiments")]
    pub(crate) fn resume(&mut self) {
        self.status = Status::Running;
    }

    fn step(&mut self) -> Result<(), StepError> {
        match self.motion.step(&self.rover, &self.command, self.step_size) {
            Ok(()) => {}
            Err(DynamicsError::Terrain { source: TerrainError::Left { .. }, .. }) => {
                self.status = Status::Ended(Event::LeftTerrain);
                return Ok(());
            }
            Err(source) => return Err(StepError::Dynamics { time: self.time(), source }),
        }
        self.ticks += 1;
        self.observe(Recorder::step);
        self.status = self.motion.outcome(&self.rover, self.step_size).status(0);
        Ok(())
    }

    /// Lets a recorder that lags take in the present signals.
    fn observe(&mut self, take: fn(&mut Recorder<S>, &mut Signals<S>)) {
        if self.recorder.lags() {
            self.sense();
            take(&mut self.recorder, &mut self.signals);
        }
    }

    /// Writes the signals as they are recorded at the present time.
    fn refresh(&mut self) {
        self.sense();
        self.recorder.record(&mut self.signals);
    }

    /// Writes the signals from the present state, as sensors without memory see it.
    fn sense(&mut self) {
        let StepState { state, integrator, energies, .. } = &self.motion;
        integrator.now.sense(&self.rover, state, energies, &mut self.signals);
    }

    /// Time since the start, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.ticks as f64 * self.step_size
    }

    /// Inner steps since the start.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.ticks
    }

    /// Inner step, s.
    #[must_use]
    pub fn step_size(&self) -> f64 {
        self.step_size
    }

    /// Signals at the present time: the true ones, but for the errors of sensors among the rover's effects.
    #[must_use]
    pub fn signals(&self) -> &Signals<S> {
        &self.signals
    }

    /// Whether the run goes on.
    #[must_use]
    pub fn status(&self) -> Status {
        self.status
    }

    /// The rover.
    #[must_use]
    pub fn rover(&self) -> &Rover<S> {
        &self.rover
    }

    /// The moving data.
    #[must_use]
    pub fn state(&self) -> &State<S> {
        &self.motion.state
    }

    /// What a step changes.
    pub(crate) fn motion(&self) -> &StepState<S> {
        &self.motion
    }

    /// Mutable access to the parts that a batch computes in SIMD lanes and writes back: the state after a step, the number of
    /// steps made, the status, the signals and their recorder, the command.
    pub(crate) fn places(&mut self) -> Places<'_, S> {
        let Self { motion, ticks, status, signals, recorder, command, .. } = self;
        Places { motion, ticks, status, signals, recorder, command }
    }

    /// Whether what is recorded depends on the past.
    pub(crate) fn lags(&self) -> bool {
        self.recorder.lags()
    }

    pub(crate) fn command(&self) -> &Command {
        &self.command
    }

    pub(crate) fn energies(&self) -> Energies<S> {
        self.motion.energies
    }

    /// Whether the last command was torques or speeds.
    #[must_use]
    pub fn drive(&self) -> Drive {
        self.command.drive
    }
}

/// Parts of a simulation that a batch writes after it has stepped several simulations together.
pub(crate) struct Places<'a, S: Scalar> {
    pub motion: &'a mut StepState<S>,
    pub ticks: &'a mut u64,
    pub status: &'a mut Status,
    pub signals: &'a mut Signals<S>,
    pub recorder: &'a mut Recorder<S>,
    pub command: &'a mut Command,
}

/// Refuses a command that does not fit a rover with this number of wheels.
pub(crate) fn check_command(command: &Command, wheels: usize) -> Result<(), StepError> {
    if command.values.len() != wheels {
        return Err(StepError::CommandLength { got: command.values.len(), expected: wheels });
    }
    match command.values.iter().position(|value| !value.is_finite()) {
        Some(k) => Err(StepError::CommandNotFinite { wheel: k + 1, value: command.values[k] }),
        None => Ok(()),
    }
}
