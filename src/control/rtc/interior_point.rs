//! Programs by Clarabel, behind the same small interface as the crate's own method.

use super::solver::{Numbers, Rows};
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

/// Clarabel with one program's data, allocated at the first solution and updated afterwards.
///
/// Equilibration is off, because its factors would stay those of the first data. A clone starts without Clarabel's
/// workspace and builds it at its next solution.
pub(super) struct InteriorPoint {
    /// Place of every term among Clarabel's values.
    places: Vec<usize>,
    /// Clarabel's form of the rows; holds pattern and values.
    matrix: CscMatrix<f64>,
    solver: Option<Box<DefaultSolver<f64>>>,
    /// Whether the weights of the unknowns have changed since they were handed over.
    weighed: bool,
}

impl InteriorPoint {
    pub fn new(numbers: &Numbers) -> Self {
        let (matrix, places) = compress(&numbers.rows, numbers.linear.len());
        Self { places, matrix, solver: None, weighed: false }
    }

    /// Solves within 1e-9 (feasibility) and 1e-8 (gap), or says why not.
    pub fn solve(&mut self, numbers: &Numbers) -> Result<(), Cow<'static, str>> {
        for (&(row, _, value), &place) in numbers.rows.terms.iter().zip(&self.places) {
            debug_assert_eq!(self.matrix.rowval[place], row, "rows are written in another order than at first");
            self.matrix.nzval[place] = value;
        }
        self.load(numbers)?;
        let Some(solver) = self.solver.as_deref_mut() else { return Err(Cow::Borrowed("no workspace")) };
        solver.solve();
        match solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => Ok(()),
            status => Err(Cow::Borrowed(word(status))),
        }
    }

    /// Hands the weights of the unknowns over anew at the next solution.
    pub fn weigh(&mut self) {
        self.weighed = true;
    }

    pub fn solution(&self) -> &[f64] {
        self.solver.as_deref().map_or(&[], |solver| &solver.solution.x)
    }

    pub fn multipliers(&self) -> &[f64] {
        self.solver.as_deref().map_or(&[], |solver| &solver.solution.z)
    }

    /// Hands the present numbers to Clarabel.
    fn load(&mut self, numbers: &Numbers) -> Result<(), Cow<'static, str>> {
        let bounds = &numbers.rows.bounds;
        let weighed = std::mem::take(&mut self.weighed);
        if let Some(solver) = self.solver.as_deref_mut() {
            if weighed {
                solver.update_P(&numbers.quadratic).map_err(|error| Cow::Owned(error.to_string()))?;
                solver.update_q(&numbers.linear).map_err(|error| Cow::Owned(error.to_string()))?;
            }
            solver.update_A(&self.matrix.nzval).map_err(|error| Cow::Owned(error.to_string()))?;
            return solver.update_b(bounds).map_err(|error| Cow::Owned(error.to_string()));
        }
        let cones = [ZeroConeT(numbers.equalities), NonnegativeConeT(bounds.len() - numbers.equalities)];
        let quadratic = diagonal(&numbers.quadratic);
        let solver = DefaultSolver::new(&quadratic, &numbers.linear, &self.matrix, bounds, &cones, settings())
            .map_err(|error| Cow::Owned(error.to_string()))?;
        self.solver = Some(Box::new(solver));
        Ok(())
    }
}

impl Clone for InteriorPoint {
    fn clone(&self) -> Self {
        Self { places: self.places.clone(), matrix: self.matrix.clone(), solver: None, weighed: false }
    }
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
