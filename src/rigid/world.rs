//! The rapier world of one rover: bodies, joints, colliders, and one step of them.

use super::bodies::{Carrier, motions, parent};
use super::rapier::*;
use super::shapes::GroundCollider;
use crate::rover::{DynamicsError, Rover, State};

/// Damping of the motor that imposes a wheel's speed, N m s/rad: 1e6 times what the soil of a small rover can do.
const IMPOSING: f64 = 1e6;
/// Loads of one step on one wheel, N and N m.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WheelLoad {
    /// Force of the soil on the wheel at its centre, [x, z].
    pub force: [f64; 2],
    /// Moment of the soil that the drive must balance.
    pub soil_torque: f64,
    /// Torque of the drive on the rim.
    pub rim_torque: f64,
}

/// All rapier data of one rover. Its clone goes on to the same bits.
pub(super) struct World {
    pub(super) gravity: Vector,
    pub(super) parameters: IntegrationParameters,
    pub(super) pipeline: PhysicsPipeline,
    pub(super) islands: IslandManager,
    pub(super) broad_phase: DefaultBroadPhase,
    pub narrow_phase: NarrowPhase,
    pub bodies: RigidBodySet,
    pub(super) colliders: ColliderSet,
    pub(super) joints: ImpulseJointSet,
    pub(super) multibodies: MultibodyJointSet,
    pub(super) soft_bodies: SoftBodySet,
    pub(super) ccd: CCDSolver,
    /// Chassis, then links.
    pub(super) masses: Vec<Carrier>,
    pub carriers: Vec<RigidBodyHandle>,
    pub wheels: Vec<RigidBodyHandle>,
    pub wheel_colliders: Vec<ColliderHandle>,
    /// Colliders of chassis and links with the carrier that they belong to.
    pub body_colliders: Vec<(ColliderHandle, usize)>,
    /// Joints of the wheels on their axles.
    pub(super) axles: Vec<MultibodyJointHandle>,
    pub obstacles: Vec<ColliderHandle>,
    pub(super) ground: GroundCollider,
    pub(super) ground_collider: ColliderHandle,
    pub(super) imposing: bool,
}

impl Clone for World {
    fn clone(&self) -> Self {
        Self {
            gravity: self.gravity,
            parameters: self.parameters,
            // Working memory only.
            pipeline: PhysicsPipeline::new(),
            islands: self.islands.clone(),
            broad_phase: self.broad_phase.clone(),
            narrow_phase: self.narrow_phase.clone(),
            bodies: self.bodies.clone(),
            colliders: self.colliders.clone(),
            joints: self.joints.clone(),
            multibodies: self.multibodies.clone(),
            soft_bodies: SoftBodySet::new(),
            ccd: self.ccd.clone(),
            masses: self.masses.clone(),
            carriers: self.carriers.clone(),
            wheels: self.wheels.clone(),
            wheel_colliders: self.wheel_colliders.clone(),
            body_colliders: self.body_colliders.clone(),
            axles: self.axles.clone(),
            obstacles: self.obstacles.clone(),
            ground: self.ground.clone(),
            ground_collider: self.ground_collider,
            imposing: self.imposing,
        }
    }
}

impl World {
    /// Centre of mass of a carrier without its wheels, from the chassis reference point with all angles at zero.
    pub fn centre(&self, body: usize) -> [f64; 2] {
        self.masses[body].centre
    }

    /// The first obstacle that overlaps a part of the rover.
    pub fn obstacle_touched(&self) -> Option<usize> {
        let rover = self.wheel_colliders.iter().copied().chain(self.body_colliders.iter().map(|(handle, _)| *handle));
        let rover: Vec<&Collider> = rover.filter_map(|handle| self.colliders.get(handle)).collect();
        let touches = |a: &Collider, b: &Collider| {
            intersection_test(a.position(), a.shape(), b.position(), b.shape()).is_ok_and(|found| found.intersecting)
        };
        self.obstacles.iter().position(|handle| {
            self.colliders.get(*handle).is_some_and(|obstacle| rover.iter().any(|part| touches(part, obstacle)))
        })
    }

    /// Gives all bodies the velocities of `state`.
    pub fn set_motion(&mut self, rover: &Rover, state: &State) {
        let motions = motions(rover, &self.masses, state);
        for (handle, motion) in self.carriers.iter().zip(&motions) {
            if let Some(body) = self.bodies.get_mut(*handle) {
                body.set_linvel(motion.velocity, true);
                body.set_angvel(motion.rate, true);
            }
        }
        for ((handle, wheel), moving) in self.wheels.iter().zip(&rover.wheels).zip(&state.wheels) {
            if let Some(body) = self.bodies.get_mut(*handle) {
                let velocity = motions[wheel.body].velocity_at(body.translation());
                body.set_linvel(velocity, true);
                body.set_angvel(-moving.spin, true);
            }
        }
        // A multibody keeps generalised velocities: those of its root, then one a joint in the order of their making.
        let Some(axle) = self.axles.first().copied() else { return };
        let Some((multibody, _)) = self.multibodies.get_mut(axle) else { return };
        let root = [motions[0].velocity.x, motions[0].velocity.y, motions[0].rate];
        let links = state.rate[3..].iter().copied();
        let turns =
            rover.wheels.iter().zip(&state.wheels).map(|(wheel, moving)| -moving.spin - motions[wheel.body].rate);
        let mut rates = multibody.generalized_velocity_mut();
        rates.iter_mut().zip(root.into_iter().chain(links).chain(turns)).for_each(|(place, rate)| *place = rate);
    }

