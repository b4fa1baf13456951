//! The corrected closed forms are the integrals of the linear stresses.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "support/quadrature.rs"]
mod quadrature;

use bekker::contact::Forces;
use bekker::linear_stress::{DrivenWheel, LinearStress};
use bekker::scalar::Dual;
use bekker::soil::Soil;
use bekker::wheel::Wheel;
use quadrature::integrate;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Both sides are exact; what is left is rounding in the differences of the closed forms, of the load.
const EXACT: f64 = 1e-10;
/// (2.24) inverts (B.5) and (B.7) algebraically.
const INVERTED: f64 = 1e-9;
/// h_1 and h_3 against the integrals of (B.1) and (B.3) at the theta_m that they contain, of W or r W: the terms of theta_1 that
/// both leave out and their coefficients, rounded to 1/20, 1/5 and 1/4, are 0.81 % of W in h_1 and 0.27 % in h_3 at 55 degrees
/// and slip 1, and less below.
const GROUPS_WITHOUT_SHEAR: f64 = 0.0085;

struct Draw {
    wheel: Wheel,
    soil: Soil,
    sinkage: f64,
    slip: f64,
}

/// Far wider than the thesis's ranges.
fn draw(random: &mut impl Rng) -> Draw {
    let mut log = |from: f64, to: f64| from * (to / from).powf(random.random());
    let radius = log(0.02, 0.5);
    let (width, theta_1) = (log(0.01, 0.5), log(0.05, 1.4));
    let (shear_modulus, k_phi, cohesion) = (log(0.001, 0.1), log(1e5, 1e7), log(1.0, 1e4));
    let (exponent, friction_angle, slip) =
        (random.random_range(0.3..1.6), random.random_range(0.1..0.7), random.random_range(0.0..=1.0));
    let soil = Soil { cohesion, friction_angle, k_phi, exponent, shear_modulus, ..Soil::default() };
    let wheel = Wheel { radius, width, ..Wheel::default() };
    Draw { wheel, soil, sinkage: radius * (1.0 - theta_1.cos()), slip }
}

fn of(draw: &Draw) -> LinearStress {
    LinearStress::of_soil(&draw.wheel, &draw.soil, draw.sinkage, draw.slip).unwrap()
}

/// (2.14)-(2.16) by quadrature with the given shear stress.
fn integrals(draw: &Draw, stress: &LinearStress, tau: impl Fn(f64) -> f64) -> Forces {
    let points = |theta: f64| {
        let (sigma, tau) = (stress.sigma(theta), tau(theta));
        [sigma * theta.cos() + tau * theta.sin(), tau * theta.cos() - sigma * theta.sin(), tau]
    };
    let (theta_1, theta_m) = (stress.wheel().theta_1(), stress.theta_m());
    let tolerance = 1e-13 * stress.sigma_m() * theta_1;
    let (rear, front) = (integrate(&points, 0.0, theta_m, tolerance), integrate(&points, theta_m, theta_1, tolerance));
    let area = draw.wheel.radius * draw.wheel.width;
    let [normal, drawbar, torque] = [0, 1, 2].map(|i| area * (rear[i] + front[i]));
    Forces { normal, drawbar, torque: torque * draw.wheel.radius }
}

fn assert_close(a: &Forces, b: &Forces, radius: f64, tolerance: f64, what: &str) {
    let of_load = [a.normal - b.normal, a.drawbar - b.drawbar, (a.torque - b.torque) / radius];
    let worst = of_load.iter().fold(0.0_f64, |w, d| w.max(d.abs())) / b.normal;
    assert!(worst < tolerance, "{what}: {worst:e}: {a:?} {b:?}");
}

#[test]
fn analytic_constants_of_the_quadrature_integrate_polynomials_exactly() {
    let powers = |x: f64| [0, 7, 12, 13, 22].map(|k| x.powi(k));
    let exact = [0, 7, 12, 13, 22].map(|k: i32| 2_f64.powi(k + 1) / f64::from(k + 1));
    // So loose that no interval is halved: the 15-point rule alone is exact up to degree 22.
    let found = integrate(&powers, 0.0, 2.0, f64::INFINITY);
    found.iter().zip(exact).for_each(|(found, exact)| assert!((found / exact - 1.0).abs() < 1e-14, "{found} {exact}"));
    let root = integrate(&|x: f64| [x.sqrt()], 0.0, 1.0, 1e-13);
    assert!((root[0] - 2.0 / 3.0).abs() < 1e-12);
}

#[test]
fn analytic_b1_to_b4_are_the_integrals_of_the_linear_stresses() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..2000 {
        let draw = draw(&mut random);
        let stress = of(&draw);
        let expected = integrals(&draw, &stress, |theta| stress.tau(theta));
        assert_close(&stress.forces(), &expected, draw.wheel.radius, EXACT, "(B.1)-(B.4)");
    }
}

#[test]
fn analytic_2_17_and_2_18_are_the_integrals_of_two_triangles() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..500 {
        let draw = draw(&mut random);
        let stress = of(&draw);
        let expected = integrals(&draw, &stress, |theta| stress.triangular_tau(theta));
        assert_close(&stress.triangular(), &expected, draw.wheel.radius, EXACT, "(2.17), (2.18)");
    }
}

