//! The plant of rigid bodies against the plant in joint coordinates, on soil alone.

#![cfg(feature = "rigid")]
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::rigid::RigidBodies;
use bekker::rover::Rover;
use bekker::signals::{Command, Drive};
use bekker::simulation::{Event, Simulation, Status};
use bekker::terrain::{Profile, Slope, Terrain, Waves};

/// Friction of the belly on the ground; it does not touch here.
const BELLY: f64 = 0.5;
/// The plants differ by this share of the way at 2 ms. Rapier's steps are of order one: forces act a step late, and a place is moved
/// with the speed at the end of its step, half a step early; 1.5 of the 1500 steps of three seconds.
const OF_THE_WAY: f64 = 1e-3;
/// Wheel loads differ by this share of the weight at 2 ms: what they change by in those 1.5 steps, 3 ms, on waves that pass with
/// 2 pi times 0.15 m/s over 0.7 m, 1.3 a second, and change them by up to the weight.
const OF_THE_WEIGHT: f64 = 4e-3;
/// Energies balance to this share of the drives' work, as for the other plant.
const ENERGY_BALANCE: f64 = 0.01;
/// A parked rover may move this far in a minute, m.
const PARKED: f64 = 1e-3;

fn waves(amplitude: f64, wavelength: f64) -> Terrain {
    Terrain::new(Profile::Waves(Waves { amplitude, wavelength, start: 0.4 }))
}

fn slope(angle: f64) -> Terrain {
    Terrain::new(Profile::Slope(Slope { slope: angle.to_radians() }))
}

fn firm(wheel_x: &[f64]) -> Rover {
    let mut rover = Rover::rigid(wheel_x);
    rover.soil.shear_modulus = 0.01;
    rover
}

/// Vehicles, ground and commands for three seconds.
fn cases() -> Vec<(&'static str, Rover, Terrain, Command)> {
    let two = firm(&[-0.35, 0.35]);
    let four = firm(&[-0.5, -0.2, 0.15, 0.5]);
    let six = firm(&[-0.5, -0.3, -0.1, 0.1, 0.3, 0.5]);
    let eight = firm(&[-0.7, -0.5, -0.3, -0.1, 0.1, 0.3, 0.5, 0.7]);
    let bogie = Rover::rocker_bogie();
    vec![
        ("two wheels, waves, torque", two.clone(), waves(0.03, 2.0), Command::torque(vec![1.5; 2])),
        ("two wheels, waves, speed", two.clone(), waves(0.03, 2.0), Command::speed(vec![2.5; 2])),
        ("two wheels, slope, speed", two.clone(), slope(8.0), Command::speed(vec![2.5; 2])),
        ("two wheels, slope, torque back", two, slope(4.0), Command::torque(vec![-1.5; 2])),
        ("four wheels, waves, torque", four, waves(0.02, 2.0), Command::torque(vec![0.8; 4])),
        ("six wheels, waves, speed", six, waves(0.02, 2.0), Command::speed(vec![2.0; 6])),
        ("eight wheels, waves, torque", eight, waves(0.01, 3.0), Command::torque(vec![0.4; 8])),
        ("rocker-bogie, waves, torque", bogie.clone(), waves(0.01, 0.7), Command::torque(vec![0.38; 3])),
        ("rocker-bogie, waves, speed", bogie.clone(), waves(0.01, 0.7), Command::speed(vec![1.5; 3])),
        ("rocker-bogie, slope, speed", bogie, slope(-6.0), Command::speed(vec![1.5; 3])),
    ]
}

fn both(rover: &Rover, command: &Command, step_size: f64, duration: f64) -> (Simulation, RigidBodies) {
    let steps = (duration / step_size).round() as u64;
    let mut joints = Simulation::new(rover.clone(), 0.0, step_size).unwrap();
    let mut bodies = RigidBodies::new(rover.clone(), 0.0, step_size, &[], BELLY).unwrap();
    assert_eq!(joints.advance(command, steps), bodies.advance(command, steps));
    assert_eq!(joints.status(), Status::Running);
    (joints, bodies)
}

#[test]
fn agreement_with_joint_coordinates_on_soil() {
    for (name, mut rover, terrain, command) in cases() {
        rover.terrain = terrain;
        let (joints, bodies) = both(&rover, &command, 0.002, 3.0);
        let (expected, found) = (joints.signals(), bodies.signals());
        let way = expected.body.x.abs();
        assert!(way > 0.1, "{name}: it drives {way} m");
        for (there, here) in [(expected.body.x, found.body.x), (expected.body.z, found.body.z)] {
            assert!((there - here).abs() < OF_THE_WAY * way, "{name}: {here} m, expected {there} m after {way} m");
        }
        let off = found.body.pitch - expected.body.pitch;
        assert!(off.abs() < 1.5e-3, "{name}: the pitch is off by {off} rad");
        let weight = rover.total_mass() * rover.environment.gravity;
        for (k, (there, here)) in expected.wheels.iter().zip(&found.wheels).enumerate() {
            let off = (there.normal_force - here.normal_force) / weight;
            assert!(off.abs() < OF_THE_WEIGHT, "{name}: load of wheel {} is off by {off} of the weight", k + 1);
        }
    }
}

