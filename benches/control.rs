//! How long a controller's command takes: `cargo bench --bench control`.

use bekker::control::{
    Controller, Nominal, RoughTerrainControl, Rtc, RtcOptions, Solver, VelocityControl, VelocityController,
};
use bekker::motor::Motor;
use bekker::signals::{Command, Measurement, Reference, WheelMeasurement};
use bekker::soil::Soil;
use bekker::wheel::Wheel;
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

/// 5 kg a wheel, 0.35 m from wheel to wheel.
fn rover(wheels: usize) -> Nominal {
    Nominal {
        gravity: 9.81,
        mass: 5.0 * wheels as f64,
        centre_of_mass: [0.175 * (wheels - 1) as f64, 0.15],
        wheel_centres: (0..wheels).map(|k| [0.35 * k as f64, 0.0]).collect(),
        wheel_bodies: vec![0; wheels],
        links: Vec::new(),
        wheel: Wheel::default(),
        motor: Motor { inverse_torque_limit: 0.2, ..Motor::default() },
        soil: Soil::default(),
    }
}

/// Readings that change from call to call, uphill on waves: mean slope 11 degrees, waves of 6 degrees.
fn reading(wheels: usize, call: usize) -> Measurement {
    let phase = 0.37 * call as f64;
    let wheel = |k: usize| WheelMeasurement {
        contact_angle: 0.2 + 0.1 * (phase + 1.3 * k as f64).sin(),
        speed: 2.0 + 0.3 * (phase + k as f64).cos(),
        ..WheelMeasurement::default()
    };
    Measurement {
        pitch: 0.2 + 0.05 * phase.sin(),
        velocity: 0.2 + 0.03 * (1.7 * phase).sin(),
        wheels: (0..wheels).map(wheel).collect(),
        ..Measurement::default()
    }
}

fn drive(bencher: Bencher, controller: &mut dyn Controller, wheels: usize) {
    let readings: Vec<Measurement> = (0..64).map(|call| reading(wheels, call)).collect();
    let (goal, mut command, mut call) = (Reference { velocity: 0.25 }, Command::torque(vec![0.0; wheels]), 0);
    bencher.bench_local(|| {
        call += 1;
        controller.command(black_box(&readings[call % 64]), &goal, &mut command).expect("finite readings");
        command.values[0]
    });
}

fn rtc(bencher: Bencher, wheels: usize, switch_angle: f64, solver: Solver) {
    let parameters = RoughTerrainControl { gain: 10.0, switch_angle, ..RoughTerrainControl::default() };
    let options = RtcOptions { solver, ..RtcOptions::default() };
    let mut controller = Rtc::with_options(rover(wheels), parameters, options).expect("a valid rover");
    for call in 0..64 {
        let (goal, mut command) = (Reference { velocity: 0.25 }, Command::torque(vec![0.0; wheels]));
        controller.command(&reading(wheels, call), &goal, &mut command).expect("finite readings");
        let outcome = controller.outcome().expect("commanded");
        assert!(outcome.feasible && outcome.objective > 0.0, "the benchmark is about problems with a solution");
    }
    drive(bencher, &mut controller, wheels);
}

#[divan::bench(args = [2, 6])]
fn rtc_minimum_power(bencher: Bencher, wheels: usize) {
    rtc(bencher, wheels, 1.6, Solver::Clarabel);
}

#[divan::bench(args = [2, 6])]
fn rtc_minimum_power_active_set(bencher: Bencher, wheels: usize) {
    rtc(bencher, wheels, 1.6, Solver::ActiveSet);
}

#[divan::bench(args = [2, 6])]
fn rtc_maximum_traction(bencher: Bencher, wheels: usize) {
    rtc(bencher, wheels, 0.0, Solver::Clarabel);
}

#[divan::bench(args = [2, 6])]
fn rtc_maximum_traction_active_set(bencher: Bencher, wheels: usize) {
    rtc(bencher, wheels, 0.0, Solver::ActiveSet);
}

#[divan::bench(args = [2, 6])]
fn velocity_control(bencher: Bencher, wheels: usize) {
    let mut controller = VelocityController::new(&rover(wheels), VelocityControl::default()).expect("a valid rover");
    drive(bencher, &mut controller, wheels);
}
