//! The identifier on board: readings from a simulated rover's sensors, no information, no allocation.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "support/counting.rs"]
mod counting;

use bekker::estimation::EstimationError;
use bekker::estimation::consistency::chi_square_interval;
use bekker::estimation::soil::{KinematicSinkage, SoilIdentification, SoilIdentifier, WheelUse};
use bekker::model::{Model, nominal};
use bekker::rover::Rover;
use bekker::signals::{LinkMeasurement, Measurement, WheelMeasurement};
use bekker::soil::Soil;
use bekker_reproduction::on_board::{OnBoard, SensorNoise};

const NO_NOISE: SensorNoise =
    SensorNoise { angle: 0.0, velocity: 0.0, wheel_speed: 0.0, torque: 0.0, contact_angle: 0.0 };
const NOISE: SensorNoise =
    SensorNoise { angle: 0.002, velocity: 0.002, wheel_speed: 0.01, torque: 0.02, contact_angle: 0.01 };

/// The thesis's two-wheeled rover on its soil with K = 1 cm, on which it drives.
fn rover() -> Rover {
    Rover { soil: Soil { shear_modulus: 0.01, ..Soil::default() }, ..Rover::two_wheeled() }
}

/// The same in the data sheet, but for the strength.
fn believed() -> Rover {
    let soil = Soil { cohesion: 500.0, friction_angle: 33.0_f64.to_radians(), ..rover().soil };
    Rover { soil, ..rover() }
}

fn settings() -> SoilIdentification {
    SoilIdentification { shear_modulus_deviation: 0.0, averaging: 0.0, ..SoilIdentification::default() }
}

fn measured(speeds: [f64; 2], torques: [f64; 2], velocity: f64) -> Measurement {
    let wheel = |k: usize| WheelMeasurement { speed: speeds[k], torque: torques[k], contact_angle: 0.0 };
    Measurement { velocity, wheels: vec![wheel(0), wheel(1)], ..Measurement::default() }
}

/// Wheel speeds that change with time, so that slips of both wheels vary.
fn speeds(time: f64) -> [f64; 2] {
    [2.0 + 0.8 * (0.9 * time).sin(), 2.0 + 0.8 * (0.55 * time).cos()]
}

#[test]
fn property_strength_is_found_while_driving() {
    const SEEDS: u64 = 40;
    // As good as the inputs are here: loads of a slow rover on flat ground, sinkages on known moduli.
    let good = SoilIdentification {
        load_error: 0.005,
        sinkage_error: 0.003,
        correlation_time: 0.2,
        cohesion_deviation: 500.0,
        averaging: 0.2,
        ..settings()
    };
    let truth = rover().soil;
    let mut nees = 0.0;
    for seed in 0..SEEDS {
        let mut rover = OnBoard::new(rover(), NOISE, seed, (0.002, 10)).unwrap();
        let mut identifier = SoilIdentifier::new(&nominal(&believed()), good).unwrap();
        for step in 0..1000 {
            rover.advance(&speeds(f64::from(step) * 0.02)).unwrap();
            identifier.update(rover.measured()).unwrap();
        }
        let (found, [[cc, cp, _], [_, pp, _], _]) = (identifier.strength(), identifier.covariance());
        let (c, phi) = (found.cohesion - truth.cohesion, found.friction_angle - truth.friction_angle);
        let one = (pp * c * c - 2.0 * cp * c * phi + cc * phi * phi) / (cc * pp - cp * cp);
        let left = identifier.directions().map(|direction| direction.left);
        println!(
            "seed {seed}: c {:.0} +- {:.0} Pa, phi {:.2} +- {:.2} deg, NEES {one:.2}, left {left:.3?}",
            found.cohesion,
            cc.sqrt(),
            found.friction_angle.to_degrees(),
            pp.sqrt().to_degrees()
        );
        nees += one / SEEDS as f64;
        // Loads that are nearly the same settle one combination of c and phi well, and the other hardly.
        assert!(left[1] < 0.05 && left[2] > 5.0 * left[1], "{left:?}");
    }
    // Errors are as large as the covariance says: 2 unknowns, 40 drives.
    let [low, high] = chi_square_interval(2, SEEDS as usize);
    assert!(nees > low && nees < high, "NEES {nees}, expected {low:.2} to {high:.2}");
}

