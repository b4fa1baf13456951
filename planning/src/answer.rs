//! Poses and plans as every door gives them: serialised once, in SI units and radians.

use crate::plan::{Failure, PathPoint, Plan};
use crate::pose::{Contact, Pose};
use crate::site::Site;
use serde::Serialize;

/// Where a wheel touches.
#[derive(Clone, Debug, Serialize)]
pub struct WheelAnswer {
    /// The wheel.
    pub name: String,
    /// Contact point, m.
    pub point: [f64; 3],
    /// Normal of the ground there.
    pub normal: [f64; 3],
    /// Slope in the wheel's plane, uphill positive, rad.
    pub contact_angle: f64,
}

/// A joint's value.
#[derive(Clone, Debug, Serialize)]
pub struct JointAnswer {
    /// The joint.
    pub name: String,
    /// Value from that on level ground, rad or m.
    pub value: f64,
}

/// A pose.
#[derive(Clone, Debug, Serialize)]
pub struct PoseAnswer {
    /// Place of the reference point, m.
    pub position: [f64; 3],
    /// Heading from east to north, rad.
    pub heading: f64,
    /// Roll, left side up, rad.
    pub roll: f64,
    /// Pitch, nose up, rad.
    pub pitch: f64,
    /// Joints.
    pub joints: Vec<JointAnswer>,
    /// Wheels.
    pub wheels: Vec<WheelAnswer>,
    /// Smallest distance of the belly from the ground, m; none without a belly.
    pub clearance: Option<f64>,
    /// Whether the rover may stand so.
    pub safe: bool,
    /// Why not.
    pub failure: Option<String>,
    /// Stability angle, rad.
    pub stability: Option<f64>,
    /// Largest thrust in the direction of travel, N; none where no forces hold the rover.
    pub thrust: Option<f64>,
}

/// A point of a path.
#[derive(Clone, Debug, Serialize)]
pub struct PointAnswer {
    /// Easting, m.
    pub x: f64,
    /// Northing, m.
    pub y: f64,
    /// Height of the rover's reference point, m.
    pub z: f64,
    /// Way from the start, m.
    pub travelled: f64,
    /// Heading from east to north, rad.
    pub heading: f64,
    /// Roll, left side up, rad.
    pub roll: f64,
    /// Pitch, nose up, rad.
    pub pitch: f64,
    /// Smallest stability angle of all cases, rad.
    pub stability: f64,
    /// Smallest of the largest thrusts of all cases, N.
    pub thrust: f64,
    /// Smallest distance of the belly from the ground, m; none without a belly.
    pub clearance: Option<f64>,
}

/// A place where the rover would fail.
#[derive(Clone, Debug, Serialize)]
pub struct FailureAnswer {
    /// Easting, m.
    pub x: f64,
    /// Northing, m.
    pub y: f64,
    /// Heading, rad.
    pub heading: f64,
    /// Kind: pose, joint limit, belly, stability, forces, unknown ground.
    pub kind: &'static str,
    /// Reason.
    pub reason: String,
}

/// A plan.
#[derive(Clone, Debug, Serialize)]
pub struct PlanAnswer {
    /// Length, m.
    pub length: f64,
    /// Performance index, or energy (J) of a plan by energy.
    pub cost: f64,
    /// Searches made.
    pub searches: usize,
    /// Stands evaluated.
    pub evaluations: usize,
    /// Points from start to goal.
    pub points: Vec<PointAnswer>,
    /// Places that were found unsafe on the way to the plan.
    pub failures: Vec<FailureAnswer>,
    /// What is doubtful in the map, and what was changed in it.
    pub remarks: Vec<String>,
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

impl PoseAnswer {
    /// The answer for a pose of a site.
    #[must_use]
    pub fn new(site: &Site, pose: &Pose, failure: Option<&Failure>) -> Self {
        let robot = site.robot();
        let weight = robot.total_mass() * site.settings.environment.gravity;
        let zero = nalgebra::Vector3::zeros();
        let stability = crate::stability::stability(pose, weight, zero, zero).ok().map(|stability| stability.margin);
        let joints = robot.links.iter().zip(&pose.joints);
        let wheels = robot.wheels.iter().zip(&pose.contacts);
        Self {
            position: pose.attitude.position.into(),
            heading: pose.attitude.heading,
            roll: pose.attitude.roll,
            pitch: pose.attitude.pitch,
            joints: joints.map(|(link, &value)| JointAnswer { name: link.joint.name.clone(), value }).collect(),
            wheels: wheels.map(|(wheel, contact)| WheelAnswer::new(&wheel.name, contact)).collect(),
            clearance: finite(pose.clearance),
            safe: failure.is_none(),
            failure: failure.map(ToString::to_string),
            stability,
            thrust: site.largest_thrust(pose),
        }
    }
}

impl WheelAnswer {
    fn new(name: &str, contact: &Contact) -> Self {
        let (point, normal) = (contact.point.into(), contact.normal.into());
        Self { name: name.to_owned(), point, normal, contact_angle: contact.angle() }
    }
}

impl PlanAnswer {
    /// The answer for a plan of a site.
    #[must_use]
    pub fn new(site: &Site, plan: &Plan) -> Self {
        let failures = plan.failures.iter().map(|([x, y], heading, failure)| FailureAnswer {
            x: *x,
            y: *y,
            heading: *heading,
            kind: failure.kind(),
            reason: failure.to_string(),
        });
        Self {
            length: plan.length,
            cost: plan.cost,
            searches: plan.searches,
            evaluations: plan.evaluations,
            points: plan.points.iter().map(PointAnswer::new).collect(),
            failures: failures.collect(),
            remarks: site.remarks(),
        }
    }
}

impl PointAnswer {
    fn new(point: &PathPoint) -> Self {
        let attitude = &point.assessment.pose.attitude;
        Self {
            x: point.x,
            y: point.y,
            z: attitude.position.z,
            travelled: point.travelled,
            heading: point.heading,
            roll: attitude.roll,
            pitch: attitude.pitch,
            stability: point.assessment.stability,
            thrust: point.assessment.thrust,
            clearance: finite(point.assessment.clearance),
        }
    }
}
