//! The comparison of table 3.1: the planner against the binary planner on generated ground.

use crate::drive::{Drive, driven, on_firm_ground};
use crate::map::{Difficulty, GroundShape, Interpolation, Surface, generated};
use crate::plan::{CostField, Evaluator, Localisation, PerformanceIndex, Planner, Request, Stand, binary_path};
use crate::robot::fsrl;
use crate::site::SiteError;
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

/// Speed of the driven check, m/s: that of the thesis's rover.
const SPEED: f64 = 0.08;

/// Start of the seeds of starts and goals beside those of the ground.
const PLACES: u64 = 1 << 32;

/// Shape of the ground of a difficulty: 195 x 195 nodes, 4 cm apart, as the thesis states. The heights of the rocks are those at
/// which the density of obstacles (for the FSRL rover's wheels) has the thesis's value on the average of 40 seeds, see the test
/// `published_ground_has_the_density_of_obstacles_of_the_thesis`.
#[must_use]
pub fn ground_shape(difficulty: Difficulty) -> GroundShape {
    let roughness = match difficulty {
        Difficulty::Benign => 0.0648,
        Difficulty::Moderate => 0.074,
        Difficulty::Difficult => 0.0837,
    };
    GroundShape { nodes: 195, cell: 0.04, feature: 0.1, roughness, swell: 0.1 }
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
    /// The planner's path driven in the core, where that was asked for and could start.
    pub drive: Option<Drive>,
}

/// The binary planner on the same task.
#[derive(Clone, Debug, serde::Serialize)]
pub struct BinaryTrial {
    /// Length, m; none where it finds no path.
    pub length: Option<f64>,
    /// Stands of its path at which the model-based evaluation says that the rover fails.
    pub unsafe_stands: usize,
}

/// One trial of table 3.1 on firm ground of `friction`; with `drive` the planner's path is driven. The same seed gives the same paths.
///
/// # Errors
/// [`SiteError`] where the ground cannot be made; a task without a path is no error.
pub fn trial(difficulty: Difficulty, seed: u64, friction: f64, drive: bool) -> Result<Trial, SiteError> {
    let map = generated(&ground_shape(difficulty), seed)?;
    let robot = fsrl();
    let surface = Surface::new(map.clone(), Interpolation::Smooth);
    let (start, goal) = places(&map.bounds(), seed);
    let clock = std::time::Instant::now();
    let field = CostField::new(&map, &robot, &PerformanceIndex::default());
    let evaluator = || Evaluator::new(&robot, &surface, &[], crate::force::Shear::firm(friction));
    let mut planner = Planner::new(evaluator()?, field, Localisation::default());
    let planned = planner.plan(&Request { start, heading: None, goal, most_evaluations: 60_000 });
    let seconds = clock.elapsed().as_secs_f64();
    let judge = evaluator()?;
    let node = |place: [f64; 2]| map.nearest(place).unwrap_or_default();
    let binary = BINARY.map(|share| {
        let height = share * 2.0 * robot.wheel_radius;
        let path = binary_path(&map, &robot, height, node(start), node(goal));
        let fails = |stand: &&Stand| judge.assess(stand.place(&map), stand.angle(), None).is_err();
        BinaryTrial {
            unsafe_stands: path.as_ref().map_or(0, |path| path.stands.iter().filter(fails).count()),
            length: path.map(|path| path.length),
        }
    });
    let drive = planned.as_ref().ok().filter(|_| drive).and_then(|plan| {
        driven(plan, &surface, on_firm_ground(Rover::fsrl(), friction), ControlKind::Velocity, SPEED).ok()
    });
    Ok(Trial {
        seed,
        start,
        goal,
        length: planned.as_ref().ok().map(|plan| plan.length),
        refusal: planned.as_ref().err().map(ToString::to_string),
        seconds,
        evaluations: planned.as_ref().map_or(0, |plan| plan.evaluations),
        binary: binary.to_vec(),
        drive,
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
