//! Strength from the full stress integrals: exact without noise, consistent with it, honest about what it cannot tell.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "support/test_wheel.rs"]
mod test_wheel;

use bekker::estimation::soil::{
    Deviations, Reading, SoilIdentification, StrengthFilter, StrengthParameters, Update, fit, friction_angle_at,
    predict,
};
use bekker::soil::Soil;
use nalgebra::{Matrix3, Vector3};
use test_wheel::{NOISE, experiment, sand, truths, wheel};

/// Rounding of the integrals and of the steady points' 1e-12 in the load.
const ROUNDING: f64 = 1e-9;

/// A prior that every soil here lies well within.
fn wide() -> SoilIdentification {
    SoilIdentification { shear_modulus_gain: 1.0, ..SoilIdentification::default() }
}

/// What the filter believes beforehand: another sand.
fn believed() -> Soil {
    sand(800.0, 31.0, 0.015)
}

fn filtered(soil: &Soil, parameters: SoilIdentification, readings: &[Reading], errors: &Deviations) -> StrengthFilter {
    let mut filter = StrengthFilter::new(&wheel(), soil, parameters).unwrap();
    for reading in readings {
        filter.update(reading, errors).unwrap();
    }
    filter
}

#[test]
fn analytic_true_strength_predicts_the_torque_of_the_full_integrals() {
    let soil = sand(400.0, 29.0, 0.012);
    for reading in truths(soil, &test_wheel::LOADS, &test_wheel::SLIPS) {
        let seen = predict(&wheel(), &believed(), &StrengthParameters::of(&soil), &reading);
        assert!((seen.torque - reading.torque).abs() < ROUNDING * reading.torque, "{seen:?} {reading:?}");
        let phi = friction_angle_at(&wheel(), &soil, &reading, soil.cohesion).unwrap();
        assert!((phi - soil.friction_angle).abs() < ROUNDING, "{phi}");
    }
}

#[test]
fn agreement_slopes_are_those_of_differences() {
    /// Central differences with steps of 1e-5 of the quantity leave 1e-8.
    const DIFFERENCE: f64 = 1e-6;
    let strength = StrengthParameters { cohesion: 600.0, friction_angle: 0.5, shear_modulus: 0.012 };
    let reading = Reading { load: 25.0, torque: 0.4, sinkage: 0.012, slip: 0.3 };
    let at = |x: [f64; 6]| {
        let strength = StrengthParameters { cohesion: x[0], friction_angle: x[1], shear_modulus: x[2].exp() };
        predict(&wheel(), &believed(), &strength, &Reading { load: x[3], sinkage: x[4], slip: x[5], ..reading })
    };
    let x = [600.0, 0.5, 0.012_f64.ln(), 25.0, 0.012, 0.3];
    let slopes = predict(&wheel(), &believed(), &strength, &reading);
    for k in 0..6 {
        let step = 1e-5 * x[k].abs();
        let moved = |sign: f64| {
            let mut moved = x;
            moved[k] += sign * step;
            at(moved).torque
        };
        let expected = (moved(1.0) - moved(-1.0)) / (2.0 * step);
        let slope = if k < 3 { slopes.by_strength[k] } else { slopes.by_input[k - 3] };
        assert!((slope - expected).abs() < DIFFERENCE * expected.abs(), "{k}: {slope} {expected}");
    }
}

#[test]
fn agreement_recursion_equals_the_batch_fit() {
    /// Of a standard deviation. While all readings are held: how far the estimate may leave the point of their slopes.
    /// With 64 of 96 absorbed: the slopes that they had when they were.
    const OF_DEVIATION: [(usize, f64); 2] = [(2, 0.02), (6, 0.25)];
    let soil = sand(900.0, 29.0, 0.012);
    for (rounds, of_deviation) in OF_DEVIATION {
        let mut worst = 0.0_f64;
        for seed in 0..8 {
            let points = experiment(soil, NOISE, seed, rounds);
            let readings: Vec<Reading> = points.iter().map(|point| point.reading).collect();
            let filter = filtered(&believed(), wide(), &readings, &NOISE);
            let all: Vec<_> = readings.iter().map(|&reading| (reading, NOISE)).collect();
            let batch = fit(&wheel(), &believed(), &wide(), &all).unwrap();
            for k in 0..3 {
                let (recursive, variance) = (filter.mean()[k], batch.covariance[k][k]);
                worst = worst.max((recursive - batch.mean[k]).abs() / variance.sqrt());
                let ratio = filter.covariance()[k][k] / variance;
                assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
            }
        }
        println!("{} readings: at most {worst:.4} standard deviations apart", 16 * rounds);
        assert!(worst < of_deviation, "{worst}");
    }
}

