//! A dense dual active-set method for small convex programs (Goldfarb and Idnani 1983), with proximal steps where
//! the objective is not strictly convex (as Arnstrom, Bemporad and Axehill 2022 do).
//!
//! The dual method starts at the unconstrained optimum and takes in one violated row after the other; each step
//! stays optimal for the rows taken so far. It wants a definite Hessian. The loads N_i have no cost, and a linear
//! program has none at all, so that the proximal point method wraps it: minimise the objective plus
//! eps |x - x'|^2 / 2 over the unknowns without cost, from x' = 0 on, with x' the solution before, until the
//! pull eps (x - x') is under rounding. Every solution but the first starts from the rows of the one before.

use super::solver::Numbers;
use std::borrow::Cow;

/// Weight of the proximal term, of the least weight in the objective.
const PROXIMAL: f64 = 1e-6;
/// The same in a linear program, whose first step is its gradient over this weight: the larger, the less rounding.
const PROXIMAL_LINEAR: f64 = 1e-2;
/// Pull of the proximal term at which the optimum is reached: what is left of the objective's gradient.
const PULL: f64 = 1e-10;
/// Violation of a row, for data of order 1, from which it counts.
const VIOLATED: f64 = 1e-10;
/// Violation that a row which depends on the active ones may keep: where it should hold with equality, rounding.
const ROUNDING: f64 = 1e-9;
/// Part of a row's normal outside the active rows' normals below which it depends on them.
const DEPENDENT: f64 = 1e-10;
/// Proximal steps at most; 2 to 5 are usual.
const MOST_CENTRES: usize = 500;
/// Rows taken in at most, over all proximal steps; a few times their number are usual.
const MOST_ROWS: usize = 2000;

/// Working memory for one program.
#[derive(Clone, Debug)]
pub(super) struct ActiveSet {
    /// Number of unknowns.
    n: usize,
    /// Rows of A, one after the other.
    matrix: Vec<f64>,
    /// Diagonal of the Hessian with the proximal term, and that term alone.
    hessian: Vec<f64>,
    proximal: Vec<f64>,
    /// J with J J' = H^-1 and J' N = [R; 0] for the active normals N; by columns.
    basis: Vec<f64>,
    /// R, upper triangular; by columns.
    triangle: Vec<f64>,
    /// Active rows, the sign with which each one's normal counts, and its multiplier.
    active: Vec<Active>,
    /// Rows that are active, or need not be.
    settled: Vec<bool>,
    x: Vec<f64>,
    centre: Vec<f64>,
    gradient: Vec<f64>,
    /// J' times a vector, and a solution of a triangular system.
    image: Vec<f64>,
    step: Vec<f64>,
    right: Vec<f64>,
    multipliers: Vec<f64>,
    taken: usize,
}

#[derive(Clone, Copy, Debug)]
struct Active {
    row: usize,
    /// The constraint is sign a'x <= sign b; -1 for an equality that was violated from below.
    sign: f64,
    multiplier: f64,
    equality: bool,
}

impl ActiveSet {
    pub fn new(numbers: &Numbers) -> Self {
        let (n, rows) = (numbers.linear.len(), numbers.rows.bounds.len());
        let least = numbers.quadratic.iter().copied().filter(|p| *p > 0.0).fold(f64::INFINITY, f64::min);
        let weight = if least.is_finite() { PROXIMAL * least } else { PROXIMAL_LINEAR };
        let proximal: Vec<f64> = numbers.quadratic.iter().map(|&p| if p > 0.0 { 0.0 } else { weight }).collect();
        Self {
            n,
            matrix: vec![0.0; rows * n],
            hessian: numbers.quadratic.iter().zip(&proximal).map(|(p, e)| p + e).collect(),
            proximal,
            basis: vec![0.0; n * n],
            triangle: vec![0.0; n * n],
            active: Vec::with_capacity(n),
            settled: vec![false; rows],
            x: vec![0.0; n],
            centre: vec![0.0; n],
            gradient: vec![0.0; n],
            image: vec![0.0; n],
            step: vec![0.0; n],
            right: vec![0.0; n],
            multipliers: vec![0.0; rows],
            taken: 0,
        }
    }

