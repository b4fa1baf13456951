//! Rocks, ledges and a hanging belly: rigid contacts of the plant of rigid bodies.

#![cfg(feature = "rigid")]
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::obstacle::Obstacle;
use bekker::rigid::RigidBodies;
use bekker::rover::Rover;
use bekker::signals::Command;
use bekker::simulation::{Event, Simulation, Status, StepError};
use bekker::terrain::{Profile, Terrain, Waves};

/// Friction of the belly on the ground.
const BELLY: f64 = 0.5;
/// Forces of soil and rigid contacts balance at rest to this share of the weight: the soil's are those of an instant,
/// the contacts' those of the last step.
const FORCE_BALANCE: f64 = 1e-3;
/// Energies balance over a rock to this share of the drives' work: impacts last less than a step.
const ENERGY_BALANCE: f64 = 0.02;
/// Acceleration on rigid ground against the formula: wheels of this plant roll without slip there.
const ACCELERATION: f64 = 2e-3;

fn firm() -> Rover {
    let mut rover = Rover::two_wheeled();
    rover.soil.shear_modulus = 0.01;
    // Torques are what is commanded, at any speed.
    rover.motor.inverse_voltage = 0.0;
    rover
}

fn plant(rover: &Rover, obstacles: &[Obstacle]) -> RigidBodies {
    RigidBodies::new(rover.clone(), 0.0, 0.002, obstacles, BELLY).unwrap()
}

/// Energy that the drives' work does not account for, J.
fn left_over(plant: &RigidBodies, start: f64) -> f64 {
    let body = &plant.signals().body;
    body.drive_work - body.soil_loss - body.other_loss - (body.mechanical_energy - start)
}

/// Sum of all forces on the rover but its weight, [x, z].
fn carried(plant: &RigidBodies) -> [f64; 2] {
    let mut sum = plant.body_contact_force(0);
    for wheel in &plant.signals().wheels {
        let (sin, cos) = wheel.contact_angle.sin_cos();
        sum[0] += wheel.drawbar_pull * cos - wheel.normal_force * sin;
        sum[1] += wheel.drawbar_pull * sin + wheel.normal_force * cos;
    }
    sum
}

#[test]
fn analytic_wheels_roll_on_a_rigid_top_with_their_inertia() {
    let rover = firm();
    let mut driven = plant(&rover, &[Obstacle::ledge(0.6, 0.02, 20.0)]);
    driven.advance(&Command::torque(vec![1.6; 2]), 1500).unwrap();
    let weight = rover.total_mass() * rover.environment.gravity;
    assert!(driven.signals().body.x > 1.2, "both wheels are on the ledge: {}", driven.signals().body.x);
    let torque = 0.5;
    let command = Command::torque(vec![torque; 2]);
    driven.advance(&command, 50).unwrap();
    let before = driven.signals().body.velocity;
    driven.advance(&command, 250).unwrap();
    let found = (driven.signals().body.velocity - before) / 0.5;
    let radius = rover.wheel.radius;
    let expected = 2.0 * torque / radius / (rover.total_mass() + 2.0 * rover.wheel.inertia / (radius * radius));
    assert!((found - expected).abs() < ACCELERATION * expected, "{found} m/s2, expected {expected}");
    let load: f64 = driven.signals().wheels.iter().map(|wheel| wheel.normal_force).sum();
    assert!((load - weight).abs() < FORCE_BALANCE * weight, "{load} N carry {weight} N");
    assert!(driven.signals().wheels.iter().all(|wheel| wheel.sinkage < 0.0 && wheel.contact_angle.abs() < 1e-6));
}

#[test]
fn property_the_rocker_bogie_climbs_a_rock_of_half_a_wheel_diameter() {
    let rover = Rover::rocker_bogie();
    let height = rover.wheel.radius;
    let command = Command::speed(vec![1.5; 3]);
    let way = |step_size: f64| {
        let rock = [Obstacle::rock(0.5, height, 0.16)];
        let mut climbing = RigidBodies::new(rover.clone(), 0.0, step_size, &rock, BELLY).unwrap();
        let start = climbing.signals().body.mechanical_energy;
        let (mut steepest, mut highest): (f64, f64) = (0.0, 0.0);
        for _ in 0..120 {
            assert_eq!(climbing.advance(&command, (0.1 / step_size).round() as u64), Ok(Status::Running));
            let signals = climbing.signals();
            highest = highest.max(signals.body.z);
            steepest = signals.wheels.iter().fold(steepest, |most, wheel| most.max(wheel.contact_angle));
        }
        let body = &climbing.signals().body;
        assert!(body.x > 0.8, "all wheels are over the rock: x = {} m", body.x);
        assert!(!climbing.touches(), "and stand on soil again");
        assert!(highest > body.z + 0.3 * height, "it rose over it: {highest} m, {} m", body.z);
        assert!(steepest > 0.7, "the front wheel felt its flank: {steepest} rad");
        let left = left_over(&climbing, start);
        assert!(left.abs() < ENERGY_BALANCE * body.drive_work, "{left} J of {} J", body.drive_work);
        body.x
    };
    let (coarse, fine) = (way(0.002), way(0.001));
    assert!((coarse - fine).abs() < 5e-3, "{coarse} m at 2 ms, {fine} m at 1 ms");
}

