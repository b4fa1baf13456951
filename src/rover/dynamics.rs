//! The equations of motion: M(q) u' = Q(q, u, wheels, command), explicit in the accelerations.

use super::kinematics::{Frames, turn_jacobian};
use super::{LinkParameters, Rover, State, Track};
use crate::contact::{Motion, Surface, Touch, slip, touch};
use crate::effects::{BodyMotion, Digging, ExpressionFailure, Place};
use crate::linear::{Factors, Matrix, Vector, add_outer, add_scaled, dot, zeros};
use crate::motor::{self, Motor};
use crate::scalar::{LaneAccess, Scalar, lanes};
use crate::signals::{Command, Drive};
use crate::snapshot::Moving;
use crate::terrain::TerrainError;

/// Why the right-hand side could not be evaluated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DynamicsError {
    /// A wheel is beyond the known ground.
    #[error("wheel {wheel}: {source}")]
    Terrain {
        /// Wheel, from 1 at the rear.
        wheel: usize,
        /// What the terrain says.
        source: TerrainError,
    },
    /// An effect of the user's own gives a value without a meaning.
    #[error(transparent)]
    Effect(#[from] ExpressionFailure),
    /// The mass matrix is singular or something is not finite.
    #[error("the equations of motion have no finite solution (state or parameters are not finite)")]
    NotFinite,
}

/// One wheel at one instant.
#[derive(Clone, Debug, Moving, LaneAccess)]
pub(crate) struct WheelEvaluation<S> {
    pub touch: Touch<S>,
    /// Jacobians of the wheel centre along the ground's normal and tangent.
    pub normal: Vector<S>,
    pub tangent: Vector<S>,
    /// Jacobian of the angle of the body that carries the wheel.
    pub turn: Vector<S>,
    /// Velocity of the wheel centre along the tangent and the normal.
    pub velocity: S,
    pub normal_velocity: S,
    /// Absolute rate of turning, and relative to the carrying body.
    pub spin: S,
    pub speed: S,
    pub slip: S,
    pub sinkage: S,
    pub contact_angle: S,
    /// The motor as it is, warm or not of its data sheet.
    pub motor: Motor<S>,
    /// Position of the contact foot along x, m.
    pub foot_x: S,
    /// Torque of the motor and of the rim, both on the wheel's side of the gear.
    pub motor_torque: S,
    pub rim_torque: S,
    pub current: S,
    /// Slope of the rim torque in the wheel speed (friction, gear, back-EMF), for the implicit integrator.
    pub drive_slope: S,
}

/// Powers at one instant, W, whose integrals are the energies among the signals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Powers<S> {
    pub dissipated: S,
    pub electrical: S,
    pub drive: S,
    pub soil_loss: S,
    pub other_loss: S,
}

/// Forces that neither soil nor drives make: rigid contacts, as the plant of rigid bodies finds them.
#[derive(Clone, Debug)]
#[cfg_attr(not(feature = "rigid"), allow(dead_code, reason = "the plant of rigid bodies reads it"))]
pub(crate) struct Outside<S> {
    /// Generalised force of all of them.
    pub force: Vector<S>,
    /// Moment on each wheel about its axle, driving it forward positive, N m.
    pub torque: Vec<S>,
}

/// The right-hand side of the equations of motion at one instant, with everything that led to it.
#[derive(Clone, Debug, Moving, LaneAccess)]
pub(crate) struct Evaluation<S> {
    pub frames: Frames<S>,
    /// Mass matrix of chassis and links.
    pub mass: Matrix<S>,
    /// Mass matrix of the system: with the wheels' inertia where their speed is imposed.
    pub system: Matrix<S>,
    pub wheels: Vec<WheelEvaluation<S>>,
    pub acceleration: Vector<S>,
    /// Dry friction of each joint over its rate, N m s/rad, for the implicit integrator.
    pub joint_friction: Vector<S>,
    /// Moment of each joint's stop on its link, N m, and its slopes against angle and rate, for the implicit integrator.
    pub stop_moment: Vector<S>,
    pub stop_stiffness: Vector<S>,
    pub stop_damping: Vector<S>,
    pub potential: S,
    /// Power that joint friction and forces on the chassis take, W.
    pub other_loss: S,
    /// Horizontal force on the chassis at its reference point, N.
    #[cfg_attr(not(feature = "rigid"), allow(dead_code, reason = "the plant of rigid bodies reads it"))]
    pub resistance: S,
    /// Forces from outside; none in joint coordinates alone.
    #[not_moving]
    pub outside: Option<Box<Outside<S>>>,
}

