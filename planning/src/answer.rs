//! Poses and plans as every door gives them: serialised once, in SI units and radians.

use crate::alternatives::{Alternatives, Route};
use crate::plan::{Failure, PathPoint, Plan};
use crate::pose::{Contact, Pose};
use crate::site::Site;
use crate::slip::SlipBand;
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
    /// Slip that the slope needs on the plan's soil; none on firm ground, and where none is enough.
    pub slip: Option<f64>,
    /// Lower end of its band; none also where the rover slides there.
    pub slip_low: Option<f64>,
    /// Upper end of its band; none also where no slip is enough there.
    pub slip_high: Option<f64>,
    /// Share of the soils looked at on which no slip is enough, 0 to 1; none on firm ground.
    pub slip_none: Option<f64>,
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
    /// Energy of the wheels by the slopes on which the rover stands, J; none on firm ground, and where some slope cannot be driven within
    /// the largest slip.
    pub energy: Option<f64>,
    /// How the slip of the points and its band were made; none on firm ground.
    pub slip_told: Option<String>,
    /// Other paths to the goal, where they were asked for.
    pub alternatives: Vec<RouteAnswer>,
    /// Alternatives that were looked for and are not there, or take the same path, with the reason.
    pub alternatives_missing: Vec<String>,
}

/// Another path to the goal.
#[derive(Clone, Debug, Serialize)]
pub struct RouteAnswer {
    /// What it is: "shortest safe path".
    pub name: String,
    /// From start to goal, m.
    pub points: Vec<[f64; 2]>,
    /// Length, m.
    pub length: f64,
    /// Cost in the plan's measure; none where it does not allow the path.
    pub cost: Option<f64>,
    /// Energy as the plan's, J.
    pub energy: Option<f64>,
    /// Least stability angle, rad; none where the rover has no pose at some place.
    pub stability: Option<f64>,
    /// Least thrust in reserve, N; none where the rover has no pose, or no forces hold it, at some place.
    pub thrust: Option<f64>,
    /// Largest slip, 0 or more; none on firm ground, where none is enough, and where the path is not safe.
    pub slip: Option<f64>,
    /// Whether the rover may stand at all of its places.
    pub safe: bool,
    /// Places evaluated.
    pub stands: usize,
    /// Those at which the rover would fail.
    pub failures: Vec<FailureAnswer>,
    /// How it compares with the plan.
    pub verdict: String,
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

impl FailureAnswer {
    fn new([x, y]: [f64; 2], heading: f64, failure: &Failure) -> Self {
        Self { x, y, heading, kind: failure.kind(), reason: failure.to_string() }
    }
}

impl RouteAnswer {
    /// The answer for a route.
    #[must_use]
    pub fn new(route: &Route) -> Self {
        let failures = route.failures.iter();
        Self {
            name: route.name.clone(),
            points: route.points.clone(),
            length: route.length,
            cost: route.cost,
            energy: route.energy,
            stability: route.stability,
            thrust: route.thrust,
            slip: route.slip.and_then(finite),
            safe: route.failures.is_empty(),
            stands: route.stands,
            failures: failures.map(|place| FailureAnswer::new(place.place, place.heading, &place.reason)).collect(),
            verdict: route.verdict.clone(),
        }
    }
}

impl PlanAnswer {
    /// The answer for a plan of a site, with the slip along it on soil.
    #[must_use]
    pub fn new(site: &Site, plan: &Plan) -> Self {
        let failures = plan.failures.iter();
        let band = site.slip_band();
        // What the map and the place leave open shows in slopes that differ.
        let uncertain = plan.points.iter().any(|point| point.slope[0] < point.slope[1]);
        Self {
            length: plan.length,
            cost: plan.cost,
            searches: plan.searches,
            evaluations: plan.evaluations,
            points: plan.points.iter().map(|point| PointAnswer::new(point, band.as_ref())).collect(),
            failures: failures.map(|(place, heading, failure)| FailureAnswer::new(*place, *heading, failure)).collect(),
            remarks: site.remarks(),
            energy: site.energy_of(&plan.points),
            slip_told: band.map(|band| band.told(uncertain)),
            alternatives: Vec::new(),
            alternatives_missing: Vec::new(),
        }
    }

    /// The same with other paths to the goal.
    #[must_use]
    pub fn with_alternatives(self, alternatives: &Alternatives) -> Self {
        let routes = alternatives.others.iter().map(RouteAnswer::new);
        Self { alternatives: routes.collect(), alternatives_missing: alternatives.without.clone(), ..self }
    }
}

impl PointAnswer {
    fn new(point: &PathPoint, band: Option<&SlipBand>) -> Self {
        let attitude = &point.assessment.pose.attitude;
        let slip = band.map(|band| band.at(attitude.slope(), point.slope));
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
            slip: slip.and_then(|slip| finite(slip.slip)),
            slip_low: slip.and_then(|slip| finite(slip.low)),
            slip_high: slip.and_then(|slip| finite(slip.high)),
            slip_none: slip.map(|slip| slip.none),
        }
    }
}
