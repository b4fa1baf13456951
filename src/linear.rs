//! Small dense linear systems in place, over any scalar (nalgebra's decompositions need a field with an
//! order and a full set of functions that dual numbers share names with; this needs + - * / only).

use crate::scalar::{Mask, Plain, Scalar, lanes};
use crate::vehicle::MAX_COORDINATES;
use num_traits::Signed;
use std::ops::{DivAssign, Mul};

/// A vector of generalised coordinates; entries beyond the rover's own stay zero.
pub(crate) type Vector<S> = [S; MAX_COORDINATES];

/// A square matrix over the generalised coordinates.
pub(crate) type Matrix<S> = [Vector<S>; MAX_COORDINATES];

#[lanes]
pub(crate) fn zeros<S: Scalar>() -> Vector<S> {
    [S::from(0.0); MAX_COORDINATES]
}

#[lanes]
pub(crate) fn dot<S: Scalar>(a: &Vector<S>, b: &Vector<S>, n: usize) -> S {
    let mut sum = S::from(0.0);
    for i in 0..n {
        sum += a[i] * b[i];
    }
    sum
}

/// `matrix += factor a b^T`.
#[lanes]
pub(crate) fn add_outer<S: Scalar>(matrix: &mut Matrix<S>, factor: S, a: &Vector<S>, b: &Vector<S>, n: usize) {
    for i in 0..n {
        let scaled = factor * a[i];
        for j in 0..n {
            matrix[i][j] += scaled * b[j];
        }
    }
}

/// `vector += factor a`.
#[lanes]
pub(crate) fn add_scaled<S: Scalar>(vector: &mut Vector<S>, factor: S, a: &Vector<S>, n: usize) {
    for i in 0..n {
        vector[i] += factor * a[i];
    }
}

/// LU factors with partial pivoting of the leading n x n block.
pub(crate) struct Factors<S: Scalar> {
    lu: Matrix<S>,
    /// The row that took the place of each: the same for all numbers side by side, or one for each.
    pivots: [Pivot<S::Plain>; MAX_COORDINATES],
    n: usize,
}

#[derive(Clone, Copy)]
enum Pivot<R> {
    Same(usize),
    Each(R),
}

#[lanes]
impl<S: Scalar> Factors<S> {
    /// Factors `matrix`; `None` where it is singular or not finite (side by side: where any is).
    #[allow(clippy::needless_range_loop, reason = "two rows at a time")]
    pub fn new(matrix: &Matrix<S>, n: usize) -> Option<Self> {
        let mut lu = *matrix;
        let mut pivots = [Pivot::Same(0); MAX_COORDINATES];
        for k in 0..n {
            let pivot = pivot(&lu, k, n)?;
            match pivot {
                Pivot::Same(row) => lu.swap(k, row),
                Pivot::Each(rows) => {
                    for row in k + 1..n {
                        let here = rows.same(S::Plain::from(row as f64));
                        for j in 0..n {
                            let (above, below) = (lu[k][j], lu[row][j]);
                            lu[k][j] = S::select(here, below, above);
                            lu[row][j] = S::select(here, above, below);
                        }
                    }
                }
            }
            pivots[k] = pivot;
            let inverse = lu[k][k].recip();
            let row = lu[k];
            for below in lu.iter_mut().take(n).skip(k + 1) {
                let factor = below[k] * inverse;
                below[k] = factor;
                for j in k + 1..n {
                    below[j] -= factor * row[j];
                }
            }
        }
        Some(Self { lu, pivots, n })
    }

    /// Solves for one right-hand side, which may carry derivatives that the matrix does not have.
    pub fn solve<T: Scalar + Mul<S, Output = T> + DivAssign<S>>(&self, right: &Vector<T>) -> Vector<T> {
        let mut x = *right;
        for k in 0..self.n {
            match self.pivots[k] {
                Pivot::Same(row) => x.swap(k, row),
                Pivot::Each(rows) => {
                    for row in k + 1..self.n {
                        let here = Mask::from_lanes(|lane| rows.lane(lane) == row as f64);
                        let (above, below) = (x[k], x[row]);
                        x[k] = T::select(here, below, above);
                        x[row] = T::select(here, above, below);
                    }
                }
            }
        }
        for i in 0..self.n {
            for j in 0..i {
                let term = x[j] * self.lu[i][j];
                x[i] -= term;
            }
        }
        for i in (0..self.n).rev() {
            for j in i + 1..self.n {
                let term = x[j] * self.lu[i][j];
                x[i] -= term;
            }
            x[i] /= self.lu[i][i];
        }
        x
    }
}

/// The last of the rows from k on with the largest entry in column k; `None` where that is zero, or one is not finite.
#[lanes]
fn pivot<S: Scalar>(lu: &Matrix<S>, k: usize, n: usize) -> Option<Pivot<S::Plain>> {
    let mut best = lu[k][k].plain().abs();
    let (mut sum, mut rows) = (best, S::Plain::from(k as f64));
    for (i, row) in lu.iter().enumerate().take(n).skip(k + 1) {
        let size = row[k].plain().abs();
        let larger = best.at_most(size);
        best = S::Plain::select(larger, size, best);
        rows = S::Plain::select(larger, S::Plain::from(i as f64), rows);
        sum += size;
    }
    if !best.over(0.0).all() || !sum.all_finite() {
        return None;
    }
    let first = rows.lane(0);
    Some(if rows.is_exactly(first) { Pivot::Same(first as usize) } else { Pivot::Each(rows) })
}
