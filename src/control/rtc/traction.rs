//! Maximum traction (4.5): the least value of the largest ratio of tractive force to load.

use super::power::{MinimumPower, to_newton};
use super::problem::{Problem, load_of, traction_of};
use super::solver::{Program, Rows, Solver};

/// Gain in the ratio at which the search ends: a hundredth of [`RATIO_ROOM`].
const RATIO_TOLERANCE: f64 = 1e-8;
/// Room above the least ratio in which the cheapest distribution is then sought: an interior-point method
/// needs an interior. No soil's strength is known to a hundred-thousandth of it.
const RATIO_ROOM: f64 = 1e-6;
/// Linear programs at most. 3 to 5 are usual, 15 were the most in 15,000 random cases of 2 to 8 wheels.
const MOST_STEPS: usize = 30;

/// How a traction search went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Search {
    /// Linear programs solved.
    pub steps: usize,
    /// Whether the optimum was reached. The optimiser can stall where the admissible forces have next to no
    /// interior, within about 1e-8 weights of infeasible; the forces are then the best that were found.
    pub converged: bool,
}

/// Minimises R = max |T_i| / N_i (4.5) over the admissible forces.
///
/// (4.5) is printed without the bars. They change nothing where the wheels pull, and let R measure the
/// distance to soil failure where they brake; without them a wheel that drags against the others would
/// count as far from failure.
///
/// R is quasi-convex. The generalised Dinkelbach search (Crouzeix, Ferland and Schaible 1985) solves, at
/// the ratio lambda reached so far and the loads N_i' of the forces that reach it, the linear program
/// min t: |T_i| - lambda N_i <= t N_i', and takes the ratio of its solution for the next lambda; at the
/// optimum t = 0. It converges superlinearly, but only halves a lambda that is far too large, which a
/// wheel with nearly no load gives: then it starts at tan phi with the loads of a rover at rest.
/// With three or more wheels many distributions share the least ratio; of these the one of least power
/// (4.10) is taken, so that the torques are unique.
#[derive(Clone)]
pub struct MaximumTraction {
    program: Program,
    /// Forces of the last linear program, N.
    trial: Vec<f64>,
    /// Loads N_i' that weight the next linear program, N.
    loads: Vec<f64>,
}

impl MaximumTraction {
    /// A solver for problems of the structure of `problem`.
    #[must_use]
    pub fn new(problem: &Problem, solver: Solver) -> Self {
        let unknowns = 2 * problem.wheels();
        let mut linear = vec![0.0; unknowns + 1];
        linear[unknowns] = 1.0;
        let program =
            Program::new("maximum traction", solver, vec![0.0; unknowns + 1], linear, problem.rows(), |rows| {
                write(problem, 1.0, &problem.expected_loads, rows);
            });
        Self { program, trial: vec![0.0; unknowns], loads: problem.expected_loads.clone() }
    }

    /// Improves `forces`, admissible at first (those of minimum power), to the optimum; N.
    pub fn solve(&mut self, problem: &Problem, cheapest: &mut MinimumPower, forces: &mut [f64]) -> Search {
        let mut search = self.least_ratio(problem, forces);
        let ratio = problem.ratio(forces);
        if search.converged && problem.wheels() > 2 && ratio > RATIO_TOLERANCE {
            search.converged = cheapest_within(problem, cheapest, ratio, forces);
        }
        search
    }

    /// Improves `forces` until their ratio is the least.
    fn least_ratio(&mut self, problem: &Problem, forces: &mut [f64]) -> Search {
        let mut reached = problem.ratio(forces);
        let mut lambda = reached.min(problem.friction.iter().copied().fold(0.0, f64::max));
        self.loads.copy_from_slice(&problem.expected_loads);
        if lambda == reached {
            self.weigh_by(forces);
        }
        for steps in 0..MOST_STEPS {
            if reached <= RATIO_TOLERANCE {
                return Search { steps, converged: true };
            }
            let Ok(solution) = self.program.solve(|rows| write(problem, lambda, &self.loads, rows)) else {
                // Next to no pull at all: the room is for solutions that no arithmetic can tell apart.
                return Search { steps: steps + 1, converged: reached <= RATIO_ROOM };
            };
            to_newton(problem, solution, &mut self.trial);
            let better = problem.ratio(&self.trial);
            if lambda >= reached && reached - better <= RATIO_TOLERANCE {
                return Search { steps: steps + 1, converged: true };
            }
            if better < reached {
                reached = better;
                forces.copy_from_slice(&self.trial);
            }
            lambda = reached;
            self.weigh_by(forces);
        }
        Search { steps: MOST_STEPS, converged: false }
    }

    /// Takes the loads of `forces` for the weights of the next linear program.
    fn weigh_by(&mut self, forces: &[f64]) {
        self.loads.iter_mut().zip(forces.iter().skip(1).step_by(2)).for_each(|(weight, load)| *weight = *load);
    }
}

/// Takes the cheapest forces of a ratio that is the least up to [`RATIO_ROOM`], or up to a little more where
/// that leaves too thin an interior; says whether they were found.
fn cheapest_within(problem: &Problem, cheapest: &mut MinimumPower, least: f64, forces: &mut [f64]) -> bool {
    let rooms = [RATIO_ROOM, 10.0 * RATIO_ROOM, 100.0 * RATIO_ROOM];
    rooms.into_iter().any(|room| cheapest.solve_within(problem, least + room, forces).is_ok())
}

/// Rows of the linear program at the ratio `lambda`, weighted by `loads`, N.
fn write(problem: &Problem, lambda: f64, loads: &[f64], rows: &mut Rows) {
    problem.write_balance(rows, 0, f64::INFINITY);
    problem.write_limits(rows);
    let excess = 2 * problem.wheels();
    for (wheel, load) in loads.iter().enumerate() {
        for sign in [1.0, -1.0] {
            let row = rows.row(0.0).term(traction_of(wheel), sign);
            row.term(load_of(wheel), -lambda).term(excess, -load / problem.force_unit());
        }
    }
}
