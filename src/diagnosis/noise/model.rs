//! Noise of one signal along a run.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// Noise of a signal: a scatter common to a whole run (the bed is prepared anew, a sensor is zeroed) plus an AR(1)
/// process from row to row. Covariance of rows i and j of a run:
/// `deviation^2 (run_share + (1 - run_share) correlation^|i - j|)`; different runs are independent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseModel {
    /// Standard deviation of one sample, in the signal's unit.
    pub deviation: f64,
    /// Share of the variance that a whole run has in common, 0 to under 1.
    pub run_share: f64,
    /// Correlation rho of neighbouring rows of the rest, 0 to under 1.
    pub correlation: f64,
}

impl NoiseModel {
    /// Independent samples.
    #[must_use]
    pub fn white(deviation: f64) -> Self {
        Self { deviation, run_share: 0.0, correlation: 0.0 }
    }

    /// Makes the rows of one run white, in place: `values` holds the rows that are there, `rows` their indices.
    ///
    /// The AR(1) part goes by differences, the scatter common to the run by a rank-one root:
    /// (I + v v^T)^(-1/2) = I - v v^T (1 - 1/sqrt(1 + v^T v))/(v^T v), with v the whitened common part.
    pub(super) fn whiten(&self, rows: &[usize], values: &mut [f64]) {
        let own = self.deviation * (1.0 - self.run_share).sqrt();
        let common = self.whitened_common_part(rows);
        let mut previous = 0.0;
        for (k, value) in values.iter_mut().enumerate() {
            let (raw, (rho, scale)) = (*value, self.step(rows, k));
            *value = (raw - rho * previous) / (own * scale);
            previous = raw;
        }
        let squared: f64 = common.iter().map(|v| v * v).sum();
        if squared > 0.0 {
            let along: f64 = common.iter().zip(&*values).map(|(v, value)| v * value).sum();
            let factor = along * (1.0 - (1.0 + squared).sqrt().recip()) / squared;
            values.iter_mut().zip(&common).for_each(|(value, v)| *value -= factor * v);
        }
    }

    /// Draws noise for all rows of one run.
    pub(crate) fn draw(&self, rng: &mut impl Rng, values: &mut [f64]) {
        let mut unit = || -> f64 { StandardNormal.sample(rng) };
        let (common, own) = (self.run_share.sqrt() * unit(), (1.0 - self.run_share).sqrt());
        let rest = (1.0 - self.correlation * self.correlation).sqrt();
        let mut along = unit();
        for (k, value) in values.iter_mut().enumerate() {
            if k > 0 {
                along = self.correlation * along + rest * unit();
            }
            *value = self.deviation * (common + own * along);
        }
    }

    /// ln det of the covariance of these rows over `deviation^2`.
    pub(super) fn log_determinant(&self, rows: &[usize]) -> f64 {
        let own = 1.0 - self.run_share;
        let along: f64 = (0..rows.len()).map(|k| (own * self.step(rows, k).1.powi(2)).ln()).sum();
        along + self.whitened_common_part(rows).iter().map(|v| v * v).sum::<f64>().ln_1p()
    }

    /// The part that a run has in common, after the AR(1) part is made white.
    fn whitened_common_part(&self, rows: &[usize]) -> Vec<f64> {
        let size = (self.run_share / (1.0 - self.run_share)).sqrt();
        let entry = |k| {
            let (rho, scale) = self.step(rows, k);
            size * (1.0 - rho) / scale
        };
        (0..rows.len()).map(entry).collect()
    }

    /// Correlation of entry `k` with the one before it, and the root of what is left of its variance.
    fn step(&self, rows: &[usize], k: usize) -> (f64, f64) {
        if k == 0 {
            return (0.0, 1.0);
        }
        let rho = if self.correlation == 0.0 { 0.0 } else { self.correlation.powi((rows[k] - rows[k - 1]) as i32) };
        (rho, (1.0 - rho * rho).sqrt())
    }
}
