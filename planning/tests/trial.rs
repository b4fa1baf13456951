//! Rocky ground of the thesis's three difficulties.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker_planning::map::{Difficulty, rocky};
use bekker_planning::plan::obstacle_density;
use bekker_planning::robot::fsrl;
use bekker_planning::trial::ground_shape;

#[test]
fn published_ground_has_the_density_of_obstacles_of_the_thesis() {
    let robot = fsrl();
    for difficulty in Difficulty::ALL {
        // 80 % of a wheel's diameter.
        let density = |seed| {
            let map = rocky(&ground_shape(difficulty), seed).unwrap();
            obstacle_density(&map, &robot, 0.8 * 2.0 * robot.wheel_radius)
        };
        let mean = (0..40).map(density).sum::<f64>() / 40.0;
        println!("{difficulty:?}: {mean:.3}, thesis {}", difficulty.density());
        assert!((mean / difficulty.density() - 1.0).abs() < 0.25, "{difficulty:?}: {mean}");
    }
}