#[test]
fn agreement_loads_are_those_of_the_simulation() {
    /// Of the mean load: accelerations, damping of the soil and the share of resistance that the wheels do not have alike.
    const ERROR: f64 = 0.03;
    let waves = Model::preset("gentle_rtc").unwrap().rover.terrain;
    let four = Rover { soil: rover().soil, ..Rover::rigid(&[-0.35, -0.1, 0.1, 0.35]) };
    let vehicles = [(Rover { terrain: waves, ..rover() }, 1.5), (Rover::rocker_bogie(), 1.0), (four, 1.0)];
    for (vehicle, speed) in vehicles {
        let mut rover = OnBoard::new(vehicle, NO_NOISE, 0, (0.002, 10)).unwrap();
        let wheels = rover.simulation().rover().wheels.len();
        let sheet = nominal(rover.simulation().rover());
        let free = SoilIdentification { minimum_slip: 0.0, velocity_noise: 0.0, wheel_speed_noise: 0.0, ..settings() };
        let mut identifier = SoilIdentifier::new(&sheet, free).unwrap();
        let (mut sum, mut count, mut steepest) = (0.0, 0.0, 0.0_f64);
        for step in 0..800 {
            rover.advance(&vec![speed; wheels]).unwrap();
            identifier.update(rover.measured()).unwrap();
            for (k, wheel) in rover.simulation().signals().wheels.iter().enumerate() {
                if let Some((reading, _)) = identifier.reading(k).filter(|_| step > 50) {
                    sum += (reading.load - wheel.normal_force).powi(2);
                    count += 1.0;
                    steepest = steepest.max(wheel.contact_angle.abs().to_degrees());
                    assert!((reading.slip - wheel.slip).abs() < 0.01, "{} {}", reading.slip, wheel.slip);
                }
            }
        }
        let error = (sum / count).sqrt() / (sheet.weight() / wheels as f64);
        println!(
            "{wheels} wheels, slopes to {steepest:.1} deg: RMS error of the loads {:.2} % of the mean, {count} readings",
            100.0 * error
        );
        assert!(count > 300.0 && error < ERROR, "{error}");
    }
}

#[test]
fn property_no_information_changes_nothing() {
    let mut identifier = SoilIdentifier::new(&nominal(&believed()), settings()).unwrap();
    // First something to lose.
    identifier.update(&Measurement { time: 1.0, ..measured([3.0, 3.0], [1.5, 1.5], 0.2) }).unwrap();
    assert!(identifier.informed());
    let kept = |identifier: &SoilIdentifier| (identifier.strength(), identifier.covariance());
    let before = kept(&identifier);
    let all = |used: WheelUse| vec![used; 2];
    for (reading, uses) in [
        (measured([0.0, 0.0], [0.0, 0.0], 0.0), all(WheelUse::Standing)),
        (measured([-2.0, -2.0], [-1.5, -1.5], -0.15), all(WheelUse::Reversing)),
        (measured([2.0, 2.0], [1.5, 1.5], -0.1), all(WheelUse::Reversing)),
        (measured([2.0, 2.0], [0.4, 0.4], 0.199), all(WheelUse::NoSlip)),
        (measured([1.0, 1.0], [0.1, 0.1], 0.2), all(WheelUse::NoSlip)),
    ] {
        identifier.update(&Measurement { time: 2.0, ..reading }).unwrap();
        assert_eq!(identifier.uses(), uses);
        assert!(!identifier.informed());
        assert_eq!(kept(&identifier), before);
    }
}

#[test]
fn property_a_wheel_off_the_ground_is_left_out() {
    let mut sheet = nominal(&believed());
    sheet.centre_of_mass = [0.345, 0.0];
    let mut identifier = SoilIdentifier::new(&sheet, settings()).unwrap();
    identifier.update(&measured([3.0, 3.0], [0.0, 0.4], 0.25)).unwrap();
    assert_eq!(identifier.uses()[0], WheelUse::OffGround);
    assert_ne!(identifier.uses()[1], WheelUse::OffGround);
}

