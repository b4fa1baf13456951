//! Robots as trees of links: a body, links on revolute and prismatic joints, wheels on any of them.
//!
//! All places are in the frame of the body with every joint at zero: x forward, y left, z up, from the body's reference point.

mod kinematics;
mod rocker_bogie;
mod sample_return;

pub use kinematics::{Attitude, Frames};
pub use rocker_bogie::{RockerBogie, fsrl};
pub use sample_return::{SampleReturn, sample_return};

/// A link of the tree that is not the body; wheels and joints name it by its index.
pub type LinkIndex = usize;

/// How a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// Turns about `axis` through the joint's place, rad.
    Revolute,
    /// Slides along `axis`, m.
    Prismatic,
}

/// A joint: its value is `passive.1 x passive coordinate + active.1 x active value`.
///
/// Two joints that share a passive coordinate are coupled, as the rockers of a differential are by the factors 1 and -1.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Name for messages.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// Axis, a unit vector.
    pub axis: [f64; 3],
    /// A point of the axis, m.
    pub at: [f64; 3],
    /// Coordinate that the ground decides, and its factor.
    #[serde(default)]
    pub passive: Option<(usize, f64)>,
    /// Value that a motor holds, and its factor.
    #[serde(default)]
    pub active: Option<(usize, f64)>,
    /// Smallest value, rad or m.
    pub least: f64,
    /// Largest value, rad or m.
    pub most: f64,
}

/// A link, the joint that carries it, and its mass.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Link {
    /// The link that carries the joint; the body where missing.
    #[serde(default)]
    pub parent: Option<LinkIndex>,
    /// The joint.
    pub joint: Joint,
    /// Mass, kg.
    #[serde(default)]
    pub mass: f64,
    /// Centre of mass, m.
    #[serde(default)]
    pub centre_of_mass: [f64; 3],
}

/// A wheel: a disc in the x-z plane of its link.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotWheel {
    /// Name for messages.
    pub name: String,
    /// The link that carries it; the body where missing.
    #[serde(default)]
    pub link: Option<LinkIndex>,
    /// Centre, m.
    pub centre: [f64; 3],
}

/// Underside of the body: a rectangle that must stay clear of the ground.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Belly {
    /// From here, m.
    pub rear: f64,
    /// To here, m.
    pub front: f64,
    /// Half of its width, m.
    pub half_width: f64,
    /// Height over the reference point (negative below), m.
    pub z: f64,
}

/// A robot as a tree of links.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Robot {
    /// Mass of the body, kg.
    pub mass: f64,
    /// Its centre of mass, m.
    pub centre_of_mass: [f64; 3],
    /// Underside of the body; none where it is never near the ground.
    #[serde(default)]
    pub belly: Option<Belly>,
    /// Radius of the wheels, m.
    pub wheel_radius: f64,
    /// Width of the wheels, m.
    pub wheel_width: f64,
    /// Largest torque of a wheel's drive, N m.
    pub wheel_torque: f64,
    /// Links, parents before children.
    pub links: Vec<Link>,
    /// Wheels.
    pub wheels: Vec<RobotWheel>,
}

/// Why a description makes no robot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RobotError {
    /// A number is out of its range.
    #[error("robot: {name} is {value}; expected {expected}")]
    Number {
        /// What it is of.
        name: String,
        /// The value.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
    /// A link or wheel hangs on a link that does not come before it.
    #[error("robot: `{name}` is carried by link {parent}; expected a link before it (there are {links})")]
    Parent {
        /// The joint's or wheel's name.
        name: String,
        /// The link it names.
        parent: usize,
        /// Links that it could hang on.
        links: usize,
    },
    /// The ground does not determine the pose.
    #[error(
        "robot: {wheels} wheels and {passive} passive coordinates; expected {wheels} - 3 of them, so that every wheel can stand \
         on the ground in one way only"
    )]
    Undetermined {
        /// Wheels.
        wheels: usize,
        /// Passive coordinates.
        passive: usize,
    },
    /// The number of values for the active joints is wrong.
    #[error("robot: {got} values were given for {expected} active joints")]
    Active {
        /// Values given.
        got: usize,
        /// Active joints.
        expected: usize,
    },
}