impl<S: Scalar> Evaluation<S> {
    pub fn new(rover: &Rover<S>) -> Self {
        let wheels =
            rover.wheels.iter().map(|w| WheelEvaluation::new(turn_jacobian(rover, w.body), rover.motor)).collect();
        Self {
            frames: Frames::new(rover),
            mass: [zeros(); super::MAX_COORDINATES],
            system: [zeros(); super::MAX_COORDINATES],
            wheels,
            acceleration: zeros(),
            joint_friction: zeros(),
            stop_moment: zeros(),
            stop_stiffness: zeros(),
            stop_damping: zeros(),
            potential: S::from(0.0),
            other_loss: S::from(0.0),
            resistance: S::from(0.0),
            outside: None,
        }
    }
}

#[lanes]
impl<S: Scalar> Evaluation<S> {
    /// Evaluates the right-hand side at `state` under `command`, plain, with derivatives, or side by side: then an error
    /// says that one of them at least has one.
    #[lanes(entry)]
    pub fn update<C: Copy + Into<S>>(
        &mut self,
        rover: &Rover<S>,
        state: &State<S>,
        command: &Command<C>,
    ) -> Result<(), DynamicsError> {
        S::wide(|| {
            let n = rover.coordinates();
            self.frames.update(rover, &state.position, &state.rate);
            let mut force = zeros();
            self.add_bodies(rover, state, &mut force)?;
            for (row, mass) in self.system.iter_mut().zip(&self.mass).take(n) {
                row[..n].copy_from_slice(&mass[..n]);
            }
            for k in 0..rover.wheels.len() {
                self.touch_ground(rover, state, (command.drive, command.values[k].into()), k)?;
                let wheel = &mut self.wheels[k];
                let (forces, body_torque) = (wheel.touch.forces, &mut wheel.rim_torque);
                match command.drive {
                    Drive::Torque => {}
                    // The drive gives what the soil takes; the wheel's inertia moves with its body.
                    Drive::Speed => {
                        *body_torque = forces.torque;
                        if let Some(outside) = &self.outside {
                            *body_torque -= outside.torque[k];
                        }
                        add_outer(&mut self.system, rover.wheel.inertia, &wheel.turn, &wheel.turn, n);
                    }
                }
                let reaction = *body_torque;
                add_scaled(&mut force, forces.normal, &wheel.normal, n);
                add_scaled(&mut force, forces.drawbar, &wheel.tangent, n);
                add_scaled(&mut force, reaction, &wheel.turn, n);
            }
            if let Some(outside) = &self.outside {
                add_scaled(&mut force, S::from(1.0), &outside.force, n);
            }
            let factors = Factors::new(&self.system, n).ok_or(DynamicsError::NotFinite)?;
            self.acceleration = factors.solve(&force);
            if !self.acceleration[..n].iter().all(|a| a.plain().all_finite()) {
                return Err(DynamicsError::NotFinite);
            }
            self.finish_drives(rover, command.drive)
        })
    }

    /// Weight, inertia and joint friction of chassis and links, and forces on the chassis.
    fn add_bodies(&mut self, rover: &Rover<S>, state: &State<S>, force: &mut Vector<S>) -> Result<(), DynamicsError> {
        let n = rover.coordinates();
        for row in self.mass.iter_mut().take(n) {
            row[..n].fill(S::from(0.0));
        }
        self.potential = S::from(0.0);
        self.other_loss = S::from(0.0);
        let body = rover.true_body();
        self.add_mass(rover, 0, [body.centre_of_mass_x, body.centre_of_mass_z], (body.mass, body.pitch_inertia), force);
        for (j, link) in rover.links.iter().enumerate() {
            let p = &link.parameters;
            self.add_mass(rover, j + 1, [p.centre_of_mass_x, p.centre_of_mass_z], (p.mass, p.inertia), force);
            self.joint_friction[j] = rover.effects.joint_friction(state.rate[3 + j]);
            let friction = (p.damping + self.joint_friction[j]) * state.rate[3 + j];
            force[3 + j] -= friction;
            self.other_loss += friction * state.rate[3 + j];
            self.add_stop(p, j, (state.position[3 + j], state.rate[3 + j]), force);
        }
        let travelled = state.position[0] - state.start_x;
        let resistance = rover.effects.body_force(&BodyMotion { travelled, velocity: state.rate[0] })?;
        force[0] += resistance;
        self.resistance = resistance;
        self.other_loss -= resistance * state.rate[0];
        debug_assert!(n <= super::MAX_COORDINATES);
        Ok(())
    }

