//! Seeded hummocky ground: uniform numbers u on a grid, each turned into ln(u / (1 - u)) (the logit transform), smoothed by a Gaussian
//! to the size of a feature and scaled to a standard deviation. It is rough everywhere; ground with single rocks is
//! [`rocky`](super::rocky).

use super::{ElevationMap, MapError};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Shape of the ground.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct GroundShape {
    /// Nodes along each side.
    pub nodes: usize,
    /// Spacing of the nodes, m.
    pub cell: f64,
    /// Standard deviation of the smoothing, the size of rocks, m.
    pub feature: f64,
    /// Standard deviation of the rocks' heights, m.
    pub roughness: f64,
    /// Standard deviation of the swells, which are four times as wide and not obstacles, m.
    pub swell: f64,
}

/// Ground of a seed. The south-western node is at (0, 0); the same seed gives the same bits.
///
/// # Errors
/// [`MapError`] where `shape` makes no map.
pub fn generated(shape: &GroundShape, seed: u64) -> Result<ElevationMap, MapError> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let [rocks, swells] = [1.0, 4.0].map(|times| field(shape.nodes, times * shape.feature / shape.cell, &mut random));
    let heights = rocks.iter().zip(&swells).map(|(rock, swell)| shape.roughness * rock + shape.swell * swell);
    ElevationMap::new(shape.nodes, shape.nodes, shape.cell, [0.0, 0.0], heights.collect())
}

/// Smoothed logistic noise of mean 0 and standard deviation 1 on `n` x `n` nodes; `size` is the smoothing's deviation in spacings.
pub(super) fn field(n: usize, size: f64, random: &mut ChaCha8Rng) -> Vec<f64> {
    let noise: Vec<f64> = (0..n * n).map(|_| logit(random.random::<f64>())).collect();
    let along_x = smoothed(&noise, n, size, |row, k| row * n + k);
    let mut both = smoothed(&along_x, n, size, |column, k| k * n + column);
    let count = (n * n).max(1) as f64;
    let mean = both.iter().sum::<f64>() / count;
    let deviation = (both.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / count).sqrt();
    both.iter_mut().for_each(|z| *z = (*z - mean) / deviation);
    both
}

/// ln(u / (1 - u)), kept finite at u = 0.
pub(super) fn logit(u: f64) -> f64 {
    let u = u.max(f64::EPSILON);
    (u / (1.0 - u)).ln()
}

/// Gaussian mean along lines of `n` values; `at(line, k)` is the place of a line's k-th value.
fn smoothed(values: &[f64], n: usize, deviation: f64, at: impl Fn(usize, usize) -> usize) -> Vec<f64> {
    let reach = (3.0 * deviation).ceil() as usize;
    let weights: Vec<f64> = (0..=reach).map(|k| (-0.5 * (k as f64 / deviation).powi(2)).exp()).collect();
    let mut out = vec![0.0; values.len()];
    for line in 0..n {
        for k in 0..n {
            let window = k.saturating_sub(reach)..=(k + reach).min(n - 1);
            let (mut sum, mut total) = (0.0, 0.0);
            for other in window {
                let weight = weights[other.abs_diff(k)];
                sum += weight * values[at(line, other)];
                total += weight;
            }
            out[at(line, k)] = sum / total;
        }
    }
    out
}
