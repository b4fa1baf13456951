//! The simulation: a rover in motion, stepped with a fixed inner step.

use crate::integrator::Integrator;
use crate::recording::Recorder;
use crate::rover::dynamics::{DynamicsError, Evaluation, Powers};
use crate::rover::{Rover, SettleError, State};
use crate::scalar::{Mask, Plain, Scalar, always};
use crate::signals::{Command, Drive, Signals};
use crate::snapshot::{Moving, Reader, SnapshotError, Writer, moving, moving_beside, moving_code};
use crate::terrain::TerrainError;
use num_traits::Signed;
use std::fmt;

/// Pitch beyond which the rover counts as tipped over, rad.
pub(crate) const TIPPED: f64 = 80.0 * std::f64::consts::PI / 180.0;
/// Progress under this share of the rim's travel, over a window of rim travel, is being stuck.
const STUCK_SHARE: f64 = 0.02;
/// The window's length in wheel radii.
const STUCK_WINDOW: f64 = 6.0;

/// What ends a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Event {
    /// The wheels turn, the rover does not move.
    Stuck,
    /// The pitch is beyond 80 degrees.
    TippedOver,
    /// The belly touches the ground.
    BellyContact,
    /// A wheel is beyond the known ground.
    LeftTerrain,
    /// A wheel has sunk to its axle.
    SunkToAxle,
}

moving_code!(Event, "an event" {
    Event::Stuck => 1 => Event::Stuck,
    Event::TippedOver => 2 => Event::TippedOver,
    Event::BellyContact => 3 => Event::BellyContact,
    Event::LeftTerrain => 4 => Event::LeftTerrain,
    Event::SunkToAxle => 5 => Event::SunkToAxle,
});

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Event::Stuck => "stuck: the wheels turn, the rover does not move",
            Event::TippedOver => "tipped over: the pitch is beyond 80 degrees",
            Event::BellyContact => "belly contact: the chassis touches the ground",
            Event::LeftTerrain => "left the terrain: a wheel is beyond the known ground",
            Event::SunkToAxle => "sunk to the axle: the wheel model does not hold any more",
        })
    }
}

/// Whether a run goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Status {
    /// It goes on.
    Running,
    /// It has ended; further steps change nothing.
    Ended(Event),
}

impl Status {
    /// What [`Status::word`] may say, as scripts, FMUs and the environment write it.
    pub const WORDS: [&str; 6] = ["running", "stuck", "tipped_over", "belly_contact", "left_terrain", "sunk_to_axle"];

    /// Its place among [`Status::WORDS`].
    #[must_use]
    pub fn place(self) -> usize {
        match self {
            Status::Running => 0,
            Status::Ended(Event::Stuck) => 1,
            Status::Ended(Event::TippedOver) => 2,
            Status::Ended(Event::BellyContact) => 3,
            Status::Ended(Event::LeftTerrain) => 4,
            Status::Ended(Event::SunkToAxle) => 5,
        }
    }

    /// One word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        Self::WORDS[self.place()]
    }
}

impl Moving for Status {
    fn save(&self, to: &mut Writer) {
        match self {
            Status::Running => to.number(0),
            Status::Ended(event) => {
                to.number(1);
                event.save(to);
            }
        }
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        *self = match from.number()? {
            0 => Status::Running,
            1 => {
                let mut event = Event::Stuck;
                event.load(from)?;
                Status::Ended(event)
            }
            code => return Err(SnapshotError::Code { what: "a status", code }),
        };
        Ok(())
    }
}

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

/// Energies since the start, J.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Energies<S> {
    pub dissipated: S,
    pub electrical: S,
    pub drive: S,
    pub soil_loss: S,
    pub other_loss: S,
}

moving_beside!(Energies<f64> { dissipated, electrical, drive, soil_loss, other_loss });

/// Progress since the present window of rim travel began.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Window<R = f64> {
    start_x: R,
    /// Path of the rims, mean over the wheels: without and with sign, m.
    rim_travel: R,
    rim_progress: R,
}

moving_beside!(Window { start_x, rim_travel, rim_progress });

impl<R: Plain> Window<R> {
    /// A window that begins at `x`.
    #[cfg_attr(feature = "batch", inline(always))]
    pub fn at(x: R) -> Self {
        Self { start_x: x, rim_travel: R::from(0.0), rim_progress: R::from(0.0) }
    }

