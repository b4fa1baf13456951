//! The optimisation of chapter 4 as a whole: dual criterion, constraints, and the nearest point without them.

use super::nearest::Nearest;
use super::power::MinimumPower;
use super::problem::Problem;
use super::solver::{Solver, Unsolved};
use super::switch::Criterion;
use super::traction::MaximumTraction;

/// Miss of the balance, in units of weight and half base, up to which a distribution counts as balanced
/// where the optimiser could not tell.
const BALANCED: f64 = 1e-6;

/// How a force distribution was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found {
    /// Whether the forces balance the wanted body force; otherwise they are the nearest.
    pub feasible: bool,
    /// Whether they are the criterion's optimum. Feasible forces that are not are the best that were found
    /// where admissible forces have next to no interior.
    pub optimal: bool,
    /// Linear programs of the traction search.
    pub steps: usize,
}

/// Finds the best admissible contact forces; all programs are set up once.
#[derive(Clone)]
pub struct Optimiser {
    power: MinimumPower,
    traction: MaximumTraction,
    nearest: Nearest,
}

impl Optimiser {
    /// An optimiser for problems of the structure of `problem`.
    #[must_use]
    pub fn new(problem: &Problem, solver: Solver) -> Self {
        Self {
            power: MinimumPower::new(problem, solver),
            traction: MaximumTraction::new(problem, solver),
            nearest: Nearest::new(problem, solver),
        }
    }

    /// Writes x = [T_1, N_1, ..] into `forces`, N: the optimum of `criterion`, or where no forces are
    /// feasible the nearest ones, the cheapest of them, whatever the criterion.
    ///
    /// # Errors
    /// [`Unsolved`] where the optimiser gives up on a problem that has a solution.
    pub fn solve(&mut self, problem: &Problem, criterion: Criterion, forces: &mut [f64]) -> Result<Found, Unsolved> {
        if self.power.solve(problem, forces).is_err() {
            self.nearest.solve(problem, forces)?;
            return Ok(Found { feasible: miss(problem, forces) <= BALANCED, optimal: false, steps: 0 });
        }
        Ok(match criterion {
            Criterion::Power | Criterion::ElectricalPower => Found { feasible: true, optimal: true, steps: 0 },
            Criterion::Traction => {
                let search = self.traction.solve(problem, &mut self.power, forces);
                Found { feasible: true, optimal: search.converged, steps: search.steps }
            }
        })
    }
}

/// Largest miss of the balance in the optimiser's units.
fn miss(problem: &Problem, forces: &[f64]) -> f64 {
    let row = |row: usize| (problem.shortfall(row, forces) / problem.row_unit(row)).abs();
    (0..problem.rows()).map(row).fold(0.0, f64::max)
}
