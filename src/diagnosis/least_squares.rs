//! Bounded nonlinear least squares: min 1/2 |r(x)|^2 with lower <= x <= upper.
//!
//! The work is done by Gauss-Newton steps (`gauss_newton`) or by `basin`'s trust-region reflective method (Branch, Coleman and Li 1999), the algorithm of
//! scipy's `least_squares`: bounds are handled without a transform that flattens the slope near them, a failed
//! evaluation (infinite residual) is a rejected step, and robust losses can be added. `levenberg-marquardt` 0.15 has
//! no bounds.
//!
//! The method is given a problem of n + 1 residuals, however many there are: of the residuals and their Jacobian, [r J] = Q R,
//! it needs the triangular factor alone, since |Q'r| = |r| and J'r, J'J stay as they are. Its singular values are found
//! by rotations of whole rows, which for thousands of rows took a fifth of a diagnosis.

use super::gauss_newton::Descent;
use basin::{
    BoxBounds, ConstraintSet, Constraints, CostFunction, DenseMatrix, Executor, Jacobian, Residual, State, StepOutcome,
    TerminationCode, TrustRegionReflective,
};
use nalgebra::DMatrix;
use std::convert::Infallible;

/// Share by which the point may still move between accepted steps when the search stops.
const STEP_TOLERANCE: f64 = 1e-10;

/// Steps after which a search gives up; fits here take 10 to 60.
const MAX_STEPS: u64 = 300;

/// How long searches from several starts are followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pace {
    /// Steps that every search makes; then only the best goes on, and those whose cost is within [`BEATEN`] of it.
    pub first_steps: usize,
    /// Steps that these make further.
    pub further_steps: usize,
    /// Steps over which a search must have gained something worth its time: near a corner of the bounds a search advances slowly, and
    /// where the model lacks an effect the last of such steps are not worth their time.
    pub stretch: usize,
    /// The share by which these must have brought the misfit beyond noise down, else the search ends.
    pub least_fall: f64,
    /// The fall of chi-square that they must have made at least, else the search ends.
    pub least_gain: f64,
    /// Two searches agree where their costs differ by less than this share: a few times that within which a search ends.
    pub agreeing: f64,
    /// Whether a search makes Gauss-Newton steps, which ask for few derivatives and little algebra.
    pub gauss_newton: bool,
    /// Such a search ends where the next step promises less than this share of the misfit beyond noise.
    pub least_promise: f64,
}

/// Share by which a search may be behind the best after the first steps.
const BEATEN: f64 = 0.05;

impl Pace {
    /// Every search to its end.
    pub const PATIENT: Self = Self {
        first_steps: usize::MAX,
        further_steps: 0,
        stretch: 10,
        least_fall: 0.0,
        least_gain: 0.0,
        agreeing: 1e-3,
        gauss_newton: false,
        least_promise: 0.0,
    };
    /// Every search to its end by Gauss-Newton steps: for sets of experiments, whose parameters are mostly so many that the singular values of
    /// a trust-region step cost as much as the derivatives.
    pub const MANY: Self =
        Self { first_steps: MAX_STEPS as usize, gauss_newton: true, least_promise: 1e-5, ..Self::PATIENT };
    /// Where an evaluation takes tenths of a second.
    pub const BRISK: Self = Self {
        first_steps: 6,
        further_steps: 34,
        least_fall: 1e-3,
        least_gain: 1.0,
        gauss_newton: true,
        least_promise: 2e-4,
        ..Self::PATIENT
    };
    /// To the place from which a search over more measurements begins.
    pub const ROUGH: Self = Self { stretch: 4, least_fall: 5e-3, least_gain: 4.0, agreeing: 5e-3, ..Self::BRISK };
    /// A few steps that tell which way is worth going on.
    pub const SHORT: Self = Self { first_steps: 4, further_steps: 0, least_fall: 5e-3, ..Self::BRISK };
    /// As many as an effect needs to take over from what a calibration had put in its place.
    pub const MEDIUM: Self = Self { first_steps: 8, further_steps: 0, least_fall: 5e-3, ..Self::BRISK };
}

