//! A small interface around Clarabel: convex programs whose structure is fixed and whose numbers change.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT};
use std::borrow::Cow;

/// Tolerance of the interior-point method on gap and feasibility, relative to data of order 1: two orders
/// under the balance of 1e-8 that a distribution keeps.
const TOLERANCE: f64 = 1e-10;

/// What is still taken where the method stalls short of [`TOLERANCE`], which it does on degenerate optima: gap.
const STALLED_GAP: f64 = 1e-8;
/// The same for feasibility.
const STALLED_FEASIBILITY: f64 = 1e-9;

/// Constraint rows a'x = b and a'x <= b as they are written down, one after the other.
///
/// The same code writes them when a program is built and whenever its numbers change, so the terms come
/// in the same order every time; a term may be zero, it still has its place.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    /// Row, column and value of every term.
    terms: Vec<(usize, usize, f64)>,
    /// Right-hand side of every row.
    bounds: Vec<f64>,
}

impl Rows {
    /// Starts the next row, with right-hand side `bound`.
    pub fn row(&mut self, bound: f64) -> &mut Self {
        self.bounds.push(bound);
        self
    }

    /// Adds `coefficient` times variable `variable` to the row started last.
    pub fn term(&mut self, variable: usize, coefficient: f64) -> &mut Self {
        self.terms.push((self.bounds.len() - 1, variable, coefficient));
        self
    }

    fn clear(&mut self) {
        self.terms.clear();
        self.bounds.clear();
    }
}

/// Minimise x'P x/2 + q'x with diagonal P, subject to `equalities` rows a'x = b, then rows a'x <= b.
///
/// Clarabel's problem data are allocated at the first solution and updated afterwards. Equilibration is
/// off, because its factors would stay those of the first data: callers scale their data to order 1.
/// A clone starts without Clarabel's workspace and builds it at its next solution; the answers do not
/// depend on what was solved before.
pub struct Program {
    /// What is sought, for error messages.
    name: &'static str,
    quadratic: Vec<f64>,
    linear: Vec<f64>,
    equalities: usize,
    rows: Rows,
    /// Place of every term among Clarabel's values.
    places: Vec<usize>,
    /// Clarabel's form of the rows; holds pattern and values.
    matrix: CscMatrix<f64>,
    solver: Option<Box<DefaultSolver<f64>>>,
}

impl Program {
    /// A program with the diagonal of P, q, the number of equalities, and rows written by `write`.
    pub fn new(
        name: &'static str,
        quadratic: Vec<f64>,
        linear: Vec<f64>,
        equalities: usize,
        write: impl FnOnce(&mut Rows),
    ) -> Self {
        let mut rows = Rows::default();
        write(&mut rows);
        let (matrix, places) = compress(&rows, linear.len());
        Self { name, quadratic, linear, equalities, rows, places, matrix, solver: None }
    }

    /// Solves for the numbers that `write` writes now; returns x.
    ///
    /// # Errors
    /// [`Unsolved`] with Clarabel's status where there is no optimum, or none within 1e-9 (feasibility) and
    /// 1e-8 (gap).
    pub fn solve(&mut self, write: impl FnOnce(&mut Rows)) -> Result<&[f64], Unsolved> {
        self.rows.clear();
        write(&mut self.rows);
        for (&(row, _, value), &place) in self.rows.terms.iter().zip(&self.places) {
            debug_assert_eq!(self.matrix.rowval[place], row, "rows are written in another order than at first");
            self.matrix.nzval[place] = value;
        }
        self.load()?;
        let name = self.name;
        let Some(solver) = self.solver.as_deref_mut() else {
            return Err(Unsolved { problem: name, status: Cow::Borrowed("no workspace") });
        };
        solver.solve();
        match solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => Ok(&solver.solution.x),
            status => Err(Unsolved { problem: name, status: Cow::Borrowed(word(status)) }),
        }
    }

    /// Hands the present numbers to Clarabel.
    fn load(&mut self) -> Result<(), Unsolved> {
        let failed = |status: String| Unsolved { problem: self.name, status: Cow::Owned(status) };
        if let Some(solver) = self.solver.as_deref_mut() {
            solver.update_A(&self.matrix.nzval).map_err(|error| failed(error.to_string()))?;
            return solver.update_b(&self.rows.bounds).map_err(|error| failed(error.to_string()));
        }
        let cones = [ZeroConeT(self.equalities), NonnegativeConeT(self.rows.bounds.len() - self.equalities)];
        let quadratic = diagonal(&self.quadratic);
        let solver = DefaultSolver::new(&quadratic, &self.linear, &self.matrix, &self.rows.bounds, &cones, settings())
            .map_err(|error| failed(error.to_string()))?;
        self.solver = Some(Box::new(solver));
        Ok(())
    }
}

impl Clone for Program {
    fn clone(&self) -> Self {
        Self {
            name: self.name,
            quadratic: self.quadratic.clone(),
            linear: self.linear.clone(),
            equalities: self.equalities,
            rows: self.rows.clone(),
            places: self.places.clone(),
            matrix: self.matrix.clone(),
            solver: None,
        }
    }
}

/// Clarabel stopped without an optimum.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the optimiser found no {problem}: {status}")]
pub struct Unsolved {
    /// What was sought.
    pub problem: &'static str,
    /// Why Clarabel stopped.
    pub status: Cow<'static, str>,
}

/// Clarabel's status in words, without allocating: infeasible problems are ordinary here.
fn word(status: SolverStatus) -> &'static str {
    match status {
        SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => "no feasible point",
        SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => "unbounded",
        SolverStatus::MaxIterations => "too many iterations",
        SolverStatus::InsufficientProgress => "insufficient progress",
        SolverStatus::NumericalError => "numerical error",
        _ => "stopped early",
    }
}

fn settings() -> DefaultSettings<f64> {
    DefaultSettings {
        verbose: false,
        presolve_enable: false, // data could not be updated
        equilibrate_enable: false,
        tol_gap_abs: TOLERANCE,
        tol_gap_rel: TOLERANCE,
        tol_feas: TOLERANCE,
        reduced_tol_gap_abs: STALLED_GAP,
        reduced_tol_gap_rel: STALLED_GAP,
        reduced_tol_feas: STALLED_FEASIBILITY,
        ..DefaultSettings::default()
    }
}

/// The rows by columns, as Clarabel wants them, and the place of every term there. Zeros keep their place.
fn compress(rows: &Rows, variables: usize) -> (CscMatrix<f64>, Vec<usize>) {
    let mut order: Vec<usize> = (0..rows.terms.len()).collect();
    order.sort_by_key(|&k| (rows.terms[k].1, rows.terms[k].0));
    let mut places = vec![0; order.len()];
    let mut starts = vec![0; variables + 1];
    for (place, &k) in order.iter().enumerate() {
        places[k] = place;
        starts[rows.terms[k].1 + 1] = place + 1;
    }
    // A column without terms starts where the one before it ends.
    for column in 1..starts.len() {
        starts[column] = starts[column].max(starts[column - 1]);
    }
    let row_of = order.iter().map(|&k| rows.terms[k].0).collect();
    let values = order.iter().map(|&k| rows.terms[k].2).collect();
    (CscMatrix::new(rows.bounds.len(), variables, starts, row_of, values), places)
}

fn diagonal(values: &[f64]) -> CscMatrix<f64> {
    let n = values.len();
    CscMatrix::new(n, n, (0..=n).collect(), (0..n).collect(), values.to_vec())
}
