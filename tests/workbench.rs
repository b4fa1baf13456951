//! An experiment held ready gives the numbers of a comparison, and what is tried on it by hand those of a diagnosis's fit.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "support/hill_drive.rs"]
#[allow(dead_code, reason = "tests use parts of it")]
mod hill_drive;

use bekker::diagnosis::{Axis, CompareError, CompareOptions, Fit, Given, Workbench, compare};
use bekker::measurement::Experiment;
use std::collections::BTreeMap;

const SAND: &str = "examples/sand_wheel";

type Values = BTreeMap<String, f64>;

fn sand() -> Experiment {
    Experiment::read(SAND).unwrap()
}

fn calibrating() -> CompareOptions {
    CompareOptions { calibrate: true, ..CompareOptions::default() }
}

/// The values at which a calibrated workbench stands.
fn found(bench: &Workbench) -> Values {
    let all = bench.baseline().unwrap().calibration.parameters.iter();
    all.map(|parameter| (parameter.variable.name.clone(), parameter.value)).collect()
}

fn assert_same(a: &Fit, b: &Fit) {
    assert_eq!(a.rmse, b.rmse);
    for (a, b) in a.runs.iter().zip(&b.runs).flat_map(|(a, b)| a.signals.iter().zip(&b.signals)) {
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&a.modelled), bits(&b.modelled), "{}", a.signal);
    }
}

#[test]
fn agreement_a_trial_of_the_given_model_is_the_comparison() {
    let experiment = sand();
    let bench = Workbench::open(Given::default(), &experiment).unwrap();
    let trial = bench.trial(&Values::new(), false).unwrap();
    let comparison = compare(Given::default(), &experiment, &CompareOptions::default()).unwrap();
    assert_same(&trial.fit, comparison.fit());
    assert_eq!(bench.noise_floor(), &comparison.noise_floor);
    assert_eq!(trial.failures, comparison.failures);
}

#[test]
fn agreement_a_calibrated_workbench_is_the_calibrated_comparison() {
    let experiment = sand();
    let bench = Workbench::open(Given::default(), &experiment).unwrap().calibrated(&|| false).unwrap();
    let comparison = compare(Given::default(), &experiment, &calibrating()).unwrap();
    let (calibration, fit) = comparison.calibrated.as_ref().unwrap();
    assert_eq!(&bench.baseline().unwrap().calibration, calibration);
    assert_eq!(bench.noise_floor(), &comparison.noise_floor);
    assert_same(&bench.trial(&found(&bench), false).unwrap().fit, fit);
    let model = bench.model(&found(&bench)).unwrap();
    assert_eq!(model.to_toml().unwrap(), comparison.model.to_toml().unwrap());
}

#[test]
fn agreement_of_a_drive_in_windows() {
    let experiment = hill_drive::drive(|_, _| true);
    let shipped = hill_drive::shipped();
    let bench = Workbench::open(&shipped, &experiment).unwrap().calibrated(&|| false).unwrap();
    let comparison = compare(&shipped, &experiment, &calibrating()).unwrap();
    let trial = bench.trial(&found(&bench), true).unwrap();
    assert_same(&trial.fit, comparison.fit());
    assert_eq!(trial.fit.motion, comparison.fit().motion);
    assert!(bench.sketch(Axis::Slip, &Values::new()).unwrap().is_none());
}

#[test]
fn property_the_missing_effect_brings_the_error_to_the_noise() {
    let experiment = sand();
    let bench = Workbench::open(Given::default(), &experiment).unwrap().calibrated(&|| false).unwrap();
    let before = bench.trial(&found(&bench), false).unwrap();
    let effects = ["slip_sinkage".to_owned()];
    let fit = bench.fitted(&effects, &found(&bench), &|| false).unwrap().unwrap();
    let values: Values = fit.parameters.iter().map(|p| (p.variable.name.clone(), p.value)).collect();
    let after = bench.trial(&values, false).unwrap();
    for (signal, floor) in bench.noise_floor() {
        let floor = floor.value().unwrap();
        // The noise of a sample, and what calibration takes of it.
        assert!(after.fit.rmse[signal] < 1.2 * floor, "{signal}: {} against {floor}", after.fit.rmse[signal]);
    }
    assert!(before.fit.rmse["drawbar_pull"] > 1.5 * after.fit.rmse["drawbar_pull"]);
    let curves = bench.sketch(Axis::Slip, &values).unwrap().unwrap();
    assert_eq!(curves.groups.len(), 6, "three loads at two speeds");
    let model = bench.model(&values).unwrap();
    assert!(model.to_toml().unwrap().contains("slip_sinkage"));
}

#[test]
fn property_what_cannot_be_set_is_refused() {
    let bench = Workbench::open(Given::default(), &sand()).unwrap();
    let set = |name: &str, value: f64| bench.trial(&[(name.to_owned(), value)].into(), false).unwrap_err().to_string();
    assert!(set("soil.cohesoin", 1.0).contains("did you mean soil.cohesion"));
    assert!(set("soil.cohesion", f64::NAN).contains("outside its allowed range"));
    assert!(set("soil.cohesion", -1.0).contains("outside its allowed range"));
    let effects = ["slip_sinking".to_owned()];
    let calibrated = bench.calibrated(&|| false).unwrap();
    let refused = calibrated.fitted(&effects, &Values::new(), &|| false).unwrap_err();
    assert!(matches!(refused, CompareError::UnknownEffect { .. }), "{refused}");
    assert_eq!(bench.calibrated(&|| true).unwrap_err(), CompareError::Interrupted);
}

#[test]
fn property_an_effect_has_a_strength_at_which_it_shows() {
    let bench = Workbench::open(Given::default(), &sand()).unwrap();
    let all = bench.parameters();
    let mut shown = BTreeMap::new();
    for parameter in all.iter().filter(|parameter| parameter.effect.is_some()) {
        assert!(parameter.variable.allows(parameter.typical), "{}", parameter.variable.name);
        // A place or a rate of an effect may keep its value.
        *shown.entry(&parameter.effect).or_insert(false) |= parameter.typical != parameter.start;
    }
    assert!(shown.len() > 15 && shown.values().all(|shown| *shown), "{shown:?}");
}
