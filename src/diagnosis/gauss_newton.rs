//! Gauss-Newton steps within bounds, for models whose derivatives cost as much as all the algebra of a search together, and for so many
//! parameters that the algebra of other methods costs as much.
//!
//! Each step goes to the least of the linearised problem within the bounds and within a part of them that grows and shrinks with
//! how well the last step was predicted (a trust region in the form of a box: Voglis and Lagaris 2004; Conn, Gould and Toint 2000,
//! chapter 7). A parameter on a bound stays there as long as the slope points outward, so that a search that ends on a bound takes no
//! more steps than one that ends inside. Directions that change less than [`PROXIMAL`] of chi-square over the width of the bounds
//! are left where they are (a proximal term, which is zero where the search ends, so that it does not move the result).
//!
//! A Jacobian costs as much as several simulations, so that it is carried on from step to step: a simulation tells how the residuals change
//! along the step, and the Jacobian is changed by as little as makes it give the same (Broyden 1965). It is computed anew where the one that was
//! carried on predicts badly, and before a search ends since nothing more is promised.

use super::bounded_quadratic::within;
use super::least_squares::{LeastSquares, Minimum, triangle};
use nalgebra::{DMatrix, DVector};

/// Chi-square that a move over the whole width of a parameter's bounds is charged.
pub(crate) const PROXIMAL: f64 = 1.0;

/// Largest first step, as a share of the width of the bounds, and the least step that is tried.
const FIRST: f64 = 0.25;
const LEAST: f64 = 1e-5;

/// Share of the predicted fall from which a step is accepted, is called poor, and is called good.
const ACCEPTED: f64 = 1e-3;
const POOR: f64 = 0.25;
const GOOD: f64 = 0.75;
/// Share of the predicted fall below which derivatives that were carried on are computed anew.
const TELLING: f64 = 0.5;
/// Factors of the trust region.
const SHRINK: f64 = 0.25;
const GROW: f64 = 2.5;
/// Share of the predicted fall above which the linearised problem is taken to predict too short steps, as it does where many residuals count
/// as bad samples. The next step is then doubled as long as chi-square falls, at most to this multiple.
const EXCEEDED: f64 = 1.25;
const LONGEST: f64 = 8.0;

/// A search ends where the linearised problem promises a smaller fall of chi-square: no decision hangs on a twentieth, nor, where the
/// misfit is far beyond noise, on a small share of what is beyond. The finite step of the simulations roughens chi-square, over many rows
/// by more than a twentieth; a fall of 1e-5 a row is 0.35 in 35,000.
const NOTHING: f64 = 0.05;
const NOTHING_A_ROW: f64 = 1e-5;

/// By how much chi-square may differ between two searches that have ended in the same place, where no decision hangs on the share
/// `of_misfit` of the misfit beyond noise.
pub(crate) fn same_end(chi_square: f64, rows: f64, of_misfit: f64) -> f64 {
    NOTHING + of_misfit * (chi_square - rows).max(0.0) + NOTHING_A_ROW * rows
}

/// A search under way.
pub(crate) struct Descent<'a> {
    problem: &'a LeastSquares<'a>,
    /// The residuals, the first column, and their Jacobian at the present point.
    linear: DMatrix<f64>,
    /// Triangular factor of these.
    triangle: DMatrix<f64>,
    /// Whether the Jacobian was carried on from other points.
    carried: bool,
    at: Vec<f64>,
    /// Largest change of a coordinate, as a share of the width of its bounds.
    trust: f64,
    /// Whether the last trial gained clearly more than was predicted.
    exceeded: bool,
    steps: u64,
    /// It ends where the next step promises less than this share of the misfit beyond noise.
    least_promise: f64,
}

/// What became of a trial.
enum Trial {
    /// A step was made, or failed.
    Made,
    /// The derivatives were computed anew; nothing else has changed.
    Derived,
    /// The search ends: whether it has converged.
    Ended(bool),
}

