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

/// Plates, a shear box and a wheel as if on one soil: three kinds of experiment.
fn three_kinds() -> Experiment {
    let read = |name: &str| Experiment::read(format!("examples/{name}")).unwrap();
    Experiment::joint(vec![read("sand_plates"), read("sand_shear"), read("sand_wheel")]).unwrap()
}

/// The same wheel twice.
fn twice(experiment: &Experiment) -> Experiment {
    Experiment::joint_named(vec![("a".to_owned(), experiment.clone()), ("b".to_owned(), experiment.clone())]).unwrap()
}

/// What a trial of a set shows of each part is what the comparison of the set has there, under names of its own.
fn assert_parts(bench: &Workbench, values: &Values, all: &Fit) {
    let trial = bench.trial(values, false).unwrap();
    assert_same(&trial.fit, all);
    let set = bench.experiment();
    let (mut seen, mut by_itself) = (0, 0);
    for (k, (part, runs)) in set.parts.iter().zip(set.runs_of_parts()).enumerate() {
        let own = bench.trial_of_part(k, &trial, values, false).unwrap().fit;
        seen += own.rmse.len();
        for (signal, error) in &own.rmse {
            assert_eq!(all.rmse[&part.signal(signal)].to_bits(), error.to_bits(), "{signal} of {}", part.name);
        }
        for ((mine, of_all), read) in own.runs.iter().zip(&all.runs[runs]).zip(&part.experiment.runs) {
            assert_eq!((mine.run.as_str(), &of_all.run), (read.name.as_str(), &format!("{}/{}", part.name, read.name)));
            let names: Vec<String> = mine.signals.iter().map(|signal| part.signal(&signal.signal)).collect();
            assert_eq!(names, of_all.signals.iter().map(|signal| signal.signal.clone()).collect::<Vec<_>>());
        }
        // The part by itself, with what the values of the set are there, gives the same.
        let values = bench.values_of_part(k, values).unwrap();
        let alone = &bench.parts()[k];
        // The scatter of the soil may carry a part beyond the bounds of a parameter, which the part by itself then refuses, and only then.
        let within = alone
            .parameters()
            .iter()
            .map(|parameter| &parameter.variable)
            .all(|variable| values.get(&variable.name).is_none_or(|value| variable.allows(*value)));
        match alone.trial(&values, false) {
            Ok(trial) => assert_same(&trial.fit, &own),
            Err(error) => assert!(!within, "{error}"),
        }
        by_itself += usize::from(within);
    }
    assert_eq!(seen, all.rmse.len());
    assert!(by_itself > 0);
}

#[test]
fn agreement_a_set_has_the_numbers_of_its_comparison() {
    let set = three_kinds();
    let bench = Workbench::open(Given::default(), &set).unwrap();
    let comparison = compare(Given::default(), &set, &CompareOptions::default()).unwrap();
    assert_parts(&bench, &Values::new(), comparison.fit());
    assert_eq!(bench.noise_floor(), &comparison.noise_floor);
    assert_eq!(bench.trial(&Values::new(), false).unwrap().failures, comparison.failures);
    // A wheel's curves are drawn of its part; tests of a soil have none.
    let curves = |k: usize| bench.sketch_of_part(k, Axis::Slip, &Values::new());
    assert!(curves(0).unwrap().is_none() && curves(2).unwrap().is_some());
    assert!(Workbench::open(Given::default(), &sand()).unwrap().parts().is_empty());
}

#[test]
fn agreement_a_calibrated_set_is_the_calibrated_comparison_and_saves_its_models() {
    let set = three_kinds();
    let bench = Workbench::open(Given::default(), &set).unwrap().calibrated(&|| false).unwrap();
    let comparison = compare(Given::default(), &set, &calibrating()).unwrap();
    let (calibration, fit) = comparison.calibrated.as_ref().unwrap();
    assert_eq!(&bench.baseline().unwrap().calibration, calibration);
    assert_eq!(bench.noise_floor(), &comparison.noise_floor);
    let values = found(&bench);
    assert_parts(&bench, &values, fit);
    for (k, (name, model)) in comparison.part_models.iter().enumerate() {
        let own = bench.model_of_part(k, &values).unwrap();
        assert_eq!(own.to_toml().unwrap(), model.to_toml().unwrap(), "{name}");
    }
}

