//! Claim: the minimum-power distribution (4.10) is the optimum, certified by methods that share nothing with it.

use crate::control_support::nonnegative::cone_distance;
use crate::control_support::{Case, choices, level_rover, null_space};
use bekker::control::{Criterion, Solver};
use nalgebra::{DMatrix, DVector};

/// Miss of the force balance G x = f_s, relative to the weight.
const BALANCE: f64 = 1e-8;
/// Difference of sum T^2 from the reference optimum, relative to the weight squared; the optimiser stops at 1e-10.
const OPTIMUM: f64 = 1e-9;
/// Difference of the tractive forces, relative to the weight: the square root of what OPTIMUM lets through.
const FORCES: f64 = 1e-5;
/// How near a constraint has to be to count as active, relative to the weight.
const ACTIVE: f64 = 1e-6;
/// What is left of the gradient outside the cone of the active constraints, relative to the weight.
const STATIONARY: f64 = 1e-5;

fn traction_square(x: &DVector<f64>) -> f64 {
    x.iter().step_by(2).map(|t| t * t).sum()
}

/// A case that is judged by power whatever its slopes.
fn by_power(seed: u64, wheels: usize) -> Case {
    let mut case = Case::random(seed, wheels);
    case.parameters.switch_angle = 1.6;
    case
}

/// The distribution, where there is a feasible one.
fn distribution(case: &Case) -> Option<DVector<f64>> {
    let (rtc, _) = case.run();
    let outcome = rtc.outcome().expect("a command was given");
    assert_eq!(outcome.criterion, Criterion::Power);
    assert_eq!(outcome.optimal, outcome.feasible, "{case:?}");
    outcome.feasible.then(|| DVector::from_column_slice(&outcome.forces))
}

/// Two wheels: the null space is a line; the limits leave an interval of it, on which the power is a parabola.
fn two_wheel_optimum(case: &Case) -> Option<DVector<f64>> {
    let (g, f) = case.balance();
    let (a, b) = case.limits();
    let (basis, start) = null_space(&g, &f);
    let direction = basis.column(0).into_owned();
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for (slope, room) in (&a * &direction).iter().zip((&b - &a * &start).iter()) {
        if *slope > 0.0 {
            high = high.min(room / slope);
        } else {
            low = low.max(room / slope);
        }
    }
    let pull = |x: &DVector<f64>| DVector::from_iterator(2, x.iter().step_by(2).copied());
    let best = -pull(&direction).dot(&pull(&start)) / pull(&direction).norm_squared();
    (low <= high).then(|| &start + direction * best.clamp(low, high))
}

/// Three wheels: every set of at most three limits taken as equalities, and the best admissible of their optima.
fn three_wheel_optimum(case: &Case) -> Option<DVector<f64>> {
    let (g, f) = case.balance();
    let (a, b) = case.limits();
    let (basis, start) = null_space(&g, &f);
    let weights = DMatrix::from_diagonal(&DVector::from_fn(6, |row, _| if row % 2 == 0 { 1.0 } else { 0.0 }));
    let hessian = basis.transpose() * &weights * &basis;
    let gradient = basis.transpose() * &weights * &start;
    let (sides, room) = (&a * &basis, &b - &a * &start);
    let tolerance = 1e-9 * case.nominal.weight();
    let mut best: Option<DVector<f64>> = None;
    for active in (0..=3).flat_map(|size| choices(room.len(), size)) {
        let count = active.len();
        let chosen = sides.select_rows(&active);
        let mut kkt = DMatrix::zeros(3 + count, 3 + count);
        kkt.view_mut((0, 0), (3, 3)).copy_from(&hessian);
        kkt.view_mut((3, 0), (count, 3)).copy_from(&chosen);
        kkt.view_mut((0, 3), (3, count)).copy_from(&chosen.transpose());
        let mut right = DVector::zeros(3 + count);
        right.rows_mut(0, 3).copy_from(&-&gradient);
        right.rows_mut(3, count).copy_from(&room.select_rows(&active));
        let Some(point) = kkt.lu().solve(&right) else { continue };
        let point = point.rows(0, 3).into_owned();
        if (&sides * &point - &room).max() > tolerance {
            continue;
        }
        let x = &start + &basis * point;
        if best.as_ref().is_none_or(|known| traction_square(&x) < traction_square(known)) {
            best = Some(x);
        }
    }
    best
}