/// The h forms against the B forms over the thesis's ranges, at the theta_m that h_1 and h_3 contain: without shear
/// only h_1 and h_3 matter; with it the largest differences are stated.
#[test]
fn agreement_the_groups_h_follow_the_exact_forms() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut worst = [0.0_f64; 3];
    for _ in 0..5000 {
        let theta_1 = random.random_range(25.0_f64..55.0).to_radians();
        let radius = random.random_range(0.03..0.15);
        let soil = Soil {
            cohesion: 0.0,
            friction_angle: random.random_range(20.0_f64..32.0).to_radians(),
            shear_modulus: random.random_range(0.001..0.01),
            exponent: random.random_range(0.2..1.5),
            c1: 0.2,
            c2: 0.309,
            ..Soil::default()
        };
        let wheel = Wheel { radius, ..Wheel::default() };
        let (sinkage, slip) = (radius * (1.0 - theta_1.cos()), random.random_range(0.0..1.0));
        let form = |soil: &Soil| LinearStress::of_soil(&wheel, soil, sinkage, slip).unwrap();
        let smooth = form(&Soil { friction_angle: 0.0, ..soil });
        let (b, h) = (smooth.forces(), smooth.simplified());
        assert_close(&h, &b, radius, GROUPS_WITHOUT_SHEAR, "no shear");
        let (b, h) = (form(&soil).forces(), form(&soil).simplified());
        let differences = [h.normal - b.normal, h.drawbar - b.drawbar, (h.torque - b.torque) / radius];
        worst.iter_mut().zip(differences).for_each(|(w, d)| *w = w.max(d.abs() / b.normal));
    }
    // Stated in the documentation of the module.
    println!("h forms against B forms, largest of W: W {:.4}, DP {:.4}, T/r {:.4}", worst[0], worst[1], worst[2]);
    let stated = [0.022, 0.061, 0.064];
    worst.iter().zip(stated).for_each(|(worst, stated)| assert!(*worst < stated, "{worst} {stated}"));
}

#[test]
fn analytic_2_24_inverts_the_groups() {
    let mut random = ChaCha8Rng::seed_from_u64(4);
    for _ in 0..500 {
        let draw = draw(&mut random);
        let stress = of(&draw);
        let Forces { normal, torque, .. } = stress.simplified();
        let tan_phi = stress.wheel().tan_phi(normal, torque, draw.soil.cohesion);
        let expected = draw.soil.friction_angle.tan();
        // Where the cohesion alone carries nearly all of the torque, little of phi is left in it.
        let cohesive =
            LinearStress::of_soil(&draw.wheel, &Soil { friction_angle: 0.0, ..draw.soil }, draw.sinkage, draw.slip)
                .unwrap();
        let share = 1.0 - cohesive.simplified().torque / torque;
        assert!((tan_phi / expected - 1.0).abs() < INVERTED / share, "{tan_phi} {expected} {share}");
    }
}

#[test]
fn analytic_torque_keeps_its_digits_as_the_shear_vanishes() {
    let (wheel, soil) = (Wheel::<f64>::default(), Soil::<f64>::default());
    let stress = LinearStress::of_soil(&wheel, &soil, 1e-9, 0.0).unwrap();
    // First order in f: T = r^2 b theta_1 f (c/2 + sigma_m tan phi (2 - theta_m/theta_1)/6).
    let (f, a) = (stress.wheel().exponent(), soil.c1);
    let mean = soil.cohesion / 2.0 + stress.sigma_m() * soil.friction_angle.tan() * (2.0 - a) / 6.0;
    let first_order = wheel.radius * wheel.radius * wheel.width * stress.wheel().theta_1() * f * mean;
    let torque = stress.forces().torque;
    assert!(f < 1e-6 && (torque / first_order - 1.0).abs() < f.max(1e-9), "{f} {torque} {first_order}");
}

#[test]
fn property_duals_carry_the_derivative_of_the_forces() {
    let (wheel, soil) = (Wheel::<f64>::default(), Soil::<f64>::default());
    let forces = |sinkage: f64| LinearStress::of_soil(&wheel, &soil, sinkage, 0.3).unwrap().forces();
    let mut sinkage = Dual::<1>::from(0.02);
    sinkage.eps = num_dual::Derivative::some(nalgebra::SVector::from([1.0]));
    let lift = |v: f64| Dual::<1>::from(v);
    let exact = LinearStress::of_soil(&wheel.map(&lift), &soil.map(&lift), sinkage, lift(0.3)).unwrap().forces();
    let step = 1e-7;
    let (plus, minus) = (forces(0.02 + step), forces(0.02 - step));
    for (exact, plus, minus) in [
        (exact.normal, plus.normal, minus.normal),
        (exact.drawbar, plus.drawbar, minus.drawbar),
        (exact.torque, plus.torque, minus.torque),
    ] {
        let slope = exact.eps.unwrap_generic(nalgebra::Const::<1>, nalgebra::U1)[0];
        let difference = (plus - minus) / (2.0 * step);
        assert!((slope / difference - 1.0).abs() < 1e-6, "{slope} {difference}");
    }
}

#[test]
fn property_what_the_forms_are_not_for_is_an_error() {
    let (wheel, soil) = (Wheel::default(), Soil::default());
    let message = |sinkage, slip| LinearStress::of_soil(&wheel, &soil, sinkage, slip).unwrap_err().to_string();
    assert!(message(0.0, 0.1).contains("sinkage = 0 m; the closed forms for linear stresses expect more than 0"));
    assert!(message(0.1, 0.1).contains("sinkage = 0.1 m") && message(f64::NAN, 0.1).contains("sinkage = NaN"));
    assert!(message(0.01, -0.2).contains("slip = -0.2") && message(0.01, 1.2).contains("0 .. 1"));
    assert!(DrivenWheel::new(&wheel, 0.0, 0.01, 0.1).unwrap_err().to_string().contains("shear modulus K = 0 m"));
    let driven = DrivenWheel::new(&wheel, 0.01, 0.01, 0.1).unwrap();
    assert!(LinearStress::new(driven, driven.theta_1(), 1e4, &soil).unwrap_err().to_string().contains("theta_m"));
}