#[test]
fn property_bad_readings_are_named_and_change_nothing() {
    let mut identifier = SoilIdentifier::new(&nominal(&believed()), settings()).unwrap();
    let before = identifier.clone();
    let mut bad = measured([3.0, 3.0], [1.5, 1.5], 0.2);
    bad.wheels[1].torque = f64::NAN;
    let error = identifier.update(&bad).unwrap_err();
    assert!(error.to_string().contains("measured torque of wheel 2"), "{error}");
    let short = Measurement { wheels: vec![WheelMeasurement::default()], ..measured([0.0; 2], [0.0; 2], 0.0) };
    let error = identifier.update(&short).unwrap_err();
    assert!(matches!(error, EstimationError::Count { what: "wheels", expected: 2, found: 1 }));
    assert_eq!(identifier, before);
    let wrong = SoilIdentification { gate: 0.5, ..settings() };
    assert!(matches!(SoilIdentifier::new(&nominal(&believed()), wrong), Err(EstimationError::Parameter { .. })));
}

#[test]
fn analytic_sinkage_follows_from_pitch_and_joint() {
    /// Rounding.
    const EXACT: f64 = 1e-15;
    let delta = 0.03_f64;
    let sheet = nominal(&rover());
    let start = measured([0.0; 2], [0.0; 2], 0.0);
    let sinkage = KinematicSinkage::from(&sheet, &start).unwrap();
    let change = sinkage.change(&Measurement { pitch: delta, ..start }, 0, |_| true).unwrap().unwrap();
    assert!((change.mean - 0.7 * delta.sin()).abs() < EXACT && change.loops == 1);
    // The rocker turns nose up about the bogie's pivot, 0.3 m ahead of and 5 cm above the rear wheel; the bogie stays.
    let sheet = nominal(&Rover::rocker_bogie());
    let start = Measurement {
        wheels: vec![WheelMeasurement::default(); 3],
        links: vec![LinkMeasurement::default()],
        ..Measurement::default()
    };
    let sinkage = KinematicSinkage::from(&sheet, &start).unwrap();
    let links = vec![LinkMeasurement { angle: -delta, rate: 0.0 }];
    let change = sinkage.change(&Measurement { pitch: delta, links, ..start }, 0, |_| true).unwrap().unwrap();
    let expected = 0.3 * delta.sin() - 0.05 * (1.0 - delta.cos());
    assert!((change.mean - expected).abs() < EXACT && change.spread < EXACT && change.loops == 2, "{change:?}");
}

#[test]
fn property_an_update_allocates_nothing() {
    let parameters = SoilIdentification { forgetting: 0.1, shear_modulus_gain: 1.0, ..SoilIdentification::default() };
    let mut identifier = SoilIdentifier::new(&nominal(&believed()), parameters).unwrap();
    let mut rover = OnBoard::new(rover(), NOISE, 1, (0.002, 10)).unwrap();
    rover.advance(&[2.0, 2.0]).unwrap();
    identifier.start_experiment(rover.measured()).unwrap();
    let mut used = 0;
    for step in 0..100 {
        rover.advance(&speeds(f64::from(step) * 0.02)).unwrap();
        let reading = rover.measured().clone();
        let count = counting::allocations(|| identifier.update(&reading).unwrap());
        assert_eq!(count, 0, "step {step}");
        used += usize::from(identifier.informed());
    }
    assert!(used >= 8, "{used} of 100 updates used");
}

#[test]
fn property_a_jerk_is_no_reading_of_the_soil() {
    let averaging = SoilIdentification { averaging: 0.2, load_error: 0.005, ..settings() };
    let mut identifier = SoilIdentifier::new(&nominal(&believed()), averaging).unwrap();
    let drive = |identifier: &mut SoilIdentifier, from: f64, velocity: fn(f64) -> f64| {
        for step in 0..10 {
            let since = 0.02 * f64::from(step);
            let reading = measured([3.0, 3.0], [1.5, 1.5], velocity(since));
            identifier.update(&Measurement { time: from + since, ..reading }).unwrap();
        }
        identifier.uses().to_vec()
    };
    // The balance of the loads knows no inertia: half a g of it is no slip's doing.
    assert_eq!(drive(&mut identifier, 0.0, |since| 0.5 * since), [WheelUse::Accelerating; 2]);
    let steady = drive(&mut identifier, 0.2, |_| 0.2);
    assert!(steady.iter().all(|used| matches!(used, WheelUse::Used(_))), "{steady:?}");
}