    /// Imposes wheel speeds (rad/s, relative to the carrier), or frees the wheels.
    pub fn impose(&mut self, speeds: Option<&[f64]>) {
        if speeds.is_none() && !self.imposing {
            return;
        }
        self.imposing = speeds.is_some();
        for (k, axle) in self.axles.iter().enumerate() {
            let Some((multibody, id)) = self.multibodies.get_mut(*axle) else { continue };
            let Some(link) = multibody.link_mut(id) else { continue };
            let speed = speeds.and_then(|speeds| speeds.get(k));
            let data = &mut link.joint.data;
            match speed {
                Some(speed) => {
                    data.set_motor_model(JointAxis::AngX, MotorModel::ForceBased);
                    data.set_motor_velocity(JointAxis::AngX, -speed, IMPOSING);
                }
                None => data.motor_axes.remove(JointAxesMask::ANG_X),
            }
        }
    }

    /// One step under the loads of the soil and the drives on the wheels, the moments of friction on the links (nose
    /// up, on the link) and the horizontal force on the chassis' reference point.
    ///
    /// # Errors
    /// [`DynamicsError::NotFinite`]: rapier holds a body that is not finite where it is and goes on without it.
    pub fn step(
        &mut self,
        rover: &Rover,
        wheels: &[WheelLoad],
        links: &[f64],
        resistance: f64,
    ) -> Result<(), DynamicsError> {
        self.bodies.iter_mut().for_each(|(_, body)| {
            body.reset_forces(false);
            body.reset_torques(false);
        });
        for ((load, handle), wheel) in wheels.iter().zip(&self.wheels).zip(&rover.wheels) {
            if let Some(body) = self.bodies.get_mut(*handle) {
                body.add_force(Vector::new(load.force[0], load.force[1]), true);
                // Driving forward is turning clockwise.
                body.add_torque(load.soil_torque - load.rim_torque, true);
            }
            if let Some(carrier) = self.bodies.get_mut(self.carriers[wheel.body]) {
                carrier.add_torque(load.rim_torque, true);
            }
        }
        for (j, &moment) in links.iter().enumerate() {
            if let Some(link) = self.bodies.get_mut(self.carriers[j + 1]) {
                link.add_torque(moment, true);
            }
            if let Some(carrier) = self.bodies.get_mut(self.carriers[parent(rover, j + 1)]) {
                carrier.add_torque(-moment, true);
            }
        }
        if let Some(chassis) = self.bodies.get_mut(self.carriers[0]) {
            let at = chassis.position().transform_point(self.masses[0].local([0.0; 2]));
            chassis.add_force_at_point(Vector::new(resistance, 0.0), at, true);
            if let Some(shape) = self.ground.moved_to(&rover.terrain, at.x)
                && let Some(collider) = self.colliders.get_mut(self.ground_collider)
            {
                collider.set_shape(shape);
            }
        }
        self.pipeline.step(
            self.gravity,
            &self.parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.joints,
            &mut self.multibodies,
            &mut self.soft_bodies,
            &mut self.ccd,
            &(),
            &(),
        );
        if self.pipeline.quarantine().is_empty() { Ok(()) } else { Err(DynamicsError::NotFinite) }
    }

    /// Reads positions, rates and spins of the rover.
    pub fn read(&self, rover: &Rover, state: &mut State) {
        let angle = |body: usize| {
            self.bodies.get(self.carriers[body]).map_or((f64::NAN, f64::NAN), |b| (b.rotation().angle(), b.angvel()))
        };
        if let Some(chassis) = self.bodies.get(self.carriers[0]) {
            let at = chassis.position().transform_point(self.masses[0].local([0.0; 2]));
            let velocity = chassis.velocity_at_point(at);
            let (pitch, rate) = angle(0);
            state.position[..3].copy_from_slice(&[at.x, at.y, pitch]);
            state.rate[..3].copy_from_slice(&[velocity.x, velocity.y, rate]);
        }
        for j in 0..rover.links.len() {
            let ((own, own_rate), (carrier, carrier_rate)) = (angle(j + 1), angle(parent(rover, j + 1)));
            state.position[3 + j] = wrapped(own - carrier);
            state.rate[3 + j] = own_rate - carrier_rate;
        }
        for (moving, handle) in state.wheels.iter_mut().zip(&self.wheels) {
            moving.spin = self.bodies.get(*handle).map_or(f64::NAN, |body| -body.angvel());
        }
    }
}

/// An angle within -pi .. pi.
fn wrapped(angle: f64) -> f64 {
    let turns = (angle / std::f64::consts::TAU).round();
    angle - turns * std::f64::consts::TAU
}