#[test]
fn property_an_effect_acts_in_the_parts_in_which_it_is_placed() {
    let bench = Workbench::open(Given::default(), &twice(&sand())).unwrap();
    let modelled = |values: &[(&str, f64)]| {
        let values: Values = values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        let trial = bench.trial(&values, false).unwrap();
        let of_part = |k: usize| bench.trial_of_part(k, &trial, &values, false).unwrap().fit;
        (of_part(0), of_part(1), bench.values_of_part(0, &values).unwrap())
    };
    let (a, b, _) = modelled(&[]);
    let (a_with, b_without, _) = modelled(&[("slip_sinkage in a.n1", 0.3)]);
    let (a_too, b_too, _) = modelled(&[("slip_sinkage.n1", 0.3)]);
    assert_same(&b, &b_without);
    assert_same(&a_with, &a_too);
    assert_same(&a_too, &b_too);
    assert_ne!(a.rmse, a_with.rmse);
    // Where an effect acts everywhere and in one part besides, the strengths add up there.
    let (sum, _, own) = modelled(&[("slip_sinkage.n1", 0.1), ("slip_sinkage in a.n1", 0.2)]);
    assert_eq!(own["slip_sinkage.n1"], 0.1 + 0.2);
    assert!((sum.rmse["sinkage"] / a_with.rmse["sinkage"] - 1.0).abs() < 1e-9, "0.1 + 0.2 is 0.3 but for rounding");
    // The scatter of the soil may carry a part beyond the bounds of the set's own parameter.
    let most = bench.parameters().iter().find(|p| p.variable.name == "soil.cohesion").unwrap().variable.max;
    let beyond: Values = [("soil.cohesion".to_owned(), most), ("soil_scatter in a.cohesion".to_owned(), 1.2)].into();
    let trial = bench.trial(&beyond, false).unwrap();
    assert!(bench.values_of_part(0, &beyond).unwrap()["soil.cohesion"] > most);
    assert!(bench.trial_of_part(0, &trial, &beyond, true).is_ok());
    assert!(bench.sketch_of_part(0, Axis::Slip, &beyond).unwrap().is_some());
    // What is known of one rig is moved there alone.
    let (larger, same, own) = modelled(&[("wheel in a.radius", 0.15)]);
    let alone = Workbench::open(Given::default(), &sand()).unwrap();
    assert_same(&larger, &alone.trial(&[("wheel.radius".to_owned(), 0.15)].into(), false).unwrap().fit);
    assert_same(&same, &b);
    assert_eq!(own["wheel.radius"], 0.15);
    let values = [("wheel in a.radius".to_owned(), 0.15)].into();
    let radius = |k: usize| bench.model_of_part(k, &values).unwrap().rover.wheel.radius;
    assert!(radius(0) == 0.15 && radius(1) != 0.15);
    // It shows at the same strength wherever it acts.
    let typical = |name: &str| bench.parameters().iter().find(|p| p.variable.name == name).unwrap().typical;
    assert_eq!(typical("slip_sinkage in b.n1"), typical("slip_sinkage.n1"));
    let parts = |name: &str| bench.parameters().iter().find(|p| p.variable.name == name).unwrap().parts.clone();
    assert_eq!(parts("soil.k_phi"), None);
    assert_eq!(parts("slip_sinkage.n1"), Some(vec![0, 1]));
    assert_eq!(parts("slip_sinkage in b.n1"), Some(vec![1]));
}

#[test]
fn agreement_a_drive_of_a_set_moves_as_by_itself() {
    let drive = hill_drive::drive(|_, _| true);
    let shipped = hill_drive::shipped();
    let alone = Workbench::open(&shipped, &drive).unwrap();
    let set = Workbench::open(&shipped, &twice(&drive)).unwrap();
    let values: Values = [("soil.friction_angle".to_owned(), 0.5)].into();
    let expected = alone.trial(&values, true).unwrap();
    let trial = set.trial(&values, false).unwrap();
    for k in 0..2 {
        let own = set.trial_of_part(k, &trial, &values, true).unwrap().fit;
        assert_same(&own, &expected.fit);
        assert_eq!(own.motion, expected.fit.motion);
        assert_eq!(set.uncounted_of_part(k), alone.uncounted());
    }
}
