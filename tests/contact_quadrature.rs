//! The wheel's forces against an independent adaptive quadrature, over all cases of motion.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "support/quadrature.rs"]
mod quadrature;
#[path = "support/wheel_model.rs"]
mod wheel_model;
#[path = "support/wheel_reference.rs"]
mod wheel_reference;

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use wheel_model::forces;
use wheel_reference::Case;

/// The project's bound, of N (of r N for the torque), for 0.5 <= n <= 1.3 and K >= 3 mm.
const ACCURACY: f64 = 1e-6;

/// How the wheel moves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Regime {
    Driving,
    Skidding,
    Locked,
    Opposite,
}

const REGIMES: [Regime; 4] = [Regime::Driving, Regime::Skidding, Regime::Locked, Regime::Opposite];

/// (V, r omega) in m/s; half of them backward.
fn speeds(motion: Regime, random: &mut impl Rng) -> (f64, f64) {
    let slip = random.random_range(0.0..1.0_f64);
    let (v, rim) = match motion {
        // Slip 0 and 1 exactly now and then.
        Regime::Driving => (1.0 - [0.0, 1.0, slip, slip, slip][random.random_range(0..5)], 1.0),
        // Evenly in slip, and down to nearly locked.
        Regime::Skidding => (1.0, [1.0 - slip, 1e-5_f64.powf(slip)][random.random_range(0..2)]),
        Regime::Locked => (1.0, 0.0),
        // Nearer to V = 0 the model turns over smoothly between two limits of the formulas.
        Regime::Opposite => (1.0, -slip / 0.12 * 0.8),
    };
    let speed = 0.1 * if random.random() { 1.0 } else { -1.0 };
    (v * speed, rim * speed)
}

/// A random contact for given n and K, over wheels and soils far beyond those of small rovers. The cohesion is at most
/// the peak pressure: beyond it a wheel does not roll on the soil but hangs on it. For the same reason a contact is
/// drawn again where the shear of a sliding rim takes away more than four fifths of what the pressure carries.
fn draw(random: &mut impl Rng, motion: Regime, n: f64, k: f64) -> Case {
    loop {
        let mut log = |from: f64, to: f64| from * (to / from).powf(random.random());
        let (r, b, k_phi, depth, cohesion) =
            (log(0.03, 0.5), log(0.02, 0.5), log(1e5, 1e7), log(0.002, 0.7), log(1e-4, 1.0));
        let phi = random.random_range(0.0..0.7);
        let (c1, c2) = (random.random_range(0.1..0.6), random.random_range(0.0..0.4));
        let exit = [0.0, 0.0, random.random_range(0.0..1.2)][random.random_range(0..3)];
        let (v, rim) = speeds(motion, random);
        let dry = Case { r, b, k_c: 1e3, k_phi, n, c: 0.0, phi, k, c1, c2, exit, z: depth * r, v, omega: rim / r };
        let case = Case { c: cohesion * dry.sigma(dry.angles().1), ..dry };
        let carried = Case { c: 0.0, phi: 0.0, ..case }.forces()[0];
        if case.forces()[0] > 0.2 * carried {
            return case;
        }
    }
}

/// Largest error of the three forces, of N.
fn error(case: &Case) -> f64 {
    let [normal, drawbar, torque] = case.forces();
    let found = forces(case);
    let errors = [found.normal - normal, found.drawbar - drawbar, (found.torque - torque) / case.r];
    errors.iter().fold(0.0, |worst: f64, error| worst.max(error.abs())) / normal.abs()
}

/// Worst of `draws` random contacts.
fn worst(
    motion: Regime,
    draws: usize,
    random: &mut ChaCha8Rng,
    nk: impl Fn(&mut ChaCha8Rng) -> (f64, f64),
) -> (f64, Case) {
    let mut worst: Option<(f64, Case)> = None;
    for _ in 0..draws {
        let (n, k) = nk(random);
        let case = draw(random, motion, n, k);
        let error = error(&case);
        assert!(error.is_finite(), "{case:?}");
        if worst.is_none_or(|(before, _)| error > before) {
            worst = Some((error, case));
        }
    }
    worst.unwrap()
}

#[test]
fn agreement_forces_are_the_adaptive_integrals() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for motion in REGIMES {
        let (error, case) = worst(motion, 4000, &mut random, |random| {
            // The bounds of the claim themselves now and then.
            let n = [0.5, 1.3, 1.0, random.random_range(0.5..1.3)][random.random_range(0..4)];
            let k = [0.003, 0.003 * 30_f64.powf(random.random())][random.random_range(0..2)];
            (n, k)
        });
        println!("{motion:?}: {error:.1e} of N at {case:?}");
        assert!(error < ACCURACY, "{motion:?}: {error:e} of N at {case:?}");
    }
}

#[test]
fn agreement_outside_the_bound_the_error_is_as_stated() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    // n, K in m, and the error of N that the documentation of `rolling` states for it.
    let outside = [
        (0.3, 0.01, 5e-6),
        (0.4, 0.01, 2e-6),
        (1.6, 0.01, 2e-7),
        (2.0, 0.01, 2e-7),
        (1.0, 0.002, 1e-7),
        (1.0, 0.001, 1e-7),
        (1.0, 0.0003, 1e-7),
    ];
    for (n, k, stated) in outside {
        let of = REGIMES.map(|motion| worst(motion, 500, &mut random, |_| (n, k)));
        let largest = of.iter().fold(0.0, |largest: f64, (error, _)| largest.max(*error));
        println!("n = {n}, K = {} mm: {largest:.1e} of N, stated {stated:e}", k * 1e3);
        assert!(largest < stated, "n = {n}, K = {k}: {largest:e}");
    }
}
