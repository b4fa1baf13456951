//! Noise of one signal along a run.

use super::Scale;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// Noise of a signal: a scatter common to a whole run (the bed is prepared anew, a sensor is zeroed) plus an AR(1)
/// process from row to row. Covariance of rows i and j of a run:
/// `deviation^2 (run_share + (1 - run_share) correlation^|i - j|)`; different runs are independent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseModel {
    /// Standard deviation of one sample, in the signal's unit; where sizes differ ([`Scale`]), of a usual one.
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

    /// The same noise with whole runs that differ by `between` besides.
    #[must_use]
    pub(crate) fn with_runs_apart(self, between: f64) -> Self {
        let (within, between) = (self.deviation * self.deviation, between * between);
        let variance = within + between;
        if variance <= 0.0 {
            return self;
        }
        let run_share = (self.run_share * within + between) / variance;
        Self { deviation: variance.sqrt(), run_share, correlation: self.correlation }
    }

    /// Makes the rows of one run white, in place: `values` holds the rows that are there, `rows` their indices, `weights` what the common
    /// part counts in each (empty: one).
    ///
    /// The AR(1) part goes by differences, the scatter common to the run by a rank-one root:
    /// (I + v v^T)^(-1/2) = I - v v^T (1 - 1/sqrt(1 + v^T v))/(v^T v), with v the whitened common part.
    pub(super) fn whiten(&self, rows: &[usize], weights: &[f64], values: &mut [f64]) {
        let own = (self.deviation * (1.0 - self.run_share).sqrt()).recip();
        let mut sums = Sums::default();
        let mut previous = 0.0;
        self.for_each_step(rows, weights, |k, step| {
            let raw = values[k];
            values[k] = (raw - step.correlation * previous) * step.scale * own;
            previous = raw;
            sums.add(step.common, values[k]);
        });
        if sums.common > 0.0 {
            let factor = sums.along * (1.0 - (1.0 + sums.common).sqrt().recip()) / sums.common;
            self.for_each_step(rows, weights, |k, step| values[k] -= factor * step.common);
        }
    }

    /// The part that all `rows` of a run have in common, made white: v in the formula of [`whiten`](Self::whiten).
    pub(crate) fn common_part(&self, rows: &[usize]) -> Vec<f64> {
        let mut all = Vec::with_capacity(rows.len());
        self.for_each_step(rows, &[], |_, step| all.push(step.common));
        all
    }

    /// Makes values white that stand in a run's `rows` from number `first` on and are zero elsewhere; `common` is the
    /// [common part](Self::common_part) of these rows.
    pub(crate) fn whiten_part(&self, rows: &[usize], first: usize, values: &[f64], common: &[f64]) -> LocalWhite {
        let own = (self.deviation * (1.0 - self.run_share).sqrt()).recip();
        // One row before, of zero, gives the first its place in the run; the row behind follows the last.
        let (from, end) = (first.saturating_sub(1), (first + values.len() + 1).min(rows.len()));
        let mut raw = vec![0.0; end - from];
        raw[first - from..first - from + values.len()].copy_from_slice(values);
        let mut previous = 0.0;
        let mut white = vec![0.0; raw.len()];
        self.for_each_step(&rows[from..end], &[], |k, step| {
            white[k] = (raw[k] - step.correlation * previous) * step.scale * own;
            previous = raw[k];
        });
        white.drain(..first - from);
        let sums = common.iter().map(|c| c * c).sum::<f64>();
        let along: f64 = white.iter().zip(&common[first..]).map(|(w, c)| w * c).sum();
        let factor = if sums > 0.0 { along * (1.0 - (1.0 + sums).sqrt().recip()) / sums } else { 0.0 };
        LocalWhite { values: white, along: factor }
    }

    /// Squared length of the whitened rows times `deviation^2`, and ln det of their covariance over `deviation^2`.
    pub(super) fn length_and_determinant(&self, rows: &[usize], weights: &[f64], values: &[f64]) -> (f64, f64) {
        let own = (1.0 - self.run_share).sqrt().recip();
        let (mut sums, mut determinant, mut squares, mut previous) = (Sums::default(), 0.0, 0.0, 0.0);
        self.for_each_step(rows, weights, |k, step| {
            let white = (values[k] - step.correlation * previous) * step.scale * own;
            previous = values[k];
            squares += white * white;
            determinant += step.log_variance;
            sums.add(step.common, white);
        });
        // Of the rank-one root only its effect on the length is needed: 1 - 1/(1 + v^T v) along v.
        let length = squares - sums.along * sums.along / (1.0 + sums.common);
        (length, determinant + rows.len() as f64 * (1.0 - self.run_share).ln() + sums.common.ln_1p())
    }

    /// Calls `f` with each entry and how it follows from the one before it; `weights` as those of [`whiten`](Self::whiten).
    fn for_each_step(&self, rows: &[usize], weights: &[f64], mut f: impl FnMut(usize, &Follow)) {
        let size = (self.run_share / (1.0 - self.run_share)).sqrt();
        // Neighbouring rows, the usual case, share their numbers.
        let (first, next) = (Follow::new(0.0, size), Follow::new(self.correlation, size));
        for k in 0..rows.len() {
            let step = match k.checked_sub(1).map(|before| rows[k] - rows[before]) {
                None => first,
                Some(1) => next,
                Some(gap) => Follow::new(self.correlation.powi(gap as i32), size),
            };
            f(k, &if weights.is_empty() { step } else { step.weighted(size, weights, k) });
        }
    }

    /// Draws noise for all rows of one run, in units of the scale of each (empty: one).
    pub(crate) fn draw(&self, rng: &mut impl Rng, scale: &[Scale], values: &mut [f64]) {
        let mut unit = || -> f64 { StandardNormal.sample(rng) };
        let (common, own) = (self.run_share.sqrt() * unit(), (1.0 - self.run_share).sqrt());
        let rest = (1.0 - self.correlation * self.correlation).sqrt();
        let mut along = unit();
        for (k, value) in values.iter_mut().enumerate() {
            if k > 0 {
                along = self.correlation * along + rest * unit();
            }
            let Scale { row, weight } = scale.get(k).copied().unwrap_or(Scale::USUAL);
            *value = self.deviation * (weight * common + own * along) * row;
        }
    }
}

