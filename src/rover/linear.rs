//! Small dense linear systems in place, over any scalar (nalgebra's decompositions need a field with an
//! order and a full set of functions that dual numbers share names with; this needs + - * / only).

use crate::scalar::Scalar;
use std::ops::{DivAssign, Mul};

/// Most generalised coordinates of a rover: three of the chassis and five passive joints.
pub const MAX_COORDINATES: usize = 8;

/// A vector of generalised coordinates; entries beyond the rover's own stay zero.
pub(crate) type Vector<S> = [S; MAX_COORDINATES];

/// A square matrix over the generalised coordinates.
pub(crate) type Matrix<S> = [Vector<S>; MAX_COORDINATES];

pub(crate) fn zeros<S: Scalar>() -> Vector<S> {
    [S::from(0.0); MAX_COORDINATES]
}

pub(crate) fn dot<S: Scalar>(a: &Vector<S>, b: &Vector<S>, n: usize) -> S {
    let mut sum = S::from(0.0);
    for i in 0..n {
        sum += a[i] * b[i];
    }
    sum
}

/// `matrix += factor a b^T`.
pub(crate) fn add_outer<S: Scalar>(matrix: &mut Matrix<S>, factor: S, a: &Vector<S>, b: &Vector<S>, n: usize) {
    for i in 0..n {
        let scaled = factor * a[i];
        for j in 0..n {
            matrix[i][j] += scaled * b[j];
        }
    }
}

/// `vector += factor a`.
pub(crate) fn add_scaled<S: Scalar>(vector: &mut Vector<S>, factor: S, a: &Vector<S>, n: usize) {
    for i in 0..n {
        vector[i] += factor * a[i];
    }
}

/// LU factors with partial pivoting of the leading n x n block.
pub(crate) struct Factors<S> {
    lu: Matrix<S>,
    pivots: [usize; MAX_COORDINATES],
    n: usize,
}

impl<S: Scalar> Factors<S> {
    /// Factors `matrix`; `None` where it is singular or not finite.
    pub fn new(matrix: &Matrix<S>, n: usize) -> Option<Self> {
        let mut lu = *matrix;
        let mut pivots = [0; MAX_COORDINATES];
        for k in 0..n {
            let pivot = (k..n).max_by(|&a, &b| lu[a][k].value().abs().total_cmp(&lu[b][k].value().abs()))?;
            let size = lu[pivot][k].value().abs();
            if !(size > 0.0 && size.is_finite()) {
                return None;
            }
            pivots[k] = pivot;
            lu.swap(k, pivot);
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
            x.swap(k, self.pivots[k]);
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
