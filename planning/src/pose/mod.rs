//! The pose of a robot on the ground, given place and heading: appendix A's inverse kinematics for any determined robot.
//!
//! Unknown are height, roll, pitch and the passive coordinates; as many equations say that every wheel touches the ground. For the
//! rocker-bogie these are (A.1)-(A.6): the five loop closures are the differences of the six wheels' equations, and the
//! differential (A.6) is built into its joints.

mod belly;
mod search;
mod wheel;

pub use wheel::{Contact, Hang};

use crate::map::Surface;
use crate::robot::{Attitude, Frames, JointKind, Robot, RobotError};
use nalgebra::Vector3;

/// A wheel touches where its disc is within this of the ground, m: a tenth of a hair, above the rounding of coordinates in a
/// projected grid (1e-9 at 5e6 m) and the search for the rim's nearest point.
pub const TOUCHING: f64 = 1e-6;

/// What makes a pose unfit.
#[derive(Clone, Debug, PartialEq, thiserror::Error, serde::Serialize)]
pub enum Violation {
    /// A joint beyond its limits (3.12).
    #[error("the {joint} is at {value:.3} {unit}, outside {least:.3}..{most:.3}")]
    Joint {
        /// The joint.
        joint: String,
        /// Its value, rad or m.
        value: f64,
        /// Smallest value.
        least: f64,
        /// Largest value.
        most: f64,
        /// Unit of the three.
        unit: &'static str,
    },
    /// The body touches the ground.
    #[error("the belly is {depth:.3} m in the ground at ({x:.2}, {y:.2})")]
    Belly {
        /// Where it is deepest, m.
        x: f64,
        /// Where it is deepest, m.
        y: f64,
        /// How deep, m.
        depth: f64,
    },
}

/// Why there is no pose.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PoseError {
    /// The description is wrong.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// Place or heading is no number.
    #[error("place ({x}, {y}) m, heading {heading} rad; expected finite numbers")]
    Input {
        /// Easting, m.
        x: f64,
        /// Northing, m.
        y: f64,
        /// Heading, rad.
        heading: f64,
    },
    /// A part of the robot stands beyond the map, or over a hole.
    #[error("the {part} is over unknown ground at ({x:.2}, {y:.2}): beyond the map or in a hole of it")]
    Unknown {
        /// Wheel or belly.
        part: String,
        /// Easting, m.
        x: f64,
        /// Northing, m.
        y: f64,
    },
    /// Not all wheels can touch the ground.
    #[error("no pose at ({x:.2}, {y:.2}) has all wheels on the ground; nearest: the {wheel} wheel is {gap:.4} m off")]
    NotFound {
        /// Easting, m.
        x: f64,
        /// Northing, m.
        y: f64,
        /// The wheel that is farthest off.
        wheel: String,
        /// Its distance from the ground, m; negative inside it.
        gap: f64,
    },
}

/// How a pose was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Damped Newton steps within the bounds.
    Newton,
    /// The bracketed search, one coordinate after the other.
    Bracketed,
}

/// A robot on the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Body and passive coordinates.
    pub attitude: Attitude,
    /// Values of all joints, in the order of the robot's links, rad or m.
    pub joints: Vec<f64>,
    /// Where the wheels touch, in the order of the robot's wheels.
    pub contacts: Vec<Contact>,
    /// Centre of mass, m.
    pub centre_of_mass: Vector3<f64>,
    /// Smallest distance of the belly from the ground, m; infinite without a belly.
    pub clearance: f64,
    /// What makes the pose unfit; empty where it is fit.
    pub violations: Vec<Violation>,
    /// How it was found.
    pub method: Method,
    /// Evaluations of all wheels.
    pub evaluations: usize,
}

/// A robot to be placed on one surface.
#[derive(Clone, Debug)]
pub struct Placing<'a> {
    robot: &'a Robot,
    surface: &'a Surface,
    active: Vec<f64>,
    /// Heights of single wheels are changed by this, m: for the worst cases of (3.19). Empty for none.
    shifts: Vec<f64>,
}

