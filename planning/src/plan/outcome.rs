//! What a planner gives: a path with what the rover meets on it, or the reason why there is none.

use super::evaluate::{Assessment, Failure};

/// A point of a path.
#[derive(Clone, Debug)]
pub struct PathPoint {
    /// Easting, m.
    pub x: f64,
    /// Northing, m.
    pub y: f64,
    /// Heading, rad from east to north.
    pub heading: f64,
    /// Way from the start, m.
    pub travelled: f64,
    /// How the rover stands there.
    pub assessment: Assessment,
    /// Smallest and largest slope of the direction of travel, rad, over all cases of the terrain's error and all stands within that of
    /// dead reckoning.
    pub slope: [f64; 2],
}

/// What a plan is the cheapest in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The performance index (3.5).
    Index,
    /// Energy of the wheels, J.
    Energy,
}

impl Measure {
    /// A cost of it in words.
    #[must_use]
    pub fn told(self, cost: f64) -> String {
        match self {
            Self::Index => format!("performance index {cost:.3}"),
            Self::Energy => format!("energy {cost:.1} J"),
        }
    }
}

/// A safe path.
#[derive(Clone, Debug)]
pub struct Plan {
    /// From start to goal; a turn where the rover stands is a second point at the same place.
    pub points: Vec<PathPoint>,
    /// Length, m.
    pub length: f64,
    /// Performance index (3.5), or energy, J.
    pub cost: f64,
    /// Which of them.
    pub measure: Measure,
    /// Searches made.
    pub searches: usize,
    /// Stands evaluated.
    pub evaluations: usize,
    /// Where the rover would fail: place (m), heading (rad), reason.
    pub failures: Vec<([f64; 2], f64, Failure)>,
}

/// Why the goal is out of reach.
#[derive(Clone, Debug, PartialEq)]
pub struct Unreachable {
    /// Nearest point to the goal that a safe path reaches, m.
    pub nearest: [f64; 2],
    /// Its distance from the goal, m.
    pub distance: f64,
    /// Failures by kind, most frequent first.
    pub failures: Vec<(&'static str, usize)>,
}

/// Why there is no plan.
#[derive(Clone, Debug, thiserror::Error)]
pub enum PlanError {
    /// Start or goal lies beyond the map.
    #[error("the {which} ({x}, {y}) is off the map, which spans x {:.2}..{:.2}, y {:.2}..{:.2} m", bounds[0], bounds[2], bounds[1], bounds[3])]
    OffMap {
        /// "start" or "goal".
        which: &'static str,
        /// Easting, m.
        x: f64,
        /// Northing, m.
        y: f64,
        /// West, south, east, north edge, m.
        bounds: [f64; 4],
    },
    /// Start or goal lies in a hole of the map.
    #[error("the {which} ({x}, {y}) lies in a hole of the map, where nothing was measured")]
    Hole {
        /// "start" or "goal".
        which: &'static str,
        /// Easting, m.
        x: f64,
        /// Northing, m.
        y: f64,
    },
    /// The rover cannot stand at start or goal.
    #[error("the rover cannot stand at the {which} ({x:.2}, {y:.2}) in any heading asked for: {reason}")]
    CannotStand {
        /// "start" or "goal".
        which: &'static str,
        /// Easting, m.
        x: f64,
        /// Northing, m.
        y: f64,
        /// Why, in the first heading.
        reason: Failure,
    },
    /// No safe path.
    #[error(
        "no safe path reaches the goal; the nearest point that one reaches is ({:.2}, {:.2}), {:.2} m from it; \
         the rover would fail by: {}",
        .0.nearest[0], .0.nearest[1], .0.distance,
        .0.failures.iter().map(|(kind, count)| format!("{kind} ({count})")).collect::<Vec<_>>().join(", ")
    )]
    Unreachable(Unreachable),
    /// The limit of searches is reached.
    #[error(
        "no safe path after {searches} searches and {evaluations} evaluations; raise the limit of evaluations, or choose another goal"
    )]
    GivenUp {
        /// Searches made.
        searches: usize,
        /// Stands evaluated.
        evaluations: usize,
    },
}
