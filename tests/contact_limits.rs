//! The wheel's forces against limits solved by hand, mirrored, at the ends of all ranges, and across all changes of case.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "support/quadrature.rs"]
mod quadrature;
#[path = "support/wheel_model.rs"]
mod wheel_model;
#[path = "support/wheel_reference.rs"]
mod wheel_reference;

use bekker::contact::Forces;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use wheel_model::forces;
use wheel_reference::Case;

/// Closed forms by hand against the quadrature of smooth functions.
const BY_HAND: f64 = 1e-8;

/// A wheel on the thesis's sand, 1 cm deep.
fn sand() -> Case {
    Case {
        r: 0.1,
        b: 0.15,
        k_c: 0.0,
        k_phi: 850e3,
        n: 1.0,
        c: 1000.0,
        phi: 0.5,
        k: 0.03,
        c1: 0.4,
        c2: 0.2,
        exit: 0.0,
        z: 0.01,
        v: 0.1,
        omega: 1.25,
    }
}

/// Integrals over the rim of sigma cos theta, sigma sin theta and sigma for n = 1, by hand, over r k_phi.
fn by_hand(theta_1: f64, theta_m: f64) -> [f64; 3] {
    let cos_1 = theta_1.cos();
    // Front: (cos theta - cos theta_1) times 1, cos theta, sin theta.
    let front = |theta: f64| {
        let (sin, cos) = theta.sin_cos();
        [0.5 * (theta + sin * cos) - cos_1 * sin, 0.5 * sin * sin + cos_1 * cos, sin - cos_1 * theta]
    };
    // Rear: cos(theta_1 - q theta) - cos theta_1 with q = (theta_1 - theta_m)/theta_m; products as sums.
    let q = (theta_1 - theta_m) / theta_m;
    let (less, more) = (q - 1.0, q + 1.0);
    let rear = |theta: f64| {
        let (sin, cos) = theta.sin_cos();
        let (a, b) = (theta_1 - less * theta, theta_1 - more * theta);
        [
            -0.5 * (a.sin() / less + b.sin() / more) - cos_1 * sin,
            0.5 * (a.cos() / less - b.cos() / more) + cos_1 * cos,
            -(theta_1 - q * theta).sin() / q - cos_1 * theta,
        ]
    };
    let between = |f: &dyn Fn(f64) -> [f64; 3], to: f64, from: f64| {
        let (to, from) = (f(to), f(from));
        [0, 1, 2].map(|i| to[i] - from[i])
    };
    let (front, rear) = (between(&front, theta_1, theta_m), between(&rear, theta_m, 0.0));
    [0, 1, 2].map(|i| front[i] + rear[i])
}

/// Both the model and the independent reference must give what was worked out by hand.
fn assert_forces(case: &Case, [normal, drawbar, torque]: [f64; 3], tolerance: f64) {
    let model = forces(case);
    for found in [[model.normal, model.drawbar, model.torque], case.forces()] {
        let errors = [found[0] - normal, found[1] - drawbar, (found[2] - torque) / case.r];
        let close = errors.iter().all(|error| error.abs() < tolerance * normal);
        assert!(close, "{case:?}: {found:?}, expected {normal} {drawbar} {torque}");
    }
}

#[test]
fn analytic_without_shear_strength_a_linear_soil_is_solved_by_hand() {
    for (z, slip) in [(0.002, 0.1), (0.01, 0.4), (0.04, 0.9)] {
        let case = Case { c: 0.0, phi: 0.0, z, v: 0.125 * (1.0 - slip), ..sand() };
        let (theta_1, theta_m, _) = case.angles();
        let [cos, sin, _] = by_hand(theta_1, theta_m);
        let stress = case.r * case.b * case.k_phi * case.r;
        assert_forces(&case, [stress * cos, -stress * sin, 0.0], BY_HAND);
    }
}

