//! Calibration: the free parameters that bring the model closest to the measurements, within their bounds.
//!
//! Residuals are made white by the noise model; a parameter with a prior adds one residual. Several searches start from
//! the given values and from the best of seeded draws, since the cost has more than one valley where an exponent and a
//! modulus trade against each other.

use super::effort::{Draws, Effort};
use super::free::Free;
use super::gauss_newton::Descent;
use super::least_squares::{LeastSquares, Minimum, Pace};
use super::thresholds::FAR;
use super::weighted::Weighted;
use crate::measurement::Prior;
use crate::scalar::Scalar;
use bekker_modeldescription::{Role, Variable};
use nalgebra::DMatrix;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// A parameter this close to a bound (a share of the range) is put on it unless that raises the cost.
const NEAR_BOUND: f64 = 1e-3;

/// Share by which the cost may rise where a parameter is put on its bound: rounding, no measurable misfit.
const SAME_COST: f64 = 1e-6;

/// Singular values below this share of the largest count as zero: the experiment does not determine that direction.
const RANK_TOLERANCE: f64 = 1e-10;

/// What the deviation means beside a calibrated value, for every text and page that prints one.
pub const STANDARD_ERROR: &str = "standard error, enlarged by the square root of chi-square per degree of freedom where that exceeds one, at most the prior's";

/// Share of a direction below which a parameter has no part in it: rounding of a decomposition of thousands of rows.
const NO_PART: f64 = 1e-7;

/// One free parameter after a calibration, in its SI unit.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedParameter {
    /// Name, meaning, unit and bounds.
    pub variable: Variable,
    /// Value before.
    pub start: f64,
    /// Value after.
    pub value: f64,
    /// Standard error, the other free parameters being uncertain too, enlarged by the square root of chi-square per degree of
    /// freedom where that exceeds one; at most the prior's standard deviation. `None` where the parameter sits on a bound, or
    /// where the experiment does not determine it: its standard error would exceed the width of its bounds.
    pub deviation: Option<f64>,
    /// Whether the value sits on a bound, so that the fit wanted to go further than is believable.
    pub at_bound: bool,
    /// What was known before.
    pub prior: Option<Prior>,
}

impl CalibratedParameter {
    /// Whether the fit leaves a law of an effect off: the parameter sits on a bound that is its neutral value. It then wants to
    /// go nowhere; a neighbouring law of the same effect may do all the work.
    pub(crate) fn is_off(&self) -> bool {
        self.at_bound && self.variable.role == Role::Effect && self.value.is_exactly(self.variable.default)
    }

    /// What a table notes beside a value on a bound.
    pub fn bound_note(&self) -> Option<&'static str> {
        self.at_bound.then(|| if self.is_off() { "left off" } else { "on its bound" })
    }
}

/// Name, unit symbol and bounds in the place of the whole variable; the shift from the prior in the place of the prior.
impl Serialize for CalibratedParameter {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut fields = to.serialize_struct("CalibratedParameter", 9)?;
        fields.serialize_field("name", &self.variable.name)?;
        fields.serialize_field("unit", self.variable.unit.symbol)?;
        fields.serialize_field("min", &self.variable.min)?;
        fields.serialize_field("max", &self.variable.max)?;
        fields.serialize_field("start", &self.start)?;
        fields.serialize_field("value", &self.value)?;
        fields.serialize_field("deviation", &self.deviation)?;
        fields.serialize_field("at_bound", &self.at_bound)?;
        fields.serialize_field("prior_shift", &self.prior_shift())?;
        fields.end()
    }
}

impl CalibratedParameter {
    /// How far the parameter moved from its prior, in the prior's standard deviations.
    #[must_use]
    pub fn prior_shift(&self) -> Option<f64> {
        self.prior.map(|prior| (self.value - prior.mean) / prior.deviation)
    }
}

/// Result of a calibration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// The free parameters.
    pub parameters: Vec<CalibratedParameter>,
    /// Standard deviation by which each signal's residuals were divided, in the signal's unit.
    pub weights: BTreeMap<String, f64>,
    /// Sum of the squared whitened residuals (Huber's beyond the robust threshold), priors included.
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

impl Calibration {
    /// Whether the misfit is so large that sensitivities around it say little.
    pub(crate) fn is_far(&self) -> bool {
        self.chi_square > FAR * self.degrees_of_freedom as f64
    }