/// Residuals and their Jacobian over a box.
pub(crate) struct LeastSquares<'a> {
    /// Lower bounds.
    pub lower: Vec<f64>,
    /// Upper bounds, each above its lower bound.
    pub upper: Vec<f64>,
    /// Number of residuals.
    pub rows: usize,
    /// Residuals; infinite where the model has no answer.
    pub residual: &'a (dyn Fn(&[f64]) -> Vec<f64> + Sync),
    /// Share by which the cost may still fall between accepted steps when the search stops.
    pub tolerance: f64,
    /// Residuals, the first column, and their Jacobian; not finite where the model has no answer.
    pub linear: &'a (dyn Fn(&[f64]) -> DMatrix<f64> + Sync),
}

/// Where a search ended.
#[derive(Clone, Debug)]
pub(crate) struct Minimum {
    pub x: Vec<f64>,
    /// 1/2 |r|^2.
    pub cost: f64,
    pub steps: u64,
    /// Whether a tolerance was met, rather than the limit of steps or a numerical breakdown.
    pub converged: bool,
    /// Triangular factor of residuals and Jacobian there, where the search knows it.
    pub triangle: Option<DMatrix<f64>>,
}

impl LeastSquares<'_> {
    /// 1/2 |r(x)|^2; infinite where the model has no answer.
    pub fn cost_at(&self, x: &[f64]) -> f64 {
        0.5 * (self.residual)(x).iter().map(|r| r * r).sum::<f64>()
    }

    /// Residuals, the first column, and their Jacobian; not finite where the model has no answer.
    pub fn linear_at(&self, x: &[f64]) -> DMatrix<f64> {
        (self.linear)(x)
    }

    /// Searches from each of `starts`, which must have finite costs; where each ended. Empty where the bounds are not an
    /// interval each.
    pub fn minimise(&self, starts: &[Vec<f64>], pace: Pace) -> Vec<Minimum> {
        if self.lower.is_empty() {
            // Nothing is free: every start is the answer.
            let known = |x: &Vec<f64>| Minimum {
                x: x.clone(),
                cost: self.cost_at(x),
                steps: 0,
                converged: true,
                triangle: None,
            };
            return starts.iter().map(known).collect();
        }
        let mut searches: Vec<Search> = starts.iter().filter_map(|start| Search::new(self, start, pace)).collect();
        for search in &mut searches {
            search.follow(pace.first_steps);
        }
        let best = searches.iter().map(|search| search.at.cost).fold(f64::INFINITY, f64::min);
        for search in searches.iter_mut().filter(|search| search.at.cost <= (1.0 + BEATEN) * best) {
            search.follow(pace.further_steps);
        }
        searches.into_iter().map(|search| search.at).collect()
    }
}

/// A search under way.
struct Search<'a> {
    /// One step of it: where it is then, and whether it ended there; `None` where it broke down.
    step: Box<dyn FnMut() -> Option<(Minimum, bool)> + 'a>,
    at: Minimum,
    ended: bool,
    /// Cost after each step.
    costs: Vec<f64>,
    pace: Pace,
    /// Cost that noise alone leaves.
    noise: f64,
}

impl<'a> Search<'a> {
    fn new(problem: &'a LeastSquares<'a>, start: &[f64], pace: Pace) -> Option<Self> {
        let noise = 0.5 * problem.rows.saturating_sub(start.len()) as f64;
        if pace.gauss_newton {
            let mut descent = Descent::new(problem, start, pace.least_promise)?;
            let at = descent.minimum(false);
            let step = Box::new(move || Some(descent.step()));
            return Some(Self { step, at, ended: false, costs: Vec::new(), pace, noise });
        }
        let solver = TrustRegionReflective::new()
            .with_relative_cost_change_tolerance(problem.tolerance)
            .with_relative_step_tolerance(STEP_TOLERANCE);
        let executor = Executor::from_start(Borrowed(problem), solver, start.to_vec()).max_iter(MAX_STEPS);
        let mut stepper = executor.into_stepper().ok()?;
        let cost = stepper.state().cost();
        let at = Minimum { x: start.to_vec(), cost, steps: 0, converged: false, triangle: None };
        let step = move || {
            let stopped = match stepper.step().ok()? {
                StepOutcome::Continue => None,
                StepOutcome::Stopped(report) => Some(met_tolerance(report.termination.code())),
            };
            let state = stepper.state();
            let at = Minimum {
                x: state.param().clone(),
                cost: state.cost(),
                steps: state.iter(),
                converged: stopped.unwrap_or(false),
                triangle: None,
            };
            Some((at, stopped.is_some()))
        };
        Some(Self { step: Box::new(step), at, ended: false, costs: Vec::new(), pace, noise })
    }