    /// The stop of joint `j` at this angle and rate.
    fn add_stop(&mut self, link: &LinkParameters<S>, j: usize, (angle, rate): (S, S), force: &mut Vector<S>) {
        let stop = link.at_stop(angle, rate);
        force[3 + j] += stop.moment;
        (self.stop_moment[j], self.stop_stiffness[j], self.stop_damping[j]) =
            (stop.moment, stop.stiffness, stop.damping);
        self.potential += stop.energy;
        self.other_loss += stop.loss;
    }

    fn add_mass(
        &mut self,
        rover: &Rover<S>,
        body: usize,
        centre: [S; 2],
        (mass, inertia): (S, S),
        force: &mut Vector<S>,
    ) {
        let n = rover.coordinates();
        let point = self.frames.point(rover, body, centre);
        let turn = turn_jacobian(rover, body);
        add_outer(&mut self.mass, mass, &point.jacobian_x, &point.jacobian_x, n);
        add_outer(&mut self.mass, mass, &point.jacobian_z, &point.jacobian_z, n);
        add_outer(&mut self.mass, inertia, &turn, &turn, n);
        let gravity = rover.environment.gravity;
        add_scaled(force, -(mass * point.bias[0]), &point.jacobian_x, n);
        add_scaled(force, -(mass * (point.bias[1] + gravity)), &point.jacobian_z, n);
        self.potential += mass * gravity * point.position[1];
    }

    /// Contact of wheel `k` with the ground, and the torque of its drive where that is commanded.
    fn touch_ground(
        &mut self,
        rover: &Rover<S>,
        state: &State<S>,
        (drive, asked): (Drive, S),
        k: usize,
    ) -> Result<(), DynamicsError> {
        let mount = &rover.wheels[k];
        let centre = self.frames.point(rover, mount.body, [mount.mount.x, mount.mount.z]);
        let foot =
            rover.terrain.foot(centre.position).map_err(|source| DynamicsError::Terrain { wheel: k + 1, source })?;
        let wheel = &mut self.wheels[k];
        let n = state.rate.len();
        wheel.normal = centre.along(foot.normal, n);
        wheel.tangent = centre.along(foot.tangent, n);
        let mut rate = zeros();
        rate[..n].copy_from_slice(&state.rate);
        wheel.velocity = dot(&wheel.tangent, &rate, n);
        wheel.normal_velocity = dot(&wheel.normal, &rate, n);
        // An encoder sees the wheel relative to its body, the soil sees the absolute rate: nose-up
        // turning of the body takes from the forward turning of the wheel.
        let body_rate = self.frames.rate(mount.body);
        (wheel.spin, wheel.speed) = match drive {
            Drive::Torque => (state.wheels[k].spin, state.wheels[k].spin + body_rate),
            Drive::Speed => (asked - body_rate, asked),
        };
        let (true_wheel, x) = (rover.true_wheel(), foot.position[0]);
        let soil = rover.terrain.soil(&rover.soil, x);
        let motion = Motion {
            sinkage: true_wheel.radius - foot.distance,
            normal_velocity: wheel.normal_velocity,
            velocity: wheel.velocity,
            spin: wheel.spin,
            hold: state.wheels[k].hold,
        };
        let tracks = state.wheels.iter().map(|wheel| &wheel.track);
        let place = Place {
            wheel: k,
            x: Some(x),
            passes: if rover.effects.counts_passes() { Track::passes(tracks, k, x) } else { S::from(0.0) },
            contact_angle: foot.angle,
            slip: motion.established_slip(&true_wheel, &soil),
            dug_slip: state.wheels[k].dug_slip,
            sinkage: motion.sinkage,
            normal_velocity: wheel.normal_velocity,
            velocity: wheel.velocity,
        };
        let (touched, sunk) = (&mut wheel.touch, &mut wheel.sinkage);
        let (local, _) = rover.effects.contact(&place, true_wheel, soil, move |local| {
            let motion = Motion { sinkage: local.wheel.radius - foot.distance, ..motion };
            *touched = touch(&local.wheel, &local.soil, &local.surface, &motion);
            *sunk = touched.sinkage;
            touched
        })?;
        wheel.slip = slip(wheel.velocity, rover.effects.recorded_radius(local.wheel.radius) * wheel.spin);
        wheel.contact_angle = foot.angle;
        wheel.foot_x = x;
        wheel.motor = rover.motor;
        rover.effects.motor(state.wheels[k].winding_rise, &mut wheel.motor);
        if drive == Drive::Torque {
            let driven = motor::drive(&rover.motor, &wheel.motor, &rover.effects, wheel.speed, asked)?;
            wheel.motor_torque = driven.motor_torque;
            wheel.rim_torque = driven.rim_torque;
            wheel.drive_slope = driven.slope;
        }
        Ok(())
    }