impl Robot {
    /// Coordinates that the ground decides.
    #[must_use]
    pub fn passive(&self) -> usize {
        self.links.iter().filter_map(|link| link.joint.passive).map(|(index, _)| index + 1).max().unwrap_or(0)
    }

    /// Values that motors hold.
    #[must_use]
    pub fn active(&self) -> usize {
        self.links.iter().filter_map(|link| link.joint.active).map(|(index, _)| index + 1).max().unwrap_or(0)
    }

    /// Mass of everything, kg.
    #[must_use]
    pub fn total_mass(&self) -> f64 {
        self.mass + self.links.iter().map(|link| link.mass).sum::<f64>()
    }

    /// Smallest and largest value that every passive coordinate may have by the limits of its joints, rad or m.
    #[must_use]
    pub fn passive_limits(&self) -> Vec<[f64; 2]> {
        self.limits(self.passive(), |joint| joint.passive)
    }

    /// Smallest and largest value that every active joint may have, rad or m.
    #[must_use]
    pub fn active_limits(&self) -> Vec<[f64; 2]> {
        self.limits(self.active(), |joint| joint.active)
    }

    fn limits(&self, count: usize, of: impl Fn(&Joint) -> Option<(usize, f64)>) -> Vec<[f64; 2]> {
        let mut limits = vec![[f64::NEG_INFINITY, f64::INFINITY]; count];
        for joint in self.links.iter().map(|link| &link.joint) {
            let Some((index, factor)) = of(joint) else { continue };
            let (a, b) = (joint.least / factor, joint.most / factor);
            limits[index] = [limits[index][0].max(a.min(b)), limits[index][1].min(a.max(b))];
        }
        limits
    }

    /// Checks the description, see [`RobotError`].
    ///
    /// # Errors
    /// [`RobotError`] names the first thing that is wrong.
    pub fn check(&self) -> Result<(), RobotError> {
        let positive = [
            ("mass", self.total_mass()),
            ("wheel_radius", self.wheel_radius),
            ("wheel_width", self.wheel_width),
            ("wheel_torque", self.wheel_torque),
        ];
        for (name, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(RobotError::Number { name: name.to_owned(), value, expected: "a positive number" });
            }
        }
        let places = self.wheels.iter().map(|wheel| (&wheel.name, wheel.centre));
        let joints =
            self.links.iter().flat_map(|link| [link.joint.at, link.centre_of_mass].map(|at| (&link.joint.name, at)));
        for (name, place) in places.chain(joints) {
            if let Some(&value) = place.iter().find(|x| !x.is_finite()) {
                return Err(RobotError::Number {
                    name: format!("a place of `{name}`"),
                    value,
                    expected: "a finite number",
                });
            }
        }
        for (k, link) in self.links.iter().enumerate() {
            check_link(k, link)?;
        }
        for wheel in &self.wheels {
            if let Some(parent) = wheel.link.filter(|link| *link >= self.links.len()) {
                return Err(RobotError::Parent { name: wheel.name.clone(), parent, links: self.links.len() });
            }
        }
        let (wheels, passive) = (self.wheels.len(), self.passive());
        if wheels != passive + 3 { Err(RobotError::Undetermined { wheels, passive }) } else { Ok(()) }
    }
}

fn check_link(k: usize, link: &Link) -> Result<(), RobotError> {
    let joint = &link.joint;
    if let Some(parent) = link.parent.filter(|parent| *parent >= k) {
        return Err(RobotError::Parent { name: joint.name.clone(), parent, links: k });
    }
    let length = joint.axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let refuse = |what: &str, value: f64, expected| {
        Err(RobotError::Number { name: format!("{what} of joint `{}`", joint.name), value, expected })
    };
    // A direction given to six digits.
    if (length - 1.0).abs() > 1e-6 || length.is_nan() {
        return refuse("length of the axis", length, "1");
    }
    if joint.least.is_nan() || joint.most.is_nan() || joint.least >= joint.most {
        return refuse("smallest value", joint.least, "less than the largest");
    }
    if let Some((_, factor)) = joint.passive.into_iter().chain(joint.active).find(|(_, f)| !f.is_finite() || *f == 0.0)
    {
        return refuse("factor", factor, "a finite number other than 0");
    }
    if link.mass.is_nan() || link.mass < 0.0 { refuse("mass", link.mass, "0 or more") } else { Ok(()) }
}