impl<'a> Descent<'a> {
    /// Starts at `start`, to end where a step promises less than the share `least_promise` of the misfit beyond noise; `None` where the model has no answer there.
    pub fn new(problem: &'a LeastSquares<'a>, start: &[f64], least_promise: f64) -> Option<Self> {
        let linear = problem.linear_at(start);
        let triangle = triangle(&linear);
        let at = start.to_vec();
        let (carried, trust, exceeded, steps) = (false, FIRST, false, 0);
        let descent = Self { problem, linear, triangle, carried, at, trust, exceeded, steps, least_promise };
        descent.chi_square().is_finite().then_some(descent)
    }

    /// Where the search is.
    pub fn minimum(&self, converged: bool) -> Minimum {
        Minimum {
            x: self.at.clone(),
            cost: 0.5 * self.chi_square(),
            steps: self.steps,
            converged,
            triangle: (!self.carried).then(|| self.triangle.clone()),
        }
    }

    fn chi_square(&self) -> f64 {
        self.linear.column(0).norm_squared()
    }

    /// Makes one trial; where the search is then, and whether it has ended.
    pub fn step(&mut self) -> (Minimum, bool) {
        loop {
            match self.trial() {
                Trial::Made => return (self.minimum(false), false),
                Trial::Derived => {}
                Trial::Ended(converged) => return (self.minimum(converged), true),
            }
        }
    }

    fn trial(&mut self) -> Trial {
        let (change, fall) = self.linear_step();
        if fall <= same_end(self.chi_square(), self.problem.rows as f64, self.least_promise) {
            if self.carried {
                return self.derive();
            }
            // A region that has become small may hide a larger fall.
            return Trial::Ended(self.trust >= FIRST * SHRINK * SHRINK);
        }
        let (factor, residual) =
            if self.exceeded { self.worth_going_on(&change) } else { (1.0, self.after(&change, 1.0)) };
        let (next, size) = (self.moved(&change, factor), factor * self.share_of_widths(&change));
        // A cost that is no number is no fall.
        let kept = (self.chi_square() - residual.norm_squared()) / fall;
        let falls = kept > ACCEPTED;
        if !falls && self.carried {
            return self.derive();
        }
        self.steps += 1;
        if !falls {
            return self.shrunk(size);
        }
        if kept < POOR && !self.carried {
            self.trust = SHRINK.sqrt() * size;
        } else if kept > GOOD {
            self.trust = self.trust.max(GROW * size).min(1.0);
        }
        self.exceeded = kept > EXCEEDED;
        self.carry(next, &residual);
        if kept < TELLING
            && let Trial::Ended(converged) = self.derive()
        {
            return Trial::Ended(converged);
        }
        Trial::Made
    }

    /// Computes the derivatives at the present point.
    fn derive(&mut self) -> Trial {
        let linear = self.problem.linear_at(&self.at);
        if linear.iter().any(|x| !x.is_finite()) {
            return Trial::Ended(false);
        }
        (self.triangle, self.linear, self.carried) = (triangle(&linear), linear, false);
        Trial::Derived
    }

    /// Goes to a point with its residuals; the Jacobian takes up how these have changed (Broyden's first method, a coordinate
    /// measured by the width of its bounds).
    fn carry(&mut self, next: Vec<f64>, residual: &DVector<f64>) {
        let widths: Vec<f64> = (0..next.len()).map(|k| self.width(k)).collect();
        let change = DVector::from_iterator(next.len(), next.iter().zip(&self.at).map(|(new, old)| new - old));
        let shares = DVector::from_iterator(next.len(), change.iter().zip(&widths).map(|(d, width)| d / width));
        let predicted = self.linear.column(0) + self.linear.columns_range(1..) * &change;
        let missed = residual - predicted;
        let length = shares.norm_squared();
        for k in 0..next.len() {
            let share = shares[k] / (length * widths[k]);
            self.linear.column_mut(k + 1).axpy(share, &missed, 1.0);
        }
        self.linear.set_column(0, residual);
        (self.triangle, self.carried, self.at) = (triangle(&self.linear), true, next);
    }

