//! Shapes of the ground: C1 everywhere, derivatives that are derivatives, samples without overshoot, random ground with its spectrum.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::scalar::Dual;
use bekker::soil::Soil;
use bekker::terrain::{
    Ditch, Profile, Random, Rocks, Samples, Slope, SoilColumn, SoilTable, Spectrum, Step, Terrain, Waves,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// Rounding of a few operations on numbers of order 1.
const ROUNDING: f64 = 1e-12;
/// Central differences over 1e-5 m of functions whose third derivative is below 1e4 per metre cubed.
const DIFFERENCES: f64 = 1e-6;
/// Mean over 400 longest wavelengths and 50 seeds against the ensemble: three standard errors of the longest waves.
const STATISTICS: f64 = 0.02;

fn sampled(x: &[f64], z: &[f64]) -> Terrain {
    Terrain::new(Profile::Samples(Arc::new(Samples::new(x, z).unwrap())))
}

/// Samples with unequal steps, level parts, jumps and slopes of either sign.
fn rough_samples(draw: &mut ChaCha8Rng) -> (Vec<f64>, Vec<f64>) {
    let mut x = vec![0.0];
    let mut z = vec![0.0];
    for _ in 0..60 {
        x.push(x[x.len() - 1] + 10_f64.powf(draw.random_range(-3.0..0.0)));
        let steps = [0.0, 0.0, 0.01, 0.3, -0.3, -0.01];
        z.push(z[z.len() - 1] + steps[draw.random_range(0..steps.len())]);
    }
    (x, z)
}

#[test]
fn property_samples_are_met_and_never_overshot() {
    let mut draw = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..200 {
        let (x, z) = rough_samples(&mut draw);
        let ground = sampled(&x, &z);
        for i in 0..x.len() - 1 {
            assert!((ground.at(x[i]).height - z[i]).abs() < ROUNDING);
            let (low, high) = (z[i].min(z[i + 1]), z[i].max(z[i + 1]));
            let rising = (z[i + 1] - z[i]).signum();
            for part in 0..=50 {
                // Rounding must not carry the place past the knot, where the next piece may fall.
                let sample = ground.at((x[i] + (x[i + 1] - x[i]) * f64::from(part) / 50.0).min(x[i + 1]));
                assert!(sample.height >= low - ROUNDING && sample.height <= high + ROUNDING, "{x:?} {z:?} {i}");
                let steepest = (high - low) / (x[i + 1] - x[i]);
                assert!(sample.slope * rising >= -ROUNDING * (1.0 + steepest), "not monotone: {x:?} {z:?} {i}");
            }
        }
    }
}

#[test]
fn property_samples_are_c1_at_the_knots_and_straight_beyond() {
    let mut draw = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..200 {
        let (x, z) = rough_samples(&mut draw);
        let ground = sampled(&x, &z);
        for &knot in &x {
            let (before, after) = (ground.at(knot.next_down()), ground.at(knot));
            let curvature = before.curvature.abs().max(after.curvature.abs());
            assert!((before.height - after.height).abs() < ROUNDING, "{x:?} {z:?} {knot}");
            assert!((before.slope - after.slope).abs() < ROUNDING * (1.0 + curvature), "{x:?} {z:?} {knot}");
        }
        let (from, to) = ground.range();
        assert_eq!((from, to), (x[0], x[x.len() - 1]));
        let (end, beyond) = (ground.at(to), ground.at(to + 2.0));
        assert_eq!((beyond.slope, beyond.curvature), (end.slope, 0.0));
        assert!((beyond.height - end.height - 2.0 * end.slope).abs() < 1e-9);
    }
}

#[test]
fn analytic_samples_of_a_line_are_the_line_and_of_a_parabola_nearly_it() {
    let x: Vec<f64> = (0..=40).map(|i| 0.05 * f64::from(i)).collect();
    let line = sampled(&x, &x.iter().map(|x| 0.3 * x - 1.0).collect::<Vec<_>>());
    let parabola = sampled(&x, &x.iter().map(|x| 0.5 * x * x).collect::<Vec<_>>());
    for i in 5..195 {
        let at = 0.01 * f64::from(i);
        let sample = line.at(at);
        assert!((sample.height - 0.3 * at + 1.0).abs() < ROUNDING && (sample.slope - 0.3).abs() < ROUNDING);
        assert!((parabola.at(at).height - 0.5 * at * at).abs() < ROUNDING);
        assert!((parabola.at(at).curvature - 1.0).abs() < 1e-9);
    }
}

/// Step of a difference that stays on one side of the kinks of the soil about a rock, m, and its error: rounding, 1e-16 over the step, and more.
const FINE: f64 = 1e-7;
const FINE_DIFFERENCES: f64 = 1e-5;

/// As many as there can be, up to a size that the model's rovers can cross.
const ROCKS: Rocks = Rocks { rock_coverage: 0.3, largest_rock: 0.3 };

fn formulas() -> Vec<Profile> {
    let spectrum = Spectrum { roughness: 0.03, wavelength: 3.0, exponent: 1.7 };
    vec![
        Profile::Flat,
        Profile::Slope(Slope { slope: -0.2 }),
        Profile::Waves(Waves { amplitude: 0.07, wavelength: 1.3, start: 0.4 }),
        Profile::Ditch(Ditch { depth: 0.2, width: 0.8, position: 2.0 }),
        Profile::Step(Step { height: -0.1, length: 0.3, position: 2.0 }),
        Profile::Random(Random::new(spectrum, 7)),
        Profile::Random(Random::new(spectrum, 7).with_rocks(ROCKS)),
    ]
}

#[test]
fn property_slope_and_curvature_are_the_derivatives() {
    let mut draw = ChaCha8Rng::seed_from_u64(3);
    let (x, z) = rough_samples(&mut draw);
    let (coarse, heights): (Vec<f64>, Vec<f64>) = x.iter().zip(&z).step_by(9).map(|(x, z)| (*x, 0.1 * *z)).unzip();
    let mut grounds: Vec<Terrain> = formulas().into_iter().map(Terrain::new).collect();
    grounds.push(sampled(&coarse, &heights));
    for ground in grounds {
        let mut checked = 0;
        for _ in 0..2000 {
            let (x, h) = (draw.random_range(-1.0..6.0), 1e-5);
            let (before, here, after) = (ground.at(x - h), ground.at(x), ground.at(x + h));
            // Where a jump of the curvature lies between the two there is no derivative to compare.
            if (after.curvature - before.curvature).abs() > 0.05 {
                continue;
            }
            checked += 1;
            let slope = (after.height - before.height) / (2.0 * h);
            let curvature = (after.slope - before.slope) / (2.0 * h);
            assert!((slope - here.slope).abs() < DIFFERENCES, "{ground:?} {x}: {slope} {}", here.slope);
            assert!(
                (curvature - here.curvature).abs() < DIFFERENCES.max(1e-3 * here.curvature.abs()),
                "{ground:?} {x}"
            );
        }
        assert!(checked > 1500, "{ground:?}: {checked} of 2000 compared");
    }
}

#[test]
fn property_formulas_are_c1_at_their_joints() {
    let joints = [(2, 0.4), (3, 1.6), (3, 2.4), (4, 2.0), (4, 2.3)];
    for (which, joint) in joints {
        let ground = Terrain::new(formulas().swap_remove(which));
        let (before, after) = (ground.at(joint - 1e-9), ground.at(joint + 1e-9));
        assert!((before.height - after.height).abs() < 1e-8 && (before.slope - after.slope).abs() < 1e-6);
        assert!((before.curvature - after.curvature).abs() > 0.1, "not a joint: {ground:?} {joint}");
    }
}

#[test]
fn analytic_presets_have_their_dimensions() {
    let at = |profile: &Profile, x: f64| Terrain::new(profile.clone()).at(x);
    let all = formulas();
    assert!((at(&all[2], 0.4 + 0.65).height - 0.14).abs() < ROUNDING, "crest");
    assert!((at(&all[3], 2.0).height + 0.2).abs() < ROUNDING && at(&all[3], 1.6).height == 0.0, "ditch");
    assert!((at(&all[4], 9.0).height + 0.1).abs() < ROUNDING && at(&all[4], 1.9).height == 0.0, "step");
    assert!((at(&all[4], 2.15).slope + 1.5 * 0.1 / 0.3).abs() < ROUNDING, "steepest place of the step");
}

#[test]
fn property_random_ground_has_its_roughness_and_its_spectrum() {
    for (roughness, exponent) in [(0.01, 1.0), (0.05, 2.0), (0.02, 3.0)] {
        let spectrum = Spectrum { roughness, wavelength: 2.0, exponent };
        let (mut heights, mut slopes) = (0.0, 0.0);
        let (seeds, points) = (50, 20_000);
        for seed in 0..seeds {
            let ground = Terrain::new(Profile::Random(Random::new(spectrum, seed)));
            for i in 0..points {
                let sample = ground.at(0.0401 * f64::from(i));
                heights += sample.height * sample.height;
                slopes += sample.slope * sample.slope;
            }
        }
        let count = f64::from(seeds) * f64::from(points);
        let deviation = (heights / count).sqrt();
        assert!((deviation / roughness - 1.0).abs() < STATISTICS, "{deviation} for {roughness}");
        // Mean square slope over mean square height is the mean of k^2 over the spectrum k^-e dk of four octaves,
        // here as 16 terms of equal width in ln k.
        let k = |j: i32| std::f64::consts::PI * (f64::from(j) / 4.0).exp2();
        let moment = |power: f64| (0..16).map(|j| k(j).powf(1.0 - exponent + power)).sum::<f64>();
        let expected = moment(2.0) / moment(0.0);
        assert!((slopes / heights / expected - 1.0).abs() < STATISTICS, "{} {expected}", slopes / heights);
    }
}

#[test]
fn property_random_ground_is_fixed_by_its_seed() {
    let ground = |seed| Terrain::new(Profile::Random(Random::new(Spectrum::default(), seed)));
    assert_eq!(ground(3).at(1.0), ground(3).at(1.0));
    assert_ne!(ground(3).at(1.0).height, ground(4).at(1.0).height);
}

#[test]
fn property_rocks_stand_on_the_ground_and_are_firm() {
    let spectrum = Spectrum { roughness: 0.02, ..Spectrum::default() };
    let bare = Terrain::new(Profile::Random(Random::new(spectrum, 5)));
    let rocky = Terrain::new(Profile::Random(Random::new(spectrum, 5).with_rocks(ROCKS)));
    let soil = Soil::<f64>::default();
    let (mut highest, mut stiffest) = (0.0_f64, 0.0_f64);
    for i in 0..20_000 {
        let x = 0.002 * f64::from(i) - 1.0;
        let (raised, firm) = (rocky.at(x).height - bare.at(x).height, rocky.soil(&soil, x));
        assert!(raised >= 0.0 && (x > 1.0 || raised == 0.0), "{x}: {raised}");
        // A foot too low for its rise to be seen in rounding is firmer too.
        assert!(raised == 0.0 || firm.k_phi > soil.k_phi, "{x}: {firm:?}");
        assert!(firm.cohesion >= 0.0);
        assert!(firm.friction_angle >= soil.friction_angle && firm.friction_angle.tan() <= 0.7 + ROUNDING);
        assert!(firm.shear_modulus <= soil.shear_modulus && firm.shear_modulus >= 0.002 - ROUNDING);
        highest = highest.max(raised);
        stiffest = stiffest.max(firm.k_phi / soil.k_phi);
    }
    // 0.3 times the largest diameter allowed; the largest of the rocks over 38 m is somewhat smaller.
    assert!(highest <= 0.3 * ROCKS.largest_rock && highest > 0.05, "{highest}");
    // On the upper half of a rock.
    assert!((stiffest - 5.0).abs() < 5.0 * ROUNDING, "{stiffest}");
}

#[test]
fn property_no_rocks_are_no_change() {
    let bare = Terrain::new(Profile::Random(Random::new(Spectrum::default(), 5)));
    let none = Rocks { rock_coverage: 0.0, largest_rock: 1.0 };
    let without = Terrain::new(Profile::Random(Random::new(Spectrum::default(), 5).with_rocks(none)));
    let soil = Soil::<f64>::default();
    for i in 0..5000 {
        let x = 0.01 * f64::from(i);
        assert_eq!(bare.at(x), without.at(x));
        assert_eq!(without.soil(&soil, x), soil);
        let centre = [x, bare.at(x).height + 0.1];
        assert_eq!(bare.foot(centre), without.foot(centre));
    }
}

#[test]
fn property_soil_on_a_rock_has_the_derivative_along_x() {
    let ground = Terrain::new(Profile::Random(Random::new(Spectrum::default(), 5).with_rocks(ROCKS)));
    let base = Soil::<f64>::default();
    let dual = |v: f64| Dual::<1>::from(v);
    let slope = |value: Dual<1>| value.eps.unwrap_generic(nalgebra::Const::<1>, nalgebra::U1)[0];
    let (h, mut changing) = (FINE, 0);
    for i in 0..2000 {
        let at = 1.0 + 0.005 * f64::from(i);
        let mut x = dual(at);
        x.eps = num_dual::Derivative::some(nalgebra::SVector::from([1.0]));
        let soil = ground.map(&|v| dual(v)).soil(&base.map(&|v| dual(v)), x);
        let [before, after] = [at - h, at + h].map(|x| ground.soil(&base, x).friction_angle);
        let difference = (after - before) / (2.0 * h);
        // With this seed no place is within a step of a kink, which is where the foot ends or where all is rock.
        assert!((slope(soil.friction_angle) - difference).abs() < FINE_DIFFERENCES * (1.0 + difference.abs()), "{at}");
        changing += usize::from(difference != 0.0);
    }
    assert!(changing > 50, "{changing} places at the foot of a rock");
}

#[test]
fn property_soil_follows_the_table_with_its_derivative() {
    let column = |name: &str, values: [f64; 3]| SoilColumn { name: name.into(), values: values.into() };
    let table = vec![column("k_phi_factor", [1.0, 0.2, 0.6]), column("exponent", [1.0, 0.8, 1.2])];
    let ground = Terrain::<f64>::default().with_soil(SoilTable::new(vec![0.0, 1.0, 3.0], table).unwrap());
    let base = Soil::<f64>::default();
    let mut x = Dual::<1>::from(2.0);
    x.eps = num_dual::Derivative::some(nalgebra::SVector::from([1.0]));
    let soil: Soil<Dual<1>> = ground.map(&|v| Dual::<1>::from(v)).soil(&base.map(&|v| Dual::<1>::from(v)), x);
    let slope = |value: Dual<1>| value.eps.unwrap_generic(nalgebra::Const::<1>, nalgebra::U1)[0];
    assert!(
        (soil.k_phi.re / base.k_phi - 0.4).abs() < ROUNDING && (slope(soil.k_phi) / base.k_phi - 0.2).abs() < ROUNDING
    );
    assert!((soil.exponent.re - 1.0).abs() < ROUNDING && (slope(soil.exponent) - 0.2).abs() < ROUNDING);
    assert_eq!(slope(soil.cohesion), 0.0);
}
