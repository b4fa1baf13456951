//! Claim: the maximum-traction distribution has the least largest |T|/N (4.5), certified by other methods.

use crate::control_support::nonnegative::cone_distance;
use crate::control_support::{Case, choices, level_rover, null_space};
use bekker::control::{Criterion, Solver};
use nalgebra::{DMatrix, DVector};

/// Ratio above the reference: the room of 1e-6 in which the cheapest distribution is sought, the
/// reference's own error, and 1e-10 of the weight over the least load.
const RATIO: f64 = 3e-6;

/// A case that is judged by traction whatever its slopes.
fn by_traction(seed: u64, wheels: usize) -> Case {
    let mut case = Case::random(seed, wheels);
    case.parameters.switch_angle = 0.0;
    case
}

fn ratio(x: &DVector<f64>) -> f64 {
    (0..x.len() / 2).map(|k| x[2 * k].abs() / x[2 * k + 1]).fold(0.0, f64::max)
}

/// The distribution's ratio, where there is a feasible one.
fn found(case: &Case) -> Option<f64> {
    let (rtc, _) = case.run();
    let outcome = rtc.outcome().expect("a command was given");
    assert_eq!(outcome.criterion, Criterion::Traction);
    assert_eq!(outcome.optimal, outcome.feasible, "{case:?}");
    assert!(
        !outcome.feasible || (outcome.objective - ratio(&DVector::from_column_slice(&outcome.forces))).abs() < 1e-12
    );
    outcome.feasible.then_some(outcome.objective)
}

/// Two wheels: 4001 points on the admissible part of the line, then golden sections around the best.
fn two_wheel_ratio(case: &Case) -> Option<f64> {
    let (g, f) = case.balance();
    let (a, b) = case.limits();
    let (basis, start) = null_space(&g, &f);
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for (slope, room) in (&a * &basis).iter().zip((&b - &a * &start).iter()) {
        if *slope > 0.0 {
            high = high.min(room / slope);
        } else {
            low = low.max(room / slope);
        }
    }
    let at = |s: f64| ratio(&(&start + basis.column(0) * s));
    let point = |k: usize| low + (high - low) * k as f64 / 4000.0;
    let best = (0..=4000).min_by(|&i, &j| at(point(i)).total_cmp(&at(point(j)))).filter(|_| low <= high)?;
    let (mut left, mut right) = (point(best.saturating_sub(1)), point((best + 1).min(4000)));
    for _ in 0..60 {
        let (inner, outer) = (left + 0.382 * (right - left), left + 0.618 * (right - left));
        if at(inner) < at(outer) { right = outer } else { left = inner }
    }
    Some(at(0.5 * (left + right)))
}