    /// Torques and currents that follow from the accelerations.
    fn finish_drives(&mut self, rover: &Rover<S>, drive: Drive) -> Result<(), DynamicsError> {
        let n = rover.coordinates();
        for wheel in &mut self.wheels {
            if drive == Drive::Speed {
                wheel.rim_torque -= rover.wheel.inertia * dot(&wheel.turn, &self.acceleration, n);
                wheel.motor_torque = motor::torque_behind(&rover.effects, wheel.speed, wheel.rim_torque)?;
                wheel.drive_slope = S::from(0.0);
            }
            wheel.current = motor::current(&wheel.motor, wheel.motor_torque);
        }
        Ok(())
    }

    /// Angular acceleration of a wheel whose drive torque is commanded.
    pub fn spin_rate(&self, rover: &Rover<S>, k: usize) -> S {
        let torque = self.wheels[k].rim_torque - self.wheels[k].touch.forces.torque;
        let torque = self.outside.as_ref().map_or(torque, |outside| torque + outside.torque[k]);
        torque / rover.wheel.inertia
    }

    /// Powers of the drives and of the soil.
    pub fn powers(&self) -> Powers<S> {
        let zero = S::from(0.0);
        let other_loss = self.other_loss;
        let mut sum = Powers { dissipated: zero, electrical: zero, drive: zero, soil_loss: zero, other_loss };
        for wheel in &self.wheels {
            let winding = wheel.winding_power();
            let forces = &wheel.touch.forces;
            sum.dissipated += winding;
            sum.electrical += winding + wheel.motor_torque * wheel.speed;
            sum.drive += wheel.rim_torque * wheel.speed;
            sum.soil_loss +=
                forces.torque * wheel.spin - forces.normal * wheel.normal_velocity - forces.drawbar * wheel.velocity;
        }
        sum
    }

    /// Warms the windings over `h` seconds, at whose start `before` held, and renews what depends on them.
    pub fn warm(&mut self, rover: &Rover<S>, before: &Self, state: &mut State<S>, h: f64) {
        for ((wheel, before), moving) in self.wheels.iter_mut().zip(&before.wheels).zip(&mut state.wheels) {
            let mean = (before.winding_power() + wheel.winding_power()) * 0.5;
            let Some(warming) = rover.effects.warming(mean) else { return };
            moving.winding_rise = warming.after(moving.winding_rise, h);
            wheel.motor = rover.motor;
            rover.effects.motor(moving.winding_rise, &mut wheel.motor);
            wheel.current = motor::current(&wheel.motor, wheel.motor_torque);
        }
    }

    /// Kinetic and potential energy, J.
    pub fn mechanical_energy(&self, rover: &Rover<S>, state: &State<S>) -> S {
        let n = rover.coordinates();
        let mut twice = S::from(0.0);
        for i in 0..n {
            for j in 0..n {
                twice += state.rate[i] * self.mass[i][j] * state.rate[j];
            }
        }
        for wheel in &self.wheels {
            twice += rover.wheel.inertia * wheel.spin * wheel.spin;
        }
        self.potential + twice * 0.5
    }
}

#[lanes]
impl<S: Scalar> WheelEvaluation<S> {
    fn new(turn: Vector<S>, motor: Motor<S>) -> Self {
        let o = S::from(0.0);
        let motion = Motion { sinkage: o, normal_velocity: o, velocity: o, spin: o, hold: Default::default() };
        Self {
            touch: touch(&Default::default(), &Default::default(), &Surface::default(), &motion),
            normal: zeros(),
            tangent: zeros(),
            turn,
            velocity: o,
            normal_velocity: o,
            spin: o,
            speed: o,
            slip: o,
            sinkage: o,
            contact_angle: o,
            motor,
            foot_x: o,
            motor_torque: o,
            rim_torque: o,
            current: o,
            drive_slope: o,
        }
    }

    /// How the wheel digs in the ground under it, with the radius (m) of the true wheel.
    pub fn digging(&self, radius: S) -> Digging<S> {
        Digging::new(self.velocity, radius * self.spin, self.sinkage.over(0.0))
    }

    /// Power dissipated in the winding, W (4.6).
    pub fn winding_power(&self) -> S {
        self.motor.resistance * self.current * self.current
    }
}