    #[cfg_attr(feature = "batch", inline(always))]
    fn restart(&mut self, mask: R::Mask, x: R) {
        let zero = R::from(0.0);
        self.start_x = R::select(mask, x, self.start_x);
        self.rim_travel = R::select(mask, zero, self.rim_travel);
        self.rim_progress = R::select(mask, zero, self.rim_progress);
    }

    /// Takes in one step that ended at `x` with these wheel `speeds`; whether it closes a window without progress.
    #[cfg_attr(feature = "batch", inline(always))]
    pub fn stuck(
        &mut self,
        x: R,
        speeds: impl ExactSizeIterator<Item = R> + Clone,
        radius: R,
        step_size: f64,
    ) -> R::Mask {
        let scale = radius * step_size / speeds.len() as f64;
        let (mut travel, mut progress) = (R::from(-0.0), R::from(-0.0));
        for speed in speeds {
            travel += speed.abs();
            progress += speed;
        }
        let (travel, progress) = (travel * scale, progress * scale);
        // Where the wheels have reversed together, the way back is not lost progress.
        let reversed = (progress * self.rim_progress).under(0.0) & (travel * 0.5).below(progress.abs());
        self.restart(reversed, x);
        self.rim_travel += travel;
        self.rim_progress += progress;
        let full = (radius * STUCK_WINDOW).at_most(self.rim_travel);
        if !full.any() {
            return full;
        }
        // Progress counts in the direction of driving: sliding back while driving on is being stuck.
        let way = x - self.start_x;
        let progress = way.abs().negative_where((way * self.rim_progress).bit(63));
        let stuck = full & progress.below(self.rim_travel * STUCK_SHARE);
        self.restart(full, x);
        stuck
    }
}

/// What a step ended in.
pub(crate) struct Outcome<M> {
    tipped: M,
    sunk: M,
    belly: M,
    stuck: M,
}

impl<M: Mask> Outcome<M> {
    /// Where the run has ended.
    #[cfg_attr(feature = "batch", inline(always))]
    pub fn ended(&self) -> M {
        self.tipped | self.sunk | self.belly | self.stuck
    }

    /// The status of number `k` of those side by side.
    pub fn status(&self, k: usize) -> Status {
        if self.tipped.lane(k) {
            Status::Ended(Event::TippedOver)
        } else if self.sunk.lane(k) {
            Status::Ended(Event::SunkToAxle)
        } else if self.belly.lane(k) {
            Status::Ended(Event::BellyContact)
        } else if self.stuck.lane(k) {
            Status::Ended(Event::Stuck)
        } else {
            Status::Running
        }
    }
}

/// What an inner step moves, of one rover or of several side by side.
#[derive(Clone, Debug)]
pub(crate) struct Motion<S: Scalar = f64> {
    pub state: State<S>,
    pub integrator: Integrator<S>,
    pub energies: Energies<S>,
    pub window: Window<S::Plain>,
}

// Of the integrator's memory only the evaluation at the present state outlives a step.
moving_beside!(Motion<f64> { state, integrator, energies, window });

impl<S: Scalar> Motion<S> {
    /// A rover in `state` under `command`.
    pub fn new<C: Copy + Into<S>>(
        rover: &Rover<S>,
        mut state: State<S>,
        command: &Command<C>,
    ) -> Result<Self, DynamicsError> {
        let mut integrator = Integrator::new(rover, &state);
        integrator.evaluate(rover, &mut state, command)?;
        let window = Window::at(state.position[0].plain());
        Ok(Self { state, integrator, energies: Energies::zero(), window })
    }

    /// Takes a new command over where the mask says so; where it imposes other speeds, the impulse counts as work of the
    /// drives. Elsewhere the command must be the same as before.
    ///
    /// # Errors
    /// [`DynamicsError`] of any; nothing has changed then.
    pub fn change_command<C: Copy + Into<S>>(
        &mut self,
        rover: &Rover<S>,
        command: &Command<C>,
        mask: S::Mask,
    ) -> Result<(), DynamicsError> {
        S::wide(
            #[cfg_attr(feature = "batch", inline(always))]
            || {
                let Self { state, integrator, energies, .. } = self;
                let before = integrator.now.mechanical_energy(rover, state);
                integrator.change(rover, state, command, mask)?;
                let after = integrator.now.mechanical_energy(rover, state);
                energies.drive = S::select(mask, energies.drive + (after - before), energies.drive);
                Ok(())
            },
        )
    }

