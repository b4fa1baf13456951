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

/// Triangular factor of the products of columns among themselves, of those that are independent of the ones before them.
#[derive(Clone, Debug)]
pub(crate) struct Factor {
    /// Which columns are in it.
    pub kept: Vec<usize>,
    /// Lower triangle, row by row.
    rows: Vec<Vec<f64>>,
}

/// Share of a column's square below which what is new of it is rounding of the products.
const NEW_SQUARE: f64 = 1e-10;

impl Factor {
    /// Of the products `gram`; Cholesky's method, which leaves dependent columns out.
    pub fn of(gram: &nalgebra::DMatrix<f64>) -> Self {
        let mut factor = Self { kept: Vec::new(), rows: Vec::new() };
        for i in 0..gram.nrows() {
            let mut row = factor.forward(&|j| gram[(i, j)]);
            let rest = gram[(i, i)] - dot(&row, &row);
            if rest > NEW_SQUARE * gram[(i, i)] && rest.is_finite() {
                row.push(rest.sqrt());
                factor.kept.push(i);
                factor.rows.push(row);
            }
        }
        factor
    }

    /// The same where the others are taken out and the kept ones numbered anew.
    pub fn numbered_anew(self) -> Self {
        Self { kept: (0..self.kept.len()).collect(), ..self }
    }

    /// Number of independent columns.
    pub fn rank(&self) -> usize {
        self.kept.len()
    }

    /// L^-1 b, of products `along` of all columns with a vector.
    pub fn forward(&self, along: &dyn Fn(usize) -> f64) -> Vec<f64> {
        let mut y: Vec<f64> = Vec::with_capacity(self.rows.len() + 1);
        for (row, k) in self.rows.iter().zip(&self.kept) {
            let rest = along(*k) - dot(&row[..y.len()], &y);
            y.push(rest / row[y.len()]);
        }
        y
    }

    /// Coefficients of the kept columns that bring a vector with these products nearest.
    pub fn solve(&self, along: &dyn Fn(usize) -> f64) -> Vec<f64> {
        let mut x = self.forward(along);
        for i in (0..x.len()).rev() {
            let sum: f64 = (i + 1..x.len()).map(|k| self.rows[k][i] * x[k]).sum();
            x[i] = (x[i] - sum) / self.rows[i][i];
        }
        x
    }
}

/// The span of many long columns, by their products: no orthonormal columns are made, which for hundreds of them takes longer than a fit.
#[derive(Clone, Debug)]
pub(crate) struct Span {
    columns: nalgebra::DMatrix<f64>,
    factor: Factor,
}

impl Span {
    /// The span of `columns`, each of `rows` entries.
    pub fn of(rows: usize, columns: &[Vec<f64>]) -> Self {
        // Of unit length, so that products tell what is new in each.
        let mut all = Vec::with_capacity(rows * columns.len());
        for column in columns {
            let size = norm(column);
            let factor = if size > 0.0 && size.is_finite() { size.recip() } else { 0.0 };
            all.extend(column.iter().map(|x| x * factor));
        }
        let columns = nalgebra::DMatrix::from_vec(rows, columns.len(), all);
        let factor = Factor::of(&products(&columns));
        Self { columns, factor }
    }

    /// Number of directions.
    pub fn rank(&self) -> usize {
        self.factor.rank()
    }

    /// Squared length of the part of a column within the span.
    pub fn squares_within(&self, column: &[f64]) -> f64 {
        let along = self.columns.tr_mul(&nalgebra::DVectorView::from_slice(column, column.len()));
        self.factor.forward(&|k| along[k]).iter().map(|y| y * y).sum()
    }

    /// The same of several columns at once, for which the span is read once.
    pub fn squares_within_each(&self, columns: &[Vec<f64>]) -> Vec<f64> {
        let (rows, count) = (self.columns.nrows(), columns.len());
        let mut beside = Vec::with_capacity(rows * count);
        (0..rows).for_each(|row| beside.extend(columns.iter().map(|column| column[row])));
        let along = nalgebra::DMatrix::from_vec(count, rows, beside) * &self.columns;
        let squares = |j: usize| self.factor.forward(&|k| along[(j, k)]).iter().map(|y| y * y).sum();
        (0..count).map(squares).collect()
    }
}

/// The span of columns: by an orthonormal basis or, where columns are many and long, by their products.
#[derive(Clone, Debug)]
pub(crate) enum Directions {
    Basis(Basis),
    Span(Span),
}

impl Directions {
    /// Number of directions.
    pub fn rank(&self) -> usize {
        match self {
            Self::Basis(basis) => basis.rank(),
            Self::Span(span) => span.rank(),
        }
    }

    /// Squared length of the part of a column within the span.
    pub fn squares_within(&self, column: &[f64]) -> f64 {
        match self {
            Self::Basis(basis) => basis.squares_within(column),
            Self::Span(span) => span.squares_within(column),
        }
    }

    /// The same of several columns.
    pub fn squares_within_each(&self, columns: &[Vec<f64>]) -> Vec<f64> {
        match self {
            Self::Basis(basis) => columns.iter().map(|column| basis.squares_within(column)).collect(),
            Self::Span(span) => span.squares_within_each(columns),
        }
    }
}

/// Products of all columns with each other. By way of the transpose, for which the product of matrices is a fast one.
pub(crate) fn products(columns: &nalgebra::DMatrix<f64>) -> nalgebra::DMatrix<f64> {
    columns.transpose() * columns
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
