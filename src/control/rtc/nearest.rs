//! The nearest admissible forces where no admissible forces balance the wanted body force.

use super::power::{to_newton, traction_weights};
use super::problem::Problem;
use super::solver::{Program, Rows, Solver, Unsolved};

/// Weight of sum T_i^2 beside the squared miss: chooses the cheapest among the nearest, and moves the
/// nearest by about this share of the tractive forces.
pub const CHEAPNESS: f64 = 1e-8;

/// How much heavier a miss of the vertical force or of the moment counts than one of the horizontal force,
/// in units of weight and half base, where even the weight cannot be balanced.
pub const LAW_WEIGHT: f64 = 10.0;

/// Horizontal forces beyond this many weights are asked for as this many. No ground gives them, so that the
/// nearest is the same, and the optimiser's data stay of moderate size.
const LARGEST_WISH: f64 = 100.0;
/// The same where even the weight cannot be balanced: a wish of any size would buy itself traction with
/// weight that is not there.
pub const WISH_OUT_OF_BALANCE: f64 = 1.0;

/// Finds the admissible forces whose sum is nearest to the wanted body force.
///
/// The vertical force and the moments are laws, the horizontal force is a wish: a rover cannot be driven by
/// a balance in which part of its weight is missing. So the wish alone gives way, as little as it can, as
/// long as the laws can be kept. Where they cannot (a wheel that would have to hold on to the ground), all
/// rows give way by least squares; this always has a solution, since (4.13), (4.14) and (4.16) hold at
/// T = 0 and any large N.
#[derive(Clone)]
pub struct Nearest {
    /// Slack on the wish.
    wish: Program,
    /// Slack on wish and laws.
    all: Program,
}

impl Nearest {
    /// A solver for problems of the structure of `problem`.
    #[must_use]
    pub fn new(problem: &Problem, solver: Solver) -> Self {
        let mut weights = vec![LAW_WEIGHT; problem.rows()];
        weights[0] = 1.0;
        let program = |name, weights: &[f64]| {
            let rows = problem.rows();
            let mut quadratic = traction_weights(problem.wheels(), CHEAPNESS);
            quadratic.extend(weights.iter().map(|weight| weight * weight));
            let linear = vec![0.0; quadratic.len()];
            let limit = LARGEST_WISH;
            Program::new(name, solver, quadratic, linear, rows, |rows| write(problem, weights.len(), limit, rows))
        };
        Self { wish: program("nearest balanced forces", &[1.0]), all: program("nearest admissible forces", &weights) }
    }

    /// Writes the nearest forces into `forces`, N.
    ///
    /// # Errors
    /// [`Unsolved`] where the optimiser gives up.
    pub fn solve(&mut self, problem: &Problem, forces: &mut [f64]) -> Result<(), Unsolved> {
        let solution = match self.wish.solve(|rows| write(problem, 1, LARGEST_WISH, rows)) {
            Ok(solution) => solution,
            Err(_) => self.all.solve(|rows| write(problem, problem.rows(), WISH_OUT_OF_BALANCE, rows))?,
        };
        to_newton(problem, solution, forces);
        Ok(())
    }
}

/// Writes the rows with slack on the first `slacks` rows of the balance and the wish within `limit` weights.
fn write(problem: &Problem, slacks: usize, limit: f64, rows: &mut Rows) {
    problem.write_balance(rows, slacks, limit);
    problem.write_limits(rows);
}
