//! Rover steps: `cargo bench --bench rover`. One iteration is 100 inner steps of 2 ms.
//!
//! The peer in the same run is the contact alone: as many contact evaluations as the steps make.

use bekker::contact::{Hold, Motion, Surface, touch};
use bekker::model::Model;
use bekker::modeldescription::Lookup;
#[cfg(feature = "rigid")]
use bekker::obstacle::Obstacle;
#[cfg(feature = "rigid")]
use bekker::rigid::RigidBodies;
use bekker::rover::Rover;
use bekker::signals::Command;
use bekker::simulation::Simulation;
use bekker::terrain::{Profile, Terrain, Waves};
use divan::{Bencher, black_box, counter::ItemsCount};

/// Steps of one iteration.
const STEPS: u64 = 100;

fn main() {
    divan::main();
}

fn waves(mut rover: Rover) -> Simulation {
    rover.terrain = Terrain::new(Profile::Waves(Waves { amplitude: 0.02, wavelength: 2.0, start: 0.3 }));
    Simulation::new(rover, 0.0, 0.002).expect("settles")
}

fn step(bencher: Bencher, rover: Rover, torque: f64) {
    let command = Command::torque(vec![torque; rover.wheels.len()]);
    let start = waves(rover);
    bencher.counter(ItemsCount::new(STEPS)).with_inputs(|| start.clone()).bench_local_values(|mut simulation| {
        simulation.advance(&command, STEPS).expect("steps");
        simulation
    });
}

/// The two-wheeled rover: 4 contact evaluations a step.
#[divan::bench]
fn two_wheels(bencher: Bencher) {
    step(bencher, Rover::two_wheeled(), 1.5);
}

/// The two-wheeled rover with three effects of the user's own: on the soil, on the drives and on the chassis.
#[divan::bench]
fn two_wheels_with_expressions(bencher: Bencher) {
    let mut model = Model::new("bench", Rover::two_wheeled());
    model.add_effects(EXPRESSIONS).expect("effects");
    for name in ["wet_patch.a", "stiction.torque", "cable.k"] {
        model.set(name, 0.1).expect("a parameter");
    }
    step(bencher, model.rover, 1.5);
}

const EXPRESSIONS: &str = r#"
[[effect]]
id = "wet_patch"
target = "soil.cohesion"
mode = "factor"
expression = "1 - a * 0.5 * (tanh((x - 0.2) / 0.05) - tanh((x - 1) / 0.05))"
parameters.a = { neutral = 0, min = 0, max = 0.9 }
[[effect]]
id = "stiction"
target = "drive.friction"
expression = "torque * tanh(speed / 0.01) * (1 + exp(-(speed / 0.5) ^ 2))"
parameters.torque = { neutral = 0, min = 0, max = 1, unit = "N.m" }
[[effect]]
id = "cable"
target = "body.force_x"
expression = "-k * max(travelled, 0)"
parameters.k = { neutral = 0, min = 0, max = 10, unit = "N/m" }
"#;

/// One side of the six-wheeled rocker-bogie: 6 contact evaluations a step.
#[divan::bench]
fn rocker_bogie_side(bencher: Bencher) {
    step(bencher, Rover::rocker_bogie(), 0.3);
}

/// Six wheels on one rigid chassis: 12 contact evaluations a step.
#[divan::bench]
fn six_wheels(bencher: Bencher) {
    step(bencher, Rover::rigid(&[-0.5, -0.3, -0.1, 0.1, 0.3, 0.5]), 0.6);
}

/// The same rovers as rigid bodies: on soil alone, as above, and with a wheel on a rock.
#[cfg(feature = "rigid")]
mod rigid_bodies {
    use super::*;

    fn step(bencher: Bencher, mut rover: Rover, torque: f64) {
        rover.terrain = Terrain::new(Profile::Waves(Waves { amplitude: 0.02, wavelength: 2.0, start: 0.3 }));
        let command = Command::torque(vec![torque; rover.wheels.len()]);
        let start = RigidBodies::new(rover, 0.0, 0.002, &[], 0.5).expect("settles");
        steps(bencher, &start, &command);
    }

    fn steps(bencher: Bencher, start: &RigidBodies, command: &Command) {
        bencher.counter(ItemsCount::new(STEPS)).with_inputs(|| start.clone()).bench_local_values(|mut plant| {
            plant.advance(command, STEPS).expect("steps");
            plant
        });
    }

    #[divan::bench]
    fn two_wheels(bencher: Bencher) {
        step(bencher, Rover::two_wheeled(), 1.5);
    }

    #[divan::bench]
    fn rocker_bogie_side(bencher: Bencher) {
        step(bencher, Rover::rocker_bogie(), 0.3);
    }

    #[divan::bench]
    fn six_wheels(bencher: Bencher) {
        step(bencher, Rover::rigid(&[-0.5, -0.3, -0.1, 0.1, 0.3, 0.5]), 0.6);
    }

    #[divan::bench]
    fn rocker_bogie_on_a_rock(bencher: Bencher) {
        let command = Command::speed(vec![1.5; 3]);
        let rock = [Obstacle::rock(0.5, 0.06, 0.16)];
        let mut start = RigidBodies::new(Rover::rocker_bogie(), 0.0, 0.002, &rock, 0.5).expect("settles");
        start.advance(&command, 1300).expect("steps");
        assert!(start.touches(), "on the rock");
        steps(bencher, &start, &command);
    }

    /// A snapshot of a rover on the rock.
    #[divan::bench]
    fn snapshot(bencher: Bencher) {
        let rock = [Obstacle::rock(0.5, 0.06, 0.16)];
        let start = RigidBodies::new(Rover::rocker_bogie(), 0.0, 0.002, &rock, 0.5).expect("settles");
        bencher.bench(|| black_box(&start).clone());
    }
}

/// The peer: the contact evaluations of 100 steps of the two-wheeled rover and nothing else.
#[divan::bench]
fn contacts_of_two_wheels(bencher: Bencher) {
    let rover = Rover::two_wheeled();
    let motion = Motion { sinkage: 0.015, normal_velocity: 0.0, velocity: 0.2, spin: 2.4, hold: Hold::default() };
    bencher.counter(ItemsCount::new(STEPS)).bench(|| {
        for _ in 0..4 * STEPS {
            black_box(touch(&rover.wheel, &rover.soil, &Surface::default(), black_box(&motion)));
        }
    });
}

/// Settling a rover on its ground, as every reset does.
#[divan::bench]
fn settle(bencher: Bencher) {
    let model = Model::preset("gentle_velocity").expect("a preset");
    bencher.bench(|| black_box(&model.rover).settled_at(1.0).expect("settles"));
}
