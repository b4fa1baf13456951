//! The direct solution of contact angles against the geometry that it inverts.

use bekker::estimation::contact_angle::{IllConditioned, PairMotion, PairNoise, direct};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::FRAC_PI_2;

const DISTANCE: f64 = 0.7;

/// The arc sine loses half of the digits where a point travels nearly across the line; cases keep 0.1 rad off that, and
/// 0.01 rad off translation, where squares of the speeds cancel.
const ROUNDING: f64 = 1e-9;

/// Motion with directions `beta` below the line at the rear and `theta` above it at the front, (2.29), (2.30).
fn motion(inclination: f64, beta: f64, theta: f64, v1: f64) -> PairMotion {
    let v2 = v1 * beta.cos() / theta.cos();
    PairMotion { inclination, rate: (v2 * theta.sin() + v1 * beta.sin()) / DISTANCE, speeds: [v1, v2] }
}

#[test]
fn analytic_known_directions_are_found_for_all_signs() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut cases = [0; 8];
    for _ in 0..4000 {
        let angle = |rng: &mut ChaCha8Rng| (FRAC_PI_2 - 0.1) * (2.0 * rng.random::<f64>() - 1.0);
        let (beta, theta, alpha) = (angle(&mut rng), angle(&mut rng), angle(&mut rng));
        let forward = rng.random::<f64>() < 0.5;
        let v1 = if forward { 0.05 + rng.random::<f64>() } else { -0.05 - rng.random::<f64>() };
        if (beta + theta).abs() < 0.01 {
            continue;
        }
        let solution = direct(DISTANCE, &motion(alpha, beta, theta, v1), &PairNoise::default()).expect("a solution");
        assert!((solution.angles[0] - (alpha - beta)).abs() < ROUNDING, "{beta} {theta} {v1}: {solution:?}");
        assert!((solution.angles[1] - (alpha + theta)).abs() < ROUNDING, "{beta} {theta} {v1}: {solution:?}");
        assert!(!solution.rotation);
        cases[usize::from(beta > 0.0) + 2 * usize::from(theta > 0.0) + 4 * usize::from(forward)] += 1;
    }
    assert!(cases.iter().all(|count| *count > 300), "{cases:?}");
}

#[test]
fn analytic_a_bar_on_a_circle_travels_along_its_chord_at_both_ends() {
    // Two wheels on a valley of radius R: speeds R alpha', directions half the chord's angle off the line.
    let (radius, rate) = (2.0, 0.1);
    let half = (DISTANCE / (2.0 * radius)).asin();
    let motion = PairMotion { inclination: 0.3, rate, speeds: [radius * rate; 2] };
    let solution = direct(DISTANCE, &motion, &PairNoise::default()).expect("a solution");
    assert!((solution.angles[0] - (0.3 - half)).abs() < ROUNDING, "{solution:?}");
    assert!((solution.angles[1] - (0.3 + half)).abs() < ROUNDING, "{solution:?}");
    // On a crest it turns the other way.
    let crest = PairMotion { rate: -rate, ..motion };
    let solution = direct(DISTANCE, &crest, &PairNoise::default()).expect("a solution");
    assert!((solution.angles[0] - (0.3 + half)).abs() < ROUNDING, "{solution:?}");
}

#[test]
fn analytic_rest_and_translation_are_reported() {
    let none = PairNoise::default();
    let rest = PairMotion { inclination: 0.2, ..PairMotion::default() };
    assert_eq!(direct(DISTANCE, &rest, &none), Err(IllConditioned::Stationary));
    let translation = PairMotion { speeds: [0.2; 2], ..rest };
    assert_eq!(direct(DISTANCE, &translation, &none), Err(IllConditioned::Translation));
    // Within three deviations of either.
    let noise = PairNoise { inclination: 0.01, rate: 0.01, speeds: [0.01; 2] };
    let slow = PairMotion { rate: 1.0, speeds: [0.02, -0.025], ..rest };
    assert_eq!(direct(DISTANCE, &slow, &noise), Err(IllConditioned::Stationary));
    let turning = PairMotion { rate: 0.029, speeds: [0.2, 0.21], ..rest };
    assert_eq!(direct(DISTANCE, &turning, &noise), Err(IllConditioned::Translation));
    // Speeds that differ by more than the line turns.
    let slipping = PairMotion { rate: 0.1, speeds: [0.2, 0.4], ..rest };
    assert_eq!(direct(DISTANCE, &slipping, &none), Err(IllConditioned::Inconsistent));
    assert_eq!(
        direct(DISTANCE, &PairMotion { speeds: [0.0, 0.2], ..slipping }, &none),
        Err(IllConditioned::Inconsistent)
    );
}