    /// One inner step.
    ///
    /// # Errors
    /// [`DynamicsError`] of any; nothing has moved then.
    pub fn step<C: Copy + Into<S>>(
        &mut self,
        rover: &Rover<S>,
        command: &Command<C>,
        step_size: f64,
    ) -> Result<(), DynamicsError> {
        S::wide(
            #[cfg_attr(feature = "batch", inline(always))]
            || {
                let before = self.integrator.now.powers();
                self.integrator.step(rover, &mut self.state, command, step_size)?;
                self.integrator.warm(rover, &mut self.state, step_size);
                let after = self.integrator.now.powers();
                self.energies.add(&before, &after, step_size);
                Ok(())
            },
        )
    }

    /// What the step just made has ended in.
    pub fn outcome(&mut self, rover: &Rover<S>, step_size: f64) -> Outcome<S::Mask> {
        S::wide(
            #[cfg_attr(feature = "batch", inline(always))]
            || {
                let radius = rover.true_wheel().radius.plain();
                let wheels = &self.integrator.now.wheels;
                let none = S::Mask::from_lanes(|_| false);
                let mut sunk = none;
                for wheel in wheels {
                    sunk = sunk | radius.at_most(wheel.sinkage.plain());
                }
                let speeds = wheels.iter().map(|wheel| wheel.speed.plain());
                Outcome {
                    tipped: self.state.position[2].plain().abs().over(TIPPED),
                    sunk,
                    belly: belly_clearance(rover, &self.state).under(0.0),
                    stuck: self.window.stuck(self.state.position[0].plain(), speeds, radius, step_size),
                }
            },
        )
    }
}

/// A rover in motion. Cloning it is a snapshot: the clone goes on to the same bits.
///
/// Over dual numbers every signal carries its derivatives in whatever the rover and its start were seeded with; events
/// are decided on real parts.
#[derive(Clone, Debug)]
pub struct Simulation<S: Scalar = f64> {
    rover: Rover<S>,
    motion: Motion<S>,
    command: Command,
    step_size: f64,
    ticks: u64,
    status: Status,
    recorder: Recorder<S>,
    signals: Signals<S>,
}

moving!(Simulation { motion, command, ticks, status, recorder, signals } { rover, step_size });

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
            Motion::new(&rover, state, &command).map_err(|source| StepError::Dynamics { time: 0.0, source })?;
        let signals = Signals::of(rover.wheels.len(), rover.links.len());
        let recorder = Recorder::new(&rover.effects.sensor_lag, &signals, step_size);
        let mut simulation =
            Self { rover, motion, command, step_size, ticks: 0, status: Status::Running, recorder, signals };
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
    pub(crate) fn apply(&mut self, command: &Command) -> Result<(), StepError> {
        check_command(command, self.rover.wheels.len())?;
        if self.command != *command && self.status == Status::Running {
            self.change_command(command).map_err(|source| StepError::Dynamics { time: self.time(), source })?;
        }
        Ok(())
    }

    fn change_command(&mut self, command: &Command) -> Result<(), DynamicsError> {
        self.motion.change_command(&self.rover, command, S::Mask::from_lanes(|_| true))?;
        self.command.drive = command.drive;
        self.command.values.copy_from_slice(&command.values);
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
        let Motion { state, integrator, energies, .. } = &self.motion;
        integrator.now.write_signals(&self.rover, state, energies, &mut self.signals);
        self.rover.effects.record(state.start_x, &mut self.signals.body, &mut self.signals.wheels);
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

    /// What a step moves.
    pub(crate) fn motion(&self) -> &Motion<S> {
        &self.motion
    }

    /// Places for what another has reckoned: the motion, the steps made, the status, the true signals.
    pub(crate) fn places(&mut self) -> Places<'_, S> {
        let Self { motion, ticks, status, signals, command, .. } = self;
        Places { motion, ticks, status, signals, command }
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

/// Places of a simulation that another may write.
pub(crate) struct Places<'a, S: Scalar> {
    pub motion: &'a mut Motion<S>,
    pub ticks: &'a mut u64,
    pub status: &'a mut Status,
    pub signals: &'a mut Signals<S>,
    pub command: &'a mut Command,
}

