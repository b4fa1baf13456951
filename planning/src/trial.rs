//! The comparison of table 3.1: the planner against the binary planner on generated ground.

use crate::drive::{Drive, DriveError, Half, Track, driven, on_firm_ground};
use crate::force::{Load, Shear, ShearError};
use crate::map::{Difficulty, Interpolation, MapError, RockyGround, Surface, rocky};
use crate::plan::{
    BinaryPath, CostField, Evaluator, Localisation, PathPoint, PerformanceIndex, Planner, Request, Stand, binary_path,
};
use crate::robot::{RobotError, fsrl};
use bekker::model::ControlKind;
use bekker::rover::Rover;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Least distance of start and goal, m (3.3).
const LEAST_DISTANCE: f64 = 5.0;

/// Starts and goals lie this far from the map's edges, m: the rover's length, so that it can stand there in any heading.
const EDGE: f64 = 0.5;

/// Obstacle heights of the binary planner, shares of a wheel's diameter (3.3).
pub const BINARY: [f64; 2] = [0.8, 1.2];

/// Coefficient of friction of the ground, which the thesis does not give.
pub const FRICTION: f64 = 0.6;

/// Stands that a plan may evaluate: a fifth of all of the map's.
const MOST_EVALUATIONS: usize = 60_000;

/// Speed of the driven check, m/s: that of the thesis's rover.
const SPEED: f64 = 0.08;

/// Start of the seeds of starts and goals beside those of the ground.
const PLACES: u64 = 1 << 32;

/// Shape of the ground of a difficulty: 195 x 195 nodes, 4 cm apart, as the thesis states. The number of rocks is that at which the
/// density of obstacles (for the FSRL rover's wheels) has the thesis's value on the average of 40 seeds, see the test
/// `published_ground_has_the_density_of_obstacles_of_the_thesis`.
#[must_use]
pub fn ground_shape(difficulty: Difficulty) -> RockyGround {
    let density = match difficulty {
        Difficulty::Benign => 0.145,
        Difficulty::Moderate => 0.65,
        Difficulty::Difficult => 1.9,
    };
    RockyGround { density, ..RockyGround::default() }
}

/// One start and goal on one ground.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Trial {
    /// Seed of ground and places.
    pub seed: u64,
    /// Start, m.
    pub start: [f64; 2],
    /// Goal, m.
    pub goal: [f64; 2],
    /// Length of the planner's path, m; none where it finds no safe one.
    pub length: Option<f64>,
    /// Why not.
    pub refusal: Option<String>,
    /// Time of planning, s of the machine; the index's field included.
    pub seconds: f64,
    /// Stands evaluated.
    pub evaluations: usize,
    /// The binary planner at each obstacle height of [`BINARY`].
    pub binary: Vec<BinaryTrial>,
    /// The planner's path driven in the core under velocity control with gains that follow from the plant, where that was asked for.
    pub drive: Option<Driven>,
    /// The same under rough-terrain control with wheel-speed loops.
    pub rtc: Option<Driven>,
    /// The planner's path, and what the evaluation says of its points; empty where there is none.
    #[serde(skip)]
    pub points: Vec<TrialPoint>,
}

/// A point of the planner's path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrialPoint {
    /// Place, m.
    pub place: [f64; 2],
    /// Way from the start, m.
    pub travelled: f64,
    /// Stability angle, rad.
    pub stability: f64,
    /// Largest thrust, N.
    pub thrust: f64,
}

/// A path given to the core to drive.
#[derive(Clone, Debug, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Driven {
    /// What came of it.
    Driven(Drive),
    /// Why it could not be driven.
    Refused(String),
}

/// The binary planner on the same task.
#[derive(Clone, Debug, serde::Serialize)]
pub struct BinaryTrial {
    /// Length, m; none where it finds no path.
    pub length: Option<f64>,
    /// Stands of its path at which the model-based evaluation says that the rover fails.
    pub unsafe_stands: usize,
    /// Its path driven in the core, where that was asked for.
    pub drive: Option<Driven>,
    /// Its path, m; empty where there is none.
    #[serde(skip)]
    pub points: Vec<[f64; 2]>,
}

