//! What rapier's contacts did in the last step: forces on wheels and carriers, and the energy they took.

use super::rapier::{ColliderHandle, ContactPair, RigidBodyHandle, Vector};
use super::world::World;

/// Rigid contact of one body over the last step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RigidLoad {
    /// Mean force on the body over the step, [x, z], N.
    pub force: [f64; 2],
    /// Sum of the normal forces alone.
    pub normal: [f64; 2],
    /// Moment of the mean force about the body's centre, counterclockwise, N m.
    pub moment: f64,
    /// Work of the mean force on the body, J.
    pub work: f64,
}

/// Velocity and angular rate of a body before the step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Before {
    pub velocity: Vector,
    pub rate: f64,
}

impl World {
    /// Velocity of a body now.
    pub fn motion_of(&self, body: RigidBodyHandle) -> Before {
        self.bodies.get(body).map_or(Before::default(), |body| Before { velocity: body.linvel(), rate: body.angvel() })
    }

    /// Adds the contacts of `collider`, which sits on `body`, over the last step of size `h`.
    pub fn add_contacts(
        &self,
        collider: ColliderHandle,
        body: RigidBodyHandle,
        before: &Before,
        h: f64,
        load: &mut RigidLoad,
    ) {
        let after = self.motion_of(body);
        for pair in self.narrow_phase.contact_pairs_with(collider) {
            add_pair(pair, collider, before, &after, h, load);
        }
    }
}

fn add_pair(
    pair: &ContactPair,
    collider: ColliderHandle,
    before: &Before,
    after: &Before,
    h: f64,
    load: &mut RigidLoad,
) {
    // Impulses are those on the first body, along the normal away from the second; the second has their opposites.
    let first = pair.collider1 == collider;
    let side = if first { 1.0 } else { -1.0 };
    for manifold in pair.solver_manifolds() {
        let away = -manifold.data.normal;
        let tangent = Vector::new(-away.y, away.x);
        for contact in &manifold.data.solver_contacts {
            let Some(point) = manifold.points.get((contact.contact_indices()[0]) as usize) else { continue };
            let data = &point.data;
            let arm = if first { data.solver_dp1 } else { data.solver_dp2 };
            let normal = away * (side * data.impulse / h);
            let force = normal + tangent * (side * data.tangent_impulse.x / h);
            let at = |motion: &Before| motion.velocity + Vector::new(-arm.y, arm.x) * motion.rate;
            add(&mut load.force, force);
            add(&mut load.normal, normal);
            load.moment += arm.perp_dot(force);
            load.work += force.dot(at(before) + at(after)) * (0.5 * h);
        }
    }
}

fn add(sum: &mut [f64; 2], vector: Vector) {
    sum[0] += vector.x;
    sum[1] += vector.y;
}