#[test]
fn property_a_smooth_rock_and_a_wall_refuse_the_rover() {
    let bogie = Rover::rocker_bogie();
    let mut smooth = Obstacle::rock(0.6, bogie.wheel.radius, 0.16);
    smooth.parameters.friction = 0.02;
    for (name, rover, obstacle) in [("smooth rock", bogie, smooth), ("wall", firm(), Obstacle::block(0.8, 0.3, 0.2))] {
        let mut refused = plant(&rover, &[obstacle]);
        let last = rover.wheels.len() - 1;
        let command = Command::speed(vec![1.5; last + 1]);
        assert_eq!(refused.advance(&command, 20_000), Ok(Status::Ended(Event::Stuck)), "{name}");
        let face = obstacle.extent().0;
        let front = refused.signals().body.x + rover.wheels[last].mount.x;
        assert!(
            front < obstacle.parameters.x && front > face - 2.0 * rover.wheel.radius,
            "{name}: front wheel at {front} m"
        );
        let push = refused.wheel_contact_force(last);
        assert!(push[0] < -1.0, "{name}: it pushes back with {push:?} N");
    }
}

#[test]
fn property_a_ledge_is_climbed_and_lifts_the_rover() {
    const HEIGHT: f64 = 0.02;
    let rover = Rover::rocker_bogie();
    let mut climbing = plant(&rover, &[Obstacle::ledge(0.5, HEIGHT, 3.0)]);
    let level = climbing.signals().body.z;
    assert_eq!(climbing.advance(&Command::speed(vec![1.5; 3]), 7_500), Ok(Status::Running));
    let (x, z) = (climbing.signals().body.x, climbing.signals().body.z);
    assert!(x > 0.75, "all wheels are on it: x = {x} m");
    // The wheels had sunk by some millimetres before.
    assert!((HEIGHT..HEIGHT + 0.02).contains(&(z - level)), "lifted from {level} m to {z} m");
}

#[test]
fn analytic_a_ledge_refuses_the_rocker_bogie_where_the_other_wheels_cannot_push_enough() {
    let rover = Rover::rocker_bogie();
    let ledge = Obstacle::ledge(0.5, 0.04, 3.0);
    let mut refused = plant(&rover, &[ledge]);
    assert_eq!(refused.advance(&Command::speed(vec![1.5; 3]), 10_000), Ok(Status::Ended(Event::Stuck)));
    // All three wheels are at their limits: rear on the sand, middle on the ledge's edge, front on its top.
    let wheels = &refused.signals().wheels;
    assert!(wheels.iter().all(|wheel| wheel.slip > 0.99), "all wheels spin on the spot");
    assert!(wheels[0].sinkage > 0.0 && refused.wheel_contact_force(0) == [0.0, 0.0]);
    let position = &refused.state().position;
    let pivot = rover.links[0].parameters;
    let turned = |angle: f64, x: f64, z: f64| [angle.cos() * x - angle.sin() * z, angle.sin() * x + angle.cos() * z];
    let joint = turned(position[2], pivot.x, pivot.z);
    let from_joint = turned(position[2] + position[3], -pivot.x, -pivot.z);
    let [x, z] = [0, 1].map(|i| position[i] + joint[i] + from_joint[i]);
    let (from_edge_x, from_edge_z) = (x - 0.5, z - ledge.parameters.height);
    let friction = |[fx, fz]: [f64; 2], nx: f64, nz: f64| (fx * nz - fz * nx) / (fx * nx + fz * nz);
    for (name, found) in [
        ("middle", friction(refused.wheel_contact_force(1), from_edge_x, from_edge_z)),
        ("front", friction(refused.wheel_contact_force(2), 0.0, 1.0)),
    ] {
        let mu = ledge.parameters.friction;
        assert!((found - mu).abs() < 0.01, "{name} wheel: friction over load {found}, coefficient {mu}");
    }
    let [x, z] = carried(&refused);
    let weight = rover.total_mass() * rover.environment.gravity;
    assert!(
        x.abs() < FORCE_BALANCE * weight && (z - weight).abs() < FORCE_BALANCE * weight,
        "[{x}, {z}] N, {weight} N"
    );
}

