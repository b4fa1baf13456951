//! Reconfiguration of the Sample Return Rover.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker_planning::force::{Assumptions, Load, Shear};
use bekker_planning::map::{ElevationMap, GroundShape, Interpolation, Surface, generated};
use bekker_planning::pose::Placing;
use bekker_planning::reconfigure::{Reconfiguration, ReconfigureError, Stance};
use bekker_planning::robot::{fsrl, sample_return};
use bekker_planning::stability::stability;
use bekker_planning::traction::{Traction, TractionError};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The two shoulders.
const PENALISED: usize = 2;

/// A descent ends where it gains less than a ten-millionth a step; near a flat optimum that leaves some millionths.
const OPTIMUM: f64 = 1e-5;

fn slope(gx: f64, gy: f64) -> Surface {
    let map = ElevationMap::from_formula(81, 81, 0.05, [-2.0, -2.0], |x, y| gx * x + gy * y).unwrap();
    Surface::new(map, Interpolation::Smooth)
}

fn margin(placing: &Placing, pose: &bekker_planning::pose::Pose) -> f64 {
    let weight = placing.robot().total_mass() * 9.81;
    stability(pose, weight, Vector3::zeros(), Vector3::zeros()).unwrap().margin
}

#[test]
fn analytic_on_planes_contacts_move_linearly_to_second_order() {
    let (robot, ground) = (sample_return(), slope(0.1, 0.25));
    let at = |active: &[f64]| {
        let placing = Placing::new(&robot, &ground, active).unwrap();
        let pose = placing.pose([0.0, 0.0], 0.2, None).unwrap();
        margin(&placing, &pose)
    };
    let placing = Placing::new(&robot, &ground, &[]).unwrap();
    let pose = placing.pose([0.0, 0.0], 0.2, None).unwrap();
    let stance = Stance::new(&placing, &pose, PENALISED, Reconfiguration::default()).unwrap();
    let error = |size: f64| {
        let change = [0.5, -0.8, 0.4, 0.7, -0.6].map(|x| x * size);
        (stance.index(&change).1 - at(&change)).abs()
    };
    assert!(error(0.0) < 1e-9);
    // A quarter at half the change, where other terms are small.
    assert!(error(0.05) < 0.35 * error(0.1) && error(0.1) < 0.01, "{} {}", error(0.05), error(0.1));
}

#[test]
fn property_no_sampled_change_is_better_than_the_optimum() {
    let robot = sample_return();
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let shape = GroundShape { nodes: 121, cell: 0.04, feature: 0.25, roughness: 0.08, swell: 0.15 };
    let mut poses = 0;
    for seed in 0..40 {
        let ground = Surface::new(generated(&shape, seed).unwrap(), Interpolation::Smooth);
        let placing = Placing::new(&robot, &ground, &[]).unwrap();
        let Ok(pose) = placing.pose([2.4, 2.4], random.random_range(-3.0..3.0), None) else { continue };
        let stance = Stance::new(&placing, &pose, PENALISED, Reconfiguration::default()).unwrap();
        if !stance.index(&[]).0.is_finite() {
            continue;
        }
        poses += 1;
        let best = stance.optimised();
        assert!(best.index <= stance.index(&[]).0);
        for _ in 0..2000 {
            let change: Vec<f64> = stance.range().iter().map(|[l, h]| l + (h - l) * random.random::<f64>()).collect();
            let there = stance.index(&change).0;
            assert!(there > best.index * (1.0 - OPTIMUM), "seed {seed}: {there} {}", best.index);
        }
    }
    assert!(poses >= 25, "{poses}");
}

#[test]
fn property_on_a_cross_slope_the_body_is_lowered_and_the_margin_grows() {
    let (robot, ground) = (sample_return(), slope(0.0, 0.35));
    let mut active = vec![0.0; 5];
    let mut margins = Vec::new();
    // On a plane the steps of range 0.15 rad come to rest.
    for _ in 0..12 {
        let placing = Placing::new(&robot, &ground, &active).unwrap();
        let pose = placing.pose([0.0, 0.0], 0.0, None).unwrap();
        margins.push(margin(&placing, &pose));
        active = Stance::new(&placing, &pose, PENALISED, Reconfiguration::default()).unwrap().optimised().values;
    }
    // Opened legs (negative) lower the body, but not onto the ground.
    assert!(active[0] < -0.1 && active[1] < -0.1, "{active:?}");
    let placing = Placing::new(&robot, &ground, &active).unwrap();
    let clearance = placing.pose([0.0, 0.0], 0.0, None).unwrap().clearance;
    assert!(clearance > 0.0, "{clearance}");
    assert!(margins.last().unwrap() > &(1.1 * margins[0]), "{margins:?}");
    let limits = robot.active_limits();
    assert!(active.iter().zip(limits).all(|(value, [least, most])| *value >= least - 1e-12 && *value <= most + 1e-12));
}

#[test]
fn property_a_robot_without_motors_is_told() {
    let (robot, ground) = (fsrl(), slope(0.0, 0.0));
    let placing = Placing::new(&robot, &ground, &[]).unwrap();
    let pose = placing.pose([0.0, 0.0], 0.0, None).unwrap();
    let refused = Stance::new(&placing, &pose, 0, Reconfiguration::default()).unwrap_err();
    assert_eq!(refused, ReconfigureError::Active { active: 0 });
}

/// Share of the thrust by which a search without slopes may end below the best of a sample: kinks hold it up.
const THRUST: f64 = 0.05;

#[test]
fn agreement_joints_for_traction_give_as_much_thrust_as_the_best_of_many_drawn() {
    let (robot, load, shear) = (sample_return(), Load::default(), Shear { adhesion: 4.0, ..Shear::firm(0.5) });
    let shape = GroundShape { nodes: 121, cell: 0.04, feature: 0.25, roughness: 0.06, swell: 0.1 };
    let (mut gains, mut random) = (0, ChaCha8Rng::seed_from_u64(5));
    for seed in 0..4 {
        let ground = Surface::new(generated(&shape, seed).unwrap(), Interpolation::Smooth);
        let traction = Traction {
            robot: &robot,
            surface: &ground,
            load: &load,
            shear: &shear,
            assumptions: Assumptions::default(),
            stability: 0.1,
        };
        let (place, nominal) = ([2.4, 2.4], vec![0.0; robot.active()]);
        let Some(before) = traction.thrust(place, 0.3, &nominal).unwrap() else { continue };
        let found = traction.most(place, 0.3, &nominal).unwrap().unwrap();
        let limits = robot.active_limits();
        let mut draw = || -> Vec<f64> { limits.iter().map(|[low, high]| random.random_range(*low..*high)).collect() };
        let drawn = (0..150).filter_map(|_| traction.thrust(place, 0.3, &draw()).unwrap());
        let best = drawn.fold(f64::NEG_INFINITY, f64::max);
        println!(
            "ground {seed}: {before:.2} N, {:.2} N after {} sets, best drawn {best:.2} N",
            found.thrust, found.judged
        );
        assert!(found.thrust >= before && found.thrust >= best - THRUST * best.abs(), "{before} {found:?} {best}");
        assert!(found.values.iter().zip(&limits).all(|(x, [low, high])| (*low..=*high).contains(x)));
        gains += usize::from(found.thrust > 1.05 * before);
        let short = traction.most(place, 0.3, &[0.0]);
        assert!(matches!(short, Err(TractionError::Robot(_))));
    }
    assert!(gains >= 2, "{gains} of 4 gain");
}
