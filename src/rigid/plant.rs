//! The plant of rigid bodies in motion.

use super::contacts::{Before, RigidLoad};
use super::loads::Loads;
use super::world::World;
use crate::integrator::{Integrator, dig};
use crate::linear::{add_scaled, zeros};
use crate::obstacle::Obstacle;
use crate::recording::Recorder;
use crate::rover::dynamics::{DynamicsError, Outside};
use crate::rover::kinematics::turn_jacobian;
use crate::rover::{Rover, State};
use crate::signals::{Command, Drive, Signals};
use crate::simulation::{Energies, Event, Status, StepError, TIPPED, Window, check_command};
use crate::terrain::TerrainError;
use std::fmt;

/// A rover of rigid bodies in motion. Cloning it is a snapshot: the clone goes on to the same bits.
#[derive(Clone)]
pub struct RigidBodies {
    pub(super) rover: Rover,
    pub(super) state: State,
    /// The state before the present step.
    pub(super) previous: State,
    pub(super) integrator: Integrator,
    pub(super) world: World,
    pub(super) loads: Loads,
    /// Rigid contacts of the wheels, then of chassis and links, over the last step.
    pub(super) wheel_contacts: Vec<RigidLoad>,
    pub(super) body_contacts: Vec<RigidLoad>,
    pub(super) wheels_before: Vec<Before>,
    pub(super) bodies_before: Vec<Before>,
    pub(super) command: Command,
    step_size: f64,
    ticks: u64,
    pub(super) energies: Energies<f64>,
    window: Window,
    status: Status,
    recorder: Recorder,
    pub(super) signals: Signals,
}

impl fmt::Debug for RigidBodies {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RigidBodies").field("rover", &self.rover).field("state", &self.state).finish_non_exhaustive()
    }
}

impl RigidBodies {
    /// A rover at rest above `x0` (m), settled on its soil, among `obstacles`, stepped by `step_size` (s). Chassis and
    /// links slide on the ground with `belly_friction`.
    ///
    /// # Errors
    /// [`StepError::Settle`] where it finds no rest, [`StepError::StepSize`], [`StepError::ObstacleAtStart`].
    pub fn new(
        rover: Rover,
        x0: f64,
        step_size: f64,
        obstacles: &[Obstacle],
        belly_friction: f64,
    ) -> Result<Self, StepError> {
        let state = rover.settled_at(x0)?;
        Self::from_state(rover, state, step_size, obstacles, belly_friction)
    }

    /// A rover in a given state.
    ///
    /// # Errors
    /// [`StepError::StepSize`], [`StepError::Dynamics`], [`StepError::ObstacleAtStart`].
    pub fn from_state(
        rover: Rover,
        mut state: State,
        step_size: f64,
        obstacles: &[Obstacle],
        belly_friction: f64,
    ) -> Result<Self, StepError> {
        if !(step_size > 0.0 && step_size <= 0.02) {
            return Err(StepError::StepSize(step_size));
        }
        let wheels = rover.wheels.len();
        let command = Command::torque(vec![0.0; wheels]);
        let mut integrator = Integrator::new(&rover, &state);
        let outside = Box::new(Outside { force: zeros(), torque: vec![0.0; wheels] });
        integrator.now.outside = Some(outside.clone());
        integrator.ahead.outside = Some(outside);
        integrator
            .evaluate(&rover, &mut state, &command)
            .map_err(|source| StepError::Dynamics { time: 0.0, source })?;
        let world = World::new(&rover, &state, obstacles, belly_friction, step_size);
        if let Some(k) = world.obstacle_touched() {
            let x = obstacles.get(k).map_or(f64::NAN, |obstacle| obstacle.parameters.x);
            return Err(StepError::ObstacleAtStart { obstacle: k + 1, x });
        }
        let bodies = 1 + rover.links.len();
        let signals = Signals::of(wheels, rover.links.len());
        let mut plant = Self {
            previous: state.clone(),
            integrator,
            world,
            loads: Loads::new(&rover),
            wheel_contacts: vec![RigidLoad::default(); wheels],
            body_contacts: vec![RigidLoad::default(); bodies],
            wheels_before: vec![Before::default(); wheels],
            bodies_before: vec![Before::default(); bodies],
            command,
            step_size,
            ticks: 0,
            energies: Energies::zero(),
            window: Window::at(state.position[0]),
            status: Status::Running,
            recorder: Recorder::new(&rover.effects, &signals, step_size),
            signals,
            rover,
            state,
        };
        plant.observe(Recorder::step);
        plant.refresh();
        Ok(plant)
    }

