//! Claim: the active-set solver finds the optimum of convex programs, certified by the conditions of Karush, Kuhn and
//! Tucker on thousands of random programs, and agrees with Clarabel on those of rough-terrain control.

use crate::control_support::Case;
use bekker::control::Solver;
use bekker::control::rtc::{Program, Rows};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Violation of a row, for data of order 1: the method takes in rows from 1e-10 on, dependent ones from 1e-9 on.
const FEASIBLE: f64 = 2e-9;
/// What is left of the gradient: the proximal term's pull of 1e-10 and rounding.
const STATIONARY: f64 = 1e-9;
/// Product of a row's room and its multiplier.
const COMPLEMENTARY: f64 = 1e-9;
/// Difference of objectives from Clarabel, which stops at 1e-10, or 1e-8 where it stalls.
const OBJECTIVE: f64 = 1e-7;

/// A random convex program with a feasible point.
struct Random {
    quadratic: Vec<f64>,
    linear: Vec<f64>,
    rows: Vec<Vec<f64>>,
    bounds: Vec<f64>,
    equalities: usize,
}

impl Random {
    /// Kinds in turn: definite, half without cost, linear; in half of them many rows meet in one point.
    fn new(seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let n = rng.random_range(2..=19_usize);
        let equalities = rng.random_range(0..=n.min(6) - 1);
        let inequalities = rng.random_range(1..=3 * n);
        let point: Vec<f64> = (0..n).map(|_| rng.random_range(-1.0..1.0)).collect();
        let kind = seed % 3;
        let cost = |k: usize, rng: &mut ChaCha8Rng| match kind {
            0 => rng.random_range(0.1..1.0),
            1 if k.is_multiple_of(2) => 1.0,
            _ => 0.0,
        };
        let quadratic = (0..n).map(|k| cost(k, &mut rng)).collect();
        let linear = (0..n).map(|_| if kind == 1 { 0.0 } else { rng.random_range(-1.0..1.0) }).collect();
        let (mut rows, mut bounds) = (Vec::new(), Vec::new());
        for row in 0..equalities + inequalities {
            let normal: Vec<f64> =
                (0..n).map(|_| if rng.random_bool(0.6) { rng.random_range(-1.0..1.0) } else { 0.0 }).collect();
            let value: f64 = normal.iter().zip(&point).map(|(a, x)| a * x).sum();
            let tight = row < equalities || (seed.is_multiple_of(2) && rng.random_bool(0.5));
            bounds.push(value + if tight { 0.0 } else { rng.random_range(0.0..1.0) });
            rows.push(normal);
        }
        // A box, so that linear programs have an optimum.
        for k in 0..n {
            for sign in [1.0, -1.0] {
                rows.push((0..n).map(|column| if column == k { sign } else { 0.0 }).collect());
                bounds.push(3.0);
            }
        }
        Self { quadratic, linear, rows, bounds, equalities }
    }

    fn write(&self, rows: &mut Rows) {
        for (normal, &bound) in self.rows.iter().zip(&self.bounds) {
            let row = rows.row(bound);
            normal.iter().enumerate().for_each(|(k, &value)| {
                row.term(k, value);
            });
        }
    }

    fn program(&self, solver: Solver) -> Program {
        let (quadratic, linear) = (self.quadratic.clone(), self.linear.clone());
        Program::new("optimum", solver, quadratic, linear, self.equalities, |rows| self.write(rows))
    }

    fn objective(&self, x: &[f64]) -> f64 {
        x.iter().zip(&self.quadratic).zip(&self.linear).map(|((x, p), q)| (0.5 * p * x + q) * x).sum()
    }

    /// Checks the conditions that make `x` an optimum, given the multipliers.
    fn certify(&self, x: &[f64], multipliers: &[f64], seed: u64) {
        let mut gradient: Vec<f64> =
            x.iter().zip(&self.quadratic).zip(&self.linear).map(|((x, p), q)| p * x + q).collect();
        for (row, (normal, &multiplier)) in self.rows.iter().zip(multipliers).enumerate() {
            let room = self.bounds[row] - normal.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
            if row < self.equalities {
                assert!(room.abs() <= FEASIBLE, "seed {seed}: equality {row} is off by {room}");
            } else {
                assert!(room >= -FEASIBLE, "seed {seed}: row {row} is violated by {}", -room);
                assert!(multiplier >= 0.0, "seed {seed}: row {row} has the multiplier {multiplier}");
                let size = COMPLEMENTARY * (1.0 + multiplier);
                assert!((room * multiplier).abs() <= size, "seed {seed}: row {row} has room and a multiplier");
            }
            gradient.iter_mut().zip(normal).for_each(|(g, a)| *g += multiplier * a);
        }
        let size = multipliers.iter().fold(1.0_f64, |most, m| most.max(m.abs()));
        let left = gradient.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
        assert!(left <= STATIONARY * size, "seed {seed}: {left} of the gradient is left, multipliers up to {size}");
    }
}