    pub fn solution(&self) -> &[f64] {
        &self.x
    }

    /// Takes the weights of the unknowns anew; which of them have one has not changed.
    pub fn weigh(&mut self, numbers: &Numbers) {
        let sums = self.hessian.iter_mut().zip(numbers.quadratic.iter().zip(&self.proximal));
        sums.for_each(|(sum, (weight, proximal))| *sum = weight + proximal);
    }

    pub fn multipliers(&self) -> &[f64] {
        &self.multipliers
    }

    /// Solves, or says why not.
    pub fn solve(&mut self, numbers: &Numbers) -> Result<(), Cow<'static, str>> {
        self.load(numbers);
        for _ in 0..MOST_CENTRES {
            for i in 0..self.n {
                self.gradient[i] = numbers.linear[i] - self.proximal[i] * self.centre[i];
            }
            self.settle(numbers);
            self.complete(numbers)?;
            let pulls = self.x.iter().zip(&self.centre).zip(&self.proximal);
            let pull = pulls.map(|((x, centre), weight)| (weight * (x - centre)).abs()).fold(0.0, f64::max);
            self.centre.copy_from_slice(&self.x);
            if pull <= PULL {
                self.multipliers.fill(0.0);
                self.active.iter().for_each(|a| self.multipliers[a.row] = a.sign * a.multiplier);
                return Ok(());
            }
        }
        Err(Cow::Borrowed("too many proximal steps"))
    }

    /// Takes the numbers over, without any active row.
    fn load(&mut self, numbers: &Numbers) {
        self.matrix.fill(0.0);
        for &(row, column, value) in &numbers.rows.terms {
            self.matrix[row * self.n + column] = value;
        }
        self.basis.fill(0.0);
        for i in 0..self.n {
            self.basis[i * self.n + i] = 1.0 / self.hessian[i].sqrt();
        }
        self.active.clear();
        self.settled.fill(false);
        self.centre.fill(0.0);
        self.taken = 0;
    }

    /// Moves to the optimum on the active rows, after dropping those that hold it back.
    fn settle(&mut self, numbers: &Numbers) {
        loop {
            let rows = self.active.len();
            self.image_of_gradient();
            // x = J1 R^-T c - J2 J2' g, once more for the rows' rounding; c the active rows' right-hand sides.
            for i in 0..self.n {
                self.x[i] = -dot_rows(&self.basis, &self.image, self.n, i, rows..self.n);
            }
            self.right.fill(0.0);
            for round in 0..2 {
                for k in 0..rows {
                    let Active { row, sign, .. } = self.active[k];
                    self.step[k] = sign * (self.value(row) - numbers.rows.bounds[row]);
                }
                self.solve_transposed(rows);
                for k in 0..rows {
                    self.right[k] += self.step[k];
                    let (column, step) = (&self.basis[k * self.n..][..self.n], self.step[k]);
                    self.x.iter_mut().zip(column).for_each(|(x, j)| *x += j * step);
                }
                if round == 0 && rows == 0 {
                    break;
                }
            }
            // R u = R^-T c + J1' g.
            for k in 0..rows {
                self.step[k] = self.right[k] + self.image[k];
            }
            self.solve_triangle(rows);
            let mut worst = (0.0, None);
            for k in 0..rows {
                let (multiplier, equality) = (self.step[k], self.active[k].equality);
                self.active[k].multiplier = multiplier;
                if !equality && multiplier < worst.0 {
                    worst = (multiplier, Some(k));
                }
            }
            let Some(place) = worst.1 else { return };
            self.drop(place);
        }
    }

    /// Takes in rows until none is violated.
    fn complete(&mut self, numbers: &Numbers) -> Result<(), Cow<'static, str>> {
        loop {
            // Rows that depended on others need not depend on those that are active now.
            for row in numbers.equalities..self.settled.len() {
                self.settled[row] = self.active.iter().any(|a| a.row == row);
            }
            if !self.next(numbers).is_some_and(|(row, violation)| violation > ROUNDING || row < numbers.equalities) {
                return self.take_all(numbers);
            }
            self.take_all(numbers)?;
        }
    }

    /// Takes in the violated rows, each at most until it is found to depend on the active ones.
    fn take_all(&mut self, numbers: &Numbers) -> Result<(), Cow<'static, str>> {
        while let Some((row, violation)) = self.next(numbers) {
            self.taken += 1;
            if self.taken > MOST_ROWS {
                return Err(Cow::Borrowed("too many iterations"));
            }
            let equality = row < numbers.equalities;
            let sign = if equality && violation < 0.0 { -1.0 } else { 1.0 };
            self.take(numbers, Active { row, sign, multiplier: 0.0, equality })?;
        }
        Ok(())
    }

    /// The next row to take in, with its violation: equalities in their order, then the most violated.
    fn next(&self, numbers: &Numbers) -> Option<(usize, f64)> {
        let violation = |row: usize| self.value(row) - numbers.rows.bounds[row];
        if let Some(row) = (0..numbers.equalities).find(|&row| !self.settled[row]) {
            return Some((row, violation(row)));
        }
        let mut worst = (VIOLATED, None);
        for row in numbers.equalities..self.settled.len() {
            if !self.settled[row] {
                let violation = violation(row);
                if violation > worst.0 {
                    worst = (violation, Some(row));
                }
            }
        }
        worst.1.map(|row| (row, worst.0))
    }

    /// Moves until `entering` holds with equality, dropping rows whose multiplier comes to zero on the way.
    fn take(&mut self, numbers: &Numbers, mut entering: Active) -> Result<(), Cow<'static, str>> {
        loop {
            let rows = self.active.len();
            let violation = entering.sign * (self.value(entering.row) - numbers.rows.bounds[entering.row]);
            self.image_of_row(entering.row, -entering.sign);
            let square = |part: &[f64]| part.iter().map(|d| d * d).sum::<f64>();
            let (free, all) = (square(&self.image[rows..]), square(&self.image));
            let dependent = free <= DEPENDENT * DEPENDENT * all;
            if dependent && violation <= ROUNDING {
                self.settled[entering.row] = true;
                return Ok(());
            }
            self.step[..rows].copy_from_slice(&self.image[..rows]);
            self.solve_triangle(rows);
            let (partial, blocking) = self.first_to_leave();
            let full = if dependent { f64::INFINITY } else { violation / free };
            let length = partial.min(full);
            if length.is_infinite() {
                return Err(Cow::Borrowed("no feasible point"));
            }
            for (active, change) in self.active.iter_mut().zip(&self.step) {
                active.multiplier -= length * change;
            }
            entering.multiplier += length;
            if !dependent {
                for i in 0..self.n {
                    self.x[i] += length * dot_rows(&self.basis, &self.image, self.n, i, rows..self.n);
                }
            }
            if full <= partial {
                self.append(entering);
                return Ok(());
            }
            if let Some(place) = blocking {
                self.drop(place);
            }
        }
    }

    /// The active row whose multiplier comes to zero first along [`step`](Self::step), and after which length.
    fn first_to_leave(&self) -> (f64, Option<usize>) {
        let mut first = (f64::INFINITY, None);
        let largest = self.step[..self.active.len()].iter().fold(0.0_f64, |most, r| most.max(r.abs()));
        for (place, (active, &change)) in self.active.iter().zip(&self.step).enumerate() {
            if !active.equality && change > f64::EPSILON * largest {
                let length = active.multiplier.max(0.0) / change;
                if length < first.0 {
                    first = (length, Some(place));
                }
            }
        }
        first
    }

    /// Makes `entering`, whose normal's image stands in [`image`](Self::image), active.
    fn append(&mut self, entering: Active) {
        let rows = self.active.len();
        for k in (rows + 1..self.n).rev() {
            let (c, s, length) = rotation(self.image[k - 1], self.image[k]);
            self.image[k - 1] = length;
            self.image[k] = 0.0;
            rotate_columns(&mut self.basis, self.n, k - 1, c, s);
        }
        self.triangle[rows * self.n..][..=rows].copy_from_slice(&self.image[..=rows]);
        self.settled[entering.row] = true;
        self.active.push(entering);
    }

    /// Makes the active row at `place` inactive.
    fn drop(&mut self, place: usize) {
        let n = self.n;
        self.settled[self.active[place].row] = false;
        self.active.remove(place);
        let rows = self.active.len();
        for k in place..rows {
            self.triangle.copy_within((k + 1) * n..(k + 2) * n, k * n);
        }
        for k in place..rows {
            let (c, s, length) = rotation(self.triangle[k * n + k], self.triangle[k * n + k + 1]);
            self.triangle[k * n + k] = length;
            self.triangle[k * n + k + 1] = 0.0;
            for column in k + 1..rows {
                let (upper, lower) = (self.triangle[column * n + k], self.triangle[column * n + k + 1]);
                self.triangle[column * n + k] = c * upper + s * lower;
                self.triangle[column * n + k + 1] = c * lower - s * upper;
            }
            rotate_columns(&mut self.basis, n, k, c, s);
        }
    }

    fn value(&self, row: usize) -> f64 {
        self.matrix[row * self.n..][..self.n].iter().zip(&self.x).map(|(a, x)| a * x).sum()
    }

    fn image_of_gradient(&mut self) {
        for (image, column) in self.image.iter_mut().zip(self.basis.chunks_exact(self.n)) {
            *image = column.iter().zip(&self.gradient).map(|(j, g)| j * g).sum();
        }
    }

    fn image_of_row(&mut self, row: usize, sign: f64) {
        let normal = &self.matrix[row * self.n..][..self.n];
        for (image, column) in self.image.iter_mut().zip(self.basis.chunks_exact(self.n)) {
            *image = sign * column.iter().zip(normal).map(|(j, a)| j * a).sum::<f64>();
        }
    }

    /// R y = step, in place.
    fn solve_triangle(&mut self, rows: usize) {
        for k in (0..rows).rev() {
            let column = &self.triangle[k * self.n..][..=k];
            self.step[k] /= column[k];
            let value = self.step[k];
            self.step[..k].iter_mut().zip(column).for_each(|(step, r)| *step -= r * value);
        }
    }

    /// R' y = step, in place.
    fn solve_transposed(&mut self, rows: usize) {
        for k in 0..rows {
            let column = &self.triangle[k * self.n..][..=k];
            let known: f64 = self.step[..k].iter().zip(column).map(|(step, r)| step * r).sum();
            self.step[k] = (self.step[k] - known) / column[k];
        }
    }
}

/// Sum over `columns` k of basis[i, k] image[k].
fn dot_rows(basis: &[f64], image: &[f64], n: usize, i: usize, columns: std::ops::Range<usize>) -> f64 {
    columns.map(|k| basis[k * n + i] * image[k]).sum()
}

/// (c, s, h) with c a + s b = h >= 0 and c b - s a = 0.
fn rotation(a: f64, b: f64) -> (f64, f64, f64) {
    let length = a.hypot(b);
    if length > 0.0 { (a / length, b / length, length) } else { (1.0, 0.0, 0.0) }
}

/// Rotates columns k and k + 1.
fn rotate_columns(matrix: &mut [f64], n: usize, k: usize, c: f64, s: f64) {
    let (left, right) = matrix[k * n..(k + 2) * n].split_at_mut(n);
    for (a, b) in left.iter_mut().zip(right) {
        (*a, *b) = (c * *a + s * *b, c * *b - s * *a);
    }
}
