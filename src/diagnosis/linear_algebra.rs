//! Long columns: orthonormal bases and projections, and least squares with signs over a few of them.
//!
//! By hand: a basis here grows column by column and decides for each whether it is new, which nalgebra's QR does not, and its
//! Cholesky subtracts in another order and has no relative threshold, so results would differ in their last bits.

/// A column counts as dependent on those before it where less than this share of it is new.
const NEW_SHARE: f64 = 1e-6;

/// An orthonormal basis of columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Basis {
    vectors: Vec<Vec<f64>>,
}

impl Basis {
    /// The span of `columns`.
    pub fn of<'a>(columns: impl IntoIterator<Item = &'a Vec<f64>>) -> Self {
        let mut basis = Self::default();
        columns.into_iter().for_each(|column| basis.add(column));
        basis
    }

    /// Adds a direction; one that is already in the span adds nothing.
    pub fn add(&mut self, column: &[f64]) {
        let size = norm(column);
        let mut rest = column.to_vec();
        // Twice is enough (Kahan, Parlett): the second pass removes what rounding left of the first.
        self.remove_from(&mut rest);
        self.remove_from(&mut rest);
        let left = norm(&rest);
        if left > NEW_SHARE * size && left.is_finite() {
            rest.iter_mut().for_each(|x| *x /= left);
            self.vectors.push(rest);
        }
    }

    /// Number of directions.
    pub fn rank(&self) -> usize {
        self.vectors.len()
    }

    /// The directions.
    pub fn iter(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.vectors.iter()
    }

    /// Subtracts the part within the span.
    pub fn remove_from(&self, column: &mut [f64]) {
        for vector in &self.vectors {
            let along = dot(vector, column);
            column.iter_mut().zip(vector).for_each(|(x, v)| *x -= along * v);
        }
    }

    /// The part of a column outside the span.
    pub fn outside(&self, column: &[f64]) -> Vec<f64> {
        let mut rest = column.to_vec();
        self.remove_from(&mut rest);
        rest
    }

    /// Squared length of the part of a column within the span.
    pub fn squares_within(&self, column: &[f64]) -> f64 {
        self.vectors.iter().map(|vector| dot(vector, column).powi(2)).sum()
    }
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Interval that a coefficient may not leave; it holds 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reach {
    pub low: f64,
    pub high: f64,
}

impl Reach {
    /// Share of `x` that lies within, up to 1; `None` where `x` goes where nothing may.
    fn share(self, x: f64) -> Option<f64> {
        let end = if x > 0.0 { self.high } else { self.low };
        if x == 0.0 {
            Some(1.0)
        } else if end == 0.0 {
            None
        } else {
            Some((end / x).min(1.0))
        }
    }
}

/// Largest fall of |r - X d|^2 over d within its reach, and that d; `gram` is X^T X (row by row), `along` X^T r.
///
/// All subsets of nonzero coefficients are tried, since there are a handful of columns at most; a subset that is
/// singular adds nothing to its parts. A solution that leaves its reach is followed as far as that goes: slopes say
/// nothing of values that no parameter may have.
pub(crate) fn best_fall(gram: &[f64], along: &[f64], reach: &[Reach]) -> (f64, Vec<f64>) {
    let n = along.len();
    let mut best = (0.0, vec![0.0; n]);
    for subset in 1_u32..1 << n {
        let members: Vec<usize> = (0..n).filter(|k| subset >> k & 1 == 1).collect();
        let Some(d) = solve(gram, along, n, &members) else { continue };
        let within = members.iter().zip(&d).map(|(k, d)| reach[*k].share(*d));
        let Some(share) = within.reduce(|a, b| Some(a?.min(b?))).flatten() else { continue };
        let whole: f64 = members.iter().zip(&d).map(|(k, d)| along[*k] * d).sum();
        // Along the way to the solution |r - X (t d)|^2 falls by (2 t - t^2) of the whole.
        let fall = whole * share * (2.0 - share);
        if fall > best.0 {
            best = (fall, vec![0.0; n]);
            members.iter().zip(d).for_each(|(k, d)| best.1[*k] = share * d);
        }
    }
    best
}

/// Solves the normal equations of a subset by Cholesky's method; `None` where they are singular.
fn solve(gram: &[f64], along: &[f64], n: usize, members: &[usize]) -> Option<Vec<f64>> {
    let m = members.len();
    let mut l = vec![0.0; m * m];
    for i in 0..m {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| l[i * m + k] * l[j * m + k]).sum();
            let entry = gram[members[i] * n + members[j]] - sum;
            if i == j {
                if entry <= NEW_SHARE * gram[members[i] * n + members[i]] || entry.is_nan() {
                    return None;
                }
                l[i * m + i] = entry.sqrt();
            } else {
                l[i * m + j] = entry / l[j * m + j];
            }
        }
    }
    let mut x: Vec<f64> = members.iter().map(|k| along[*k]).collect();
    for i in 0..m {
        let sum: f64 = (0..i).map(|k| l[i * m + k] * x[k]).sum();
        x[i] = (x[i] - sum) / l[i * m + i];
    }
    for i in (0..m).rev() {
        let sum: f64 = (i + 1..m).map(|k| l[k * m + i] * x[k]).sum();
        x[i] = (x[i] - sum) / l[i * m + i];
    }
    Some(x)
}