#[test]
fn property_a_belly_on_a_rock_hangs_up() {
    let rover = firm();
    let mut hung = plant(&rover, &[Obstacle::rock(0.8, 0.1, 0.24)]);
    let start = hung.signals().body.mechanical_energy;
    assert_eq!(hung.advance(&Command::speed(vec![2.5; 2]), 10_000), Ok(Status::Ended(Event::Stuck)));
    let weight = rover.total_mass() * rover.environment.gravity;
    let [x, z] = hung.body_contact_force(0);
    assert!(z > 0.3 * weight, "the belly carries {z} N of {weight} N and holds {x} N");
    let [x, z] = carried(&hung);
    assert!(x.abs() < FORCE_BALANCE * weight, "{x} N along x at rest");
    assert!((z - weight).abs() < FORCE_BALANCE * weight, "{z} N carry {weight} N");
    let (left, work) = (left_over(&hung, start), hung.signals().body.drive_work);
    assert!(left.abs() < ENERGY_BALANCE * work, "{left} J of {work} J");
}

#[test]
fn property_a_belly_on_a_crest_hangs_up_where_the_other_plant_ends_its_run() {
    let mut rover = firm();
    rover.terrain = Terrain::new(Profile::Waves(Waves { amplitude: 0.12, wavelength: 1.0, start: 0.5 }));
    let command = Command::speed(vec![2.5; 2]);
    let mut joints = Simulation::new(rover.clone(), 0.0, 0.002).unwrap();
    assert_eq!(joints.advance(&command, 10_000), Ok(Status::Ended(Event::BellyContact)));
    let mut bodies = plant(&rover, &[]);
    assert_eq!(bodies.advance(&command, 10_000), Ok(Status::Ended(Event::Stuck)));
    let (there, here) = (joints.signals().body.x, bodies.signals().body.x);
    assert!((0.0..0.1).contains(&(here - there)), "it goes on from {there} m to {here} m");
    let weight = rover.total_mass() * rover.environment.gravity;
    let [x, z] = carried(&bodies);
    assert!(
        x.abs() < FORCE_BALANCE * weight && (z - weight).abs() < FORCE_BALANCE * weight,
        "[{x}, {z}] N of {weight} N"
    );
}

#[test]
fn property_soil_and_rock_act_on_one_wheel_together() {
    let rover = firm();
    // Too smooth to be climbed.
    let mut wall = Obstacle::block(0.8, 0.3, 0.2);
    wall.parameters.friction = 0.2;
    let mut held = plant(&rover, &[wall]);
    held.advance(&Command::torque(vec![1.5; 2]), 4_000).unwrap();
    let wheel = &held.signals().wheels[1];
    let rock = held.wheel_contact_force(1);
    assert!(rock[0] < -1.0, "the wall pushes back: {rock:?} N");
    assert!(wheel.sinkage > 1e-3, "the soil carries the wheel: sunk by {} m", wheel.sinkage);
    // The contact angle is that of both normal forces together, between the soil's 0 and the wall's 90 degrees.
    assert!((0.05..1.5).contains(&wheel.contact_angle), "{} rad", wheel.contact_angle);
    let [x, z] = carried(&held);
    let weight = rover.total_mass() * rover.environment.gravity;
    assert!(
        x.abs() < FORCE_BALANCE * weight && (z - weight).abs() < FORCE_BALANCE * weight,
        "[{x}, {z}] N, {weight} N"
    );
}

#[test]
fn property_the_same_inputs_give_the_same_bits_and_a_clone_goes_on_alike() {
    let rover = Rover::rocker_bogie();
    let rock = [Obstacle::rock(0.5, 0.05, 0.16), Obstacle::block(1.0, 0.03, 0.1)];
    let command = Command::speed(vec![1.5; 3]);
    let (mut once, mut again) = (plant(&rover, &rock), plant(&rover, &rock));
    once.advance(&command, 3000).unwrap();
    again.advance(&command, 1400).unwrap();
    assert!(again.touches(), "the copy is made on the rock");
    let mut copy = again.clone();
    again.advance(&command, 1600).unwrap();
    for _ in 0..160 {
        copy.advance(&command, 10).unwrap();
    }
    assert_eq!(once.signals(), again.signals());
    assert_eq!(once.signals(), copy.signals());
    assert_eq!(once.state(), copy.state());
}

#[test]
fn property_an_obstacle_under_the_rover_is_refused() {
    let error =
        RigidBodies::new(firm(), 0.0, 0.002, &[Obstacle::rock(2.0, 0.1, 0.2), Obstacle::rock(0.3, 0.1, 0.2)], BELLY);
    let error = error.expect_err("it stands in the front wheel");
    assert_eq!(error, StepError::ObstacleAtStart { obstacle: 2, x: 0.3 });
    assert!(error.to_string().contains("obstacle 2 at x = 0.3 m"), "{error}");
}
