//! Claims: RTC's constraints (4.13, 4.14, 4.16) always hold, and each binds somewhere; where no forces are
//! admissible the nearest are taken, and said to be so.

use crate::control_support::nonnegative::cone_distance;
use crate::control_support::{Case, corners, level_rover, thesis_rover};
use bekker::control::rtc::{CHEAPNESS, LAW_WEIGHT, WISH_OUT_OF_BALANCE};
use bekker::control::{ControlError, Criterion, RoughTerrainControl, Rtc};
use nalgebra::DVector;

/// Violation of a constraint, relative to the weight; the optimiser stops at 1e-10.
const VIOLATION: f64 = 1e-8;
/// How near a constraint has to be to count as binding, relative to the weight.
const BINDING: f64 = 1e-6;
/// Weighted miss of the body force against the reference, in weights: that of the reference's row for the
/// sum of shares, and the preference for cheap forces.
const NEAREST: f64 = 1e-6;

/// Which constraints bind in a feasible case: minimum load, torque limit, soil strength. None may be violated.
fn bindings(case: &Case) -> [bool; 3] {
    let (rtc, _) = case.run();
    let outcome = rtc.outcome().expect("commanded");
    let (a, b) = case.limits();
    let weight = case.nominal.weight();
    let room = (b - a.clone() * DVector::from_column_slice(&outcome.forces)) / weight;
    assert!(room.min() >= -VIOLATION, "a constraint is violated by {} weights in {case:?}", -room.min());
    let mut binds = [false; 3];
    for (row, room) in a.row_iter().zip(room.iter()) {
        let (pulls, loads) =
            (row.iter().step_by(2).any(|v| *v != 0.0), row.iter().skip(1).step_by(2).any(|v| *v != 0.0));
        let kind = if !pulls {
            0
        } else if loads {
            2
        } else {
            1
        };
        binds[kind] |= *room <= BINDING && outcome.feasible;
    }
    binds
}

/// Raises the demand of a case to 99.9 % of what is feasible.
fn nearly_infeasible(case: &mut Case) {
    let error = case.goal - case.velocity;
    let (mut low, mut high) = (0.0, 100.0);
    for _ in 0..25 {
        let middle = 0.5 * (low + high);
        case.velocity = case.goal - middle * error;
        if case.run().0.outcome().expect("commanded").feasible { low = middle } else { high = middle }
    }
    case.velocity = case.goal - 0.999 * low * error;
}

#[test]
fn property_constraints_hold_always_and_each_binds_somewhere() {
    let mut counts = [[0; 3]; 2];
    for seed in 0..450 {
        let mut case = Case::random(seed, [2, 3, 6][(seed / 3) as usize % 3]);
        let rough = seed % 2 == 0;
        case.parameters.switch_angle = if rough { 0.0 } else { 1.6 };
        if seed % 3 == 0 {
            nearly_infeasible(&mut case);
        }
        for (count, binds) in counts[usize::from(rough)].iter_mut().zip(bindings(&case)) {
            *count += usize::from(binds);
        }
    }
    // Minimum load, torque limit, soil strength; by power, then by traction.
    for (criterion, row) in ["power", "traction"].into_iter().zip(counts) {
        assert!(row.iter().all(|&count| count >= 5), "{criterion}: load, torque, strength bind {row:?} times");
    }
}

#[test]
fn analytic_torque_limit_caps_the_command() {
    // 2.5 N a wheel are wanted, 0.2 N m allow 2 N: all wheels at the limit, and 1 N is missing.
    let mut case = Case::level(thesis_rover());
    case.goal = 0.05;
    case.nominal.motor.inverse_torque_limit = 5.0;
    let (rtc, torques) = case.run();
    let outcome = rtc.outcome().expect("commanded");
    assert!(!outcome.feasible);
    assert!(torques.iter().all(|torque| (torque - 0.2).abs() < 1e-7), "{torques:?}");
    assert!((outcome.shortfall[0] - 1.0).abs() < 1e-4, "{:?}", outcome.shortfall);
}