#[test]
fn property_estimates_are_unbiased_and_consistent_over_seeds() {
    /// Experiments, and 5 standard errors of the means over them, which one soil in a million leaves.
    const SEEDS: u64 = 200;
    const ERRORS: f64 = 5.0;
    let soil = sand(900.0, 29.0, 0.012);
    let truth = Vector3::new(soil.cohesion, soil.friction_angle, soil.shear_modulus.ln());
    // The prior must be about the truth for its part of the error to be as its covariance says: it is drawn.
    let (mut nees, mut nis, mut off, mut count) = (0.0, 0.0, Vector3::zeros(), 0);
    for seed in 0..SEEDS {
        let mut stream = bekker_reproduction::instruments::NormalNoise::new(90_000 + seed);
        let parameters = SoilIdentification {
            cohesion_deviation: 300.0,
            friction_angle_deviation: 0.05,
            shear_modulus_deviation: 0.2,
            ..wide()
        };
        let prior = Soil {
            cohesion: (soil.cohesion + stream.draw(300.0)).max(0.0),
            friction_angle: soil.friction_angle + stream.draw(0.05),
            shear_modulus: soil.shear_modulus * stream.draw(0.2).exp(),
            ..soil
        };
        let mut filter = StrengthFilter::new(&wheel(), &prior, parameters).unwrap();
        for point in experiment(soil, NOISE, seed, 2) {
            let Update::Used { nis: one } = filter.update(&point.reading, &NOISE).unwrap() else { panic!("refused") };
            nis += one;
            count += 1;
        }
        let error = Vector3::from(filter.mean()) - truth;
        let covariance = Matrix3::from(filter.covariance());
        nees += error.dot(&(covariance.try_inverse().unwrap() * error));
        off += Vector3::from_fn(|k, _| error[k] / covariance[(k, k)].sqrt());
    }
    let seeds = SEEDS as f64;
    let (nees, nis, off) = (nees / seeds, nis / f64::from(count), off / seeds);
    println!("NEES {nees:.3} of 3, NIS {nis:.3} of 1, mean error {off:?} standard deviations");
    // A chi-squared variable of k degrees has the variance 2 k; a normalised error has 1.
    assert!((nees - 3.0).abs() < ERRORS * (6.0 / seeds).sqrt(), "NEES {nees}");
    assert!((nis - 1.0).abs() < ERRORS * (2.0 / f64::from(count)).sqrt(), "NIS {nis}");
    assert!(off.amax() < ERRORS / seeds.sqrt(), "{off:?}");
}

#[test]
fn property_one_load_and_slip_settle_one_combination_only() {
    let soil = sand(900.0, 29.0, 0.012);
    let left = |loads: &[f64], slips: &[f64]| {
        let readings = truths(soil, loads, slips).repeat(400 / (loads.len() * slips.len()));
        filtered(&soil, wide(), &readings, &NOISE).directions().map(|direction| direction.left)
    };
    let (one, all) = (left(&[20.0], &[0.3]), left(&[10.0, 30.0, 50.0], &[0.05, 0.2, 0.7]));
    let (loads, slips) = (left(&[10.0, 30.0, 50.0], &[0.3]), left(&[20.0], &[0.05, 0.2, 0.7]));
    println!("left of the prior: one point {one:?}, loads {loads:?}, slips {slips:?}, both {all:?}");
    assert!(one[0] < 0.05 && one[1] > 0.999 && one[2] > 0.999, "{one:?}");
    assert!(all.iter().all(|left| *left < 0.5), "{all:?}");
}

#[test]
fn property_a_considered_modulus_widens_the_estimate_and_stays() {
    let soil = sand(900.0, 29.0, 0.012);
    let readings: Vec<Reading> = experiment(soil, NOISE, 3, 5).iter().map(|point| point.reading).collect();
    let run = |deviation: f64| {
        let parameters = SoilIdentification {
            shear_modulus_gain: 0.0,
            shear_modulus_deviation: deviation,
            ..SoilIdentification::default()
        };
        filtered(&believed(), parameters, &readings, &NOISE)
    };
    let (known, considered) = (run(0.0), run(0.5));
    assert_eq!(considered.mean()[2], believed().shear_modulus.ln());
    assert!((considered.covariance()[2][2] - 0.25).abs() < 1e-12);
    assert_eq!(known.covariance()[2], [0.0; 3]);
    assert!(considered.covariance()[1][1] > 2.0 * known.covariance()[1][1]);
    // K is wrong by 22 %: the considered one's interval knows, the known one's does not.
    let off =
        |filter: &StrengthFilter| (filter.mean()[1] - soil.friction_angle).abs() / filter.covariance()[1][1].sqrt();
    println!(
        "phi off by {:.2} deviations with K considered, {:.2} with K taken for known",
        off(&considered),
        off(&known)
    );
    assert!(off(&considered) < 3.0);
}

