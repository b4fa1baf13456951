//! How far the two estimates of the largest shear force (4.15) are from the true one, by the full stress integrals.

use bekker::contact::rolling;
use bekker::control::Strength;
use bekker::soil::Soil;
use bekker::wheel::Wheel;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const DRAWS: u64 = 300;

/// A wheel, a soil and a load: sinkage by (4.18) 3 to 30 % of the radius. Ranges of the sources in the vocabulary.
fn draw(seed: u64) -> (Wheel, Soil, f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let wheel = Wheel { radius: rng.random_range(0.05..0.15), width: rng.random_range(0.05..0.15), ..Wheel::default() };
    let soil = Soil {
        cohesion: rng.random_range(0.0..1500.0),
        friction_angle: rng.random_range(24.0_f64..38.0).to_radians(),
        k_phi: rng.random_range(8e5..2e6),
        exponent: rng.random_range(0.8..1.2),
        shear_modulus: rng.random_range(0.005..0.03),
        ..Soil::default()
    };
    let sinkage = wheel.radius * rng.random_range(0.03..0.3_f64);
    let n = soil.exponent;
    let load = (3.0 - n) / 3.0 * wheel.width * soil.modulus(wheel.width) * (2.0 * wheel.radius).sqrt() * sinkage.powf(n + 0.5);
    (wheel, soil, load)
}

/// Largest shear force T/r over all slips under a load, N: the soil's moment over the radius, with the wheel sunk as far
/// as that load and slip ask for.
fn largest_shear(wheel: &Wheel, soil: &Soil, load: f64) -> f64 {
    let at = |slip: f64| {
        let forces = |z: f64| rolling(wheel, soil, 0.0, z, 1.0 - slip, 1.0 / wheel.radius);
        let (mut low, mut high) = (0.0, 0.95 * wheel.radius);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if forces(middle).normal < load { low = middle } else { high = middle }
        }
        forces(high).torque / wheel.radius
    };
    (1..=10).map(|k| at(0.1 * f64::from(k))).fold(0.0, f64::max)
}

/// Mean, least and largest ratio of an estimate to the truth.
fn spread(strength: Strength, shear_modulus: Option<f64>) -> [f64; 3] {
    let ratios: Vec<f64> = (0..DRAWS)
        .map(|seed| {
            let (wheel, mut soil, load) = draw(seed);
            soil.shear_modulus = shear_modulus.unwrap_or(soil.shear_modulus);
            strength.limit(&soil, &wheel, load, 1.0).under(load) / largest_shear(&wheel, &soil, load)
        })
        .collect();
    let mean = ratios.iter().sum::<f64>() / DRAWS as f64;
    [mean, ratios.iter().copied().fold(f64::MAX, f64::min), ratios.iter().copied().fold(0.0, f64::max)]
}

#[test]
fn published_shear_limit_of_the_thesis_overstates_and_mohr_coulomb_hardly() {
    for (name, modulus) in [("K of 5 to 30 mm", None), ("K of 1 mm, all shear mobilised", Some(0.001))] {
        for strength in [Strength::Thesis, Strength::MohrCoulomb, Strength::Mobilised] {
            println!("{name}, {strength:?}: mean, least, largest {:.3?}", spread(strength, modulus));
        }
    }
}