impl<'a> Placing<'a> {
    /// Checks the robot, its motors holding `active` (all 0 where empty).
    ///
    /// # Errors
    /// [`RobotError`] where description and values do not fit.
    pub fn new(robot: &'a Robot, surface: &'a Surface, active: &[f64]) -> Result<Self, RobotError> {
        robot.check()?;
        let expected = robot.active();
        let active = if active.is_empty() { vec![0.0; expected] } else { active.to_vec() };
        if active.len() != expected {
            return Err(RobotError::Active { got: active.len(), expected });
        }
        Ok(Self { robot, surface, active, shifts: Vec::new() })
    }

    /// The same with the ground under each wheel raised by `shifts` (m), one for each wheel.
    #[must_use]
    pub fn with_shifts(&self, shifts: &[f64]) -> Self {
        Self { shifts: shifts.to_vec(), ..self.clone() }
    }

    /// The robot.
    #[must_use]
    pub fn robot(&self) -> &'a Robot {
        self.robot
    }

    /// The ground.
    #[must_use]
    pub fn surface(&self) -> &'a Surface {
        self.surface
    }

    /// Values of the active joints, rad or m.
    #[must_use]
    pub fn active(&self) -> &[f64] {
        &self.active
    }

    /// The pose with the reference point over (x, y) (m) and the given heading (rad, from x towards y). `start` is a pose nearby,
    /// from which the search begins; level ground where missing.
    ///
    /// # Errors
    /// [`PoseError`] where a wheel is over unknown ground, or no pose has all wheels on the ground.
    pub fn pose(&self, place: [f64; 2], heading: f64, start: Option<&Attitude>) -> Result<Pose, PoseError> {
        let [x, y] = place;
        if !(x.is_finite() && y.is_finite() && heading.is_finite()) {
            return Err(PoseError::Input { x, y, heading });
        }
        let found = search::search(self, place, heading, start)?;
        let frames = Frames::new(self.robot, &found.attitude, &self.active);
        let contact = |wheel: usize| {
            let hang = self.hang(&frames, wheel)?;
            hang.contact().ok_or_else(|| self.unknown(wheel, hang.rim))
        };
        let contacts = (0..self.robot.wheels.len()).map(contact);
        let contacts = contacts.collect::<Result<Vec<_>, _>>()?;
        let joints = frames.joint_values().to_vec();
        let centre_of_mass = frames.centre_of_mass();
        let (clearance, below) = belly::clearance(self.robot, self.surface, &frames)?;
        let limits = self.robot.links.iter().zip(&joints).filter_map(|(link, &value)| {
            let joint = &link.joint;
            let unit = if joint.kind == JointKind::Revolute { "rad" } else { "m" };
            let (least, most) = (joint.least, joint.most);
            let inside = value >= least && value <= most;
            (!inside).then(|| Violation::Joint { joint: joint.name.clone(), value, least, most, unit })
        });
        let violations = limits.chain(below).collect();
        let (method, evaluations) = (found.method, found.evaluations);
        let attitude = found.attitude;
        Ok(Pose { attitude, joints, contacts, centre_of_mass, clearance, violations, method, evaluations })
    }

    /// How a wheel hangs over the ground.
    fn hang(&self, frames: &Frames, wheel: usize) -> Result<Hang, PoseError> {
        let robot_wheel = &self.robot.wheels[wheel];
        let shift = self.shifts.get(wheel).copied().unwrap_or(0.0);
        let hang = wheel::hang(self.surface, frames, robot_wheel, self.robot.wheel_radius, shift);
        hang.map_err(|place| self.unknown(wheel, place))
    }

    fn unknown(&self, wheel: usize, place: Vector3<f64>) -> PoseError {
        PoseError::Unknown { part: format!("{} wheel", self.robot.wheels[wheel].name), x: place.x, y: place.y }
    }
}
