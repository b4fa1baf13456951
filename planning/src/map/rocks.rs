//! Seeded ground with features of a given density, in place of the thesis's terrain generator.
//!
//! The thesis names "a pseudo-random terrestrial terrain generator based on the logit transform (Pickover 1995)" that works from a
//! "terrain feature density", and gives nothing more than the density of obstacles that came of it. Here: rocks and pits at places
//! evenly over the map, as many as the density says, with heights from uniform numbers u by s ln(u / (1 - u)) (the logit transform),
//! on wide gentle swells. Most features are low and a few prominent, as the logistic distribution has them.

use super::generate::{field, logit};
use super::{ElevationMap, MapError};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Ground with single rocks and pits.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RockyGround {
    /// Nodes along each side.
    pub nodes: usize,
    /// Spacing of the nodes, m.
    pub cell: f64,
    /// Rocks and pits a square metre.
    pub density: f64,
    /// Mean radius of a feature, m; radii are evenly spread from half to one and a half of it.
    pub radius: f64,
    /// Scale s of the logistic distribution of the features' heights, m: half of them are higher than 1.1 s, one in ten than 2.9 s.
    pub height: f64,
    /// Standard deviation of the smoothing of the swells, m.
    pub swell_size: f64,
    /// Standard deviation of the heights of the swells, m.
    pub swell: f64,
}

impl Default for RockyGround {
    /// The map of section 3.3. Sizes are assumptions: features a little shorter than the rover, half of them higher than a wheel's radius;
    /// swells of a few degrees.
    fn default() -> Self {
        Self { nodes: 195, cell: 0.04, density: 0.5, radius: 0.15, height: 0.06, swell_size: 0.9, swell: 0.1 }
    }
}

/// The three grounds of section 3.3, by their density of obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Difficulty {
    /// 0.05 obstacles a rover's area.
    Benign,
    /// 0.23.
    Moderate,
    /// 0.72.
    Difficult,
}

impl Difficulty {
    /// All three, as the thesis numbers them.
    pub const ALL: [Self; 3] = [Self::Benign, Self::Moderate, Self::Difficult];

    /// Obstacles a rover's area, as the thesis states (nodes whose largest step to a neighbour exceeds 80 % of a wheel's
    /// diameter, over the rover's footprint).
    #[must_use]
    pub fn density(self) -> f64 {
        match self {
            Self::Benign => 0.05,
            Self::Moderate => 0.23,
            Self::Difficult => 0.72,
        }
    }
}

/// Ground of a seed. The south-western node is at (0, 0); the same seed gives the same bits.
///
/// # Errors
/// [`MapError`] where `shape` makes no map.
pub fn rocky(shape: &RockyGround, seed: u64) -> Result<ElevationMap, MapError> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let swells = field(shape.nodes, shape.swell_size / shape.cell, &mut random);
    let mut heights: Vec<f64> = swells.iter().map(|swell| shape.swell * swell).collect();
    let side = (shape.nodes as f64 - 1.0) * shape.cell;
    let count = (shape.density * side * side).round().max(0.0) as usize;
    for _ in 0..count {
        let [x, y] = [0, 1].map(|_| side * random.random::<f64>());
        let radius = shape.radius * (0.5 + random.random::<f64>());
        let height = shape.height * logit(random.random::<f64>());
        add_feature(&mut heights, shape, [x, y], radius, height);
    }
    ElevationMap::new(shape.nodes, shape.nodes, shape.cell, [0.0, 0.0], heights)
}

/// Adds a rock (or, where `height` is negative, a pit): height exp(-(d/radius)^4), flat on top and steep at its side.
fn add_feature(heights: &mut [f64], shape: &RockyGround, [x, y]: [f64; 2], radius: f64, height: f64) {
    // exp(-1.8^4) is 3e-5.
    let reach = 1.8 * radius / shape.cell;
    let ends = |at: f64| {
        let at = at / shape.cell;
        ((at - reach).ceil().max(0.0) as usize)..((at + reach).floor() as usize + 1).min(shape.nodes)
    };
    for row in ends(y) {
        for column in ends(x) {
            let d = (column as f64 * shape.cell - x).hypot(row as f64 * shape.cell - y);
            heights[row * shape.nodes + column] += height * (-(d / radius).powi(4)).exp();
        }
    }
}