#[test]
fn property_both_plants_approach_each_other_with_order_one() {
    for (name, mut rover, terrain, command) in cases() {
        rover.terrain = terrain;
        let difference = |step_size: f64| {
            let (joints, bodies) = both(&rover, &command, step_size, 2.0);
            (joints.signals().body.x - bodies.signals().body.x).abs()
        };
        let [coarse, middle, fine] = [0.004, 0.002, 0.001].map(difference);
        if coarse < 2e-5 {
            // So near that other errors pass zero.
            continue;
        }
        for (larger, smaller) in [(coarse, middle), (middle, fine)] {
            let order = (larger / smaller).log2();
            assert!((0.7..1.7).contains(&order), "{name}: order {order:.2} from {larger:.2e} to {smaller:.2e} m");
        }
    }
}

#[test]
fn property_energies_balance_on_soil() {
    let mut laden = Rover::rocker_bogie();
    laden.links[0].parameters.damping = 0.5;
    laden.effects.drag.force = 0.5;
    laden.effects.coulomb_friction.torque = 0.02;
    laden.effects.gear_efficiency.eta = 0.8;
    laden.effects.suspension_friction.moment = 0.1;
    laden.effects.payload.mass = 0.5;
    laden.effects.centre_of_mass.shift = 0.02;
    laden.effects.radius_scale.deviation = 0.03;
    let extra = [
        ("laden, torque", laden.clone(), waves(0.01, 0.7), Command::torque(vec![0.38; 3])),
        ("laden, speed", laden, waves(0.01, 0.7), Command::speed(vec![1.5; 3])),
    ];
    for (name, mut rover, terrain, command) in cases().into_iter().chain(extra) {
        rover.terrain = terrain;
        let mut bodies = RigidBodies::new(rover, 0.0, 0.002, &[], BELLY).unwrap();
        let start = bodies.signals().body.mechanical_energy;
        bodies.advance(&command, 1500).unwrap();
        let body = &bodies.signals().body;
        let left = body.drive_work - body.soil_loss - body.other_loss - (body.mechanical_energy - start);
        let turned = body.drive_work.abs().max(body.soil_loss);
        assert!(turned > 0.3, "{name}: the drives work: {turned} J");
        assert!(left.abs() < ENERGY_BALANCE * turned, "{name}: {left} J of {turned} J");
    }
}

#[test]
fn property_effects_act_in_the_same_way() {
    let mut rover = Rover::rocker_bogie();
    rover.terrain = waves(0.01, 0.7);
    let command = Command::torque(vec![0.38; 3]);
    let plain = both(&rover, &command, 0.002, 2.0).1.signals().body.x;
    rover.effects.slip_sinkage.n1 = 0.4;
    rover.effects.slip_sinkage.length = 0.05;
    rover.effects.drag.force = 0.5;
    rover.effects.payload.mass = 0.3;
    rover.effects.suspension_friction.moment = 0.1;
    rover.effects.radius_scale.deviation = 0.02;
    rover.effects.viscous_friction.coefficient = 0.01;
    let (joints, bodies) = both(&rover, &command, 0.002, 2.0);
    let (there, here) = (joints.signals().body.x, bodies.signals().body.x);
    assert!((plain - here).abs() > 0.05 * plain, "the effects matter: {plain} m, {here} m");
    assert!((there - here).abs() < 2.0 * OF_THE_WAY * there, "{here} m, expected {there} m");
}

#[test]
fn property_a_parked_rover_stays() {
    for (mut rover, angle) in
        [(firm(&[-0.35, 0.35]), 15.0), (firm(&[-0.35, 0.35]), -10.0), (Rover::rocker_bogie(), 8.0)]
    {
        rover.terrain = slope(angle);
        let command = Command::speed(vec![0.0; rover.wheels.len()]);
        let mut parked = RigidBodies::new(rover, 0.0, 0.002, &[], BELLY).unwrap();
        let x = parked.signals().body.x;
        assert_eq!(parked.advance(&command, 30_000), Ok(Status::Running));
        let moved = (parked.signals().body.x - x).abs();
        assert!(moved < PARKED, "{angle} deg: moved {moved} m in a minute");
    }
}

#[test]
fn property_drives_may_change_between_torque_and_speed() {
    let mut rover = firm(&[-0.35, 0.35]);
    rover.terrain = waves(0.02, 2.0);
    let mut joints = Simulation::new(rover.clone(), 0.0, 0.001).unwrap();
    let mut bodies = RigidBodies::new(rover, 0.0, 0.001, &[], BELLY).unwrap();
    let commands = [Command::speed(vec![2.0; 2]), Command::torque(vec![1.4; 2]), Command::speed(vec![3.0, 2.5])];
    for command in &commands {
        joints.advance(command, 600).unwrap();
        bodies.advance(command, 600).unwrap();
        assert_eq!(bodies.drive(), command.drive);
        if command.drive == Drive::Speed {
            let speeds: Vec<f64> = bodies.signals().wheels.iter().map(|wheel| wheel.speed).collect();
            assert_eq!(speeds, command.values);
        }
    }
    let (there, here) = (joints.signals().body.x, bodies.signals().body.x);
    assert!((there - here).abs() < OF_THE_WAY * there, "{here} m, expected {there} m");
}

#[test]
fn property_a_rover_that_cannot_climb_is_stuck_for_both() {
    let mut rover = Rover::two_wheeled();
    rover.terrain = slope(25.0);
    let command = Command::speed(vec![2.5; 2]);
    let mut joints = Simulation::new(rover.clone(), 0.0, 0.002).unwrap();
    let mut bodies = RigidBodies::new(rover, 0.0, 0.002, &[], BELLY).unwrap();
    assert_eq!(joints.advance(&command, 5_000), Ok(Status::Ended(Event::Stuck)));
    assert_eq!(bodies.advance(&command, 5_000), Ok(Status::Ended(Event::Stuck)));
}
