//! Forward kinematics: where links, wheels and the centre of mass are, and how they move with each coordinate.

use super::{JointKind, LinkIndex, Robot, RobotWheel};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// Place and orientation of the body, and the coordinates of its joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Attitude {
    /// Reference point, m.
    pub position: Vector3<f64>,
    /// Heading, from x (east) to y (north), rad.
    pub heading: f64,
    /// Roll, left side up, rad.
    pub roll: f64,
    /// Pitch, nose up, rad.
    pub pitch: f64,
    /// Passive coordinates, rad or m.
    pub passive: Vec<f64>,
}

/// A joint's axis in the world.
#[derive(Clone, Copy, Debug)]
struct WorldJoint {
    axis: Vector3<f64>,
    at: Vector3<f64>,
}

/// Where everything of a robot is in one pose.
#[derive(Clone, Debug)]
pub struct Frames<'a> {
    robot: &'a Robot,
    attitude: &'a Attitude,
    body: Matrix3<f64>,
    /// Rotation and translation of each link: a point x of the description is at R x + p.
    links: Vec<(Matrix3<f64>, Vector3<f64>)>,
    joints: Vec<WorldJoint>,
    values: Vec<f64>,
}

impl Attitude {
    /// Rotation of the body: heading about z, then roll about the forward axis, then pitch about the lateral one. In this order
    /// the loop closures (A.1)-(A.5) hold exactly: the height of a point of a rocker is cos(roll) times that in its plane.
    #[must_use]
    pub fn rotation(&self) -> Matrix3<f64> {
        let turn = |axis: Unit<Vector3<f64>>, angle: f64| Rotation3::from_axis_angle(&axis, angle);
        let (heading, roll) = (turn(Vector3::z_axis(), self.heading), turn(Vector3::x_axis(), self.roll));
        *(heading * roll * turn(Vector3::y_axis(), -self.pitch)).matrix()
    }

    /// Slope of the direction of travel, uphill positive, rad: sin = cos(roll) sin(pitch).
    #[must_use]
    pub fn slope(&self) -> f64 {
        (self.roll.cos() * self.pitch.sin()).asin()
    }
}

impl<'a> Frames<'a> {
    /// The robot in a pose, its motors holding `active`.
    #[must_use]
    pub fn new(robot: &'a Robot, attitude: &'a Attitude, active: &[f64]) -> Self {
        let body = attitude.rotation();
        let mut frames = Self { robot, attitude, body, links: Vec::new(), joints: Vec::new(), values: Vec::new() };
        for link in &robot.links {
            let (rotation, translation) = frames.frame(link.parent);
            let joint = &link.joint;
            let part = |of: Option<(usize, f64)>, values: &[f64]| {
                of.map_or(0.0, |(index, factor)| factor * values.get(index).copied().unwrap_or(0.0))
            };
            let value = part(joint.passive, &attitude.passive) + part(joint.active, active);
            let (axis, at) = (Vector3::from(joint.axis), Vector3::from(joint.at));
            frames.joints.push(WorldJoint { axis: rotation * axis, at: rotation * at + translation });
            frames.values.push(value);
            frames.links.push(match joint.kind {
                JointKind::Revolute => {
                    let turn = *Rotation3::from_axis_angle(&Unit::new_unchecked(axis), value).matrix();
                    (rotation * turn, rotation * (at - turn * at) + translation)
                }
                JointKind::Prismatic => (rotation, rotation * (axis * value) + translation),
            });
        }
        frames
    }

    fn frame(&self, link: Option<LinkIndex>) -> (Matrix3<f64>, Vector3<f64>) {
        link.map_or((self.body, self.attitude.position), |k| self.links[k])
    }

    /// A point of a link (the body where `None`) in the world, m.
    #[must_use]
    pub fn point(&self, link: Option<LinkIndex>, place: [f64; 3]) -> Vector3<f64> {
        let (rotation, translation) = self.frame(link);
        rotation * Vector3::from(place) + translation
    }

    /// A direction of a link in the world.
    #[must_use]
    pub fn direction(&self, link: Option<LinkIndex>, direction: Vector3<f64>) -> Vector3<f64> {
        self.frame(link).0 * direction
    }

    /// A wheel of the robot.
    #[must_use]
    pub fn wheel(&self, wheel: usize) -> &'a RobotWheel {
        &self.robot.wheels[wheel]
    }

    /// Values of all joints, rad or m.
    #[must_use]
    pub fn joint_values(&self) -> &[f64] {
        &self.values
    }

    /// Centre of mass of everything, m.
    #[must_use]
    pub fn centre_of_mass(&self) -> Vector3<f64> {
        let body = self.point(None, self.robot.centre_of_mass) * self.robot.mass;
        let links = self.robot.links.iter().enumerate();
        let sum = links.fold(body, |sum, (k, link)| sum + self.point(Some(k), link.centre_of_mass) * link.mass);
        sum / self.robot.total_mass()
    }

    /// How a point of a link moves with height, roll, pitch and each passive coordinate.
    #[must_use]
    pub fn motion(&self, link: Option<LinkIndex>, point: Vector3<f64>) -> Vec<Vector3<f64>> {
        let mut columns = vec![Vector3::zeros(); 3 + self.robot.passive()];
        let from_reference = point - self.attitude.position;
        let forward = Vector3::new(self.attitude.heading.cos(), self.attitude.heading.sin(), 0.0);
        columns[0] = Vector3::z();
        columns[1] = forward.cross(&from_reference);
        columns[2] = -self.body.column(1).cross(&from_reference);
        let mut at = link;
        while let Some(k) = at {
            let joint = &self.robot.links[k].joint;
            if let Some((index, factor)) = joint.passive {
                columns[3 + index] += factor * self.joint_motion(k, point);
            }
            at = self.robot.links[k].parent;
        }
        columns
    }

    /// How a point of a link moves with each active value.
    #[must_use]
    pub fn active_motion(&self, link: Option<LinkIndex>, point: Vector3<f64>) -> Vec<Vector3<f64>> {
        let mut columns = vec![Vector3::zeros(); self.robot.active()];
        let mut at = link;
        while let Some(k) = at {
            if let Some((index, factor)) = self.robot.links[k].joint.active {
                columns[index] += factor * self.joint_motion(k, point);
            }
            at = self.robot.links[k].parent;
        }
        columns
    }

    /// How a point beyond joint `k` moves with the joint's value.
    fn joint_motion(&self, k: LinkIndex, point: Vector3<f64>) -> Vector3<f64> {
        let WorldJoint { axis, at } = self.joints[k];
        match self.robot.links[k].joint.kind {
            JointKind::Revolute => axis.cross(&(point - at)),
            JointKind::Prismatic => axis,
        }
    }
}
