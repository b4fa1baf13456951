//! Masses and frames of the rigid bodies that make up a rover.
//!
//! In joint coordinates a wheel's mass belongs to the body that carries it, and only its inertia about the axle is its
//! own. A rigid body needs a mass, so part of the carrier's goes to each wheel. Mass, centre of mass and inertia of
//! carrier and wheels together stay what they were, and with a wheel fixed to its axle so does all motion.

use super::rapier::{Pose, Vector};
use crate::rover::{Rover, State};

/// The wheels of a body get at most this share of its mass and, as point masses, of its moment of inertia; both
/// together leave the carrier at least 2/3 of its inertia.
const WHEELS_SHARE: f64 = 0.25;

/// A carrier (0 the chassis, k link k) without its wheels. Its frame has its origin in its own centre of mass: rapier
/// moves the root of a multibody by the velocity of that centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carrier {
    pub mass: f64,
    pub inertia: f64,
    /// Centre of mass from the chassis reference point with all angles at zero.
    pub centre: [f64; 2],
    /// Mass of each of its wheels.
    pub wheel_mass: f64,
}

impl Carrier {
    pub fn new(rover: &Rover, body: usize) -> Self {
        let (mass, inertia, centre) = whole(rover, body);
        let arms: Vec<[f64; 2]> = rover
            .wheels
            .iter()
            .filter(|wheel| wheel.body == body)
            .map(|wheel| [wheel.mount.x - centre[0], wheel.mount.z - centre[1]])
            .collect();
        let second: f64 = arms.iter().map(|[x, z]| x * x + z * z).sum();
        let count = arms.len().max(1) as f64;
        let of_inertia = if second > 0.0 { WHEELS_SHARE * inertia / second } else { f64::INFINITY };
        let wheel_mass = (WHEELS_SHARE * mass / count).min(of_inertia);
        let rest = mass - wheel_mass * arms.len() as f64;
        let first = arms.iter().fold([0.0, 0.0], |sum, arm| [sum[0] + arm[0], sum[1] + arm[1]]);
        // The carrier's own centre moves away from its wheels.
        let shift = first.map(|sum| -wheel_mass * sum / rest);
        let own = inertia - wheel_mass * second - rest * (shift[0] * shift[0] + shift[1] * shift[1]);
        Self { mass: rest, inertia: own, centre: [centre[0] + shift[0], centre[1] + shift[1]], wheel_mass }
    }

    /// A point given from the chassis reference point with all angles at zero, in the carrier's frame.
    pub fn local(&self, [x, z]: [f64; 2]) -> Vector {
        Vector::new(x - self.centre[0], z - self.centre[1])
    }
}

/// Mass, inertia and centre of mass of a carrier with its wheels, as it is.
fn whole(rover: &Rover, body: usize) -> (f64, f64, [f64; 2]) {
    match body.checked_sub(1).and_then(|j| rover.links.get(j)) {
        None => {
            let body = rover.true_body();
            (body.mass, body.pitch_inertia, [body.centre_of_mass_x, body.centre_of_mass_z])
        }
        Some(link) => {
            let p = &link.parameters;
            (p.mass, p.inertia, [p.centre_of_mass_x, p.centre_of_mass_z])
        }
    }
}

/// Where a link's joint is, from the chassis reference point with all angles at zero.
pub(super) fn joint(rover: &Rover, body: usize) -> [f64; 2] {
    body.checked_sub(1).and_then(|j| rover.links.get(j)).map_or([0.0; 2], |link| [link.parameters.x, link.parameters.z])
}

/// Body that carries body `body` (a link).
pub(super) fn parent(rover: &Rover, body: usize) -> usize {
    body.checked_sub(1).and_then(|j| rover.links.get(j)).map_or(0, |link| link.parent)
}

/// Poses and velocities of all carriers at `state`.
pub(super) fn motions(rover: &Rover, carriers: &[Carrier], state: &State) -> Vec<BodyMotion> {
    let mut all: Vec<BodyMotion> = Vec::with_capacity(carriers.len());
    for (body, carrier) in carriers.iter().enumerate() {
        // The carrier's joint, or the chassis reference point, as its carrier or the state moves it.
        let pivot = carrier.local(joint(rover, body));
        let (at, velocity, angle, rate) = if body == 0 {
            let at = Vector::new(state.position[0], state.position[1]);
            (at, Vector::new(state.rate[0], state.rate[1]), state.position[2], state.rate[2])
        } else {
            let below = parent(rover, body);
            let at = all[below].pose.transform_point(carriers[below].local(joint(rover, body)));
            let (angle, rate) = (all[below].angle + state.position[2 + body], all[below].rate + state.rate[2 + body]);
            (at, all[below].velocity_at(at), angle, rate)
        };
        let rotation = Pose::new(Vector::ZERO, angle);
        let arm = -rotation.transform_vector(pivot);
        let velocity = velocity + Vector::new(-arm.y, arm.x) * rate;
        all.push(BodyMotion { pose: Pose::new(at + arm, angle), angle, velocity, rate });
    }
    all
}

/// Where a carrier is and how it moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyMotion {
    pub pose: Pose,
    angle: f64,
    /// Velocity of the centre of mass.
    pub velocity: Vector,
    /// Angular rate, nose up.
    pub rate: f64,
}

impl BodyMotion {
    /// Velocity of the body's point that is now at `point`.
    pub fn velocity_at(&self, point: Vector) -> Vector {
        let arm = point - self.pose.translation;
        self.velocity + Vector::new(-arm.y, arm.x) * self.rate
    }
}
