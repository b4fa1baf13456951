//! The comparison of table 3.1: the planner against the binary planner on generated ground.

use crate::map::{Difficulty, GroundShape};

/// Shape of the ground of a difficulty: 195 x 195 nodes, 4 cm apart, as the thesis states. The heights of the rocks are those at
/// which the density of obstacles (for the FSRL rover's wheels) has the thesis's value on the average of 40 seeds, see the test
/// `published_ground_has_the_density_of_obstacles_of_the_thesis`.
#[must_use]
pub fn ground_shape(difficulty: Difficulty) -> GroundShape {
    let roughness = match difficulty {
        Difficulty::Benign => 0.06,
        Difficulty::Moderate => 0.08,
        Difficulty::Difficult => 0.1,
    };
    GroundShape { nodes: 195, cell: 0.04, feature: 0.12, roughness, swell: 0.1 }
}
