//! Identification of the soil: `cargo bench --bench identification`.

use bekker::control::Nominal;
use bekker::estimation::soil::{
    ClosedForm, Deviations, Reading, SoilIdentification, SoilIdentifier, StrengthFilter, StrengthParameters, predict,
};
use bekker::model::nominal;
use bekker::rover::Rover;
use bekker::signals::{Measurement, WheelMeasurement};
use bekker::soil::Soil;
use bekker::wheel::Wheel;
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

const ERRORS: Deviations = Deviations { load: 0.2, torque: 0.01, sinkage: 0.0005, slip: 0.01 };

fn sand() -> Soil {
    Soil { k_phi: 1_545_000.0, exponent: 1.1, shear_modulus: 0.01, ..Soil::default() }
}

fn wheel() -> Wheel {
    Wheel { radius: 0.073, width: 0.06, ..Wheel::default() }
}

/// Readings of a slowly changing slip and load, their torques those of the sand.
fn readings() -> Vec<Reading> {
    let reading = |k: usize| {
        let phase = 0.21 * k as f64;
        let (load, slip) = (25.0 + 10.0 * phase.sin(), 0.3 + 0.2 * (1.7 * phase).cos());
        let reading = Reading { load, torque: 0.0, sinkage: 0.008 + 0.0002 * load, slip };
        Reading { torque: predict(&wheel(), &sand(), &StrengthParameters::of(&sand()), &reading).torque, ..reading }
    };
    (0..1000).map(reading).collect()
}

/// One recursive update after 500 others, on the full integrals with exact slopes.
#[divan::bench(args = [0.0, 1.0])]
fn filter_update(bencher: Bencher, shear_modulus_gain: f64) {
    let parameters = SoilIdentification { shear_modulus_gain, ..SoilIdentification::default() };
    let prior = Soil { friction_angle: 0.55, ..sand() };
    let mut filter = StrengthFilter::new(&wheel(), &prior, parameters).expect("valid");
    let readings = readings();
    for reading in &readings[..500] {
        filter.update(reading, &ERRORS).expect("a driven wheel");
    }
    let mut k = 500;
    bencher.bench_local(|| {
        k = if k == 999 { 500 } else { k + 1 };
        filter.update(black_box(&readings[k]), &ERRORS)
    });
}

/// The torque's equation alone, with its six slopes.
#[divan::bench]
fn equation(bencher: Bencher) {
    let reading = readings()[3];
    let strength = StrengthParameters::of(&sand());
    bencher.bench(|| predict(black_box(&wheel()), black_box(&sand()), &strength, black_box(&reading)));
}

/// c and phi from 20 readings by the thesis's closed form: pairs (2.25) and least squares.
#[divan::bench]
fn closed_form(bencher: Bencher) {
    let readings = readings();
    bencher.bench(|| {
        let closed = ClosedForm::new(&wheel(), 0.01, black_box(&readings[..20])).expect("driven wheels");
        (closed.by_pairs(), closed.least_squares())
    });
}

/// From sensors to soil on board: loads, slips, sinkages and one update a wheel.
#[divan::bench]
fn on_board(bencher: Bencher) {
    let sheet: Nominal = nominal(&Rover { soil: sand(), ..Rover::two_wheeled() });
    let mut identifier = SoilIdentifier::new(&sheet, SoilIdentification::default()).expect("valid");
    let wheel = WheelMeasurement { speed: 2.5, torque: 1.6, contact_angle: 0.0 };
    let mut measured = Measurement { velocity: 0.18, wheels: vec![wheel; 2], ..Measurement::default() };
    bencher.bench_local(|| {
        measured.time += 0.01;
        measured.wheels[0].speed = 2.5 + 0.3 * (3.0 * measured.time).sin();
        identifier.update(black_box(&measured))
    });
}