#[test]
fn agreement_nearest_wish_with_the_corners_of_the_admissible_forces() {
    let (mut out_of_reach, mut out_of_balance) = (0, 0);
    for seed in 0..400 {
        let wheels = 2 + seed as usize % 2;
        let case = if seed < 160 { Case::random(seed, wheels) } else { Case::tipping(seed, wheels) };
        let (rtc, _) = case.run();
        let outcome = rtc.outcome().expect("commanded");
        let weight = case.nominal.weight();
        let (g, f) = case.balance();
        let laws = (g.rows(1, 2).into_owned(), f.rows(1, 2).into_owned());
        let reach: Vec<f64> = corners(&laws, &case.limits(), 1e-9 * weight).iter().map(|x| (&g * x)[0]).collect();
        let (low, high) =
            (reach.iter().copied().fold(f64::MAX, f64::min), reach.iter().copied().fold(f64::MIN, f64::max));
        let missing = (&f - &g * DVector::from_column_slice(&outcome.forces)) / weight;
        if reach.is_empty() {
            assert!(!outcome.feasible, "not even the weight can be balanced in {case:?}");
            out_of_balance += 1;
            continue;
        }
        let expected = (f[0] - f[0].clamp(low, high)) / weight;
        assert!((missing[0] - expected).abs() <= NEAREST, "{} of {expected} weights missing in {case:?}", missing[0]);
        assert!(missing.rows(1, 2).amax() <= VIOLATION, "weight and moment have to balance in {case:?}");
        assert_eq!(outcome.feasible, expected.abs() <= NEAREST, "{expected} weights missing in {case:?}");
        out_of_reach += usize::from(!outcome.feasible);
    }
    assert!(out_of_reach > 20 && out_of_balance > 5, "{out_of_reach} out of reach, {out_of_balance} out of balance");
}

/// The two-dimensional polyhedron of one wheel's admissible (T, N): corners, and directions without end.
fn wheel_polyhedron(minimum: f64, drive: f64, adhesion: f64, friction: f64) -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
    let low = drive.min(adhesion + friction * minimum);
    let mut corners = vec![[low, minimum], [-low, minimum]];
    if drive.is_infinite() {
        return (corners, vec![[friction, 1.0], [-friction, 1.0]]);
    }
    let load = ((drive - adhesion) / friction).max(minimum);
    corners.extend([[drive, load], [-drive, load]]);
    (corners, vec![[0.0, 1.0]])
}

/// Weights of a miss of the balance's rows, per N, N and N m.
fn miss_weights(case: &Case) -> [f64; 3] {
    let weight = case.nominal.weight();
    [1.0, LAW_WEIGHT, LAW_WEIGHT / (0.5 * case.nominal.base())].map(|factor| factor / weight)
}

/// The wanted body force with the wish as far as it counts out of balance.
fn wanted(case: &Case) -> DVector<f64> {
    let (_, mut wanted) = case.balance();
    let largest = WISH_OUT_OF_BALANCE * case.nominal.weight();
    wanted[0] = wanted[0].clamp(-largest, largest);
    wanted
}

/// Least weighted miss of the body force, in weights: nonnegative least squares over corners and directions.
fn least_miss(case: &Case) -> f64 {
    let (g, _) = case.balance();
    let (a, b) = case.limits();
    let (weight, wheels, scale) = (case.nominal.weight(), case.nominal.wheels(), miss_weights(case));
    let share_row = 1e4;
    let column = |wheel: usize, [pull, load]: [f64; 2], share: f64| {
        let force = g.column(2 * wheel) * pull + g.column(2 * wheel + 1) * load;
        DVector::from_fn(3 + wheels, |row, _| match row {
            0..3 => force[row] * scale[row],
            _ if row == 3 + wheel => share * share_row,
            _ => 0.0,
        })
    };
    let mut rays = Vec::new();
    let rows = b.len() / wheels;
    for wheel in 0..wheels {
        let first = rows * wheel;
        let drive = if rows == 5 { b[first + 1] } else { f64::INFINITY };
        let friction = -a[(first + rows - 1, 2 * wheel + 1)];
        let (corners, directions) = wheel_polyhedron(-b[first], drive, b[first + rows - 1], friction);
        rays.extend(corners.into_iter().map(|corner| column(wheel, corner, 1.0)));
        rays.extend(directions.into_iter().map(|[pull, load]| column(wheel, [pull * weight, load * weight], 0.0)));
    }
    let wanted = wanted(case);
    let target = DVector::from_fn(3 + wheels, |row, _| if row < 3 { wanted[row] * scale[row] } else { share_row });
    cone_distance(&rays, &target)
}

