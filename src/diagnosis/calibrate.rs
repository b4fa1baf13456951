//! Calibration: the free parameters that bring the model closest to the measurements, within their bounds.
//!
//! Each residual is divided by the signal's standard deviation of one sample; a parameter with a prior adds one
//! residual (p - p_0)/sigma_p. Positive parameters that span decades are searched in logarithms. Several searches start
//! from the given values and from the best of seeded draws, since the cost has more than one valley where an exponent
//! and a modulus trade against each other.

use super::layout::Layout;
use super::least_squares::{LeastSquares, Minimum};
use super::prediction::Predict;
use bekker_modeldescription::Variable;
use nalgebra::DMatrix;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// Ratio of the bounds from which a positive parameter is searched in logarithms.
const DECADES: f64 = 100.0;

/// Draws from which the starts are chosen by their cost, and how many of them are searched from besides the first.
const DRAWS: usize = 64;
const SEARCHES: usize = 5;
const SEED: u64 = 1967;

/// A parameter this close to a bound (a share of the range) is put on it unless that raises the cost.
const NEAR_BOUND: f64 = 1e-3;

/// Share by which the cost may rise where a parameter is put on its bound: rounding, no measurable misfit.
const SAME_COST: f64 = 1e-6;

/// Two searches agree where their costs differ by less than this share.
const AGREEING_COST: f64 = 1e-4;

/// Singular values below this share of the largest count as zero: the experiment does not determine that direction.
const RANK_TOLERANCE: f64 = 1e-10;

/// What is known of a parameter from a separate test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// The value that the test gave.
    pub mean: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// One free parameter after a calibration, in its SI unit.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedParameter {
    /// Name, meaning, unit and bounds.
    pub variable: Variable,
    /// Value before.
    pub start: f64,
    /// Value after.
    pub value: f64,
    /// Standard error, the other free parameters being uncertain too; `None` where the parameter sits on a bound or the
    /// experiment does not determine it. It takes the residuals as independent and is too small where they are not.
    pub deviation: Option<f64>,
    /// Whether the value sits on a bound, so that the fit wanted to go further than is believable.
    pub at_bound: bool,
    /// What was known before.
    pub prior: Option<Prior>,
}

impl CalibratedParameter {
    /// How far the parameter moved from its prior, in the prior's standard deviations.
    #[must_use]
    pub fn prior_shift(&self) -> Option<f64> {
        self.prior.map(|prior| (self.value - prior.mean) / prior.deviation)
    }
}

/// Result of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// The free parameters.
    pub parameters: Vec<CalibratedParameter>,
    /// Standard deviation by which each signal's residuals were divided, in the signal's unit.
    pub weights: BTreeMap<String, f64>,
    /// Sum of the squared weighted residuals.
    pub chi_square: f64,
    /// Measured values (and priors) less free parameters.
    pub degrees_of_freedom: usize,
    /// Steps of the search that won.
    pub steps: u64,
    /// Whether that search met its tolerance.
    pub converged: bool,
    /// Searches made from different starts, and how many of them ended at the same cost.
    pub searches: usize,
    /// Searches that ended at the best cost.
    pub agreeing: usize,
}

/// A parameter to be calibrated.
#[derive(Clone, Debug)]
pub(crate) struct Free {
    pub variable: Variable,
    pub start: f64,
    pub prior: Option<Prior>,
}

impl Free {
    fn logarithmic(&self) -> bool {
        self.variable.min > 0.0 && self.variable.max / self.variable.min >= DECADES
    }

    /// Coordinate of the search: ln p, or p over its range.
    fn coordinate(&self, value: f64) -> f64 {
        if self.logarithmic() { value.ln() } else { value / (self.variable.max - self.variable.min) }
    }

    fn value(&self, coordinate: f64) -> f64 {
        let value =
            if self.logarithmic() { coordinate.exp() } else { coordinate * (self.variable.max - self.variable.min) };
        value.clamp(self.variable.min, self.variable.max)
    }