    /// Where a change leads, made so many times as long, within the bounds.
    fn moved(&self, change: &[f64], factor: f64) -> Vec<f64> {
        let bounds = self.problem.lower.iter().zip(&self.problem.upper);
        let moved = self.at.iter().zip(change).zip(bounds);
        moved.map(|((x, d), (low, high))| (x + factor * d).clamp(*low, *high)).collect()
    }

    /// The residuals where a change leads, made so many times as long.
    fn after(&self, change: &[f64], factor: f64) -> DVector<f64> {
        DVector::from_vec((self.problem.residual)(&self.moved(change, factor)))
    }

    /// The multiple of a change, by doubling, up to which chi-square falls, 1 to [`LONGEST`], and the residuals there.
    fn worth_going_on(&self, change: &[f64]) -> (f64, DVector<f64>) {
        let (mut factor, mut residual) = (1.0, self.after(change, 1.0));
        while factor < LONGEST {
            let further = self.after(change, 2.0 * factor);
            if further.norm_squared() < residual.norm_squared() {
                (factor, residual) = (2.0 * factor, further);
            } else {
                break;
            }
        }
        (factor, residual)
    }

    /// After a trial of this size that failed.
    fn shrunk(&mut self, size: f64) -> Trial {
        (self.trust, self.exceeded) = (SHRINK * size, false);
        if self.trust < LEAST { Trial::Ended(false) } else { Trial::Made }
    }

    fn width(&self, k: usize) -> f64 {
        self.problem.upper[k] - self.problem.lower[k]
    }

    fn share_of_widths(&self, change: &[f64]) -> f64 {
        change.iter().enumerate().map(|(k, d)| (d / self.width(k)).abs()).fold(0.0, f64::max)
    }

    /// The step to the least of the linearised problem within bounds and trust region, and the fall of chi-square that it promises.
    fn linear_step(&self) -> (Vec<f64>, f64) {
        let n = self.at.len();
        let jacobian = self.triangle.columns_range(1..);
        let residual = self.triangle.column(0);
        let (mut gram, along) = (jacobian.tr_mul(&jacobian), jacobian.tr_mul(&residual));
        let exact = gram.clone();
        for k in 0..n {
            gram[(k, k)] += PROXIMAL / self.width(k).powi(2);
        }
        let ends = |k: usize| {
            let most = self.trust * self.width(k);
            (
                (self.problem.lower[k] - self.at[k]).clamp(-most, 0.0),
                (self.problem.upper[k] - self.at[k]).clamp(0.0, most),
            )
        };
        let ends: Vec<(f64, f64)> = (0..n).map(ends).collect();
        let change = within(&gram, along.as_slice(), &ends);
        let mut fall = 0.0;
        for i in 0..n {
            let curved: f64 = (0..n).map(|k| exact[(i, k)] * change[k]).sum();
            fall -= change[i] * (2.0 * along[i] + curved);
        }
        (change, fall)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};

    /// Rounding of a handful of products.
    const ROUNDING: f64 = 1e-9;
    /// Share of the misfit that is no gain.
    const LEAST_PROMISE: f64 = 2e-4;

    #[test]
    fn analytic_a_careful_step_goes_on_as_long_as_that_leaves_less() {
        for (least, expected) in [(0.4, 1.0), (3.1, 4.0), (2.0, 2.0), (1e3, LONGEST)] {
            let residual = |x: &[f64]| vec![x[0] - least];
            let linear = |x: &[f64]| DMatrix::from_row_slice(1, 2, &[x[0] - least, 1.0]);
            let (lower, upper) = (vec![-1e4], vec![1e4]);
            let problem =
                LeastSquares { lower, upper, rows: 1, tolerance: 1e-12, residual: &residual, linear: &linear };
            let descent = Descent::new(&problem, &[0.0], LEAST_PROMISE).expect("a line has values everywhere");
            assert_eq!(descent.worth_going_on(&[1.0]).0, expected, "least at {least}");
        }
    }

