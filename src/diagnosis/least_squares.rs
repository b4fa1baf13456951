//! Bounded nonlinear least squares: min 1/2 |r(x)|^2 with lower <= x <= upper.
//!
//! The work is done by `basin`'s trust-region reflective method (Branch, Coleman and Li 1999), the algorithm of
//! scipy's `least_squares`: bounds are handled without a transform that flattens the slope near them, a failed
//! evaluation (infinite residual) is a rejected step, and robust losses can be added. `levenberg-marquardt` 0.15 has
//! no bounds.

use basin::{
    BoxBounds, ConstraintSet, Constraints, CostFunction, DenseMatrix, Executor, Jacobian, Residual, TerminationCode,
    TrustRegionReflective,
};
use std::convert::Infallible;

/// Share by which the point may still move between accepted steps when the search stops.
const STEP_TOLERANCE: f64 = 1e-10;

/// Steps after which a search gives up; fits here take 10 to 60.
const MAX_STEPS: u64 = 300;

/// Residuals and their Jacobian over a box.
pub(crate) struct LeastSquares<'a> {
    /// Lower bounds.
    pub lower: Vec<f64>,
    /// Upper bounds, each above its lower bound.
    pub upper: Vec<f64>,
    /// Residuals; infinite where the model has no answer.
    pub residual: &'a (dyn Fn(&[f64]) -> Vec<f64> + Sync),
    /// Share by which the cost may still fall between accepted steps when the search stops.
    pub tolerance: f64,
    /// Jacobian of the residuals, row by row.
    pub jacobian: &'a (dyn Fn(&[f64]) -> Vec<f64> + Sync),
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
}

impl LeastSquares<'_> {
    /// 1/2 |r(x)|^2; infinite where the model has no answer.
    pub fn cost_at(&self, x: &[f64]) -> f64 {
        0.5 * (self.residual)(x).iter().map(|r| r * r).sum::<f64>()
    }

    /// Searches from `start`, which must have a finite cost; `None` where the bounds are not an interval each.
    pub fn minimise(&self, start: &[f64]) -> Option<Minimum> {
        let solver = TrustRegionReflective::new()
            .with_relative_cost_change_tolerance(self.tolerance)
            .with_relative_step_tolerance(STEP_TOLERANCE);
        let result = Executor::from_start(Borrowed(self), solver, start.to_vec()).max_iter(MAX_STEPS).run().ok()?;
        let converged = !matches!(
            result.report.termination.code(),
            TerminationCode::SolverFailed | TerminationCode::MaxIter | TerminationCode::MaxTime
        );
        Some(Minimum { x: result.param().clone(), cost: result.cost(), steps: result.iter(), converged })
    }
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

    fn residual(&self, x: &Vec<f64>) -> Result<Vec<f64>, Infallible> {
        Ok((self.0.residual)(x))
    }
}

impl Jacobian for Borrowed<'_, '_> {
    type Jacobian = DenseMatrix;

    fn jacobian(&self, x: &Vec<f64>) -> Result<DenseMatrix, Infallible> {
        let rows = (self.0.jacobian)(x);
        Ok(DenseMatrix::from_row_slice(rows.len() / x.len(), x.len(), &rows))
    }
}
