//! The ground ahead of a rover, as an elevation map from a camera or a laser has it.
//!
//! At chosen distances along x from the body's reference point the map tells the height of the ground, or of the obstacle that stands
//! there, above the ground at the reference point. Every cell has noise of its own, anew in each reading, and may be missing:
//!
//! ```text
//! height_k = h(x + d_k) - h(x) + noise          0 where the cell is missing
//! ```
//!
//! The map lies where the rover takes itself to be, at the recorded `x`: a wrong scale of the odometry or a lag moves it along the ground.
//!
//! A reading is a function of the run's seed and its inner step: reading twice in one step gives the same, and a copy of a run
//! reads what the run itself reads.

use crate::obstacle::Obstacle;
use crate::rover::Rover;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// What is wrong with an [`Ahead`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum AheadError {
    /// No distance was given.
    #[error("distances: expected at least one, m")]
    Empty,
    /// A distance is not finite.
    #[error("distances[{index}] = {value}: expected a finite distance along x, m")]
    Distance {
        /// Its place.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The noise is negative or not finite.
    #[error("noise = {0}: expected a standard deviation from 0, m")]
    Noise(f64),
    /// The probability of a missing cell is none.
    #[error("dropout = {0}: expected a probability within 0 .. 1")]
    Dropout(f64),
}

/// Where the ground ahead is looked at, and how well.
#[derive(Clone, Debug, PartialEq)]
pub struct Ahead {
    distances: Vec<f64>,
    noise: f64,
    dropout: f64,
}

impl Ahead {
    /// Numbers that a reading has for each distance: height (m), 1 where the cell is not missing, 1 where the soil is another one.
    pub const ROWS: usize = 3;

    /// A map with cells at `distances` along x from the body's reference point, m, negative ones behind it; `noise` is the standard
    /// deviation of a height, m, and `dropout` the probability with which a cell is missing.
    ///
    /// # Errors
    /// [`AheadError`] names the number that is refused.
    pub fn new(distances: Vec<f64>, noise: f64, dropout: f64) -> Result<Self, AheadError> {
        if distances.is_empty() {
            return Err(AheadError::Empty);
        }
        if let Some((index, value)) = distances.iter().enumerate().find(|(_, distance)| !distance.is_finite()) {
            return Err(AheadError::Distance { index, value: *value });
        }
        if !(noise.is_finite() && noise >= 0.0) {
            return Err(AheadError::Noise(noise));
        }
        if !(0.0..=1.0).contains(&dropout) {
            return Err(AheadError::Dropout(dropout));
        }
        Ok(Self { distances, noise, dropout })
    }

    /// Where the cells are, m.
    #[must_use]
    pub fn distances(&self) -> &[f64] {
        &self.distances
    }

    /// Standard deviation of a height, m.
    #[must_use]
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// Probability with which a cell is missing.
    #[must_use]
    pub fn dropout(&self) -> f64 {
        self.dropout
    }

    /// Reads the ground ahead of `x`: all heights, then which cells are there, then which have another soil than the rover's own;
    /// `out` holds [`Self::ROWS`] numbers for each distance.
    pub(crate) fn read(&self, rover: &Rover, obstacles: &[Obstacle], x: f64, at: ReadingOf, out: &mut [f64]) {
        let mut noise = at.noise();
        let here = rover.terrain.at(x).height;
        let count = self.distances.len();
        for (k, distance) in self.distances.iter().enumerate() {
            // Always the same draws, so that what one cell reads does not depend on the others.
            let (error, chance): (f64, f64) = (StandardNormal.sample(&mut noise), noise.random());
            let there = x + distance;
            let present = chance >= self.dropout;
            let height = top(rover, obstacles, there) - here + self.noise * error;
            let other = rover.terrain.soil(&rover.soil, there) != rover.soil;
            out[k] = if present { height } else { 0.0 };
            out[count + k] = f64::from(present);
            out[2 * count + k] = f64::from(present && other);
        }
    }
}

/// The run and the moment of a reading, which decide its noise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReadingOf {
    pub seed: u64,
    pub tick: u64,
}

impl ReadingOf {
    /// A stream of its own for each moment; the first stream of the seed is that of the other sensors.
    fn noise(self) -> ChaCha8Rng {
        let mut noise = ChaCha8Rng::seed_from_u64(self.seed);
        noise.set_stream(self.tick + 1);
        noise
    }
}

/// Height of what a wheel would stand on at `x`: the ground or an obstacle.
fn top(rover: &Rover, obstacles: &[Obstacle], x: f64) -> f64 {
    let ground = rover.terrain.at(x).height;
    let of = |obstacle: &Obstacle| Some(rover.terrain.at(obstacle.parameters.x).height + obstacle.height_at(x)?);
    obstacles.iter().filter_map(of).fold(ground, f64::max)
}