/// Compares the controller with a reference on random cases; returns how many were feasible, and not.
fn compare(wheels: usize, seeds: u64, reference: impl Fn(&Case) -> Option<DVector<f64>>) -> (usize, usize) {
    let (mut feasible, mut infeasible) = (0, 0);
    for case in (0..seeds).map(|seed| by_power(seed, wheels)) {
        let weight = case.nominal.weight();
        match (distribution(&case), reference(&case)) {
            (Some(found), Some(expected)) => {
                feasible += 1;
                let excess = traction_square(&found) - traction_square(&expected);
                assert!(excess.abs() <= OPTIMUM * weight * weight, "{excess} of {weight}^2 in {case:?}");
                let apart = (found - expected).iter().step_by(2).fold(0.0, |worst: f64, d| worst.max(d.abs()));
                assert!(apart <= FORCES * weight, "forces {apart} N apart in {case:?}");
            }
            (None, None) => infeasible += 1,
            (found, expected) => panic!("found {found:?}, expected {expected:?} in {case:?}"),
        }
    }
    (feasible, infeasible)
}

#[test]
fn analytic_symmetric_rover_on_the_level_shares_evenly() {
    let mut case = Case::level(level_rover(2));
    case.goal = 0.05;
    let (rtc, torques) = case.run();
    // F = m K dv = 10 * 10 * 0.05 = 5 N: 2.5 N a wheel. Moments about the centre of mass, 0.25 m up:
    // 0.25 F + 0.35 (N_2 - N_1) = 0, so the rear wheel carries 0.25 * 5 / 0.35 N more than the front.
    let (shift, even) = (0.5 * 0.25 * 5.0 / 0.35, 0.5 * 98.1);
    let expected = [2.5, even + shift, 2.5, even - shift];
    for (found, expected) in rtc.outcome().expect("commanded").forces.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-7, "{found} N, by hand {expected} N");
    }
    for torque in torques {
        assert!((torque - 0.25).abs() < 1e-8, "r T = 0.1 * 2.5 N m, found {torque}");
    }
    // P = sum R (tau / (gear K_t))^2 = 2 * 2.32 * (0.25 / 2.34)^2.
    let power = rtc.outcome().expect("commanded").objective;
    assert!((power - 2.0 * 2.32 * (0.25_f64 / 2.34).powi(2)).abs() < 1e-9, "{power} W");
}

#[test]
fn agreement_two_wheels_with_the_line_of_the_null_space() {
    let (feasible, infeasible) = compare(2, 1000, two_wheel_optimum);
    assert!(feasible > 400 && infeasible > 100, "{feasible} feasible and {infeasible} infeasible cases");
}

#[test]
fn agreement_three_wheels_with_all_active_sets() {
    let (feasible, infeasible) = compare(3, 60, three_wheel_optimum);
    assert!(feasible > 25 && infeasible > 5, "{feasible} feasible and {infeasible} infeasible cases");
}

/// Largest distance of the power's gradient from the cone of the active constraints over `cases`, in weights;
/// returns how many cases had an active limit.
fn certify(cases: impl Iterator<Item = Case>) -> usize {
    let mut binding = 0;
    for case in cases {
        let Some(x) = distribution(&case) else { continue };
        let weight = case.nominal.weight();
        let (g, f) = case.balance();
        let (a, b) = case.limits();
        assert!((&g * &x - f).amax() <= BALANCE * weight, "the forces do not balance in {case:?}");
        assert!((&a * &x - &b).max() <= BALANCE * weight, "a limit is violated in {case:?}");
        let active: Vec<usize> =
            (0..b.len()).filter(|&k| b[k] - a.row(k).transpose().dot(&x) < ACTIVE * weight).collect();
        binding += usize::from(!active.is_empty());
        // -grad = G' nu + A' lambda with nu free, lambda >= 0.
        let gradient = DVector::from_fn(x.len(), |row, _| if row % 2 == 0 { -x[row] } else { 0.0 });
        let mut rays: Vec<DVector<f64>> = active.iter().map(|&k| a.row(k).transpose()).collect();
        rays.extend((0..g.nrows()).flat_map(|k| [g.row(k).transpose(), -g.row(k).transpose()]));
        let distance = cone_distance(&rays, &gradient);
        assert!(distance <= STATIONARY * weight, "{distance} N off the cone in {case:?}");
    }
    binding
}

#[test]
fn property_conditions_of_karush_kuhn_and_tucker_hold() {
    let binding = certify((0..320).map(|seed| by_power(seed, [2, 3, 4, 5, 6, 7, 8, 2][seed as usize % 8])));
    assert!(binding > 50, "only {binding} cases with an active limit");
}

#[test]
fn property_conditions_of_karush_kuhn_and_tucker_hold_with_joints() {
    let jointed = |seed: u64| {
        let mut case = Case::jointed(seed, 3 + seed as usize % 6);
        case.parameters.switch_angle = 1.6;
        case.solver = [Solver::Clarabel, Solver::ActiveSet][seed as usize / 6 % 2];
        case
    };
    let binding = certify((0..180).map(jointed));
    assert!(binding > 30, "only {binding} cases with an active limit");
}
