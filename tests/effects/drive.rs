//! Effects between the command and the rim: gear, torque constant, winding heat.

use bekker::diagnosis::{Rig, steady_point};
use bekker::effects::Effects;
use bekker::motor::{self, Motor};
use bekker::rover::Rover;
use bekker::signals::Command;
use bekker::simulation::{Simulation, Status};
use bekker::terrain::{Profile, Slope, Terrain};

/// Identities in which only rounding differs.
const ROUNDING: f64 = 1e-12;
/// The gear's smooth reversal leaves up to tau/2 = 0.5 mN m at torques of 0.3 N m and more, and its direction is
/// smooth over 0.01 rad/s at 2 rad/s.
const REVERSAL: f64 = 2e-3;
/// Identical motions of two simulations, grown over a thousand steps.
const SAME_MOTION: f64 = 1e-9;
/// Central differences over 1e-6 of smooth functions.
const DIFFERENCES: f64 = 1e-6;
/// Temperatures of two integrations of second and fourth order over 100 s in steps of 10 ms.
const TEMPERATURE: f64 = 1e-6;

fn geared(eta: f64) -> Effects {
    let mut effects = Effects::default();
    effects.gear_efficiency.eta = eta;
    effects
}

fn rim_torque(effects: &Effects, speed: f64, torque: f64) -> motor::Driven {
    let motor = Motor::default();
    motor::drive(&motor, &motor, effects, speed, torque).unwrap()
}

/// A rover that hardly sinks, at 1 rad/s up a slope (degrees).
fn on_slope(angle: f64, effects: Effects) -> Simulation {
    let mut rover = Rover::two_wheeled();
    rover.soil.k_phi = 2e7;
    rover.soil.shear_modulus = 0.005;
    rover.terrain = Terrain::new(Profile::Slope(Slope { slope: angle.to_radians() }));
    rover.effects = effects;
    let mut simulation = Simulation::new(rover, 0.0, 0.002).expect("settles");
    let status = simulation.advance(&Command::speed(vec![2.0; 2]), 1000).expect("steps");
    assert_eq!(status, Status::Running);
    simulation
}

#[test]
fn analytic_a_gear_takes_its_share_when_driving_and_when_driven() {
    for eta in [0.4, 0.75, 0.95] {
        let effects = geared(eta);
        for (speed, torque) in [(2.0, 1.0), (-2.0, -0.7), (2.0, -1.0), (-1.5, 0.8)] {
            let expected = if speed * torque > 0.0 { eta } else { 1.0 / eta };
            let share = rim_torque(&effects, speed, torque).rim_torque / torque;
            assert!((share / expected - 1.0).abs() < 2.0 * REVERSAL, "{eta}: {share} for {expected}");
        }
    }
}

#[test]
fn property_a_gear_is_smooth_reversible_on_paper_and_never_gives_power() {
    let effects = geared(0.6);
    let grid = [-1.0, -0.1, -1e-2, -1e-3, -1e-4, 0.0, 1e-4, 1e-3, 1e-2, 0.1, 1.0];
    for speed in grid {
        for torque in grid {
            let driven = rim_torque(&effects, speed, torque);
            let loss = (torque - driven.rim_torque) * speed;
            assert!(loss >= -1e-15, "{speed} rad/s, {torque} N m: {loss} W");
            let back = motor::torque_behind(&effects, speed, driven.rim_torque).unwrap();
            assert!((back - torque).abs() < ROUNDING, "{back} for {torque}");
            let mirrored = rim_torque(&effects, -speed, -torque).rim_torque;
            assert!((mirrored + driven.rim_torque).abs() < ROUNDING);
            let step = 1e-6;
            let [above, below] = [step, -step].map(|d| rim_torque(&effects, speed + d, torque).rim_torque);
            let slope = (above - below) / (2.0 * step);
            assert!((driven.slope - slope).abs() < DIFFERENCES * (1.0 + slope.abs()), "{} and {slope}", driven.slope);
        }
    }
}

#[test]
fn analytic_uphill_the_torque_is_divided_and_downhill_multiplied_by_the_efficiency() {
    let eta = 0.7;
    for (angle, expected) in [(8.0, 1.0 / eta), (-12.0, eta)] {
        let (ideal, lossy) = (on_slope(angle, Effects::default()), on_slope(angle, geared(eta)));
        for (ideal, lossy) in ideal.signals().wheels.iter().zip(&lossy.signals().wheels) {
            assert!(ideal.torque * angle > 0.0, "{angle} deg: {} N m", ideal.torque);
            let ratio = lossy.torque / ideal.torque;
            assert!((ratio / expected - 1.0).abs() < REVERSAL * 2.0, "{angle} deg: {ratio}, expected {expected}");
            assert!((lossy.current / ideal.current - ratio).abs() < ROUNDING);
        }
    }
}

#[test]
fn analytic_a_rig_records_the_motor_torque_of_gear_and_torque_constant() {
    let mut rig = Rig::of(&Rover::two_wheeled());
    let ideal = steady_point(&rig, 50.0, 0.3, 2.0).expect("a steady point");
    rig.effects.gear_efficiency.eta = 0.8;
    rig.effects.torque_scale.deviation = 0.1;
    let lossy = steady_point(&rig, 50.0, 0.3, 2.0).expect("a steady point");
    let expected = ideal.torque / (0.8 * 1.1);
    assert!((lossy.torque / expected - 1.0).abs() < REVERSAL, "{} for {expected}", lossy.torque);
    assert_eq!((lossy.drawbar_pull, lossy.sinkage), (ideal.drawbar_pull, ideal.sinkage));
}

