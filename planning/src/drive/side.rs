//! One side of a robot as the core's planar rover.

use crate::robot::{Attitude, Frames, Link, LinkIndex, Robot};
use bekker::rover::{Body, Link as PlanarLink, LinkParameters, Mount, Rover, WheelMount};
use nalgebra::Vector3;

/// Share of the side's mass that a link gets where the robot's description has none: the core moves every link by its inertia, and one
/// as light as its bearings would shake on firm ground within a step. Its centre of mass is put into the joint, where it loads the
/// wheels as if it belonged to the carrier. The bogie of the core's FSRL rover is as heavy.
const LINK_MASS: f64 = 0.2;

/// Radius of inertia of a link about its centre of mass, m: that of the same bogie.
const LINK_RADIUS: f64 = 0.1;

/// Which side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Wheels with y > 0.
    Left,
    /// The others.
    Right,
}

impl Side {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    fn has(self, y: f64) -> bool {
        (y > 0.0) == (self == Self::Left)
    }
}

/// The side of a robot whose motors hold `active`, with half of the body's mass. Soil, motor and inertia of the wheels are `base`'s.
///
/// Joints that couple both sides (the rockers of a differential) do not move in the plane: the body goes with them. The belly is taken
/// away, since it lies between the tracks. With it comes the mean of the
/// wheels' places across the path, m, to the left positive. `None` where the side has no wheels.
#[must_use]
pub fn planar_side(robot: &Robot, active: &[f64], side: Side, base: &Rover) -> Option<(Rover, f64)> {
    let level = Attitude {
        position: Vector3::zeros(),
        heading: 0.0,
        roll: 0.0,
        pitch: 0.0,
        passive: vec![0.0; robot.passive()],
    };
    let frames = Frames::new(robot, &level, active);
    let wheels: Vec<_> = robot.wheels.iter().filter(|wheel| side.has(wheel.centre[1])).collect();
    let across = wheels.iter().map(|wheel| wheel.centre[1]).sum::<f64>() / wheels.len() as f64;
    let mut rover = base.clone();
    rover.wheel.radius = robot.wheel_radius;
    rover.wheel.width = robot.wheel_width;
    rover.motor.inverse_torque_limit = 1.0 / robot.wheel_torque;
    let half = 0.5 * robot.total_mass();
    let mut bodies = Bodies { robot, numbers: vec![0; robot.links.len()], links: Vec::new() };
    for wheel in &wheels {
        bodies.body_of(wheel.link, &frames, half);
    }
    rover.wheels = wheels
        .iter()
        .map(|wheel| {
            let at = frames.point(wheel.link, wheel.centre);
            let body = wheel.link.map_or(0, |link| bodies.numbers[link]);
            WheelMount { body, mount: Mount { x: at.x, z: at.z } }
        })
        .collect();
    rover.wheels.sort_by(|a, b| a.mount.x.total_cmp(&b.mount.x));
    rover.links = bodies.links;
    rover.body = body(&rover, half, frames.centre_of_mass());
    (!wheels.is_empty()).then_some((rover, across))
}

/// The chassis: what is left of the mass, where the whole keeps its centre of mass.
fn body(rover: &Rover, mass: f64, centre: Vector3<f64>) -> Body {
    let links = rover.links.iter().map(|link| link.parameters);
    let (linked, x, z) = links.fold((0.0, 0.0, 0.0), |(mass, x, z), link| {
        (mass + link.mass, x + link.mass * link.centre_of_mass_x, z + link.mass * link.centre_of_mass_z)
    });
    let own = mass - linked;
    let places = rover.wheels.iter().map(|wheel| wheel.mount.x);
    let (rear, front) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    Body {
        mass: own,
        // A bar between the outermost wheels.
        pitch_inertia: own * (front - rear).powi(2) / 12.0,
        centre_of_mass_x: (mass * centre.x - x) / own,
        centre_of_mass_z: (mass * centre.z - z) / own,
        belly_z: rover.wheels.iter().map(|wheel| wheel.mount.z).fold(f64::NEG_INFINITY, f64::max)
            + 10.0 * rover.wheel.radius,
    }
}

/// Numbers of the planar bodies that links belong to: 0 the chassis, k planar link k.
struct Bodies<'a> {
    robot: &'a Robot,
    numbers: Vec<usize>,
    links: Vec<PlanarLink>,
}

impl Bodies<'_> {
    /// The body of a link, made where it is not there yet.
    fn body_of(&mut self, link: Option<LinkIndex>, frames: &Frames, half: f64) -> usize {
        let Some(index) = link else { return 0 };
        if self.numbers[index] > 0 {
            return self.numbers[index];
        }
        let part = &self.robot.links[index];
        let parent = self.body_of(part.parent, frames, half);
        self.numbers[index] = if self.turns_alone(part) {
            let at = frames.point(part.parent, part.joint.at);
            let own = part.mass > 0.0;
            let mass = if own { part.mass } else { LINK_MASS * half };
            let centre = if own { frames.point(Some(index), part.centre_of_mass) } else { at };
            let parameters = LinkParameters {
                x: at.x,
                z: at.z,
                mass,
                inertia: mass * LINK_RADIUS.powi(2),
                centre_of_mass_x: centre.x,
                centre_of_mass_z: centre.z,
                ..LinkParameters::default()
            };
            self.links.push(PlanarLink { parent, parameters });
            self.links.len()
        } else {
            parent
        };
        self.numbers[index]
    }

    /// Whether the ground turns a link without turning one of the other side.
    fn turns_alone(&self, link: &Link) -> bool {
        let Some((coordinate, _)) = link.joint.passive else { return false };
        let same = |other: &&Link| other.joint.passive.is_some_and(|(index, _)| index == coordinate);
        self.robot.links.iter().filter(same).count() == 1
    }
}
