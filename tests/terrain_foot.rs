//! The contact foot is the nearest point of the profile, its frame is orthonormal, and it depends on its arguments alone.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::scalar::{Dual, Scalar};
use bekker::terrain::{Ditch, Profile, Random, Rocks, Samples, Slope, Spectrum, Step, Terrain, TerrainError, Waves};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// A point found by brute force and golden section is no nearer than the foot by more than this, m: rounding.
const NEAREST: f64 = 1e-12;
/// Central differences with a step of 1e-6 m of a function with derivatives of order 100 per metre.
const DIFFERENCES: f64 = 1e-5;
/// Rounding of a few operations on numbers of order 10.
const ROUNDING: f64 = 1e-12;

fn samples(draw: &mut impl Rng, spacing: f64, rough: f64) -> Profile {
    let mut x = vec![-3.0];
    let mut z = vec![0.0];
    while x[x.len() - 1] < 15.0 {
        x.push(x[x.len() - 1] + spacing * draw.random_range(0.3..1.7));
        z.push(0.9 * z[z.len() - 1] + rough * draw.random_range(-1.0..1.0));
    }
    Profile::Samples(Arc::new(Samples::new(&x, &z).unwrap()))
}

/// Grounds from gentle to far rougher than a wheel.
fn grounds(draw: &mut impl Rng) -> Vec<Terrain> {
    let mut all = vec![
        Profile::Flat,
        Profile::Slope(Slope { slope: draw.random_range(-0.9..0.9) }),
        Profile::Waves(Waves { amplitude: 0.05, wavelength: 2.0, start: 0.5 }),
        Profile::Waves(Waves {
            amplitude: draw.random_range(0.0..0.3),
            wavelength: draw.random_range(0.2..2.0),
            start: 1.0,
        }),
        Profile::Ditch(Ditch {
            depth: draw.random_range(-0.3..0.5),
            width: draw.random_range(0.1..1.0),
            position: 2.0,
        }),
        Profile::Step(Step {
            height: draw.random_range(-0.3..0.3),
            length: draw.random_range(0.01..0.5),
            position: 2.0,
        }),
        samples(draw, 0.2, 0.05),
        samples(draw, 0.01, 0.01),
    ];
    for roughness in [0.01, 0.1] {
        let spectrum = Spectrum { roughness, wavelength: 2.0, exponent: draw.random_range(1.0..3.0) };
        let random = Random::new(spectrum, draw.random());
        all.push(Profile::Random(random.clone()));
        all.push(Profile::Random(random.with_rocks(Rocks { rock_coverage: 0.3, largest_rock: 0.4 })));
    }
    all.into_iter().map(Terrain::new).collect()
}

/// A centre up to 0.4 m above or below the ground.
fn centre(draw: &mut impl Rng, ground: &Terrain) -> [f64; 2] {
    let x = draw.random_range(-1.0..10.0);
    [x, ground.at(x).height + draw.random_range(-0.1..0.4)]
}

/// Least distance of the profile from `centre`, by a fine scan refined with golden sections.
fn brute_force(ground: &Terrain, [x, z]: [f64; 2]) -> f64 {
    let distance = |at: f64| (at - x).hypot(ground.at(at).height - z);
    let reach = distance(x);
    let (steps, mut best) = (4000, reach);
    for i in 0..steps {
        let edge = |i: i32| x + reach * (2.0 * f64::from(i) / f64::from(steps) - 1.0);
        let (mut from, mut to) = (edge(i - 1), edge(i + 1));
        if distance(edge(i)) > best + reach * 0.01 {
            continue;
        }
        for _ in 0..60 {
            let (left, right) = (to - 0.618_034 * (to - from), from + 0.618_034 * (to - from));
            if distance(left) < distance(right) { to = right } else { from = left }
        }
        best = best.min(distance(0.5 * (from + to)));
    }
    best
}