/// Whitened values of a part of a run.
pub(crate) struct LocalWhite {
    /// Those of the part and of the row behind it.
    pub values: Vec<f64>,
    /// What of the run's common part has to be subtracted, in all rows.
    pub along: f64,
}

/// How an entry of an AR(1) process of unit variance follows from the one before it.
#[derive(Clone, Copy)]
struct Follow {
    correlation: f64,
    /// One over the root of the variance that is left.
    scale: f64,
    log_variance: f64,
    /// The part that a run has in common, whitened.
    common: f64,
}

impl Follow {
    fn new(correlation: f64, size: f64) -> Self {
        let variance = 1.0 - correlation * correlation;
        let scale = variance.sqrt().recip();
        Self { correlation, scale, log_variance: variance.ln(), common: size * (1.0 - correlation) * scale }
    }

    /// The same where what a run has in common counts differently from row to row.
    fn weighted(self, size: f64, weights: &[f64], k: usize) -> Self {
        let before = k.checked_sub(1).map_or(0.0, |before| weights[before]);
        Self { common: size * (weights[k] - self.correlation * before) * self.scale, ..self }
    }
}

/// v^T v and v^T u of the common part v and whitened values u.
#[derive(Default)]
struct Sums {
    common: f64,
    along: f64,
}

impl Sums {
    fn add(&mut self, common: f64, value: f64) {
        self.common += common * common;
        self.along += common * value;
    }
}

#[cfg(test)]
mod tests {
    use super::NoiseModel;
    use nalgebra::{DMatrix, DVector};

    /// Rounding of some hundred products of order one.
    const ROUNDING: f64 = 1e-12;
    const MODEL: NoiseModel = NoiseModel { deviation: 0.3, run_share: 0.7, correlation: 0.6 };
    /// Rows of a run in which some are missing, and what the common part of the run counts in each.
    const ROWS: [usize; 6] = [0, 1, 2, 5, 6, 9];
    const WEIGHTS: [f64; 6] = [0.1, 0.5, 0.9, 1.0, 1.0, 0.8];

    /// The covariance as it is defined, over the squared deviation.
    fn covariance() -> DMatrix<f64> {
        DMatrix::from_fn(ROWS.len(), ROWS.len(), |i, k| {
            let along = MODEL.correlation.powi(ROWS[i].abs_diff(ROWS[k]) as i32);
            MODEL.run_share * WEIGHTS[i] * WEIGHTS[k] + (1.0 - MODEL.run_share) * along
        })
    }

    #[test]
    fn analytic_whitened_noise_of_a_run_that_counts_by_row_is_white() {
        let mut map = DMatrix::<f64>::identity(ROWS.len(), ROWS.len());
        for mut column in map.column_iter_mut() {
            MODEL.whiten(&ROWS, &WEIGHTS, column.as_mut_slice());
        }
        let white = &map * covariance() * map.transpose() * MODEL.deviation.powi(2);
        let off = (white - DMatrix::<f64>::identity(ROWS.len(), ROWS.len())).amax();
        assert!(off < ROUNDING, "{off}");
    }

    #[test]
    fn analytic_length_and_determinant_are_those_of_the_covariance() {
        let values = [0.3, -0.2, 0.5, 0.1, -0.4, 0.2];
        let (length, determinant) = MODEL.length_and_determinant(&ROWS, &WEIGHTS, &values);
        let (covariance, values) = (covariance(), DVector::from_row_slice(&values));
        let solved = covariance.clone().lu().solve(&values).map(|x| x.dot(&values));
        assert!(solved.is_some_and(|solved| (length - solved).abs() < ROUNDING * solved), "{length} {solved:?}");
        let expected = covariance.determinant().ln();
        assert!((determinant - expected).abs() < ROUNDING * expected.abs(), "{determinant} {expected}");
    }
}