    /// Applies `command` and makes `steps` inner steps with it.
    ///
    /// # Errors
    /// [`StepError`]; one of the dynamics leaves bodies that cannot go on.
    pub fn advance(&mut self, command: &Command, steps: u64) -> Result<Status, StepError> {
        check_command(command, self.rover.wheels.len())?;
        self.hold(command.drive, &|k| command.values[k])?;
        self.go_on(steps)
    }

    /// Takes the command `value(k)` of each wheel k over, which must be finite; it holds from now on.
    ///
    /// # Errors
    /// [`StepError::Dynamics`], after which the bodies cannot go on.
    pub(crate) fn hold(&mut self, drive: Drive, value: &dyn Fn(usize) -> f64) -> Result<(), StepError> {
        if self.command.is(drive, value) || self.status != Status::Running {
            return Ok(());
        }
        self.command.set(drive, value);
        self.take_command_over().map_err(|source| StepError::Dynamics { time: self.time(), source })
    }

    /// Makes `steps` inner steps with the command that holds.
    ///
    /// # Errors
    /// As [`RigidBodies::advance`].
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

    /// The new command acts; where it imposes other speeds, the impulse counts as work of the drives.
    fn take_command_over(&mut self) -> Result<(), DynamicsError> {
        let before = self.integrator.now.mechanical_energy(&self.rover, &self.state);
        self.integrator.impose(&self.rover, &mut self.state, &self.command, true)?;
        self.integrator.evaluate(&self.rover, &mut self.state, &self.command)?;
        match self.command.drive {
            Drive::Torque => self.world.impose(None),
            Drive::Speed => {
                self.world.set_motion(&self.rover, &self.state);
                self.world.impose(Some(&self.command.values));
            }
        }
        let after = self.integrator.now.mechanical_energy(&self.rover, &self.state);
        self.energies.drive += after - before;
        self.observe(Recorder::jump);
        Ok(())
    }

    fn step(&mut self) -> Result<(), StepError> {
        let h = self.step_size;
        let before = self.integrator.now.powers();
        self.previous.copy_from(&self.state);
        let moved = self.move_bodies(h).and_then(|()| self.evaluate()).and_then(|()| self.find_drives(h));
        match moved {
            Ok(()) => {}
            Err(DynamicsError::Terrain { source: TerrainError::Left { .. }, .. }) => {
                self.state.copy_from(&self.previous);
                self.status = Status::Ended(Event::LeftTerrain);
                return Ok(());
            }
            Err(source) => return Err(StepError::Dynamics { time: self.time(), source }),
        }
        self.ticks += 1;
        self.integrator.warm(&self.rover, &mut self.state, h);
        self.add_energies(&before, h);
        self.observe(Recorder::step);
        self.check_events();
        Ok(())
    }

    /// Lets the bodies move for a step under the mean forces of soil and drives.
    fn move_bodies(&mut self, h: f64) -> Result<(), DynamicsError> {
        self.integrator.stages(&self.rover, &self.state, &self.command, h)?;
        self.loads.set(&self.rover, &self.integrator, self.command.drive, h);
        let (first, second) = (&self.integrator.first.wheels, &self.integrator.second.wheels);
        for (k, wheel) in self.state.wheels.iter_mut().enumerate() {
            wheel.hold.travel += (1.5 * first[k][1] + 0.5 * second[k][1]) * h;
            wheel.hold.turn += (1.5 * first[k][2] + 0.5 * second[k][2]) * h;
            wheel.hold = wheel.hold.bounded();
        }
        let Integrator { now, ahead, .. } = &self.integrator;
        dig(&self.rover, [now, ahead], &mut self.state, h);
        for (before, handle) in self.wheels_before.iter_mut().zip(&self.world.wheels) {
            *before = self.world.motion_of(*handle);
        }
        for (before, handle) in self.bodies_before.iter_mut().zip(&self.world.carriers) {
            *before = self.world.motion_of(*handle);
        }
        self.world.step(&self.rover, &self.loads.wheels, &self.loads.links, self.loads.resistance)?;
        self.world.read(&self.rover, &mut self.state);
        self.read_contacts(h);
        Ok(())
    }

