//! Minimum power (4.10): a quadratic program.

use super::problem::{Problem, load_of, traction_of};
use super::solver::{Program, Rows, Solver, Unsolved};

/// Weights of the unknowns in sum T_i^2, which is P up to a factor that all wheels share (same drives).
pub(super) fn traction_weights(wheels: usize, weight: f64) -> Vec<f64> {
    (0..2 * wheels).map(|column| if column % 2 == 0 { weight } else { 0.0 }).collect()
}

/// Minimises P = sum R r^2 / (K_t^2 gear^2) T_i^2 (4.10) over the admissible forces.
///
/// P does not see the loads: the tractive forces, and with them the torques, are unique; with three or
/// more wheels the loads are one choice among many.
#[derive(Clone)]
pub struct MinimumPower {
    program: Program,
    /// With (4.5) bounded from above by a given ratio.
    bounded: Program,
}

impl MinimumPower {
    /// A solver for problems of the structure of `problem`.
    #[must_use]
    pub fn new(problem: &Problem, solver: Solver) -> Self {
        let (wheels, rows) = (problem.wheels(), problem.rows());
        let (quadratic, linear) = (traction_weights(wheels, 1.0), vec![0.0; 2 * wheels]);
        Self {
            program: Program::new("minimum power", solver, quadratic.clone(), linear.clone(), rows, |rows| {
                write(problem, rows);
            }),
            bounded: Program::new("minimum power at a ratio", solver, quadratic, linear, rows, |rows| {
                write_bounded(problem, 1.0, rows);
            }),
        }
    }

    /// Writes the optimum into `forces`, N.
    ///
    /// # Errors
    /// [`Unsolved`], also where no admissible forces exist.
    pub fn solve(&mut self, problem: &Problem, forces: &mut [f64]) -> Result<(), Unsolved> {
        if let Some(costs) = &problem.costs {
            self.program.weigh(costs.iter().enumerate().map(|(wheel, cost)| (traction_of(wheel), *cost)));
        }
        let solution = self.program.solve(|rows| write(problem, rows))?;
        to_newton(problem, solution, forces);
        Ok(())
    }

    /// The same among forces with |T_i| <= `ratio` N_i.
    ///
    /// # Errors
    /// [`Unsolved`], also where no admissible forces exist.
    pub fn solve_within(&mut self, problem: &Problem, ratio: f64, forces: &mut [f64]) -> Result<(), Unsolved> {
        let solution = self.bounded.solve(|rows| write_bounded(problem, ratio, rows))?;
        to_newton(problem, solution, forces);
        Ok(())
    }
}

/// Turns the optimiser's first unknowns into forces in N; none on wheels off the ground.
pub(super) fn to_newton(problem: &Problem, solution: &[f64], forces: &mut [f64]) {
    for (k, (force, value)) in forces.iter_mut().zip(solution).enumerate() {
        *force = if problem.lifted[k / 2] { 0.0 } else { value * problem.force_unit() };
    }
}

fn write(problem: &Problem, rows: &mut Rows) {
    problem.write_balance(rows, 0, f64::INFINITY);
    problem.write_limits(rows);
}

fn write_bounded(problem: &Problem, ratio: f64, rows: &mut Rows) {
    write(problem, rows);
    for wheel in 0..problem.wheels() {
        for sign in [1.0, -1.0] {
            rows.row(0.0).term(traction_of(wheel), sign).term(load_of(wheel), -ratio);
        }
    }
}
