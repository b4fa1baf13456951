//! Model-based evaluation of a stand: pose, stability, forces (3.2.2), over the worst cases of the terrain's error (3.2.5).

use crate::force::{Assumptions, ForceError, Load, Programme, Shear};
use crate::map::{RangeError, Surface};
use crate::pose::{Placing, Pose, PoseError, Violation};
use crate::robot::{Attitude, Robot, RobotError};
use crate::stability::{StabilityError, stability};
use bekker_modeldescription::{Unit, parameters};
use nalgebra::Vector3;

/// Most wheels whose worst cases are enumerated: 2^8 poses.
const MOST_WHEELS: usize = 8;

parameters! {
    /// What a stand must keep.
    pub struct Limits {
        /// Smallest stability angle alpha_min (3.11).
        stability: [Unit::RADIAN] = 10.0_f64.to_radians(), 0.0..=1.5, Fixed, "assumption: the thesis has `a positive constant`";
        /// Thrust that must be possible in the direction of travel, as a share of the weight (3.2.2, force analysis).
        thrust: [Unit::ONE] = 0.02, 0.0..=2.0, Fixed, "assumption: the thesis has `a small positive constant`";
        /// Smallest distance of the belly from the ground.
        clearance: [Unit::METRE] = 0.0, -1.0..=10.0, Fixed, "assumption: touching is allowed, not more";
    }
}

/// Why the rover must not stand somewhere.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// No pose, or over unknown ground.
    #[error("{0}")]
    Pose(PoseError),
    /// A joint limit, or the belly in the ground.
    #[error("{0}")]
    Kinematic(Violation),
    /// The belly is nearer to the ground than allowed.
    #[error("the belly is {clearance:.3} m over the ground; expected at least {least:.3} m")]
    Clearance {
        /// Distance, m.
        clearance: f64,
        /// Smallest allowed, m.
        least: f64,
    },
    /// Tipping over.
    #[error("the stability angle is {:.1} deg; expected at least {:.1} deg", margin.to_degrees(), least.to_degrees())]
    Stability {
        /// The margin, rad.
        margin: f64,
        /// Smallest allowed, rad.
        least: f64,
    },
    /// Contacts on one line.
    #[error(transparent)]
    Support(#[from] StabilityError),
    /// No forces hold the rover.
    #[error("no forces within friction and drives hold the rover")]
    NoForces,
    /// Not enough thrust.
    #[error("the largest thrust is {largest:.2} N; expected at least {needed:.2} N")]
    Thrust {
        /// Largest possible, N.
        largest: f64,
        /// Needed, N.
        needed: f64,
    },
    /// The rover slides ahead.
    #[error("the rover slides: braking leaves {smallest:.2} N ahead; expected at most {needed:.2} N")]
    Slides {
        /// Smallest possible thrust, N.
        smallest: f64,
        /// Thrust wanted, N.
        needed: f64,
    },
    /// The force programme failed.
    #[error(transparent)]
    Force(#[from] ForceError),
}

impl Failure {
    /// A word for the kind.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Pose(PoseError::Unknown { .. }) => "unknown ground",
            Self::Pose(_) => "no pose",
            Self::Kinematic(Violation::Joint { .. }) => "joint limit",
            Self::Kinematic(Violation::Belly { .. }) | Self::Clearance { .. } => "belly",
            Self::Stability { .. } | Self::Support(_) => "stability",
            Self::NoForces | Self::Thrust { .. } | Self::Slides { .. } | Self::Force(_) => "forces",
        }
    }
}

/// How a stand is, in the worst of its cases.
#[derive(Clone, Debug)]
pub struct Assessment {
    /// The pose on the map as it is.
    pub pose: Pose,
    /// Smallest stability angle, rad.
    pub stability: f64,
    /// Smallest of the largest thrusts, N.
    pub thrust: f64,
    /// Smallest clearance, m.
    pub clearance: f64,
    /// Smallest and largest slope of the direction of travel, uphill positive, rad.
    pub slope: [f64; 2],
    /// Cases looked at: 1, or 2^n with uncertain ground.
    pub cases: usize,
}