#[test]
fn analytic_full_shear_of_a_sliding_wheel_is_solved_by_hand() {
    // Locked, and turning against the motion: |j| is without bound, the shear is the strength, against the sliding.
    for (z, omega) in [(0.003, 0.0), (0.01, 0.0), (0.02, -1.0)] {
        let case = Case { z, omega, ..sand() };
        let (theta_1, theta_m, _) = case.angles();
        let stress = case.k_phi * case.r;
        let [cos, sin, plain] = by_hand(theta_1, theta_m).map(|integral| stress * integral);
        let (tan, area) = (case.phi.tan(), case.r * case.b);
        let normal = area * (cos - case.c * (1.0 - theta_1.cos()) - tan * sin);
        let drawbar = area * (-case.c * theta_1.sin() - tan * cos - sin);
        let torque = -case.r * area * (case.c * theta_1 + tan * plain);
        assert_forces(&case, [normal, drawbar, torque], BY_HAND);
    }
}

#[test]
fn analytic_full_shear_is_the_limit_of_a_small_shear_modulus() {
    let full = |z: f64| {
        let case = Case { z, v: 0.0, omega: 1.25, ..sand() };
        let (theta_1, theta_m, _) = case.angles();
        let [cos, sin, plain] = by_hand(theta_1, theta_m).map(|integral| case.k_phi * case.r * integral);
        let (tan, area) = (case.phi.tan(), case.r * case.b);
        let normal = area * (cos + case.c * (1.0 - theta_1.cos()) + tan * sin);
        let drawbar = area * (case.c * theta_1.sin() + tan * cos - sin);
        (case, [normal, drawbar, case.r * area * (case.c * theta_1 + tan * plain)])
    };
    for z in [0.003, 0.01, 0.03] {
        let (case, limit) = full(z);
        // What is missing is strength over the first few K of the rim: of first order in K.
        for k in [1e-5, 1e-6, 1e-7] {
            assert_forces(&Case { k, ..case }, limit, 10.0 * k / z);
        }
    }
}

#[test]
fn property_moving_backward_mirrors_the_forces_to_the_bit() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for (v, rim) in [(0.06, 0.1), (0.1, 0.1), (0.1, 0.06), (0.1, 0.0), (0.1, -0.1), (0.003, -0.1), (0.0, 0.1)] {
        for _ in 0..100 {
            let [n, z, exit] = [(0.3, 1.6), (0.001, 0.09), (0.0, 1.2)].map(|(a, b)| random.random_range(a..b));
            let case = Case { n, z, exit, v, omega: rim / 0.1, ..sand() };
            let (there, back) = (forces(&case), forces(&Case { v: -case.v, omega: -case.omega, ..case }));
            let mirrored = Forces { normal: back.normal, drawbar: -back.drawbar, torque: -back.torque };
            assert_eq!(there, mirrored, "{case:?}");
        }
    }
}

#[test]
fn property_forces_are_finite_everywhere() {
    let speeds = [0.0, 1e-300, 1e-12, 1e-3, 1.0, 1e3, 1e12, 1e300];
    let signed = || speeds.iter().flat_map(|s| [*s, -*s]);
    for (v, omega) in signed().flat_map(|v| signed().map(move |omega| (v, omega))) {
        for z in [-1.0, 0.0, 1e-300, 1e-12, 1e-3, 0.05, 0.1, 0.15, 0.5] {
            for (exit, k, n) in [(0.0, 0.03, 1.0), (1.2, 1e-6, 0.3), (0.5, 0.2, 2.0)] {
                let found = forces(&Case { v, omega, z, exit, k, n, ..sand() });
                let finite = [found.normal, found.drawbar, found.torque].iter().all(|f| f.is_finite());
                assert!(finite, "V {v}, omega {omega}, z {z}, exit {exit}, K {k}, n {n}: {found:?}");
            }
        }
    }
}

#[test]
fn property_no_contact_no_force() {
    for z in [-0.1, -1e-12, 0.0] {
        assert_eq!(forces(&Case { z, ..sand() }), Forces::zero());
    }
}

