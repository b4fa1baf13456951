//! Convex programs whose structure is fixed and whose numbers change, and the choice of who solves them.

use super::active_set::ActiveSet;
use super::interior_point::InteriorPoint;
use std::borrow::Cow;

/// Who solves the programs of an optimisation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Solver {
    /// Clarabel's interior-point method: in a thin interior it may stall, and says so.
    #[default]
    Clarabel,
    /// A dense dual active-set method of this crate for batches of rovers: faster, exact on the active constraints.
    ActiveSet,
}

/// Constraint rows a'x = b and a'x <= b as they are written down, one after the other.
///
/// The same code writes them when a program is built and whenever its numbers change, so the terms come
/// in the same order every time; a term may be zero, it still has its place.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    /// Row, column and value of every term.
    pub(super) terms: Vec<(usize, usize, f64)>,
    /// Right-hand side of every row.
    pub(super) bounds: Vec<f64>,
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

/// Numbers of a program: minimise x'P x/2 + q'x with diagonal P over the rows' polyhedron.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    /// Diagonal of P.
    pub quadratic: Vec<f64>,
    /// q.
    pub linear: Vec<f64>,
    /// How many rows, the first ones, are equalities.
    pub equalities: usize,
    /// All rows.
    pub rows: Rows,
}

/// Minimise x'P x/2 + q'x with diagonal P, subject to `equalities` rows a'x = b, then rows a'x <= b.
///
/// Memory is taken at the first solution at the latest, and numbers are updated afterwards. Callers scale their data
/// to order 1. The answers do not depend on what was solved before.
#[derive(Clone)]
pub struct Program {
    /// What is sought, for error messages.
    name: &'static str,
    numbers: Numbers,
    engine: Engine,
}

#[derive(Clone)]
enum Engine {
    InteriorPoint(InteriorPoint),
    ActiveSet(Box<ActiveSet>),
}

impl Program {
    /// A program with the diagonal of P, q, the number of equalities, and rows written by `write`.
    pub fn new(
        name: &'static str,
        solver: Solver,
        quadratic: Vec<f64>,
        linear: Vec<f64>,
        equalities: usize,
        write: impl FnOnce(&mut Rows),
    ) -> Self {
        let mut rows = Rows::default();
        write(&mut rows);
        let numbers = Numbers { quadratic, linear, equalities, rows };
        let engine = match solver {
            Solver::Clarabel => Engine::InteriorPoint(InteriorPoint::new(&numbers)),
            Solver::ActiveSet => Engine::ActiveSet(Box::new(ActiveSet::new(&numbers))),
        };
        Self { name, numbers, engine }
    }

    /// Solves for the numbers that `write` writes now; returns x.
    ///
    /// # Errors
    /// [`Unsolved`] with the solver's reason where there is no optimum, or none was reached.
    pub fn solve(&mut self, write: impl FnOnce(&mut Rows)) -> Result<&[f64], Unsolved> {
        self.numbers.rows.clear();
        write(&mut self.numbers.rows);
        let solved = match &mut self.engine {
            Engine::InteriorPoint(engine) => engine.solve(&self.numbers),
            Engine::ActiveSet(engine) => engine.solve(&self.numbers),
        };
        match solved {
            Ok(()) => Ok(self.solution()),
            Err(status) => Err(Unsolved { problem: self.name, status }),
        }
    }

    /// Takes other weights (P_jj, q_j) for some unknowns j that had a weight P_jj over 0, from the next solution on.
    pub(super) fn weigh(&mut self, weights: impl Iterator<Item = (usize, [f64; 2])>) {
        for (unknown, [quadratic, linear]) in weights {
            debug_assert!(self.numbers.quadratic[unknown] > 0.0 && quadratic > 0.0);
            (self.numbers.quadratic[unknown], self.numbers.linear[unknown]) = (quadratic, linear);
        }
        match &mut self.engine {
            Engine::InteriorPoint(engine) => engine.weigh(),
            Engine::ActiveSet(engine) => engine.weigh(&self.numbers),
        }
    }

    /// Multipliers of the last solution, one a row: P x + q + A' multipliers = 0, and none negative on rows a'x <= b.
    #[must_use]
    pub fn multipliers(&self) -> &[f64] {
        match &self.engine {
            Engine::InteriorPoint(engine) => engine.multipliers(),
            Engine::ActiveSet(engine) => engine.multipliers(),
        }
    }

    fn solution(&self) -> &[f64] {
        match &self.engine {
            Engine::InteriorPoint(engine) => engine.solution(),
            Engine::ActiveSet(engine) => engine.solution(),
        }
    }
}

/// A solver stopped without an optimum.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the optimiser found no {problem}: {status}")]
pub struct Unsolved {
    /// What was sought.
    pub problem: &'static str,
    /// Why the solver stopped.
    pub status: Cow<'static, str>,
}