    /// Goes on until the search ends, at most so many steps.
    fn follow(&mut self, steps: usize) {
        for _ in 0..steps {
            if self.ended {
                return;
            }
            let Some(after) = (self.step)() else {
                self.ended = true;
                return;
            };
            (self.at, self.ended) = after;
            self.costs.push(self.at.cost);
            if !self.ended && self.crawls() {
                (self.ended, self.at.converged) = (true, true);
            }
        }
    }

    fn crawls(&self) -> bool {
        let Some(before) = self.costs.len().checked_sub(self.pace.stretch + 1) else { return false };
        let least = (self.pace.least_fall * (self.at.cost - self.noise)).max(0.5 * self.pace.least_gain);
        self.costs[before] - self.at.cost < least
    }
}

fn met_tolerance(code: TerminationCode) -> bool {
    !matches!(code, TerminationCode::SolverFailed | TerminationCode::MaxIter | TerminationCode::MaxTime)
}

/// What `basin` takes by value.
struct Borrowed<'a, 'b>(&'a LeastSquares<'b>);

impl Constraints for Borrowed<'_, '_> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;

    fn constraints(&self) -> <Self::Set as basin::ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.0.lower), Some(&self.0.upper)))
    }
}

impl CostFunction for Borrowed<'_, '_> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Infallible;

    fn cost(&self, x: &Vec<f64>) -> Result<f64, Infallible> {
        Ok(self.0.cost_at(x))
    }
}

impl Residual for Borrowed<'_, '_> {
    type Param = Vec<f64>;
    type Output = Vec<f64>;
    type Error = Infallible;

    /// The first column of the triangular factor.
    fn residual(&self, x: &Vec<f64>) -> Result<Vec<f64>, Infallible> {
        let mut all = vec![0.0; self.0.rows.min(x.len() + 1)];
        if let Some(first) = all.first_mut() {
            *first = (2.0 * self.0.cost_at(x)).sqrt();
        }
        Ok(all)
    }
}

impl Jacobian for Borrowed<'_, '_> {
    type Jacobian = DenseMatrix;

    /// The other columns.
    fn jacobian(&self, x: &Vec<f64>) -> Result<DenseMatrix, Infallible> {
        let triangle = triangle(&(self.0.linear)(x));
        let columns = triangle.columns_range(1..);
        // Stored by columns, so that the transpose is in the order of rows.
        Ok(DenseMatrix::from_row_slice(columns.nrows(), columns.ncols(), columns.transpose().as_slice()))
    }
}

/// The triangular factor of residuals and Jacobian, its first entry not negative.
pub(crate) fn triangle(linear: &DMatrix<f64>) -> DMatrix<f64> {
    if linear.iter().any(|x| !x.is_finite()) {
        return DMatrix::from_element(linear.nrows().min(linear.ncols()), linear.ncols(), f64::NAN);
    }
    linear.clone().qr().r()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a few hundred products.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn analytic_the_triangular_factor_keeps_cost_gradient_and_curvature() {
        for (rows, columns) in [(200, 5), (5, 5), (3, 5)] {
            let linear = DMatrix::from_fn(rows, columns, |i, k| ((3 * i + 7 * k * k) as f64).sin());
            let triangle = triangle(&linear);
            assert_eq!(triangle.nrows(), rows.min(columns));
            assert!((triangle[(0, 0)] - linear.column(0).norm()).abs() < ROUNDING);
            assert!(triangle.column(0).iter().skip(1).all(|x| *x == 0.0));
            let (kept, whole) = (triangle.transpose() * &triangle, linear.transpose() * &linear);
            assert!((kept - whole).amax() < ROUNDING * rows as f64);
        }
    }
}