    /// dp/du.
    fn slope(&self, value: f64) -> f64 {
        if self.logarithmic() { value } else { self.variable.max - self.variable.min }
    }
}

/// The weighted residuals as a function of the search's coordinates.
struct Weighted<'a> {
    predict: &'a dyn Predict,
    layout: &'a Layout,
    free: &'a [Free],
    /// One over the standard deviation, for each entry of the layout.
    weights: Vec<f64>,
}

impl Weighted<'_> {
    fn values(&self, u: &[f64]) -> Vec<f64> {
        self.free.iter().zip(u).map(|(free, u)| free.value(*u)).collect()
    }

    fn priors(&self) -> impl Iterator<Item = (usize, Prior)> {
        self.free.iter().enumerate().filter_map(|(k, free)| Some((k, free.prior?)))
    }

    fn present(&self) -> impl Iterator<Item = usize> {
        (0..self.layout.len()).filter(|at| !self.layout.measured[*at].is_nan())
    }

    /// Infinite where the model has no answer, which rejects a step.
    fn residual(&self, u: &[f64]) -> Vec<f64> {
        let values = self.values(u);
        let priors = self.priors().map(|(k, prior)| (values[k] - prior.mean) / prior.deviation);
        match self.predict.values(&values) {
            Ok(modelled) => self
                .present()
                .map(|at| (modelled[at] - self.layout.measured[at]) * self.weights[at])
                .chain(priors)
                .collect(),
            Err(_) => vec![f64::INFINITY; self.layout.present() + self.priors().count()],
        }
    }

    /// Row by row; NaN where the model has no answer, which the search reports as a breakdown.
    fn jacobian(&self, u: &[f64]) -> Vec<f64> {
        let values = self.values(u);
        let scale: Vec<f64> = self.free.iter().zip(&values).map(|(free, value)| free.slope(*value)).collect();
        let Ok((_, slopes)) = self.predict.slopes(&values) else {
            return vec![f64::NAN; (self.layout.present() + self.priors().count()) * u.len()];
        };
        let mut rows = Vec::new();
        for at in self.present() {
            rows.extend((0..u.len()).map(|k| slopes[k][at] * scale[k] * self.weights[at]));
        }
        for (j, prior) in self.priors() {
            rows.extend((0..u.len()).map(|k| if k == j { scale[k] / prior.deviation } else { 0.0 }));
        }
        rows
    }
}

/// Calibrates `free`; `weights` gives each signal's standard deviation. `None` where no start has a finite cost.
pub(crate) fn calibrate(
    predict: &dyn Predict,
    layout: &Layout,
    free: &[Free],
    weights: &BTreeMap<String, f64>,
) -> Option<Calibration> {
    let mut by_entry = vec![0.0; layout.len()];
    for block in &layout.blocks {
        let deviation = weights.get(&block.signal)?;
        by_entry[block.range.clone()].fill(deviation.recip());
    }
    let weighted = Weighted { predict, layout, free, weights: by_entry };
    let problem = LeastSquares {
        lower: free.iter().map(|f| f.coordinate(f.variable.min)).collect(),
        upper: free.iter().map(|f| f.coordinate(f.variable.max)).collect(),
        residual: &|u| weighted.residual(u),
        jacobian: &|u| weighted.jacobian(u),
    };
    let minima: Vec<Minimum> = starts(&problem, free).iter().filter_map(|start| problem.minimise(start)).collect();
    let mut best = minima.iter().min_by(|a, b| a.cost.total_cmp(&b.cost))?.clone();
    let agreeing = minima.iter().filter(|m| m.cost <= best.cost * (1.0 + AGREEING_COST)).count();
    let at_bound = put_on_bounds(&problem, &mut best);
    let degrees_of_freedom = (layout.present() + weighted.priors().count()).saturating_sub(free.len());
    let chi_square = 2.0 * best.cost;
    let deviations = deviations(&weighted, &best.x, &at_bound, chi_square, degrees_of_freedom);
    let values = weighted.values(&best.x);
    let parameters = free.iter().enumerate().map(|(k, free)| CalibratedParameter {
        variable: free.variable.clone(),
        start: free.start,
        value: values[k],
        deviation: deviations[k],
        at_bound: at_bound[k],
        prior: free.prior,
    });
    Some(Calibration {
        parameters: parameters.collect(),
        weights: weights.clone(),
        chi_square,
        degrees_of_freedom,
        steps: best.steps,
        converged: best.converged,
        searches: minima.len(),
        agreeing,
    })
}