#[test]
fn agreement_nearest_out_of_balance_with_nonnegative_least_squares() {
    let mut out_of_balance = 0;
    for seed in 0..300 {
        let case = Case::tipping(seed, [2, 3, 6][seed as usize % 3]);
        let (rtc, _) = case.run();
        let outcome = rtc.outcome().expect("commanded");
        let weight = case.nominal.weight();
        if outcome.shortfall[1].abs() <= NEAREST * weight && outcome.shortfall[2].abs() <= NEAREST * weight {
            continue;
        }
        out_of_balance += 1;
        let (g, _) = case.balance();
        let mut missing = wanted(&case) - g * DVector::from_column_slice(&outcome.forces);
        missing.iter_mut().zip(miss_weights(&case)).for_each(|(row, weight)| *row *= weight);
        let (ours, least) = (missing.norm(), least_miss(&case));
        assert!((ours - least).abs() <= NEAREST, "missing {ours}, least {least} weights in {case:?}");
    }
    assert!(out_of_balance > 20, "only {out_of_balance} cases out of balance");
    const { assert!(CHEAPNESS < NEAREST) };
}

#[test]
fn analytic_switch_turns_above_its_angle() {
    let mut case = Case::level(level_rover(3));
    let limit = case.parameters.switch_angle;
    for (angle, expected) in [
        (limit, Criterion::Power),
        (-limit, Criterion::Power),
        (limit + 1e-9, Criterion::Traction),
        (-limit - 1e-9, Criterion::Traction),
    ] {
        case.angles[1] = angle;
        assert_eq!(case.run().0.outcome().expect("commanded").criterion, expected, "at {angle} rad");
    }
}

#[test]
fn analytic_resistance_adds_what_the_ruts_cost() {
    let mut case = Case::level(thesis_rover());
    (case.goal, case.velocity) = (0.25, 0.25);
    assert!(case.run().1.iter().all(|torque| torque.abs() < 1e-9), "no error, no torque");
    case.parameters.resistance = 1.0;
    // (4.18) with n = 1: z = (3 N / (2 b k sqrt(2 r)))^(2/3); R = b k z^2 / 2 on each wheel.
    let z = (3.0 * 49.05 / (2.0 * 0.15 * 850e3 * 0.2_f64.sqrt())).powf(2.0 / 3.0);
    let resistance = 0.15 * 850e3 * z * z / 2.0;
    let total: f64 = case.run().1.iter().sum();
    assert!((total - 0.1 * 2.0 * resistance).abs() < 1e-7, "{total} N m");
    (case.goal, case.velocity) = (-0.25, -0.25);
    let back: f64 = case.run().1.iter().sum();
    assert!((back + total).abs() < 1e-7, "{back} N m backward, {total} N m forward");
}

#[test]
fn property_impossible_nominal_rovers_are_refused() {
    let refused = |change: fn(&mut Case)| {
        let mut case = Case::level(thesis_rover());
        change(&mut case);
        Rtc::new(case.nominal, case.parameters).err().expect("has to be refused").to_string()
    };
    assert!(refused(|c| c.parameters.minimum_load = 49.06).contains("minimum_load"));
    assert!(refused(|c| c.parameters.gain = f64::NAN).contains("gain"));
    assert!(refused(|c| c.nominal.mass = 0.0).contains("mass"));
    assert!(refused(|c| c.nominal.gravity = f64::NAN).contains("gravity"));
    assert!(refused(|c| c.nominal.soil.exponent = 9.0).contains("exponent"));
    assert!(refused(|c| c.nominal.wheel_centres.truncate(1)).contains("number of wheels"));
    assert!(refused(|c| c.nominal.wheel_centres[1][0] = f64::NAN).contains("wheel 2"));
    assert!(refused(|c| c.nominal.wheel_centres[1] = c.nominal.wheel_centres[0]).contains("distance"));
    let loads = RoughTerrainControl { minimum_load: 60.0, ..RoughTerrainControl::default() };
    assert!(matches!(Rtc::new(thesis_rover(), loads), Err(ControlError::MinimumLoad { wheels: 2, .. })));
}