    /// The values of the free parameters.
    pub(crate) fn values(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.value).collect()
    }
}

/// Calibrates from the given values and from seeded draws. `None` where no start has a finite cost.
pub(crate) fn calibrate(weighted: &Weighted, weights: &BTreeMap<String, f64>, effort: Effort) -> Option<Calibration> {
    let given: Vec<f64> = weighted.free.iter().map(|free| free.start).collect();
    calibrate_from(weighted, weights, &[given], effort)
}

/// Calibrates from the given starts, values in SI units, and from seeded draws. `None` where none has a finite cost.
pub(crate) fn calibrate_from(
    weighted: &Weighted,
    weights: &BTreeMap<String, f64>,
    starts: &[Vec<f64>],
    effort: Effort,
) -> Option<Calibration> {
    let residual = |u: &[f64]| weighted.residual(u);
    let linear = |u: &[f64]| weighted.linear(u);
    let problem = least_squares(weighted, &residual, &linear);
    let given = starts.iter().map(|values| weighted.coordinates(values)).filter(|u| problem.cost_at(u).is_finite());
    let mut draws = Draws::new(&problem, weighted.free);
    let starts: Vec<Vec<f64>> = given.chain(draws.best(effort.draws, effort.searches)).collect();
    let mut best = search(weighted, &problem, &starts, weights, effort.pace);
    let Some((count, most)) = effort.until_agreed else { return best };
    for start in draws.best(count, most) {
        if best.as_ref().is_some_and(|best| best.agreeing > 1) {
            break;
        }
        best = better(best, search(weighted, &problem, &[start], weights, effort.pace), effort.pace.agreeing);
    }
    best
}

/// The one with less misfit; they agree where their costs differ by less than the share `agreeing`.
pub(crate) fn better(a: Option<Calibration>, b: Option<Calibration>, agreeing: f64) -> Option<Calibration> {
    let (Some(a), Some(b)) = (&a, &b) else { return a.or(b) };
    let best = if b.chi_square < a.chi_square { b } else { a };
    let same = |other: &Calibration| other.chi_square <= best.chi_square * (1.0 + agreeing);
    let agreeing = [a, b].into_iter().filter(|other| same(other)).map(|other| other.agreeing).sum();
    Some(Calibration { searches: a.searches + b.searches, agreeing, ..best.clone() })
}

fn least_squares<'a>(
    weighted: &Weighted,
    residual: &'a (dyn Fn(&[f64]) -> Vec<f64> + Sync),
    linear: &'a (dyn Fn(&[f64]) -> DMatrix<f64> + Sync),
) -> LeastSquares<'a> {
    let (lower, upper) = weighted.free.iter().map(Free::bounds).unzip();
    LeastSquares { lower, upper, rows: weighted.rows(), tolerance: weighted.predict.tolerance(), residual, linear }
}

fn search(
    weighted: &Weighted,
    problem: &LeastSquares,
    starts: &[Vec<f64>],
    weights: &BTreeMap<String, f64>,
    pace: Pace,
) -> Option<Calibration> {
    let mut minima = problem.minimise(starts, pace);
    minima.retain(|minimum| weighted.is_valid(&minimum.x));
    let best = minima.iter().min_by(|a, b| a.cost.total_cmp(&b.cost))?.clone();
    let agreeing = minima.iter().filter(|m| m.cost <= best.cost * (1.0 + pace.agreeing)).count();
    Some(Calibration { searches: minima.len(), agreeing, ..finished(weighted, problem, best, weights) })
}

/// A calibration at given values, without any search. `None` where the model has no answer there.
pub(crate) fn settled(
    weighted: &Weighted,
    weights: &BTreeMap<String, f64>,
    values: &[f64],
    pace: Pace,
) -> Option<Calibration> {
    let residual = |u: &[f64]| weighted.residual(u);
    let linear = |u: &[f64]| weighted.linear(u);
    let problem = least_squares(weighted, &residual, &linear);
    let x = weighted.coordinates(values);
    if pace.gauss_newton {
        let at = Descent::new(&problem, &x, pace.least_promise).filter(|_| weighted.is_valid(&x))?.minimum(true);
        return Some(finished(weighted, &problem, at, weights));
    }
    let cost = Some(problem.cost_at(&x)).filter(|cost| cost.is_finite() && weighted.is_valid(&x))?;
    Some(finished(weighted, &problem, Minimum { x, cost, steps: 0, converged: true, triangle: None }, weights))
}

