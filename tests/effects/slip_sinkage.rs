//! Slip-sinkage that builds up along a wheel's way.

use bekker::rover::Rover;
use bekker::signals::Command;
use bekker::simulation::{Simulation, Status};

/// Inner step, s.
const STEP: f64 = 0.002;
/// That of the comparison with another rule: a twentieth of the time in which the slip changes while the wheels spin up.
const SMALL_STEP: f64 = 0.0005;
/// Two rules of order 2 in such steps, the square of a twentieth of what changes, over the few changes of a drive.
const INTEGRATION: f64 = 1e-4;
/// What is left of a slip after 20 lengths, e^-20, and of how the rover came there.
const STEADY: f64 = 1e-6;

/// Loose sand in which slip digs within `length` (m).
fn rover(length: f64) -> Rover {
    let mut rover = Rover::two_wheeled();
    rover.effects.slip_sinkage.n1 = 0.4;
    rover.effects.slip_sinkage.length = length;
    rover
}

#[test]
fn analytic_the_ground_follows_the_slip_as_its_equation_says() {
    let length = 0.05;
    let rover = rover(length);
    let radius = rover.wheel.radius;
    let mut simulation = Simulation::new(rover, 0.0, SMALL_STEP).unwrap();
    let command = Command::torque(vec![1.6, 1.6]);
    // Past the break-away, whose first steps no explicit rule follows.
    simulation.advance(&command, 200).unwrap();
    let mut dug: Vec<f64> = simulation.state().wheels.iter().map(|wheel| wheel.dug_slip).collect();
    let begun = dug[0];
    let motion = |simulation: &Simulation| {
        let wheels = simulation.signals().wheels.iter().zip(&simulation.state().wheels);
        wheels.map(|(seen, state)| (seen.slip, radius * state.spin)).collect::<Vec<_>>()
    };
    let mut before = motion(&simulation);
    let mut largest: f64 = 0.0;
    for _ in 0..4000 {
        assert_eq!(simulation.advance(&command, 1), Ok(Status::Running));
        let after = motion(&simulation);
        for (k, dug) in dug.iter_mut().enumerate() {
            // ds/dt = (i - s) r omega/l of a driven wheel, by the trapezoidal rule.
            let [a, b] = [before[k].1, after[k].1].map(|rim| 0.5 * SMALL_STEP * rim / length);
            *dug = (*dug * (1.0 - a) + a * before[k].0 + b * after[k].0) / (1.0 + b);
            let kept = simulation.state().wheels[k].dug_slip;
            assert!((kept - *dug).abs() < INTEGRATION, "wheel {k}: {kept}, expected {dug}");
        }
        largest = largest.max(dug[0]);
        before = after;
    }
    assert!(largest > 1.5 * begun, "it digs on: {begun}, then {largest}");
}

#[test]
fn property_in_the_end_the_wheel_stands_as_deep_as_where_slip_digs_at_once() {
    let command = Command::speed(vec![2.0; 2]);
    let drive = |length: f64, steps: u64| {
        let mut simulation = Simulation::new(rover(length), 0.0, STEP).unwrap();
        assert_eq!(simulation.advance(&command, steps), Ok(Status::Running));
        simulation
    };
    let sinkage = |simulation: &Simulation| simulation.signals().wheels[0].sinkage;
    let (start, soon) = (drive(0.05, 0), [0.0, 0.05].map(|length| drive(length, 50)));
    assert!(sinkage(&soon[1]) > sinkage(&start), "it digs");
    assert!(sinkage(&soon[1]) < 0.9 * sinkage(&soon[0]), "but not at once: {soon:?}");
    let late = [0.0, 0.05].map(|length| drive(length, 5000));
    assert!((sinkage(&late[1]) / sinkage(&late[0]) - 1.0).abs() < STEADY);
    assert!(sinkage(&late[0]) > 1.1 * sinkage(&start));
}

#[test]
fn property_a_start_in_motion_is_where_a_long_drive_ends() {
    let mut simulation = Simulation::new(rover(0.05), 0.0, STEP).unwrap();
    simulation.advance(&Command::speed(vec![2.0; 2]), 5000).unwrap();
    let (state, signals) = (simulation.state(), simulation.signals());
    let speeds: Vec<f64> = signals.wheels.iter().map(|wheel| wheel.speed).collect();
    let start = rover(0.05).moving_at(signals.body.x, state.rate[0], &speeds, &[]).unwrap();
    for (there, here) in state.wheels.iter().zip(&start.wheels) {
        assert!((there.dug_slip - here.dug_slip).abs() < STEADY, "{there:?}, {here:?}");
        assert!(here.dug_slip > 0.05);
    }
    assert!((state.position[1] - start.position[1]).abs() < STEADY);
}
