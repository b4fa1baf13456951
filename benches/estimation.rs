//! How long an estimator's update takes: `cargo bench --bench estimation`.
//!
//! `pair` is one cycle of the thesis's Kalman filter: prediction and update of the six states of one pair of wheels, by
//! readings that change from call to call; the thesis states 0.6 ms a cycle of its rover, with a 486 processor. `rocker_bogie` is the update
//! of all three wheels of a rocker-bogie side from a measurement (two pairs), `six_wheels` that of six on one body (six
//! pairs). `direct_solution` is the solution of one reading without a filter.

use bekker::estimation::contact_angle::{PairFilter, PairModel, PairMotion, PairNoise, PairReading, direct};
use bekker::estimation::{ContactAngleEstimation, ContactAngles};
use bekker::model::nominal;
use bekker::rover::Rover;
use bekker::signals::{LinkMeasurement, Measurement, WheelMeasurement};
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

/// Readings of a drive over waves.
const READINGS: usize = 64;

/// The line swings by 0.02 rad once in all readings, 10 ms apart, at a steady speed.
fn motion(call: usize) -> PairMotion {
    let turn = std::f64::consts::TAU / READINGS as f64;
    let (sin, cos) = (turn * call as f64).sin_cos();
    PairMotion { inclination: 0.02 * sin, rate: 0.02 * turn / 0.01 * cos, speeds: [0.2; 2] }
}

#[divan::bench]
fn pair(bencher: Bencher) {
    let model = PairModel {
        distance: 0.7,
        rate_drift: 0.05,
        speed_drift: 0.05,
        offset: 0.0,
        angle_deviation: 0.25,
        correlation_length: 0.1,
        kinematic_error: 0.1,
    };
    let readings: Vec<PairReading> = (0..READINGS)
        .map(|call| {
            let PairMotion { inclination, rate, speeds: [v1, v2] } = motion(call);
            PairReading { inclination: [inclination, 1e-4], rate: Some([rate, 1e-4]), speeds: [[v1, 1e-5], [v2, 1e-5]] }
        })
        .collect();
    let mut filter = PairFilter::new(model, &readings[0]);
    let mut call = 0;
    bencher.bench_local(|| {
        call = (call + 1) % READINGS;
        black_box(filter.step(0.01, black_box(&readings[call])))
    });
}

fn rover(bencher: Bencher, rover: &Rover) {
    let mut estimator = ContactAngles::new(&nominal(rover), ContactAngleEstimation::default()).expect("pairs");
    let mut measurements: Vec<Measurement> = (0..READINGS)
        .map(|call| {
            let PairMotion { inclination, rate, speeds } = motion(call);
            let wheel = |k: usize| WheelMeasurement { speed: 10.0 * speeds[k % 2], ..WheelMeasurement::default() };
            let link = LinkMeasurement { angle: 0.5 * inclination, rate: 0.5 * rate };
            Measurement {
                pitch: inclination,
                pitch_rate: rate,
                wheels: (0..rover.wheels.len()).map(wheel).collect(),
                links: vec![link; rover.links.len()],
                ..Measurement::default()
            }
        })
        .collect();
    let mut call = 0_usize;
    bencher.bench_local(|| {
        call += 1;
        let measured = &mut measurements[call % READINGS];
        measured.time = 0.01 * call as f64;
        estimator.update(black_box(measured)).expect("finite readings");
        black_box(estimator.angles()[0])
    });
}

#[divan::bench]
fn rocker_bogie(bencher: Bencher) {
    rover(bencher, &Rover::rocker_bogie());
}

#[divan::bench]
fn six_wheels(bencher: Bencher) {
    rover(bencher, &Rover::rigid(&[-0.5, -0.3, -0.1, 0.1, 0.3, 0.5]));
}

#[divan::bench]
fn direct_solution(bencher: Bencher) {
    let motions: Vec<PairMotion> = (0..READINGS).map(motion).collect();
    let noise = PairNoise { inclination: 1e-3, rate: 1e-3, speeds: [1e-3; 2] };
    let mut call = 0;
    bencher.bench_local(|| {
        call = (call + 1) % READINGS;
        black_box(direct(0.7, black_box(&motions[call]), &noise))
    });
}
