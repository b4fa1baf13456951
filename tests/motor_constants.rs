//! Torques from currents: a motor's constants with a prior are calibrated with the soil, and come back from what was measured.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::diagnosis::{CalibratedParameter, CompareOptions, compare};
use bekker::measurement::Experiment;
use bekker::model::Model;
use bekker::modeldescription::Lookup;

/// Time between rows, s, and rows of the drive.
const PERIOD: f64 = 0.05;
const ROWS: usize = 81;
/// Step of recorded drive and calibration, s.
const STEP: f64 = 0.005;
/// Planted constants and what is believed of them before: a mean and a standard deviation, 30 % off and wide.
const TORQUE_CONSTANT: (f64, f64) = (0.030, 0.0234);
const RESISTANCE: (f64, f64) = (1.3, 1.0);
const WIDE: f64 = 0.5;
/// Planted values come back to where the search ends; what the wide priors pull is less.
const RECOVERY: f64 = 1e-3;

/// A drive with the planted soil and motors, of which these signals are recorded: the sum of the currents, and others.
fn drive(others: &[&str]) -> String {
    let mut model = Model::preset("two_wheeled_speed").unwrap();
    model.stepping.step_size = STEP;
    for (name, value) in [
        ("soil.friction_angle", 0.55),
        ("motor.torque_constant", TORQUE_CONSTANT.0),
        ("motor.resistance", RESISTANCE.0),
    ] {
        model.set(name, value).unwrap();
    }
    let mut run = model.start().unwrap();
    let mut csv =
        format!("time,wheel[1].speed_command,wheel[2].speed_command,wheel[1+2].current,{}\n", others.join(","));
    for row in 0..ROWS {
        let current: f64 = run.signals().wheels.iter().map(|wheel| wheel.current).sum();
        let mut signals = run.signals().clone();
        let measured: Vec<String> = others.iter().map(|name| format!("{:?}", signals.get(name).unwrap())).collect();
        let command = 2.0 + (row as f64 * 0.3).sin();
        csv += &format!("{:?},{command:?},{command:?},{current:?},{}\n", row as f64 * PERIOD, measured.join(","));
        run.inputs_mut().set_all(&[command; 2]).unwrap();
        run.advance((PERIOD / STEP).round() as u64).unwrap();
    }
    csv
}

/// Calibrates soil and constants; what is free, by name.
fn calibrated(priors: &str, csv: String) -> Vec<CalibratedParameter> {
    let soil = Model::preset("two_wheeled").unwrap().rover.soil;
    let toml = format!(
        "name = \"currents\"\nkind = \"traverse\"\n[parameters]\n\"soil.cohesion\" = {}\n\"soil.k_phi\" = {}\n\
         \"soil.exponent\" = 1\n\"soil.shear_modulus\" = {}\n\"soil.c1\" = 0.4\n\"soil.c2\" = 0.2\n[priors]\n{priors}\
         [[run]]\nfile = \"drive.csv\"\n",
        soil.cohesion, soil.k_phi, soil.shear_modulus
    );
    let texts = [("experiment.toml".to_owned(), toml), ("drive.csv".to_owned(), csv)];
    let experiment = Experiment::from_texts(&texts.into()).unwrap();
    let mut model = Model::preset("two_wheeled_speed").unwrap();
    model.stepping.step_size = STEP;
    let options = CompareOptions { calibrate: true, ..CompareOptions::default() };
    compare(&model, &experiment, &options).unwrap().calibrated.unwrap().0.parameters
}

fn assert_planted(found: &[CalibratedParameter], planted: &[(&str, f64)]) {
    assert_eq!(found.len(), planted.len(), "{found:?}");
    for (name, value) in planted {
        let parameter = found.iter().find(|parameter| parameter.variable.name == *name).unwrap();
        assert!((parameter.value / value - 1.0).abs() < RECOVERY, "{parameter:?}, planted {value}");
        let error = parameter.deviation.unwrap();
        assert!(parameter.prior.is_none_or(|prior| error < prior.deviation), "{parameter:?}");
    }
}

#[test]
fn property_currents_tell_the_torque_constant_where_motion_tells_the_soil() {
    let (planted, believed) = TORQUE_CONSTANT;
    let prior = format!("\"motor.torque_constant\" = {{ mean = {believed}, sd = {} }}\n", WIDE * believed);
    let found = calibrated(&prior, drive(&["x", "velocity"]));
    assert_planted(&found, &[("soil.friction_angle", 0.55), ("motor.torque_constant", planted)]);
}

#[test]
fn property_power_in_the_windings_tells_the_resistance() {
    let prior = |name: &str, (_, believed): (f64, f64)| {
        format!("\"motor.{name}\" = {{ mean = {believed}, sd = {} }}\n", WIDE * believed)
    };
    let priors = prior("torque_constant", TORQUE_CONSTANT) + &prior("resistance", RESISTANCE);
    let found = calibrated(&priors, drive(&["x", "velocity", "power"]));
    let planted = [
        ("soil.friction_angle", 0.55),
        ("motor.torque_constant", TORQUE_CONSTANT.0),
        ("motor.resistance", RESISTANCE.0),
    ];
    assert_planted(&found, &planted);
}

#[test]
fn property_without_a_prior_the_constants_stay() {
    let found = calibrated("", drive(&["x"]));
    assert!(found.iter().all(|parameter| !parameter.variable.name.starts_with("motor.")), "{found:?}");
}