    fn read_contacts(&mut self, h: f64) {
        let world = &self.world;
        for (k, load) in self.wheel_contacts.iter_mut().enumerate() {
            *load = RigidLoad::default();
            world.add_contacts(world.wheel_colliders[k], world.wheels[k], &self.wheels_before[k], h, load);
        }
        self.body_contacts.iter_mut().for_each(|load| *load = RigidLoad::default());
        for &(collider, body) in &world.body_colliders {
            let load = &mut self.body_contacts[body];
            world.add_contacts(collider, world.carriers[body], &self.bodies_before[body], h, load);
        }
    }

    /// Evaluates soil and drives at the new state, with the rigid contacts as they were on the mean of the step.
    fn evaluate(&mut self) -> Result<(), DynamicsError> {
        self.set_outside();
        self.integrator.ahead.update(&self.rover, &self.state, &self.command)?;
        std::mem::swap(&mut self.integrator.now, &mut self.integrator.ahead);
        for (wheel, evaluation) in self.state.wheels.iter_mut().zip(&self.integrator.now.wheels) {
            wheel.spin = evaluation.spin;
            if evaluation.sinkage > 0.0 {
                wheel.track.extend(evaluation.foot_x, true);
            }
        }
        Ok(())
    }

    /// The rigid contacts as generalised forces, for the next step's stages.
    fn set_outside(&mut self) {
        let n = self.rover.coordinates();
        let mut force = zeros();
        let frames = &mut self.integrator.ahead.frames;
        frames.update(&self.rover, &self.state.position, &self.state.rate);
        for (load, wheel) in self.wheel_contacts.iter().zip(&self.rover.wheels) {
            let centre = frames.point(&self.rover, wheel.body, [wheel.mount.x, wheel.mount.z]);
            add_scaled(&mut force, 1.0, &centre.along(load.force, n), n);
        }
        for (body, load) in self.body_contacts.iter().enumerate() {
            let centre = frames.point(&self.rover, body, self.world.centre(body));
            add_scaled(&mut force, 1.0, &centre.along(load.force, n), n);
            add_scaled(&mut force, load.moment, &turn_jacobian(&self.rover, body), n);
        }
        for evaluation in [&mut self.integrator.now, &mut self.integrator.ahead] {
            if let Some(outside) = &mut evaluation.outside {
                outside.force = force;
                // A wheel that turns forward turns clockwise.
                let torques = outside.torque.iter_mut().zip(&self.wheel_contacts);
                torques.for_each(|(torque, load)| *torque = -load.moment);
            }
        }
    }

    fn check_events(&mut self) {
        let radius = self.rover.true_wheel().radius;
        let wheels = &self.integrator.now.wheels;
        if self.state.position[2].abs() > TIPPED {
            self.status = Status::Ended(Event::TippedOver);
        } else if wheels.iter().any(|wheel| wheel.sinkage >= radius) {
            self.status = Status::Ended(Event::SunkToAxle);
        }
        let speeds = wheels.iter().map(|wheel| wheel.speed);
        if self.window.stuck(self.state.position[0], speeds, radius, self.step_size) && self.status == Status::Running {
            self.status = Status::Ended(Event::Stuck);
        }
    }

    /// Lets a recorder that lags take in the present signals.
    fn observe(&mut self, take: fn(&mut Recorder, &mut Signals)) {
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

    /// Whether a wheel, a link or the chassis touched anything rigid in the last step.
    #[must_use]
    pub fn touches(&self) -> bool {
        self.wheel_contacts.iter().chain(&self.body_contacts).any(|contact| contact.normal != [0.0, 0.0])
    }

    /// Mean force of obstacles and ground on chassis (0) or link k over the last step, [x, z], N.
    #[must_use]
    pub fn body_contact_force(&self, body: usize) -> [f64; 2] {
        self.body_contacts.get(body).map_or([0.0; 2], |contact| contact.force)
    }

    /// Mean force of obstacles on wheel k (0 at the rear) over the last step, [x, z], N.
    #[must_use]
    pub fn wheel_contact_force(&self, wheel: usize) -> [f64; 2] {
        self.wheel_contacts.get(wheel).map_or([0.0; 2], |contact| contact.force)
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
    pub fn signals(&self) -> &Signals {
        &self.signals
    }

    /// Whether the run goes on.
    #[must_use]
    pub fn status(&self) -> Status {
        self.status
    }

    /// The rover.
    #[must_use]
    pub fn rover(&self) -> &Rover {
        &self.rover
    }

    /// The moving data in joint coordinates.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Whether the last command was torques or speeds.
    #[must_use]
    pub fn drive(&self) -> Drive {
        self.command.drive
    }
}
