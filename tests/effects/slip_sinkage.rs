//! Slip-sinkage that builds up along a wheel's way.

use bekker::rover::Rover;
use bekker::signals::Command;
use bekker::simulation::{Simulation, Status};

/// Inner step, s.
const STEP: f64 = 0.002;
/// Largest [`difference`] at the usual step: twice what is seen.
const INTEGRATION: f64 = 5.4e-5;
/// Share of it that a fourth of the step leaves at most: a sixteenth where both rules are of order 2, a fourth at order 1.
const LEFT_BY_SMALL_STEPS: f64 = 0.15;
/// Slips and relative sinkages after 40 lengths, of which e^-40 is left; the rover's pitching, damped by the soil, leaves more.
const STEADY: f64 = 1e-6;

/// Loose sand in which slip digs within `length` (m).
fn rover(length: f64) -> Rover {
    let mut rover = Rover::two_wheeled();
    rover.effects.slip_sinkage.n1 = 0.4;
    rover.effects.slip_sinkage.length = length;
    rover
}

/// Largest difference of `dug_slip` from the trapezoidal rule over the recorded slips, in a start under torque while the wheels drive, and
/// largest change of `dug_slip` meanwhile; both without a unit.
fn difference(step: f64) -> [f64; 2] {
    let length = 0.05;
    let rover = rover(length);
    let radius = rover.wheel.radius;
    let mut simulation = Simulation::new(rover, 0.0, step).unwrap();
    let command = Command::torque(vec![1.6, 1.6]);
    // Past the break-away, whose first steps no explicit rule follows.
    simulation.advance(&command, (0.1 / step).round() as u64).unwrap();
    let kept =
        |simulation: &Simulation| simulation.state().wheels.iter().map(|wheel| wheel.dug_slip).collect::<Vec<f64>>();
    let motion = |simulation: &Simulation| {
        let wheels = simulation.signals().wheels.iter().zip(&simulation.state().wheels);
        wheels.map(|(seen, state)| (seen.slip, radius * state.spin)).collect::<Vec<_>>()
    };
    let (mut dug, mut before, begun) = (kept(&simulation), motion(&simulation), kept(&simulation)[0]);
    let (mut apart, mut change): (f64, f64) = (0.0, 0.0);
    for _ in 0..(0.7 / step).round() as usize {
        assert_eq!(simulation.advance(&command, 1), Ok(Status::Running));
        let after = motion(&simulation);
        for (k, (dug, kept)) in dug.iter_mut().zip(kept(&simulation)).enumerate() {
            // ds/dt = (i - s) r omega/l of a driven wheel, by the trapezoidal rule.
            assert!(after[k].0 > 0.0, "it drives");
            let [a, b] = [before[k].1, after[k].1].map(|rim| 0.5 * step * rim / length);
            *dug = (*dug * (1.0 - a) + a * before[k].0 + b * after[k].0) / (1.0 + b);
            apart = apart.max((kept - *dug).abs());
            change = change.max((kept - begun).abs());
        }
        before = after;
    }
    [apart, change]
}

#[test]
fn analytic_the_ground_follows_the_slip_as_its_equation_says() {
    let [usual, change] = difference(STEP);
    let [small, _] = difference(STEP / 4.0);
    println!("{usual:.2e} at the usual step, {small:.2e} at a fourth of it, of a change of {change:.2}");
    assert!(usual < INTEGRATION && change > 1000.0 * INTEGRATION, "{usual} of a change of {change}");
    assert!(small < LEFT_BY_SMALL_STEPS * usual, "{small} at a fourth of the step, {usual} at the usual one");
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
    // In 0.1 s the rim moves by 0.4 lengths, which brings a third of the way.
    let share = (sinkage(&soon[1]) - sinkage(&start)) / (sinkage(&soon[0]) - sinkage(&start));
    assert!(share > 0.1 && share < 0.6, "{share} of the digging at once");
    let late = [0.0, 0.05].map(|length| drive(length, 5000));
    assert!((sinkage(&late[1]) / sinkage(&late[0]) - 1.0).abs() < STEADY);
    assert!(sinkage(&late[0]) > 1.05 * sinkage(&start), "digging matters here");
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
