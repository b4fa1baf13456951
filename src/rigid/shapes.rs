//! Shapes of chassis, links, wheels, obstacles and ground for the contact detection.

use super::bodies::{Carrier, joint};
use super::rapier::{
    CoefficientCombineRule, Collider, ColliderBuilder, Group, InteractionGroups, InteractionTestMode, SharedShape,
    Vector,
};
use crate::obstacle::Obstacle;
use crate::rover::Rover;
use crate::terrain::{Profile, Terrain};

/// Half length of the stretch of ground that is kept as a collider around the rover, m.
const WINDOW: f64 = 10.0;
/// The stretch is moved once the rover is this far from its middle, m.
const OFF_MIDDLE: f64 = 5.0;
/// Spacing of its points, m: the chords of waves of 5 cm in 2 m stay within 6 um of them.
const SPACING: f64 = 0.01;
/// Least thickness of the chassis box and of a link, m.
const THICKNESS: f64 = 0.01;
/// Obstacles reach this far below the lowest ground under them, in wheel radii.
const ROOT: f64 = 4.0;

/// What may touch what: wheels sink into the ground, so only chassis and links touch it.
const WHEEL: Group = Group::GROUP_1;
const BODY: Group = Group::GROUP_2;
const OBSTACLE: Group = Group::GROUP_3;
const GROUND: Group = Group::GROUP_4;

fn groups(own: Group, others: Group) -> InteractionGroups {
    InteractionGroups::new(own, others, InteractionTestMode::And)
}

/// Friction is a property of ground and obstacles; the rover's own side is zero and the larger of both counts.
fn moving(shape: SharedShape, own: Group, others: Group) -> Collider {
    ColliderBuilder::new(shape)
        .density(0.0)
        .friction(0.0)
        .friction_combine_rule(CoefficientCombineRule::Max)
        .collision_groups(groups(own, others))
        .build()
}

fn standing(shape: SharedShape, friction: f64, own: Group, others: Group) -> Collider {
    ColliderBuilder::new(shape)
        .friction(friction)
        .friction_combine_rule(CoefficientCombineRule::Max)
        .collision_groups(groups(own, others))
        .build()
}

/// A wheel: a disc of its true radius.
pub(super) fn wheel(rover: &Rover) -> Collider {
    moving(SharedShape::ball(rover.true_wheel().radius), WHEEL, OBSTACLE)
}

/// The chassis: a box between the outer wheel centres from the belly up to the centre of mass.
pub(super) fn chassis(rover: &Rover, carrier: &Carrier) -> Collider {
    let at = |k: usize| rover.wheels.get(k).map_or(0.0, |wheel| wheel.mount.x);
    let (rear, front) = (at(0), at(rover.wheels.len() - 1));
    let (belly, top) = (rover.body.belly_z, rover.body.centre_of_mass_z.max(rover.body.belly_z + THICKNESS));
    let corners = [[rear, belly], [front, belly], [front, top], [rear, top]].map(|corner| carrier.local(corner));
    let shape = SharedShape::convex_polyline(corners.to_vec()).unwrap_or_else(|| SharedShape::ball(THICKNESS));
    moving(shape, BODY, OBSTACLE.union(GROUND))
}

/// A link: bars from its joint to its wheels' axles.
pub(super) fn link(rover: &Rover, carrier: &Carrier, body: usize) -> Vec<Collider> {
    let from = carrier.local(joint(rover, body));
    let bar = |axle| moving(SharedShape::capsule(from, axle, 0.5 * THICKNESS), BODY, OBSTACLE.union(GROUND));
    let axles = rover.wheels.iter().filter(|wheel| wheel.body == body);
    axles.map(|wheel| bar(carrier.local([wheel.mount.x, wheel.mount.z]))).collect()
}

/// An obstacle on its ground.
pub(super) fn obstacle(obstacle: &Obstacle, rover: &Rover) -> Option<Collider> {
    let (from, to) = obstacle.extent();
    let steps = ((to - from) / SPACING).ceil().max(1.0);
    let height = |k: f64| rover.terrain.at(from + (to - from) * k / steps).height;
    let lowest = (0..=steps as usize).map(|k| height(k as f64)).fold(f64::INFINITY, f64::min);
    let ground = rover.terrain.at(obstacle.parameters.x).height;
    let bottom = lowest.min(ground) - ROOT * rover.wheel.radius;
    let outline = obstacle.outline(ground, bottom).into_iter().map(|[x, z]| Vector::new(x, z)).collect();
    let shape = SharedShape::convex_polyline(outline)?;
    Some(standing(shape, obstacle.parameters.friction, OBSTACLE, WHEEL.union(BODY)))
}

/// Collider of the terrain for chassis and links: a piece of the profile that moves along with the rover.
#[derive(Clone, Debug)]
pub(super) struct GroundCollider {
    /// Middle of the stretch; NaN where the whole ground is one plane.
    middle: f64,
}

impl GroundCollider {
    /// The ground around `x`, with its collider.
    pub fn new(terrain: &Terrain, x: f64, friction: f64) -> (Self, Collider) {
        let (shape, middle) = match &terrain.profile {
            Profile::Flat => (plane(0.0), f64::NAN),
            Profile::Slope(slope) => (plane(slope.slope), f64::NAN),
            _ => (stretch(terrain, x), x),
        };
        (Self { middle }, standing(shape, friction, GROUND, BODY))
    }

    /// The shape of the ground around `x`, where the rover has come too far from the middle of the present one.
    pub fn moved_to(&mut self, terrain: &Terrain, x: f64) -> Option<SharedShape> {
        if (x - self.middle).abs() > OFF_MIDDLE {
            self.middle = x;
            Some(stretch(terrain, x))
        } else {
            None
        }
    }
}

fn plane(angle: f64) -> SharedShape {
    SharedShape::halfspace(Vector::new(-angle.sin(), angle.cos()))
}

fn stretch(terrain: &Terrain, middle: f64) -> SharedShape {
    let (first, last) = terrain.range();
    let (from, to) = ((middle - WINDOW).max(first), (middle + WINDOW).min(last));
    let steps = ((to - from) / SPACING).ceil().max(1.0);
    let point = |k: usize| {
        let x = from + (to - from) * k as f64 / steps;
        Vector::new(x, terrain.at(x).height)
    };
    SharedShape::polyline((0..=steps as usize).map(point).collect(), None)
}