#[test]
fn property_random_programs_are_certified_by_their_multipliers() {
    for seed in 0..4000 {
        let random = Random::new(seed);
        let mut program = random.program(Solver::ActiveSet);
        let x = match program.solve(|rows| random.write(rows)) {
            Ok(x) => x.to_vec(),
            Err(error) => panic!("seed {seed}: {error}"),
        };
        random.certify(&x, program.multipliers(), seed);
        if seed % 20 == 0 {
            let mut reference = random.program(Solver::Clarabel);
            let Ok(expected) = reference.solve(|rows| random.write(rows)) else { continue };
            let apart = random.objective(&x) - random.objective(expected);
            assert!(apart.abs() <= OBJECTIVE, "seed {seed}: {apart} from Clarabel's objective");
        }
    }
}

#[test]
fn property_programs_without_a_feasible_point_are_refused() {
    for seed in 0..500 {
        let mut random = Random::new(seed);
        // A sum of rows, with a right-hand side a little under what they allow together.
        let picked: Vec<usize> = (random.equalities..random.rows.len()).step_by(3).collect();
        let n = random.linear.len();
        let sum: Vec<f64> = (0..n).map(|k| -picked.iter().map(|&row| random.rows[row][k]).sum::<f64>()).collect();
        let bound: f64 = picked.iter().map(|&row| random.bounds[row]).sum();
        random.rows.push(sum);
        random.bounds.push(-bound - 1e-3);
        let error = random.program(Solver::ActiveSet).solve(|rows| random.write(rows)).err();
        assert_eq!(error.unwrap().to_string(), "the optimiser found no optimum: no feasible point", "seed {seed}");
    }
}

/// How near the two solvers' tractive forces have to be, in weights: the square root of what Clarabel leaves of sum T^2.
const FORCES: f64 = 1e-4;
/// The same of ratios (4.5).
const RATIO: f64 = 3e-6;
/// Miss of what was wanted where nothing admissible balances, in weights.
const MISS: f64 = 1e-6;

/// By how much sum T^2 of the nearest forces may be over Clarabel's, in weights squared.
const CHEAPER: f64 = 1e-4;

#[test]
fn agreement_rough_terrain_control_with_clarabel() {
    let (mut feasible, mut nearest) = (0, 0);
    for seed in 0..2400 {
        let wheels = 2 + seed as usize % 7;
        let mut case = match seed % 4 {
            0 => Case::tipping(seed, wheels),
            1 if wheels > 2 => Case::jointed(seed, wheels),
            _ => Case::random(seed, wheels),
        };
        case.parameters.switch_angle = if seed % 3 == 0 { 0.0 } else { 1.6 };
        let (reference, _) = case.run();
        case.solver = Solver::ActiveSet;
        let (ours, _) = case.run();
        let (ours, reference) = (ours.outcome().unwrap(), reference.outcome().unwrap());
        let weight = case.nominal.weight();
        assert_eq!(ours.feasible, reference.feasible, "seed {seed}: {:?} {:?}", ours.shortfall, reference.shortfall);
        if ours.feasible {
            feasible += 1;
            assert!(ours.optimal, "seed {seed}");
            let apart = ours.objective - reference.objective;
            let tolerance = match ours.criterion {
                bekker::control::Criterion::Traction => RATIO,
                bekker::control::Criterion::Power => {
                    case.nominal.winding_power(FORCES * weight * 0.1) + 1e-7 * ours.objective
                }
                bekker::control::Criterion::ElectricalPower => {
                    panic!("seed {seed}: a criterion of wheel-speed loops only")
                }
            };
            assert!(apart.abs() <= tolerance, "seed {seed}: {apart} of {} apart", reference.objective);
        } else {
            nearest += 1;
            for row in 0..3 {
                let apart = (ours.shortfall[row] - reference.shortfall[row]).abs() / weight;
                assert!(apart <= MISS, "seed {seed}, row {row}: {apart} weights apart");
            }
        }
        let square = |forces: &[f64]| forces.iter().step_by(2).map(|pull| pull * pull).sum::<f64>() / (weight * weight);
        if !ours.feasible {
            // Clarabel's gap of 1e-10 leaves the cheapest of the nearest open, whose cost weighs 1e-8.
            let dearer = square(&ours.forces) - square(&reference.forces);
            assert!(dearer <= CHEAPER, "seed {seed}: sum T^2 is {dearer} weights^2 over Clarabel's");
        } else if case.parameters.switch_angle > 1.0 {
            for (k, (a, b)) in ours.forces.iter().zip(&reference.forces).enumerate().step_by(2) {
                assert!((a - b).abs() <= FORCES * weight, "seed {seed}, force {k}: {a} N, Clarabel {b} N");
            }
        }
    }
    assert!(feasible > 800 && nearest > 300, "{feasible} feasible, {nearest} not");
}
