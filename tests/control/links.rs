//! Claims: the balance of jointed vehicles is that of virtual work, and the loads that it gives are those of the
//! simulation at rest.

use crate::control_support::Case;
use bekker::control::{ControlError, Controller, Rtc};
use bekker::model::{ControlKind, Model, nominal};
use bekker::rover::Rover;
use bekker::signals::{Command, LinkMeasurement, Measurement, Reference, WheelMeasurement};
use bekker::simulation::{Simulation, Status};
use bekker::terrain::{Profile, Terrain, Waves};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Difference from virtual work by central differences, in weights and metres.
const ROWS: f64 = 1e-9;
/// Difference of loads, of the weight: the simulation rests within 1e-9 of it, the optimiser stops at 1e-10.
const LOADS: f64 = 1e-7;
/// Miss of the balance by a rover that has stood for some seconds, of the weight: what is left of its settling.
const STANDING: f64 = 1e-6;

#[test]
fn agreement_balance_with_virtual_work() {
    for seed in 0..60 {
        let case = Case::jointed(seed, 3 + seed as usize % 6);
        let (rtc, _) = case.run();
        let ours = &rtc.problem().distribution;
        let (g, f) = case.balance();
        assert_eq!(ours.rows(), g.nrows());
        for row in 0..g.nrows() {
            for wheel in 0..case.angles.len() {
                let [traction, load] = ours.coefficients(row, wheel);
                let apart = (traction - g[(row, 2 * wheel)]).abs().max((load - g[(row, 2 * wheel + 1)]).abs());
                assert!(apart <= ROWS, "row {row}, wheel {wheel}: {apart} m apart in {case:?}");
            }
            let apart = (ours.wanted(row) - f[row]).abs() / case.nominal.weight();
            assert!(apart <= ROWS, "row {row}: {apart} weights m apart in {case:?}");
        }
    }
}

/// A rocker-bogie of random proportions.
fn rocker_bogie(seed: u64) -> Rover {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut rover = Rover::rocker_bogie();
    rover.environment.gravity = [9.81, 3.71, 1.62][rng.random_range(0..3)];
    rover.body.mass = rng.random_range(1.5..4.0);
    rover.body.centre_of_mass_x = rng.random_range(-0.1..0.0);
    let link = &mut rover.links[0].parameters;
    link.mass = rng.random_range(0.3..1.0);
    link.x = rng.random_range(0.05..0.13);
    link.centre_of_mass_x = rng.random_range(0.05..0.15);
    link.centre_of_mass_z = rng.random_range(-0.02..0.05);
    rover
}

/// What ideal sensors say of a simulation.
fn reading(simulation: &Simulation) -> Measurement {
    let (signals, state) = (simulation.signals(), simulation.state());
    let wheel = |wheel: &bekker::signals::WheelSignals| WheelMeasurement {
        contact_angle: wheel.contact_angle,
        speed: wheel.speed,
        torque: wheel.torque,
    };
    let joints = state.position.iter().zip(&state.rate).skip(3);
    Measurement {
        pitch: signals.body.pitch,
        wheels: signals.wheels.iter().map(wheel).collect(),
        links: joints.map(|(&angle, &rate)| LinkMeasurement { angle, rate }).collect(),
        ..Measurement::default()
    }
}

/// A controller after it has seen the simulation, asked to stand.
fn controller_of(simulation: &Simulation) -> Rtc {
    let parameters = bekker::control::RoughTerrainControl { minimum_load: 0.01, ..Default::default() };
    let mut rtc = Rtc::new(nominal(simulation.rover()), parameters).unwrap();
    let mut command = Command::torque(vec![0.0; 3]);
    rtc.command(&reading(simulation), &Reference { velocity: 0.0 }, &mut command).unwrap();
    rtc
}

#[test]
fn agreement_loads_on_the_level_with_the_simulation_at_rest() {
    for seed in 0..12 {
        let simulation = Simulation::new(rocker_bogie(seed), 0.0, 0.002).unwrap();
        let rtc = controller_of(&simulation);
        let (outcome, weight) = (rtc.outcome().unwrap(), rtc.nominal().weight());
        assert!(outcome.feasible);
        for (k, wheel) in simulation.signals().wheels.iter().enumerate() {
            let (ours, true_load) = (outcome.forces[2 * k + 1], wheel.normal_force);
            assert!((ours - true_load).abs() <= LOADS * weight, "wheel {k}: {ours} N, at rest {true_load} N");
        }
        assert!(outcome.forces.iter().step_by(2).all(|pull| pull.abs() <= LOADS * weight), "nothing pulls");
    }
}

