//! How the rapier world of a rover is put together.

use super::bodies::{Carrier, joint, motions, parent};
use super::rapier::*;
use super::shapes::{self, GroundCollider};
use super::world::World;
use crate::obstacle::Obstacle;
use crate::rover::{Rover, State};

/// Solver iterations of rapier a step: as many small steps of its own.
const SMALL_STEPS: usize = 4;
/// Sweeps over all constraints in each of the two passes of a small step. With one, a driven wheel that slides on a rock
/// is off its imposed speed by 3 %; with four by 2e-5, and more change nothing.
const SWEEPS: usize = 4;

impl World {
    /// The rover at `state` among `obstacles`, stepped by `step_size` (s).
    pub fn new(rover: &Rover, state: &State, obstacles: &[Obstacle], belly_friction: f64, step_size: f64) -> Self {
        let mut colliders = ColliderSet::new();
        let (ground, collider) = GroundCollider::new(&rover.terrain, state.position[0], belly_friction);
        let ground_collider = colliders.insert(collider);
        let obstacles =
            obstacles.iter().filter_map(|o| shapes::obstacle(o, rover)).map(|collider| colliders.insert(collider));
        let obstacles = obstacles.collect();
        let parameters = IntegrationParameters {
            dt: step_size,
            num_solver_iterations: SMALL_STEPS,
            num_internal_pgs_iterations: SWEEPS,
            num_internal_stabilization_iterations: SWEEPS,
            // Contacts are found anew at every step, and nothing here is fast enough to pass through another.
            contact_recycling: false,
            contact_clustering: false,
            max_ccd_substeps: 0,
            ..IntegrationParameters::default()
        };
        let mut world = Self {
            gravity: Vector::new(0.0, -rover.environment.gravity),
            parameters,
            pipeline: PhysicsPipeline::new(),
            islands: IslandManager::new(),
            broad_phase: DefaultBroadPhase::new(),
            narrow_phase: NarrowPhase::new(),
            bodies: RigidBodySet::new(),
            colliders,
            joints: ImpulseJointSet::new(),
            multibodies: MultibodyJointSet::new(),
            soft_bodies: SoftBodySet::new(),
            ccd: CCDSolver::new(),
            masses: (0..=rover.links.len()).map(|body| Carrier::new(rover, body)).collect(),
            carriers: Vec::new(),
            wheels: Vec::new(),
            wheel_colliders: Vec::new(),
            body_colliders: Vec::new(),
            axles: Vec::new(),
            obstacles,
            ground,
            ground_collider,
            imposing: false,
        };
        world.add_rover(rover);
        world.place(rover, state);
        world.set_motion(rover, state);
        world
    }

    /// Adds the rover with all angles and coordinates at zero.
    fn add_rover(&mut self, rover: &Rover) {
        for body in 0..=rover.links.len() {
            let own = self.masses[body];
            let carrier = self.add_body(own.centre, own.mass, own.inertia);
            let shapes = if body == 0 { vec![shapes::chassis(rover, &own)] } else { shapes::link(rover, &own, body) };
            for shape in shapes {
                let collider = self.colliders.insert_with_parent(shape, carrier, &mut self.bodies);
                self.body_colliders.push((collider, body));
            }
            if body > 0 {
                let (at, below) = (joint(rover, body), parent(rover, body));
                self.add_joint(self.carriers[below], self.masses[below].local(at), carrier, own.local(at));
            }
            self.carriers.push(carrier);
        }
        for wheel in &rover.wheels {
            let carrier = self.masses[wheel.body];
            let centre = [wheel.mount.x, wheel.mount.z];
            let body = self.add_body(centre, carrier.wheel_mass, rover.wheel.inertia);
            let collider = self.colliders.insert_with_parent(shapes::wheel(rover), body, &mut self.bodies);
            let axle = self.add_joint(self.carriers[wheel.body], carrier.local(centre), body, Vector::ZERO);
            self.axles.extend(axle);
            self.wheels.push(body);
            self.wheel_colliders.push(collider);
        }
        // Rapier damps the joints of a multibody by default; their friction is the rover's own here.
        if let Some((multibody, _)) = self.axles.first().and_then(|axle| self.multibodies.get_mut(*axle)) {
            multibody.damping_mut().fill(0.0);
        }
    }

    fn add_body(&mut self, [x, z]: [f64; 2], mass: f64, inertia: f64) -> RigidBodyHandle {
        let pose = Pose::new(Vector::new(x, z), 0.0);
        let mass = MassProperties::new(Vector::ZERO, mass, inertia);
        self.bodies.insert(RigidBodyBuilder::dynamic().pose(pose).additional_mass_properties(mass).can_sleep(false))
    }

    fn add_joint(
        &mut self,
        carrier: RigidBodyHandle,
        anchor: Vector,
        carried: RigidBodyHandle,
        anchor_there: Vector,
    ) -> Option<MultibodyJointHandle> {
        let joint =
            RevoluteJointBuilder::new().local_anchor1(anchor).local_anchor2(anchor_there).contacts_enabled(false);
        self.multibodies.insert(carrier, carried, joint, true)
    }

    /// Moves the rover from zero to `state`. This goes through the multibody's coordinates: rapier takes over the pose of
    /// a root that was set directly, but not its angle as a coordinate (2D, version 0.36.1), and loses it then.
    fn place(&mut self, rover: &Rover, state: &State) {
        let motions = motions(rover, &self.masses, state);
        let Some(axle) = self.axles.first().copied() else { return };
        let Some((multibody, _)) = self.multibodies.get_mut(axle) else { return };
        multibody.forward_kinematics(&self.bodies, true);
        let (to, from) = (motions[0].pose.translation, self.masses[0].centre);
        let mut shift = vec![to.x - from[0], to.y - from[1]];
        shift.extend_from_slice(&state.position[2..]);
        shift.resize(multibody.ndofs(), 0.0);
        multibody.apply_displacements(&shift);
        multibody.forward_kinematics(&self.bodies, false);
        multibody.update_rigid_bodies(&mut self.bodies, true);
        let colliders = self.wheel_colliders.iter().zip(&self.wheels);
        let bodies = self.body_colliders.iter().map(|(collider, body)| (collider, &self.carriers[*body]));
        for (collider, body) in colliders.chain(bodies) {
            if let (Some(collider), Some(body)) = (self.colliders.get_mut(*collider), self.bodies.get(*body)) {
                collider.set_position(*body.position());
            }
        }
    }
}