#[test]
fn analytic_rotation_follows_by_inspection() {
    // About a point on the line: gamma_1 = alpha - pi/2 sgn alpha', gamma_2 = alpha + pi/2 sgn alpha' at positive speeds.
    for (rate, share) in [(0.4, 0.5), (0.4, 0.2), (-0.4, 0.7)] {
        let w = DISTANCE * f64::abs(rate);
        let motion = PairMotion { inclination: 0.1, rate, speeds: [w * share, w * (1.0 - share)] };
        let solution = direct(DISTANCE, &motion, &PairNoise::default()).expect("a solution");
        assert!(solution.rotation, "{solution:?}");
        let quarter = FRAC_PI_2.copysign(rate);
        assert!((solution.angles[0] - (0.1 - quarter)).abs() < ROUNDING, "{solution:?}");
        assert!((solution.angles[1] - (0.1 + quarter)).abs() < ROUNDING, "{solution:?}");
    }
    // The thesis's b = -1, a wheel that runs backward: its direction is turned about.
    let motion = PairMotion { inclination: 0.1, rate: 0.4, speeds: [0.5 * 0.4 * DISTANCE, -0.5 * 0.4 * DISTANCE] };
    let solution = direct(DISTANCE, &motion, &PairNoise::default()).expect("a solution");
    assert!(solution.rotation && (solution.angles[1] - (0.1 - FRAC_PI_2)).abs() < ROUNDING, "{solution:?}");
}

/// 4000 draws give a deviation to 1.1 %; noise of 2 % of the speeds bends the solution by some per cent more.
const DEVIATION_ERROR: f64 = 0.1;

#[test]
fn agreement_deviations_are_those_of_many_draws() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for (beta, theta) in [(0.3, 0.5), (-0.4, 0.9), (0.6, 0.1), (-0.8, -0.3)] {
        let exact = motion(0.1, beta, theta, 0.2);
        let noise = PairNoise { inclination: 0.01, rate: 0.003, speeds: [0.002, 0.001] };
        let predicted = direct(DISTANCE, &exact, &noise).expect("a solution").deviations;
        let mut squares = [0.0; 2];
        const DRAWS: usize = 4000;
        for _ in 0..DRAWS {
            // Sum of twelve uniform numbers: variance 1.
            let mut draw = |deviation: f64| deviation * ((0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0);
            let [v1, v2] = exact.speeds;
            let noisy = PairMotion {
                inclination: 0.1 + draw(noise.inclination),
                rate: exact.rate + draw(noise.rate),
                speeds: [v1 + draw(noise.speeds[0]), v2 + draw(noise.speeds[1])],
            };
            let found = direct(DISTANCE, &noisy, &noise).expect("a solution").angles;
            squares[0] += (found[0] - (0.1 - beta)).powi(2);
            squares[1] += (found[1] - (0.1 + theta)).powi(2);
        }
        for (square, predicted) in squares.iter().zip(predicted) {
            let deviation = (square / DRAWS as f64).sqrt();
            assert!((deviation / predicted - 1.0).abs() < DEVIATION_ERROR, "{beta} {theta}: {deviation}, {predicted}");
        }
    }
}

#[test]
fn analytic_a_common_slip_shrinks_the_angles_to_the_line() {
    // Speeds from rims that slip by 20 % are 1/0.8 of the true ones: sin(gamma - alpha) loses its part that is even in v.
    let exact = motion(0.0, 0.05, 0.12, 0.2);
    let biased = PairMotion { speeds: exact.speeds.map(|v| v / 0.8), ..exact };
    let found = direct(DISTANCE, &biased, &PairNoise::default());
    let [v1, v2] = biased.speeds;
    let w = DISTANCE * exact.rate;
    let sin = ((v1 - v2) * (v1 + v2) + w * w) / (2.0 * v1 * w);
    let found = found.expect("a solution");
    assert!((found.angles[0] + sin.asin()).abs() < ROUNDING);
    // The difference of the directions is l alpha'/v, too small by the slip.
    let difference = found.angles[1] - found.angles[0];
    assert!((difference / 0.17 - 0.8).abs() < 0.01, "{difference}");
}