/// Evaluates stands of a robot on a surface.
#[derive(Clone, Debug)]
pub struct Evaluator<'a> {
    placing: Placing<'a>,
    /// Load.
    pub load: Load,
    /// Strength of the ground.
    pub shear: Shear,
    /// What the force analysis assumes.
    pub assumptions: Assumptions,
    /// What must be kept.
    pub limits: Limits,
    /// The sensor's error and where it stood, m; none for a map that is exact.
    pub uncertainty: Option<(RangeError, [f64; 2])>,
}

impl<'a> Evaluator<'a> {
    /// An evaluator with default load and limits, on an exact map.
    ///
    /// # Errors
    /// [`RobotError`] where the description is wrong.
    pub fn new(robot: &'a Robot, surface: &'a Surface, active: &[f64], shear: Shear) -> Result<Self, RobotError> {
        let placing = Placing::new(robot, surface, active)?;
        let (load, assumptions, limits) = (Load::default(), Assumptions::default(), Limits::default());
        Ok(Self { placing, load, shear, assumptions, limits, uncertainty: None })
    }

    /// The placing that poses come from.
    #[must_use]
    pub fn placing(&self) -> &Placing<'a> {
        &self.placing
    }

    /// Evaluates a place and heading.
    ///
    /// # Errors
    /// [`Failure`] says which of the checks is not kept, in the order kinematics, stability, forces.
    pub fn assess(&self, place: [f64; 2], heading: f64, start: Option<&Attitude>) -> Result<Assessment, Failure> {
        let pose = self.placing.pose(place, heading, start).map_err(Failure::Pose)?;
        let (stability, thrust) = self.check(&pose)?;
        let clearance = pose.clearance;
        let slope = [pose.attitude.slope(); 2];
        let mut worst = Assessment { pose, stability, thrust, clearance, slope, cases: 1 };
        let Some((error, sensor)) = &self.uncertainty else { return Ok(worst) };
        // (3.15), (3.19)
        let deviation = error.deviation((place[0] - sensor[0]).hypot(place[1] - sensor[1]));
        let wheels = self.placing.robot().wheels.len().min(MOST_WHEELS);
        if deviation == 0.0 {
            return Ok(worst);
        }
        for case in 0..1_usize << wheels {
            let shift = |wheel: usize| if case >> wheel & 1 == 1 { deviation } else { -deviation };
            let shifts: Vec<f64> = (0..wheels).map(shift).collect();
            let placing = self.placing.with_shifts(&shifts);
            let near = worst.pose.attitude.clone();
            let pose = placing.pose(place, heading, Some(&near)).map_err(Failure::Pose)?;
            let (stability, thrust) = self.check(&pose)?;
            worst.stability = worst.stability.min(stability);
            worst.thrust = worst.thrust.min(thrust);
            worst.clearance = worst.clearance.min(pose.clearance);
            let slope = pose.attitude.slope();
            worst.slope = [worst.slope[0].min(slope), worst.slope[1].max(slope)];
            worst.cases += 1;
        }
        Ok(worst)
    }

    /// Stability angle and largest thrust of a pose that keeps all limits.
    fn check(&self, pose: &Pose) -> Result<(f64, f64), Failure> {
        if let Some(violation) = pose.violations.first() {
            return Err(Failure::Kinematic(violation.clone()));
        }
        let least = self.limits.clearance;
        if pose.clearance < least {
            return Err(Failure::Clearance { clearance: pose.clearance, least });
        }
        let weight = self.placing.robot().total_mass() * self.load.gravity;
        let margin = stability(pose, weight, self.load.force, self.load.moment)?.margin;
        let least = self.limits.stability;
        if margin < least {
            return Err(Failure::Stability { margin, least });
        }
        Ok((margin, self.forces(pose, weight)?))
    }

    fn forces(&self, pose: &Pose, weight: f64) -> Result<f64, Failure> {
        let programme = Programme::new(&self.placing, pose, &self.load, &self.shear, self.assumptions)?;
        let needed = self.limits.thrust * weight;
        let largest = programme.largest_thrust()?.ok_or(Failure::NoForces)?.thrust;
        if largest < needed {
            return Err(Failure::Thrust { largest, needed });
        }
        // On ground that does not fall ahead of it a rover that can go can also stay.
        let travel = pose.attitude.rotation() * Vector3::x();
        if travel.z < 0.0 {
            let smallest = programme.smallest_thrust()?.ok_or(Failure::NoForces)?.thrust;
            if smallest > needed {
                return Err(Failure::Slides { smallest, needed });
            }
        }
        Ok(largest)
    }
}