    /// Residuals of a curve p0 exp(-p1 t) + p2 at exact values.
    fn decay(x: &[f64], true_values: &[f64; 3]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let (mut residual, mut slopes) = (Vec::new(), vec![Vec::new(); 3]);
        for k in 0..40 {
            let t = 0.1 * k as f64;
            let at = |p: &[f64]| p[0] * (-p[1] * t).exp() + p[2];
            residual.push(100.0 * (at(x) - at(true_values)));
            let e = (-x[1] * t).exp();
            [e, -t * x[0] * e, 1.0].into_iter().zip(&mut slopes).for_each(|(s, column)| column.push(100.0 * s));
        }
        (residual, slopes)
    }

    #[test]
    fn analytic_a_carried_jacobian_tells_the_step_and_nothing_else() {
        let true_values = [2.0, 1.3, 0.4];
        let residual = |x: &[f64]| decay(x, &true_values).0;
        let linear = |x: &[f64]| {
            let (residual, slopes) = decay(x, &true_values);
            DMatrix::from_fn(40, 4, |i, k| if k == 0 { residual[i] } else { slopes[k - 1][i] })
        };
        let (lower, upper) = (vec![0.0; 3], vec![5.0, 2.0, 10.0]);
        let problem = LeastSquares { lower, upper, rows: 40, tolerance: 1e-12, residual: &residual, linear: &linear };
        let (start, next) = ([0.5, 0.5, 0.0], [1.0, 0.9, 0.2]);
        let mut descent = Descent::new(&problem, &start, LEAST_PROMISE).expect("the curve has values everywhere");
        let before = descent.linear.clone();
        let there = DVector::from_vec(residual(&next));
        descent.carry(next.to_vec(), &there);
        let step = DVector::from_fn(3, |k, _| next[k] - start[k]);
        let change = descent.linear.columns_range(1..) * step;
        assert!((before.column(0) + change - &there).amax() < ROUNDING * 100.0, "the step that was made");
        // At right angles to it, by the widths 5, 2, 10: (0.1, 0.2, 0.02) of them.
        let across = DVector::from_vec(vec![5.0 * 0.2, -2.0 * 0.1, 0.0]);
        let [old, new] = [&before, &descent.linear].map(|linear| linear.columns_range(1..) * &across);
        assert!((old - new).amax() < ROUNDING * 100.0, "any other direction");
        assert!(descent.carried && descent.minimum(true).triangle.is_none());
    }

    #[test]
    fn analytic_a_curve_comes_back_inside_and_on_a_bound() {
        for (true_values, upper, expected) in
            [([2.0, 1.3, 0.4], 5.0, Some([2.0, 1.3, 0.4])), ([2.0, 1.3, 0.4], 1.0, None)]
        {
            let residual = |x: &[f64]| decay(x, &true_values).0;
            let derived = AtomicU64::new(0);
            let linear = |x: &[f64]| {
                derived.fetch_add(1, Ordering::Relaxed);
                let (residual, slopes) = decay(x, &true_values);
                DMatrix::from_fn(40, 4, |i, k| if k == 0 { residual[i] } else { slopes[k - 1][i] })
            };
            let (lower, upper) = (vec![0.0; 3], vec![5.0, upper, 5.0]);
            let problem =
                LeastSquares { lower, upper, rows: 40, tolerance: 1e-12, residual: &residual, linear: &linear };
            let mut descent =
                Descent::new(&problem, &[0.5, 0.5, 0.0], LEAST_PROMISE).expect("the curve has values everywhere");
            let mut ended = false;
            for _ in 0..30 {
                if ended {
                    break;
                }
                ended = descent.step().1;
            }
            let at = descent.minimum(true);
            assert!(ended && at.steps < 15, "{} steps", at.steps);
            assert!(derived.load(Ordering::Relaxed) < at.steps, "derivatives are carried on over {} steps", at.steps);
            assert!(at.triangle.is_some(), "a search ends by the derivatives of its last point");
            match expected {
                // What a fall of a twentieth of chi-square leaves.
                Some(values) => assert!(at.x.iter().zip(values).all(|(x, v)| (x - v).abs() < 5e-3), "{:?}", at.x),
                None => assert!((at.x[1] - 1.0).abs() < 1e-12, "{:?}", at.x),
            }
        }
    }
}