/// Least height of the belly, a straight line between the outer wheels of the chassis, above the ground, m.
#[cfg_attr(feature = "batch", inline(always))]
pub(crate) fn belly_clearance<S: Scalar>(rover: &Rover<S>, state: &State<S>) -> S::Plain {
    const POINTS: usize = 7;
    let mounts = &rover.wheels;
    let (rear, front) = (mounts[0].mount.x.plain(), mounts[mounts.len() - 1].mount.x.plain());
    let (sin, cos) = state.position[2].plain().sine_cosine();
    let belly = rover.body.belly_z.plain();
    let mut least = S::Plain::from(f64::INFINITY);
    for i in 1..=POINTS {
        let along = rear + (front - rear) * i as f64 / (POINTS + 1) as f64;
        let x = state.position[0].plain() + cos * along - sin * belly;
        let z = state.position[1].plain() + sin * along + cos * belly;
        least = least.smaller(z - rover.terrain.at(S::from_plain(x)).height.plain());
    }
    least
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

/// Speed along the path, signed by its direction along x; its real part is `hypot`'s to the last bit.
pub(crate) fn path_speed<S: Scalar>(vx: S, vz: S) -> S {
    if S::Plain::LANES > 1 {
        let (vx, vz) = (vx.plain(), vz.plain());
        return S::from_plain(Plain::from_lanes(|k| path_speed(vx.lane(k), vz.lane(k))));
    }
    let speed = vx.value().hypot(vz.value()).copysign(vx.value());
    if speed == 0.0 {
        return S::from(speed);
    }
    // d|v| = (vx dvx + vz dvz)/|v|.
    let change = |v: S| (v - v.value()) * (v.value() / speed);
    change(vx) + change(vz) + speed
}

impl<S: Scalar> Evaluation<S> {
    /// Writes the true signals at this instant.
    pub(crate) fn write_signals(
        &self,
        rover: &Rover<S>,
        state: &State<S>,
        energies: &Energies<S>,
        signals: &mut Signals<S>,
    ) {
        let powers = self.powers();
        let [vx, vz] = [state.rate[0], state.rate[1]];
        let body = &mut signals.body;
        body.x = state.position[0];
        body.z = state.position[1];
        body.velocity = path_speed(vx, vz);
        body.pitch = state.position[2];
        body.pitch_rate = state.rate[2];
        body.power = powers.dissipated;
        body.electrical_power = powers.electrical;
        body.dissipated_energy = energies.dissipated;
        body.electrical_energy = energies.electrical;
        body.drive_work = energies.drive;
        body.soil_loss = energies.soil_loss;
        body.other_loss = energies.other_loss;
        body.mechanical_energy = self.mechanical_energy(rover, state);
        for (signals, wheel) in signals.wheels.iter_mut().zip(&self.wheels) {
            signals.speed = wheel.speed;
            signals.slip = wheel.slip;
            signals.sinkage = wheel.sinkage;
            signals.normal_force = wheel.touch.forces.normal;
            signals.drawbar_pull = wheel.touch.forces.drawbar;
            signals.torque = wheel.motor_torque;
            signals.current = wheel.current;
            signals.contact_angle = wheel.contact_angle;
        }
        for (j, link) in signals.links.iter_mut().enumerate() {
            link.angle = state.position[3 + j];
            link.rate = state.rate[3 + j];
        }
    }
}

impl<S: Copy> Energies<S> {
    /// The same over another scalar.
    pub fn map<T>(&self, f: &dyn Fn(S) -> T) -> Energies<T> {
        let Self { dissipated, electrical, drive, soil_loss, other_loss } = *self;
        let [dissipated, electrical, drive] = [dissipated, electrical, drive].map(f);
        let [soil_loss, other_loss] = [soil_loss, other_loss].map(f);
        Energies { dissipated, electrical, drive, soil_loss, other_loss }
    }
}

impl<S: Scalar> Energies<S> {
    pub fn zero() -> Self {
        let zero = S::from(0.0);
        Self { dissipated: zero, electrical: zero, drive: zero, soil_loss: zero, other_loss: zero }
    }

    /// Trapezoidal rule over one step: the order of the integrator.
    #[cfg_attr(feature = "batch", inline(always))]
    pub fn add(&mut self, before: &Powers<S>, after: &Powers<S>, h: f64) {
        let mean = always(
            #[cfg_attr(feature = "batch", inline(always))]
            |a: S, b: S| (a + b) * (0.5 * h),
        );
        self.dissipated += mean(before.dissipated, after.dissipated);
        self.electrical += mean(before.electrical, after.electrical);
        self.drive += mean(before.drive, after.drive);
        self.soil_loss += mean(before.soil_loss, after.soil_loss);
        self.other_loss += mean(before.other_loss, after.other_loss);
    }
}