#[test]
fn property_forgetting_follows_a_soil_that_changes() {
    let (before, after) = (sand(900.0, 26.0, 0.012), sand(900.0, 33.0, 0.012));
    let error = |forgetting: f64| {
        let parameters = SoilIdentification {
            forgetting,
            shear_modulus_deviation: 0.0,
            cohesion_deviation: 100.0,
            gate: 1e3,
            ..SoilIdentification::default()
        };
        let mut filter = StrengthFilter::new(&wheel(), &Soil { friction_angle: 0.5, ..before }, parameters).unwrap();
        for soil in [before, after] {
            for point in experiment(soil, NOISE, 5, 10) {
                filter.forget(0.05);
                filter.update(&point.reading, &NOISE).unwrap();
            }
        }
        (filter.mean()[1] - after.friction_angle).to_degrees().abs()
    };
    let (never, quickly) = (error(0.0), error(1.0));
    println!("off by {never:.2} deg without forgetting, {quickly:.2} deg with a length of 1 m");
    assert!(never > 2.0 && quickly < 0.5);
}

#[test]
fn property_forgetting_goes_to_the_prior_and_no_further() {
    let mut filter = filtered(
        &believed(),
        SoilIdentification { forgetting: 2.0, ..wide() },
        &truths(sand(300.0, 27.0, 0.01), &[10.0, 40.0], &[0.2, 0.6]),
        &NOISE,
    );
    filter.forget(1e3);
    let fresh = StrengthFilter::new(&wheel(), &believed(), SoilIdentification { forgetting: 2.0, ..wide() }).unwrap();
    for k in 0..3 {
        let (variance, prior) = (filter.covariance()[k][k], fresh.covariance()[k][k]);
        assert!((filter.mean()[k] - fresh.mean()[k]).abs() < 1e-3 * prior.sqrt());
        assert!(variance <= prior && variance > 0.99 * prior, "{variance} {prior}");
    }
}

#[test]
fn property_outliers_and_nonsense_change_nothing() {
    let soil = sand(900.0, 29.0, 0.012);
    let readings: Vec<Reading> = experiment(soil, NOISE, 1, 2).iter().map(|point| point.reading).collect();
    let mut filter = filtered(&believed(), wide(), &readings, &NOISE);
    let before = filter.clone();
    let outlier = Reading { torque: 3.0 * readings[0].torque, ..readings[0] };
    assert!(matches!(filter.update(&outlier, &NOISE).unwrap(), Update::Refused { .. }));
    assert_eq!(filter, before);
    for bad in [
        Reading { load: 0.0, ..readings[0] },
        Reading { torque: f64::NAN, ..readings[0] },
        Reading { sinkage: 0.073, ..readings[0] },
        Reading { slip: -0.01, ..readings[0] },
    ] {
        filter.update(&bad, &NOISE).unwrap_err();
        assert_eq!(filter, before);
    }
}

#[test]
fn property_without_cohesion_the_reported_strength_stays_within_the_bounds_and_the_mean_unbiased() {
    /// 5 standard errors of the mean over the seeds.
    const SEEDS: u64 = 60;
    let soil = sand(0.0, 29.0, 0.012);
    let mut sum = 0.0;
    for seed in 0..SEEDS {
        let readings: Vec<Reading> = experiment(soil, NOISE, 500 + seed, 2).iter().map(|point| point.reading).collect();
        let parameters = SoilIdentification { shear_modulus_deviation: 0.0, cohesion_deviation: 2000.0, ..wide() };
        let filter = filtered(&Soil { cohesion: 0.0, ..soil }, parameters, &readings, &NOISE);
        assert!(filter.strength().cohesion >= 0.0);
        sum += filter.mean()[0] / filter.covariance()[0][0].sqrt();
    }
    let mean = sum / SEEDS as f64;
    println!("mean cohesion {mean:.3} standard deviations");
    assert!(mean.abs() < 5.0 / (SEEDS as f64).sqrt(), "{mean}");
}