/// Why a trial cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum TrialError {
    /// The ground.
    #[error(transparent)]
    Map(#[from] MapError),
    /// The robot.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// The ground does not carry the rover.
    #[error(transparent)]
    Shear(#[from] ShearError),
    /// The planar rover.
    #[error(transparent)]
    Drive(#[from] DriveError),
}

/// One trial of table 3.1 on firm ground of `friction`; with `drive` the planner's path is driven. The same seed gives the same paths.
///
/// # Errors
/// [`TrialError`] where the ground or the rover cannot be made; a task without a path is no error.
pub fn trial(difficulty: Difficulty, seed: u64, friction: f64, drive: bool) -> Result<Trial, TrialError> {
    let map = rocky(&ground_shape(difficulty), seed)?;
    let robot = fsrl();
    let surface = Surface::new(map.clone(), Interpolation::Smooth);
    let (start, goal) = places(&map.bounds(), seed);
    let clock = std::time::Instant::now();
    let field = CostField::new(&map, &robot, &PerformanceIndex::default());
    // The plan counts on the strength of the very ground that is driven over.
    let half = Half::new(&robot, &[], &on_firm_ground(Rover::fsrl(), friction))?;
    let load = robot.total_mass() * Load::default().gravity / robot.wheels.len() as f64;
    let shear = Shear::of(&half.rover.soil, &half.rover.wheel, load)?;
    let evaluator = || Evaluator::new(&robot, &surface, &[], shear);
    let mut planner = Planner::new(evaluator()?, field, Localisation::default());
    let planned = planner.plan(&Request { start, heading: None, goal, most_evaluations: MOST_EVALUATIONS });
    let seconds = clock.elapsed().as_secs_f64();
    let judge = evaluator()?;
    let node = |place: [f64; 2]| map.nearest(place).unwrap_or_default();
    let check = |points: &[[f64; 2]], kind| {
        (drive && !points.is_empty()).then(|| match driven(points, &surface, &half, Track::Mean, kind, SPEED) {
            Ok(drive) => Driven::Driven(drive),
            Err(error) => Driven::Refused(error.to_string()),
        })
    };
    let mut before: Option<BinaryTrial> = None;
    let binary = BINARY.map(|share| {
        let height = share * 2.0 * robot.wheel_radius;
        let path = binary_path(&map, &robot, height, node(start), node(goal));
        let fails = |stand: &&Stand| judge.assess(stand.place(&map), stand.angle(), None).is_err();
        let places = |path: &BinaryPath| path.stands.iter().map(|stand| stand.place(&map)).collect();
        let points: Vec<[f64; 2]> = path.as_ref().map_or(Vec::new(), places);
        // Where both heights leave the same path free, it is judged and driven once.
        let same = before.take().filter(|before| before.points == points);
        let trial = same.unwrap_or_else(|| BinaryTrial {
            unsafe_stands: path.as_ref().map_or(0, |path| path.stands.iter().filter(fails).count()),
            length: path.as_ref().map(|path| path.length),
            drive: check(&points, ControlKind::VelocityTuned),
            points,
        });
        before = Some(trial.clone());
        trial
    });
    let plan = planned.as_ref().ok();
    let point = |point: &PathPoint| TrialPoint {
        place: [point.x, point.y],
        travelled: point.travelled,
        stability: point.assessment.stability,
        thrust: point.assessment.thrust,
    };
    let points: Vec<TrialPoint> = plan.map_or(Vec::new(), |plan| plan.points.iter().map(point).collect());
    let places: Vec<[f64; 2]> = points.iter().map(|point| point.place).collect();
    Ok(Trial {
        seed,
        start,
        goal,
        length: plan.map(|plan| plan.length),
        refusal: planned.as_ref().err().map(ToString::to_string),
        seconds,
        evaluations: plan.map_or(0, |plan| plan.evaluations),
        binary: binary.to_vec(),
        drive: check(&places, ControlKind::VelocityTuned),
        rtc: check(&places, ControlKind::RtcSpeed),
        points,
    })
}

/// Start and goal of a seed, evenly over the map, at least [`LEAST_DISTANCE`] apart.
fn places(bounds: &[f64; 4], seed: u64) -> ([f64; 2], [f64; 2]) {
    let mut random = ChaCha8Rng::seed_from_u64(seed + PLACES);
    let mut place = || [0, 1].map(|axis| random.random_range(bounds[axis] + EDGE..bounds[axis + 2] - EDGE));
    loop {
        let (start, goal) = (place(), place());
        if (start[0] - goal[0]).hypot(start[1] - goal[1]) >= LEAST_DISTANCE {
            return (start, goal);
        }
    }
}