/// Three wheels: bisection on the ratio; forces exist where one of the polytope's corners is admissible.
fn three_wheel_ratio(case: &Case) -> Option<f64> {
    let (g, f) = case.balance();
    let (a, b) = case.limits();
    let (basis, start) = null_space(&g, &f);
    let corners = choices(b.len() + 6, 3);
    let exists = |ratio: f64| {
        let mut rows = DMatrix::zeros(b.len() + 6, 6);
        rows.rows_mut(0, b.len()).copy_from(&a);
        let mut bounds = DVector::zeros(b.len() + 6);
        bounds.rows_mut(0, b.len()).copy_from(&b);
        for k in 0..6 {
            rows[(b.len() + k, k / 2 * 2)] = if k % 2 == 0 { 1.0 } else { -1.0 };
            rows[(b.len() + k, k / 2 * 2 + 1)] = -ratio;
        }
        let (sides, room) = (&rows * &basis, bounds - &rows * &start);
        corners.iter().any(|corner| {
            let corner_sides = sides.select_rows(corner).fixed_view::<3, 3>(0, 0).into_owned();
            let corner_room = room.select_rows(corner).fixed_rows::<3>(0).into_owned();
            let Some(point) = corner_sides.lu().solve(&corner_room) else { return false };
            (0..room.len()).all(|row| {
                let side = sides.row(row);
                side[0] * point[0] + side[1] * point[1] + side[2] * point[2] <= room[row] + 1e-9 * case.nominal.weight()
            })
        })
    };
    let (mut low, mut high) = (0.0, 10.0);
    if !exists(high) {
        return None;
    }
    while high - low > 1e-8 {
        let middle = 0.5 * (low + high);
        if exists(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

fn compare(wheels: usize, seeds: u64, reference: impl Fn(&Case) -> Option<f64>) -> (usize, usize) {
    let (mut feasible, mut infeasible) = (0, 0);
    for case in (0..seeds).map(|seed| by_traction(seed, wheels)) {
        match (found(&case), reference(&case)) {
            (Some(found), Some(expected)) => {
                feasible += 1;
                assert!((found - expected).abs() <= RATIO, "ratio {found}, reference {expected} in {case:?}");
            }
            (None, None) => infeasible += 1,
            (found, expected) => panic!("found {found:?}, expected {expected:?} in {case:?}"),
        }
    }
    (feasible, infeasible)
}

#[test]
fn analytic_symmetric_rover_on_the_level_has_equal_ratios() {
    let mut case = Case::level(level_rover(2));
    case.parameters.switch_angle = 0.0;
    case.angles = vec![1e-9, 0.0]; // above the switch, and level
    case.goal = 0.05;
    let (rtc, _) = case.run();
    let outcome = rtc.outcome().expect("commanded");
    // All wheels pull with the same ratio: R = F / (m g) = 5 / 98.1.
    assert!((outcome.objective - 5.0 / 98.1).abs() < 1e-7, "R = {}", outcome.objective);
    // The loads are those of the balance of moments, whoever pulls: N = 49.05 +- 0.5 * 0.25 * 5 / 0.35.
    let rear = 49.05 + 0.5 * 0.25 * 5.0 / 0.35;
    assert!((outcome.forces[1] - rear).abs() < 1e-5 && (outcome.forces[0] - rear * 5.0 / 98.1).abs() < 1e-5);
}

#[test]
fn agreement_two_wheels_with_a_fine_line_search() {
    let (feasible, infeasible) = compare(2, 300, two_wheel_ratio);
    assert!(feasible > 120 && infeasible > 30, "{feasible} feasible and {infeasible} infeasible cases");
}

#[test]
fn agreement_three_wheels_with_bisection_over_all_corners() {
    let (feasible, infeasible) = compare(3, 25, three_wheel_ratio);
    assert!(feasible > 10 && infeasible > 2, "{feasible} feasible and {infeasible} infeasible cases");
}

#[test]
fn property_traction_never_needs_more_than_power_and_converges_fast() {
    let (mut most, mut total) = (0, 0);
    for (seed, wheels) in (0..500).map(|seed| (seed, [2, 3, 4, 6, 8][seed as usize % 5])) {
        let case = by_traction(seed, wheels);
        let (rtc, _) = case.run();
        let mut benign = case.clone();
        benign.parameters.switch_angle = 1.6;
        let (cheap, _) = benign.run();
        let (outcome, cheap) = (rtc.outcome().expect("commanded"), cheap.outcome().expect("commanded"));
        if outcome.feasible {
            total += outcome.steps;
            let dearer = ratio(&DVector::from_column_slice(&cheap.forces));
            assert!(outcome.objective <= dearer + RATIO, "{} against {dearer} in {case:?}", outcome.objective);
            most = most.max(outcome.steps);
        }
    }
    assert!((2..=15).contains(&most) && total < 500 * 5, "{most} linear programs at most, {total} in all");
}

/// Distance from a proof of optimality, of t: the room of 1e-6 in which the cheapest distribution is sought, over loads
/// of a tenth of the weight.
const PROOF: f64 = 1e-5;
/// Room up to which a ratio or a limit is tried in the certificate, in weights; of the others the multiplier is 0.
const NEAR: f64 = 1e-2;

/// Distance from a proof that no forces have a smaller largest ratio: what is left of the conditions of Karush, Kuhn
/// and Tucker of min t: |T_i| - R N_i <= t N_i', and the gap, which is the most that t can fall (N_i' of the forces
/// themselves, in weights; a ratio of linear functions is quasi-convex, so that t = 0 at the optimum).
fn improvable(case: &Case, forces: &[f64]) -> f64 {
    let (g, _) = case.balance();
    let (a, b) = case.limits();
    let (unknowns, weight) = (forces.len(), case.nominal.weight());
    let x = DVector::from_column_slice(forces);
    let largest = ratio(&x);
    // Coordinates: the forces, t, and the room, by which a multiplier adds to the gap.
    let stacked = |row: DVector<f64>, t: f64, room: f64| row.push(t).push(room.max(0.0));
    let room = |k: usize| (b[k] - a.row(k).transpose().dot(&x)) / weight;
    let limits = (0..b.len()).filter(|&k| room(k) < NEAR);
    let mut rays: Vec<DVector<f64>> = limits.map(|k| stacked(a.row(k).transpose(), 0.0, room(k))).collect();
    for wheel in 0..unknowns / 2 {
        let (pull, load) = (forces[2 * wheel], forces[2 * wheel + 1]);
        let room = (largest * load - pull.abs()) / weight;
        if room < NEAR {
            let mut row = DVector::zeros(unknowns);
            row[2 * wheel] = pull.signum();
            row[2 * wheel + 1] = -largest;
            rays.push(stacked(row, -load / weight, room));
        }
    }
    for k in 0..g.nrows() {
        rays.extend([stacked(g.row(k).transpose(), 0.0, 0.0), stacked(-g.row(k).transpose(), 0.0, 0.0)]);
    }
    let mut falling = DVector::zeros(unknowns + 2);
    falling[unknowns] = -1.0;
    cone_distance(&rays, &falling)
}

#[test]
fn property_no_ratio_can_be_lowered_for_three_to_eight_wheels_and_joints() {
    let mut certified = 0;
    for seed in 0..240 {
        let wheels = 3 + seed as usize % 6;
        let mut case = if seed % 2 == 0 { Case::random(seed, wheels) } else { Case::jointed(seed, wheels) };
        case.parameters.switch_angle = 0.0;
        case.solver = [Solver::Clarabel, Solver::ActiveSet][seed as usize / 12 % 2];
        let (rtc, _) = case.run();
        let outcome = rtc.outcome().expect("commanded");
        if outcome.feasible && outcome.objective > 0.01 {
            let distance = improvable(&case, &outcome.forces);
            assert!(distance <= PROOF, "seed {seed}: {distance} off a proof at R = {}", outcome.objective);
            certified += 1;
        }
    }
    assert!(certified > 100, "only {certified} ratios certified");
}