/// Bounds, standard errors and figures of a minimum.
fn finished(
    weighted: &Weighted,
    problem: &LeastSquares,
    mut best: Minimum,
    weights: &BTreeMap<String, f64>,
) -> Calibration {
    let free = weighted.free;
    let at_bound = put_on_bounds(weighted, problem, &mut best);
    let degrees_of_freedom = weighted.freedom().saturating_sub(free.len());
    let chi_square = 2.0 * best.cost;
    let deviations = deviations(weighted, &best, &at_bound, chi_square, degrees_of_freedom);
    let values = weighted.values(&best.x);
    let parameters = free.iter().enumerate().map(|(k, free)| CalibratedParameter {
        variable: free.variable.clone(),
        start: free.start,
        value: values[k],
        deviation: deviations[k],
        at_bound: at_bound[k],
        prior: free.prior.or(free.shared),
    });
    Calibration {
        parameters: parameters.collect(),
        weights: weights.clone(),
        chi_square,
        degrees_of_freedom,
        steps: best.steps,
        converged: best.converged,
        searches: 1,
        agreeing: 1,
    }
}

/// Puts coordinates that have all but reached a bound on it; returns which.
fn put_on_bounds(weighted: &Weighted, problem: &LeastSquares, minimum: &mut Minimum) -> Vec<bool> {
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
        // A search that knows its derivatives has been there.
        if minimum.triangle.is_some() && minimum.x[k] == bound {
            at_bound[k] = true;
            continue;
        }
        let mut moved = minimum.x.clone();
        moved[k] = bound;
        let cost = problem.cost_at(&moved);
        if cost <= minimum.cost * (1.0 + SAME_COST) && weighted.is_valid(&moved) {
            (minimum.x, minimum.cost, at_bound[k], minimum.triangle) = (moved, cost, true, None);
        }
    }
    at_bound
}

/// Standard errors from the Jacobian, enlarged where the residuals scatter more than the noise.
///
/// Data do not reduce the information of a prior, so that no standard error exceeds the prior's, however large the misfit.
/// Where a standard error exceeds the width of the bounds, the parameter counts as not determined.
fn deviations(
    weighted: &Weighted,
    minimum: &Minimum,
    at_bound: &[bool],
    chi_square: f64,
    degrees_of_freedom: usize,
) -> Vec<Option<f64>> {
    let u = &minimum.x;
    let inner: Vec<usize> = (0..u.len()).filter(|k| !at_bound[*k]).collect();
    // Products of the columns, all that is asked for, are those of their triangular factor.
    let linear = minimum.triangle.clone().unwrap_or_else(|| weighted.linear(u));
    let jacobian = linear.select_columns(&inner.iter().map(|k| k + 1).collect::<Vec<_>>());
    let mut all = vec![None; u.len()];
    if jacobian.is_empty() || jacobian.iter().any(|x| !x.is_finite()) {
        return all;
    }
    let scatter = (chi_square / degrees_of_freedom.max(1) as f64).max(1.0);
    let Some(variances) = variances(jacobian) else { return all };
    for (at, variance) in inner.iter().zip(variances) {
        let free = &weighted.free[*at];
        let deviation = (variance * scatter).sqrt() * free.slope(free.value(u[*at]));
        let deviation = free.prior.or(free.shared).map_or(deviation, |prior| deviation.min(prior.deviation));
        all[*at] = Some(deviation).filter(|d| *d <= free.variable.max - free.variable.min);
    }
    all
}

/// Variances of the coordinates for residuals that scatter by 1: the diagonal of (J^T J)^-1, infinite where nothing determines one.
pub(crate) fn variances(jacobian: DMatrix<f64>) -> Option<Vec<f64>> {
    let svd = jacobian.svd(false, true);
    let v_t = svd.v_t?;
    let smallest = RANK_TOLERANCE * svd.singular_values.max();
    let variance = |k: usize| {
        let mut variance = 0.0;
        for (j, singular) in svd.singular_values.iter().enumerate() {
            let share: f64 = v_t[(j, k)];
            // A direction that nothing determines leaves alone the parameters that have no part in it but rounding.
            variance += match *singular > smallest {
                true => (share / singular).powi(2),
                false if share.abs() > NO_PART => f64::INFINITY,
                false => 0.0,
            };
        }
        variance
    };
    Some((0..v_t.ncols()).map(variance).collect())
}