#[test]
fn property_foot_is_the_nearest_point() {
    let mut draw = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..12 {
        for ground in grounds(&mut draw) {
            for _ in 0..4 {
                let centre = centre(&mut draw, &ground);
                let foot = ground.foot(centre).unwrap();
                let nearest = brute_force(&ground, centre);
                assert!(foot.distance.abs() <= nearest + NEAREST, "{ground:?} {centre:?}: {} {nearest}", foot.distance);
                let below = centre[1] < ground.at(centre[0]).height;
                assert!((foot.distance < 0.0) == below, "{ground:?} {centre:?}: side");
            }
        }
    }
}

#[test]
fn property_foot_lies_on_the_profile_with_the_centre_on_its_normal() {
    let mut draw = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..100 {
        for ground in grounds(&mut draw) {
            let centre = centre(&mut draw, &ground);
            let foot = ground.foot(centre).unwrap();
            let [x, z] = foot.position;
            let sample = ground.at(x);
            assert!((z - sample.height).abs() < ROUNDING && (foot.angle.tan() - sample.slope).abs() < ROUNDING);
            let [t, n] = [foot.tangent, foot.normal];
            assert!((t[0] * n[0] + t[1] * n[1]).abs() < ROUNDING && t[0] > 0.0 && n[1] > 0.0);
            assert!((t[1].atan2(t[0]) - foot.angle).abs() < ROUNDING);
            for axis in 0..2 {
                let reached = foot.position[axis] + foot.distance * n[axis];
                assert!((reached - centre[axis]).abs() < 1e-9, "{ground:?} {centre:?}: {reached}");
            }
        }
    }
}

#[test]
fn analytic_foot_on_a_slope_and_on_the_flat() {
    let hill = Terrain::new(Profile::Slope(Slope { slope: 0.3 }));
    let (sin, cos) = 0.3_f64.sin_cos();
    let foot = hill.foot([2.0 * cos - 0.2 * sin, 2.0 * sin + 0.2 * cos]).unwrap();
    assert!((foot.distance - 0.2).abs() < ROUNDING && (foot.position[0] - 2.0 * cos).abs() < ROUNDING);
    assert!((foot.angle - 0.3).abs() < ROUNDING);
    let foot = Terrain::default().foot([1.5, -0.1]).unwrap();
    assert_eq!((foot.distance, foot.position, foot.angle), (-0.1, [1.5, 0.0], 0.0));
}

#[test]
fn property_mirrored_samples_mirror_the_foot() {
    let mut draw = ChaCha8Rng::seed_from_u64(3);
    for spacing in [0.05, 0.5] {
        let x: Vec<f64> = (0..40).map(|i| f64::from(i) * spacing).collect();
        let z: Vec<f64> = x.iter().map(|_| draw.random_range(0.0..0.2 * spacing)).collect();
        let mirror = |v: &[f64], sign: f64| v.iter().rev().map(|v| sign * v).collect::<Vec<_>>();
        let ground = Terrain::new(Profile::Samples(Arc::new(Samples::new(&x, &z).unwrap())));
        let mirrored = Samples::new(&mirror(&x, -1.0), &mirror(&z, 1.0)).unwrap();
        let mirrored = Terrain::new(Profile::Samples(Arc::new(mirrored)));
        for i in 0..200 {
            let centre = [spacing * (5.0 + 0.15 * f64::from(i)), 0.3 * spacing + 0.1];
            let (foot, other) = (ground.foot(centre).unwrap(), mirrored.foot([-centre[0], centre[1]]).unwrap());
            assert!((foot.distance - other.distance).abs() < ROUNDING);
        }
    }
}

