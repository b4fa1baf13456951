//! The ground ahead of a rover, as an elevation map has it that was made with a camera or a laser.
//!
//! At distances d_k along x from the body's reference point a reading has the height of the ground, or of the obstacle that stands there,
//! and the shear strength of the soil at the mean ground pressure p of the wheels. Every height has noise of its own, new in each reading,
//! and a cell may be missing; it then reads 0:
//!
//! ```text
//! height_k   = h(x + d_k) - h(x) + noise
//! strength_k = (c + p tan phi at x + d_k) / (c + p tan phi of the model's soil),     p = m g / (n r b)
//! ```
//!
//! The map is stored and looked up at the recorded `x`: where an effect changes what is recorded (the scale of the odometry, a lag), the
//! cells read are those about the recorded place. Effects on the soil, such as a soft patch, are not on the map.
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
    /// `dropout` is not within 0 to 1.
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
    /// Numbers that a reading has for each distance: height (m), 1 where the cell is there and 0 where it is missing, relative strength of the soil.
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

    /// Reads the ground about the place `x`: all heights, then which cells are there, then the strengths; `out` holds [`Self::ROWS`]
    /// numbers for each distance.
    pub(crate) fn read(&self, rover: &Rover, obstacles: &[Obstacle], x: f64, at: ReadingOf, out: &mut [f64]) {
        let mut noise = at.noise();
        let here = rover.terrain.at(x).height;
        let count = self.distances.len();
        let pressure = ground_pressure(rover);
        let usual = rover.soil.shear_strength(pressure);
        for (k, distance) in self.distances.iter().enumerate() {
            // Always the same draws, so that what one cell reads does not depend on the others.
            let (error, chance): (f64, f64) = (StandardNormal.sample(&mut noise), noise.random());
            let there = x + distance;
            let present = chance >= self.dropout;
            let height = top(rover, obstacles, there) - here + self.noise * error;
            let strength = rover.terrain.soil(&rover.soil, there).shear_strength(pressure) / usual;
            out[k] = if present { height } else { 0.0 };
            out[count + k] = f64::from(present);
            out[2 * count + k] = if present { strength } else { 0.0 };
        }
    }
}

/// Stream of the seed in the first step; the sensors have the first two streams.
const FIRST_STREAM: u64 = 1 << 32;

/// Weight of the rover over the sum of radius times width of its wheels, Pa.
fn ground_pressure(rover: &Rover) -> f64 {
    let area = rover.wheels.len() as f64 * rover.wheel.radius * rover.wheel.width;
    rover.total_mass() * rover.environment.gravity / area
}

/// The run and the moment of a reading, which decide its noise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReadingOf {
    pub seed: u64,
    pub tick: u64,
}

impl ReadingOf {
    /// A stream of its own for each step.
    fn noise(self) -> ChaCha8Rng {
        let mut noise = ChaCha8Rng::seed_from_u64(self.seed);
        noise.set_stream(FIRST_STREAM + self.tick);
        noise
    }
}

/// Height of what a wheel would stand on at `x`: the ground or an obstacle.
fn top(rover: &Rover, obstacles: &[Obstacle], x: f64) -> f64 {
    let ground = rover.terrain.at(x).height;
    let of = |obstacle: &Obstacle| Some(obstacle.height_at(x)? + rover.terrain.at(obstacle.parameters.x).height);
    obstacles.iter().filter_map(of).fold(ground, f64::max)
}