#[test]
fn analytic_a_stronger_motor_needs_less_current_and_records_less_torque() {
    let mut effects = Effects::default();
    effects.torque_scale.deviation = 0.08;
    let (plain, scaled) = (on_slope(5.0, Effects::default()), on_slope(5.0, effects));
    for (plain, scaled) in plain.signals().wheels.iter().zip(&scaled.signals().wheels) {
        assert!((plain.torque / scaled.torque - 1.08).abs() < ROUNDING);
        assert!((plain.current / scaled.current - 1.08).abs() < ROUNDING);
    }
    let ratio = plain.signals().body.power / scaled.signals().body.power;
    assert!((ratio - 1.08 * 1.08).abs() < ROUNDING, "{ratio}");
}

#[test]
fn analytic_a_commanded_torque_comes_out_scaled_and_is_recorded_as_commanded() {
    let drive = |deviation: f64, torque: f64| {
        let mut rover = Rover::two_wheeled();
        rover.soil.shear_modulus = 0.01;
        rover.effects.torque_scale.deviation = deviation;
        let mut simulation = Simulation::new(rover, 0.0, 0.002).expect("settles");
        simulation.advance(&Command::torque(vec![torque; 2]), 1000).expect("steps");
        simulation
    };
    let (scaled, stronger) = (drive(0.1, 1.2), drive(0.0, 1.2 * 1.1));
    let (a, b) = (scaled.signals(), stronger.signals());
    assert!(a.body.x > 0.1 && (a.body.x - b.body.x).abs() < SAME_MOTION, "{} and {}", a.body.x, b.body.x);
    assert!((a.wheels[0].torque - 1.2).abs() < ROUNDING);
    // Mechanical power is the true torque's.
    let mechanical: f64 = b.wheels.iter().map(|wheel| wheel.torque * wheel.speed).sum();
    assert!((a.body.electrical_power - a.body.power - mechanical).abs() < 1e-7);
}

#[test]
fn analytic_a_winding_warms_as_its_equation_says_and_torque_does_not_show_it() {
    let (torque, thermal, constant) = (0.5, 8.0, 40.0);
    let mut rover = Rover::two_wheeled();
    rover.effects.winding_heat.thermal_resistance = thermal;
    rover.effects.winding_heat.time_constant = constant;
    let motor = rover.motor;
    // An independent integration of dT' = (R_th R(dT) I(dT)^2 - dT)/time_constant.
    let power = |rise: f64| {
        let current = torque / (motor.gear_ratio * motor.torque_constant * (1.0 - 0.0011 * rise));
        motor.resistance * (1.0 + 0.0039 * rise) * current * current
    };
    let rate = |rise: f64| (thermal * power(rise) - rise) / constant;
    let mut simulation = Simulation::new(rover.clone(), 0.0, 0.01).expect("settles");
    let cold = motor.resistance * (torque / (motor.gear_ratio * motor.torque_constant)).powi(2);
    let mut rise = 0.0;
    for _ in 0..10 {
        let status = simulation.advance(&Command::torque(vec![torque; 2]), 1000).expect("steps");
        assert_eq!(status, Status::Running);
        for _ in 0..1000 {
            let h = 0.01;
            let k1 = rate(rise);
            let k2 = rate(rise + 0.5 * h * k1);
            let k3 = rate(rise + 0.5 * h * k2);
            let k4 = rate(rise + h * k3);
            rise += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        }
        let warm = simulation.state().wheels[0].winding_rise;
        assert!((warm / rise - 1.0).abs() < TEMPERATURE, "{warm} K, expected {rise} K");
        let signals = simulation.signals();
        assert!((signals.body.power / (2.0 * power(warm)) - 1.0).abs() < ROUNDING);
        assert_eq!(signals.wheels[0].torque, torque);
    }
    // Near the exponential of the cold winding's power: the coefficients move it by a few per cent.
    let exponential = thermal * cold * (1.0 - (-100.0 / constant).exp());
    assert!(rise > exponential && rise < 1.05 * exponential, "{rise} K, {exponential} K");
}

#[test]
fn property_a_lossy_rover_stays_parked_and_its_drive_reverses_without_chatter() {
    let mut rover = Rover::two_wheeled();
    rover.terrain = Terrain::new(Profile::Slope(Slope { slope: 3.0_f64.to_radians() }));
    rover.effects = geared(0.5);
    let mut parked = Simulation::new(rover.clone(), 0.0, 0.002).expect("settles");
    parked.advance(&Command::torque(vec![0.0; 2]), 30_000).expect("steps");
    let moved = parked.signals().body.x;
    assert!(moved.abs() < 1e-3, "moved {moved} m in a minute");
    rover.soil.shear_modulus = 0.01;
    let mut reversing = Simulation::new(rover, 0.0, 0.002).expect("settles");
    let (mut before, mut reversals) = (0.0, 0);
    for torque in [4.5, -4.5] {
        for _ in 0..500 {
            reversing.advance(&Command::torque(vec![torque; 2]), 1).expect("steps");
            let speed = reversing.signals().wheels[0].speed;
            reversals += usize::from(speed * before < 0.0);
            before = speed;
        }
        assert!(before * torque > 0.0, "it follows {torque} N m: {before} rad/s");
    }
    assert!(reversals <= 3, "{reversals} reversals for one command");
}