#[test]
fn agreement_balance_on_waves_with_the_forces_of_a_standing_rover() {
    let mut held = 0.0_f64;
    for seed in 0..6 {
        let mut rover = rocker_bogie(seed);
        let waves = Waves { amplitude: 0.02, wavelength: 0.55, start: -5.0 };
        rover.terrain = Terrain::new(Profile::Waves(waves));
        let mut simulation = Simulation::new(rover, 0.07 * seed as f64, 0.002).unwrap();
        simulation.advance(&Command::speed(vec![0.0; 3]), 4000).unwrap();
        let rtc = controller_of(&simulation);
        let (balance, weight) = (&rtc.problem().distribution, rtc.nominal().weight());
        let wheels = &simulation.signals().wheels;
        let forces: Vec<f64> = wheels.iter().flat_map(|wheel| [wheel.drawbar_pull, wheel.normal_force]).collect();
        let most = wheels.iter().fold(0.0_f64, |most, wheel| most.max(wheel.drawbar_pull.abs()));
        held = held.max(most / weight);
        // The balance takes forces at the rim; drawbar pull acts at the centre, and the motor's reaction on its body.
        let beside = |wheel: usize| wheels[wheel].torque - rtc.nominal().wheel.radius * wheels[wheel].drawbar_pull;
        for row in 0..balance.rows() {
            let couples: f64 = match row {
                0 | 1 => 0.0,
                2 => (0..3).map(beside).sum(),
                _ => (0..3).filter(|&k| balance.joints[row - 3].carries[k]).map(beside).sum(),
            };
            // The rover stands: nothing but its weight is to be carried.
            let miss = (balance.sum(row, &forces) + couples - balance.wanted(row)).abs();
            assert!(miss <= STANDING * weight, "row {row}, seed {seed}: {} weights are missing", miss / weight);
        }
    }
    assert!(held > 0.01, "the slopes have to be held, by {held} weights at most");
}

#[test]
fn property_rocker_bogie_drives_over_waves_by_rough_terrain_control() {
    let mut model = Model::preset("rocker_bogie_velocity").unwrap();
    model.control.kind = ControlKind::Rtc;
    let mut run = model.start().unwrap();
    // It speeds up at what the ground gives, which is less than what is asked for.
    assert_eq!(run.advance(500).unwrap(), Status::Running);
    for _ in 0..40 {
        assert_eq!(run.advance(50).unwrap(), Status::Running);
        let outcome = run.rtc().unwrap().outcome().unwrap();
        assert!(outcome.feasible && outcome.optimal, "on gentle ground at t = {}", run.time());
    }
    let speed = run.signals().body.x / run.time();
    assert!((0.15..0.26).contains(&speed), "{speed} m/s of 0.25 m/s, without a term for the soil's resistance");
}

#[test]
fn property_links_that_make_no_sense_are_refused() {
    let refused = |change: fn(&mut Case)| {
        let mut case = Case::jointed(1, 6);
        change(&mut case);
        Rtc::new(case.nominal, case.parameters).err().unwrap().to_string()
    };
    assert!(refused(|c| c.nominal.links[0].parent = 1).contains("parent of a link"));
    assert!(refused(|c| c.nominal.links[2].mass = c.nominal.mass).contains("mass of the chassis"));
    assert!(refused(|c| c.nominal.wheel_bodies[0] = 4).contains("body of a wheel"));
    assert!(refused(|c| c.nominal.wheel_bodies.truncate(3)).contains("wheels with a body"));
    let case = Case::jointed(1, 6);
    let (mut rtc, _) = case.run();
    let measured = Measurement { links: Vec::new(), ..case.measurement() };
    let error = rtc.command(&measured, &case.reference(), &mut Command::torque(Vec::new())).unwrap_err();
    assert_eq!(error, ControlError::LinkCount { expected: 3, found: 0 });
}