/// Largest change of a force between neighbours among `count` points of a closed curve in the (V, r omega) plane.
fn largest_jump(case: &Case, count: u32, curve: impl Fn(f64) -> (f64, f64)) -> f64 {
    let at = |i: u32| {
        let (v, rim) = curve(f64::from(i) / f64::from(count));
        let found = forces(&Case { v, omega: rim / case.r, ..*case });
        [found.normal, found.drawbar, found.torque / case.r]
    };
    let mut before = at(0);
    let mut largest = 0.0_f64;
    for i in 1..=count {
        let now = at(i);
        largest = (0..3).fold(largest, |largest, c| largest.max((now[c] - before[c]).abs()));
        before = now;
    }
    largest
}

#[test]
fn property_forces_are_continuous_off_the_origin_of_the_speeds() {
    use std::f64::consts::TAU;
    for case in [sand(), Case { exit: 0.8, n: 0.7, ..sand() }, Case { k: 0.005, phi: 0.6, ..sand() }] {
        let load = forces(&case).normal;
        // Around the origin: all signs of both speeds, every ratio, the locked wheel and the spinning one.
        let circle = |part: f64| (0.1 * (TAU * part).cos(), 0.1 * (TAU * part).sin());
        // Across each axis on straight lines that pass by the origin.
        let across_v = |part: f64| (0.2 * part - 0.1, 0.03);
        let across_rim = |part: f64| (0.03, 0.2 * part - 0.1);
        let oblique = |part: f64| (0.2 * part - 0.12, 0.1 - 0.15 * part);
        let curves: [&dyn Fn(f64) -> (f64, f64); 4] = [&circle, &across_v, &across_rim, &oblique];
        for (number, curve) in curves.into_iter().enumerate() {
            // A jump would keep its size as the points come closer; what is continuous shrinks.
            let (coarse, fine) = (largest_jump(&case, 2_000, curve), largest_jump(&case, 64_000, curve));
            println!("curve {number}: {:.1e} and {:.1e} of N", coarse / load, fine / load);
            assert!(fine < 0.1 * coarse && fine < 0.01 * load, "curve {number}: {coarse} {fine} of {load} N");
        }
    }
}

#[test]
fn property_forces_are_continuous_in_the_sinkage_and_the_exit_angle() {
    let jump = |count: u32, along: &dyn Fn(f64) -> Case| {
        let at = |i: u32| forces(&along(f64::from(i) / f64::from(count))).drawbar;
        (1..=count).map(|i| (at(i) - at(i - 1)).abs()).fold(0.0, f64::max)
    };
    let sinkage = |part: f64| Case { z: 0.05 * part, ..sand() };
    let exit = |part: f64| Case { exit: 1.2 * part, v: 0.14, ..sand() };
    let curves: [&dyn Fn(f64) -> Case; 2] = [&sinkage, &exit];
    for along in curves {
        let (coarse, fine) = (jump(500, along), jump(16_000, along));
        // The exit angle begins as the root of its ratio, whose largest change shrinks as the root of the step.
        assert!(fine < 0.25 * coarse, "{coarse} {fine}");
    }
}

#[test]
fn analytic_reece_moduli_give_the_same_surface_at_one_width() {
    // Errata 15: (k_1 + k_2 b)(z/b)^n is Bekker's curve with k_c/b + k_phi = (k_1 + k_2 b) b^-n.
    let (k_1, k_2, width) = (1.2e3, 4.0e4, 0.12);
    let soil = bekker::soil::Soil { exponent: 0.9, ..Default::default() }.with_reece_moduli(k_1, k_2, width);
    for depth in [0.002_f64, 0.01, 0.05] {
        let reece = (k_1 + k_2 * width) * (depth / width).powf(0.9);
        assert!((soil.pressure(depth, width) / reece - 1.0).abs() < 1e-14, "at {depth} m");
    }
}
