//! Effects of the user's own in an experiment: read with their place, calibrated like those of the library.

use bekker::diagnosis::{CompareOptions, Rig, compare, steady_point};
use bekker::measurement::Experiment;
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A planted value comes back to the rounding of the data files (9 digits), magnified by the fit's conditioning.
const RECOVERY: f64 = 1e-6;
const PLANTED: f64 = 0.35;

/// Soil that softens under slip: not in the library.
const SOFTENING: &str = "[[effect]]\nid = 'softening'\ntarget = 'soil.k_phi'\nmode = 'factor'\n\
    expression = '1 - a * slip ^ 2'\nparameters.a = { neutral = 0.0, min = 0.0, max = 0.95 }\n";

/// A folder with the experiment of a wheel on softening soil; all parameters but the effect's are stated.
fn folder(name: &str, effects: &str, extra: &str) -> PathBuf {
    let mut model = Model::preset("two_wheeled").unwrap();
    model.add_effects(SOFTENING).unwrap();
    model.set("softening.a", PLANTED).unwrap();
    let rig = Rig::of(&model.rover);
    let mut csv = "load,slip,wheel_speed,drawbar_pull,torque,sinkage\n".to_owned();
    for (load, slip) in [(20.0, 0.1), (20.0, 0.3), (20.0, 0.6), (40.0, 0.1), (40.0, 0.3), (40.0, 0.6)] {
        let point = steady_point(&rig, load, slip, 0.5).unwrap();
        writeln!(csv, "{load},{slip},0.5,{:.9},{:.9},{:.9}", point.drawbar_pull, point.torque, point.sinkage).unwrap();
    }
    let stated = ["cohesion", "friction_angle", "k_phi", "exponent", "shear_modulus", "c1", "c2"]
        .map(|name| format!("\"soil.{name}\" = {}\n", model.get(&format!("soil.{name}")).unwrap()));
    let toml = format!(
        "name = 't'\nkind = 'single_wheel'\n[parameters]\n{}{extra}[[run]]\nfile = 'a.csv'\n{effects}",
        stated.concat()
    );
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("effects_custom_experiment").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("a.csv"), csv).unwrap();
    std::fs::write(folder.join("experiment.toml"), toml).unwrap();
    folder
}

#[test]
fn property_an_effect_of_the_experiment_is_calibrated() {
    // A prior frees it; this one is too wide to hold it.
    let free = folder("free", SOFTENING, "[priors]\n\"softening.a\" = { mean = 0.0, sd = 1000.0 }\n");
    let experiment = Experiment::read(free).unwrap();
    let model = Model::preset("two_wheeled").unwrap();
    let comparison =
        compare(&model, &experiment, &CompareOptions { calibrate: true, ..CompareOptions::default() }).unwrap();
    let (calibration, fit) = comparison.calibrated.as_ref().unwrap();
    let found: Vec<(&str, f64)> = calibration.parameters.iter().map(|p| (p.variable.name.as_str(), p.value)).collect();
    assert_eq!(found.len(), 1);
    assert!(found[0].0 == "softening.a" && (found[0].1 - PLANTED).abs() < RECOVERY, "{found:?}");
    let given = &comparison.given.as_ref().unwrap().rmse;
    for (signal, error) in &fit.rmse {
        assert!(*error < 1e-4 * given[signal], "{signal}: {error} after {}", given[signal]);
    }
}

#[test]
fn property_its_value_may_be_stated() {
    let stated = folder("stated", SOFTENING, &format!("\"softening.a\" = {PLANTED}\n"));
    let experiment = Experiment::read(stated).unwrap();
    let comparison = compare(
        &Model::preset("two_wheeled").unwrap(),
        &experiment,
        &CompareOptions { calibrate: false, ..CompareOptions::default() },
    )
    .unwrap();
    // The files have nine decimals.
    assert!(comparison.fit().rmse.values().all(|error| *error < 1e-9), "{:?}", comparison.fit().rmse);
}

#[test]
fn property_a_bad_effect_is_refused_with_its_line() {
    let bad = folder("bad", &SOFTENING.replace("slip ^ 2", "slipp ^ 2"), "");
    let text = std::fs::read_to_string(bad.join("experiment.toml")).unwrap();
    let line = text.lines().position(|line| line == "[[effect]]").unwrap() + 1;
    let message = Experiment::read(bad).unwrap_err().to_string();
    for word in ["experiment.toml", &format!("line {line}"), "`softening`", "character 9", "`slipp`", "sinkage"] {
        assert!(message.contains(word), "{message}: {word}");
    }
    let other = Experiment::read(folder("other", SOFTENING, "")).unwrap();
    let mut model = Model::preset("two_wheeled").unwrap();
    model.add_effects(&SOFTENING.replace("0.95", "0.5")).unwrap();
    let message = compare(&model, &other, &CompareOptions { calibrate: false, ..CompareOptions::default() })
        .unwrap_err()
        .to_string();
    assert!(message.contains("`softening`") && message.contains("taken"), "{message}");
}
