//! How much of a calibration is spent where: starts from seeded draws, searches, and how long these are followed.

use super::free::Free;
use super::least_squares::{LeastSquares, Pace};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const SEED: u64 = 1967;

/// How many starts a calibration tries, and how long it follows them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Effort {
    /// Draws from which the starts are chosen by their cost.
    pub draws: usize,
    /// How many of them are searched from, besides the given values.
    pub searches: usize,
    /// How long a search is followed.
    pub pace: Pace,
    /// Draws, and how many of the best are searched from, one after the other, until two searches have ended at the least cost.
    pub until_agreed: Option<(usize, usize)>,
}

impl Effort {
    /// A first look at an effect on a traverse, from the given starts and so many draws.
    pub fn scouting(searches: usize) -> Self {
        Self { draws: 8 * searches, searches, pace: Pace::SHORT, until_agreed: None }
    }

    /// To a place from which a search over more measurements begins.
    pub fn roughly(self) -> Self {
        Self { pace: if self.pace == Pace::BRISK { Pace::ROUGH } else { self.pace }, ..self }
    }

    /// From the given starts only.
    pub fn without_draws(self) -> Self {
        Self { draws: 0, searches: 0, until_agreed: None, ..self }
    }
}

/// Seeded draws around the given values.
pub(crate) struct Draws<'a> {
    problem: &'a LeastSquares<'a>,
    given: Vec<f64>,
    rng: ChaCha8Rng,
    /// Draws that were not taken, each with its cost.
    left: Vec<(f64, Vec<f64>)>,
}

impl<'a> Draws<'a> {
    pub fn new(problem: &'a LeastSquares<'a>, free: &[Free]) -> Self {
        let given = free.iter().map(|f| f.coordinate(f.start)).collect();
        Self { problem, given, rng: ChaCha8Rng::seed_from_u64(SEED), left: Vec::new() }
    }

    /// Draws `count` more and takes the best `most` out, as far as their costs are finite.
    pub fn best(&mut self, count: usize, most: usize) -> Vec<Vec<f64>> {
        for _ in 0..count {
            let u = self.next();
            let cost = self.problem.cost_at(&u);
            self.left.extend(cost.is_finite().then_some((cost, u)));
        }
        self.left.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.left.drain(..most.min(self.left.len())).map(|(_, u)| u).collect()
    }

    /// Half of the way from the given values to anywhere between the bounds: wide, but not absurd.
    fn next(&mut self) -> Vec<f64> {
        let bounds = self.problem.lower.iter().zip(&self.problem.upper);
        let anywhere = bounds.map(|(lower, upper)| lower + (upper - lower) * self.rng.random::<f64>());
        anywhere.zip(&self.given).map(|(anywhere, given)| 0.5 * (given + anywhere)).collect()
    }
}