/// Dual numbers in the centre and in the first parameter of the profile.
fn with_derivatives(ground: &Terrain, centre: [f64; 2]) -> (Terrain<Dual<3>>, [Dual<3>; 2]) {
    use bekker::modeldescription::Parameters;
    let seed = |value: f64, i: usize| {
        let mut dual = Dual::<3>::from(value);
        dual.eps = num_dual::Derivative::some(nalgebra::SVector::from_fn(|row, _| f64::from(u8::from(row == i))));
        dual
    };
    let mut ground = ground.map(&|v| Dual::from(v));
    let mut first = true;
    ground.visit("", &mut |_, value| {
        if std::mem::take(&mut first) {
            *value = seed(value.value(), 2);
        }
    });
    (ground, [seed(centre[0], 0), seed(centre[1], 1)])
}

#[test]
fn property_duals_carry_the_exact_derivatives_of_the_foot() {
    use bekker::modeldescription::Parameters;
    let mut draw = ChaCha8Rng::seed_from_u64(4);
    let step = 1e-6;
    for _ in 0..30 {
        for ground in grounds(&mut draw) {
            let x = draw.random_range(-1.0..10.0);
            // Above gentle ground only: elsewhere the foot may jump between the two differences.
            let bend = (0..=40).map(|i| ground.at(x + 0.01 * f64::from(i - 20)).curvature.abs()).fold(0.0, f64::max);
            let centre = [x, ground.at(x).height + 0.15_f64.min(0.3 / bend)];
            let (duals, lifted) = with_derivatives(&ground, centre);
            let exact = duals.foot(lifted).unwrap();
            for i in 0..3 {
                let moved = |sign: f64| {
                    let (mut ground, mut centre) = (ground.clone(), centre);
                    if i < 2 {
                        centre[i] += sign * step;
                    }
                    let mut first = i == 2;
                    ground.visit("", &mut |_, value| {
                        *value += sign * step * f64::from(u8::from(std::mem::take(&mut first)))
                    });
                    let foot = ground.foot(centre).unwrap();
                    [foot.position[0], foot.position[1], foot.angle, foot.distance, foot.normal[0]]
                };
                let of = [exact.position[0], exact.position[1], exact.angle, exact.distance, exact.normal[0]];
                for ((plus, minus), exact) in moved(1.0).into_iter().zip(moved(-1.0)).zip(of) {
                    let difference = (plus - minus) / (2.0 * step);
                    let exact = exact.eps.unwrap_generic(nalgebra::Const::<3>, nalgebra::U1)[i];
                    let scale = 1.0 + exact.abs();
                    assert!(
                        (difference - exact).abs() < DIFFERENCES * scale * (1.0 + bend),
                        "{ground:?} {centre:?} {i}: {difference} {exact}"
                    );
                }
            }
        }
    }
}

#[test]
fn property_impossible_centres_are_errors() {
    let mut draw = ChaCha8Rng::seed_from_u64(5);
    for ground in grounds(&mut draw) {
        for bad in [[f64::NAN, 0.0], [0.0, f64::INFINITY], [f64::NEG_INFINITY, f64::NAN]] {
            assert!(matches!(ground.foot(bad), Err(TerrainError::NotFinite { .. })), "{ground:?}");
        }
        for far in [[1.0, 1e3], [1.0, -1e300], [2.0, 25.0]] {
            assert!(matches!(ground.foot(far), Err(TerrainError::TooFar { .. })), "{ground:?}");
        }
        assert!(ground.foot([3.0, 19.0]).is_ok() || matches!(ground.profile, Profile::Slope(_)), "{ground:?}");
    }
    let ground = Terrain::new(samples(&mut draw, 0.1, 0.0));
    let (from, to) = ground.range();
    assert_eq!(ground.foot([to + 0.5, 0.1]), Err(TerrainError::Left { x: to + 0.5, from, to }));
    assert!(ground.foot([from, 0.1]).is_ok() && ground.foot([from - 1e-9, 0.1]).is_err());
    let message = ground.foot([to + 0.5, 0.1]).unwrap_err().to_string();
    assert!(message.contains("left the terrain at x = ") && message.contains("from -3 m to"), "{message}");
}