/// The given values, and the best of seeded draws around them.
fn starts(problem: &LeastSquares, free: &[Free]) -> Vec<Vec<f64>> {
    let given: Vec<f64> = free.iter().map(|f| f.coordinate(f.start)).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut drawn: Vec<(f64, Vec<f64>)> = (0..DRAWS)
        .map(|_| {
            // Half of the way from the given value to anywhere between the bounds: wide, but not absurd.
            let u: Vec<f64> = (0..free.len())
                .map(|k| {
                    let anywhere = problem.lower[k] + (problem.upper[k] - problem.lower[k]) * rng.random::<f64>();
                    0.5 * (given[k] + anywhere)
                })
                .collect();
            (problem.cost_at(&u), u)
        })
        .filter(|(cost, _)| cost.is_finite())
        .collect();
    drawn.sort_by(|a, b| a.0.total_cmp(&b.0));
    let given = Some(given).filter(|u| problem.cost_at(u).is_finite());
    given.into_iter().chain(drawn.into_iter().map(|(_, u)| u).take(SEARCHES)).collect()
}

/// Puts coordinates that have all but reached a bound on it; returns which.
fn put_on_bounds(problem: &LeastSquares, minimum: &mut Minimum) -> Vec<bool> {
    let mut at_bound = vec![false; minimum.x.len()];
    for k in 0..minimum.x.len() {
        let (lower, upper) = (problem.lower[k], problem.upper[k]);
        let share = (minimum.x[k] - lower) / (upper - lower);
        let bound = if share < NEAR_BOUND {
            lower
        } else if share > 1.0 - NEAR_BOUND {
            upper
        } else {
            continue;
        };
        let mut moved = minimum.x.clone();
        moved[k] = bound;
        let cost = problem.cost_at(&moved);
        if cost <= minimum.cost * (1.0 + SAME_COST) {
            (minimum.x, minimum.cost, at_bound[k]) = (moved, cost, true);
        }
    }
    at_bound
}

/// Standard errors from the Jacobian; the residuals' own scatter where it exceeds the weights.
fn deviations(
    weighted: &Weighted,
    u: &[f64],
    at_bound: &[bool],
    chi_square: f64,
    degrees_of_freedom: usize,
) -> Vec<Option<f64>> {
    let inner: Vec<usize> = (0..u.len()).filter(|k| !at_bound[*k]).collect();
    let rows = weighted.jacobian(u);
    let jacobian = DMatrix::from_fn(rows.len() / u.len().max(1), inner.len(), |i, k| rows[i * u.len() + inner[k]]);
    let mut all = vec![None; u.len()];
    if jacobian.is_empty() || jacobian.iter().any(|x| !x.is_finite()) {
        return all;
    }
    let scatter = (chi_square / degrees_of_freedom.max(1) as f64).max(1.0);
    let svd = jacobian.svd(false, true);
    let Some(v_t) = svd.v_t else { return all };
    let smallest = RANK_TOLERANCE * svd.singular_values.max();
    for (k, at) in inner.iter().enumerate() {
        let mut variance = 0.0;
        for (j, singular) in svd.singular_values.iter().enumerate() {
            variance += if *singular > smallest { (v_t[(j, k)] / singular).powi(2) } else { f64::INFINITY };
        }
        let free = &weighted.free[*at];
        let deviation = (variance * scatter).sqrt() * free.slope(free.value(u[*at]));
        all[*at] = Some(deviation).filter(|d| d.is_finite());
    }
    all
}
