//! A wheel on a carriage against measurements: steady points, derivatives, calibration, the shipped experiment.

use bekker::contact::rolling;
use bekker::diagnosis::{CompareOptions, Comparison, Rig, compare, levels, steady_point};
use bekker::effects::Effects;
use bekker::measurement::Experiment;
use bekker::model::Model;
use bekker::modeldescription::{Lookup, Parameters};
use bekker::rover::Environment;
use bekker::scalar::Dual;
use bekker::soil::Soil;
use bekker::wheel::Wheel;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The soil carries the load to rounding of the solver.
const BALANCE: f64 = 1e-11;
/// Exact derivatives against central differences of step 1e-5: their truncation error.
const DIFFERENCE: f64 = 1e-6;
/// Planted values come back to the rounding of the data files (9 digits), magnified by the fit's conditioning.
const RECOVERY: f64 = 1e-3;

/// Noise that the generator put in (it prints them): 2 % of each signal's root mean square.
const PLANTED_NOISE: [(&str, f64); 3] = [("drawbar_pull", 0.094), ("torque", 0.0362), ("sinkage", 0.00044)];
/// 108 degrees of freedom give a standard deviation to 7 %, and the scatter of whole runs counts as less than that
/// many independent values: 20 % is about two standard errors.
const NOISE_ESTIMATE: f64 = 0.2;
/// An error this many times the scatter of repeats is structure: four standard errors above the 1 that noise alone gives.
const STRUCTURE: f64 = 1.0 + 2.0 * NOISE_ESTIMATE;

const FREE: [&str; 7] =
    ["soil.cohesion", "soil.friction_angle", "soil.k_phi", "soil.exponent", "soil.shear_modulus", "soil.c1", "soil.c2"];

fn dry_sand() -> Rig {
    let wheel = Wheel { radius: 0.1, width: 0.12, ..Wheel::default() };
    let soil = Soil {
        cohesion: 1040.0,
        friction_angle: 28.0_f64.to_radians(),
        k_c: 990.0,
        k_phi: 1_528_430.0,
        exponent: 1.1,
        shear_modulus: 0.016,
        ..Soil::default()
    };
    Rig { environment: Environment::default(), wheel, soil, effects: Effects::default() }
}

/// The thesis's rover; a carriage tests its wheel, soil and effects.
fn baseline() -> Model {
    Model::preset("two_wheeled").unwrap()
}

fn shipped() -> Experiment {
    Experiment::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/sand_wheel")).unwrap()
}

fn run(experiment: &Experiment, calibrate: bool) -> Comparison {
    compare(&baseline(), experiment, &CompareOptions { calibrate, ..CompareOptions::default() }).unwrap()
}

#[test]
fn property_the_soil_carries_the_load() {
    let rig = dry_sand();
    for (slip, speed) in [(0.0, 0.5), (0.3, 0.5), (1.0, 0.5), (-0.4, 0.5), (-1.0, 0.0), (0.3, -0.5)] {
        let point = steady_point(&rig, 40.0, slip, speed).unwrap();
        let velocity = match slip {
            -1.0 => 0.1,
            s if s >= 0.0 => 0.1 * speed * (1.0 - s),
            s => 0.1 * speed / (1.0 + s),
        };
        let forces = rolling(&rig.wheel, &rig.soil, 0.0, point.sinkage, velocity, speed);
        assert!((forces.normal / 40.0 - 1.0).abs() < BALANCE, "slip {slip}: {forces:?}");
        assert!((forces.drawbar - point.drawbar_pull).abs() < BALANCE * 40.0);
        assert!((forces.torque - point.torque).abs() < BALANCE * 4.0);
    }
    let (ahead, back) = (steady_point(&rig, 40.0, 0.3, 0.5).unwrap(), steady_point(&rig, 40.0, 0.3, -0.5).unwrap());
    assert!((ahead.drawbar_pull + back.drawbar_pull).abs() < BALANCE * 40.0, "backward mirrors forward");
}

#[test]
fn property_impossible_points_are_refused() {
    let rig = dry_sand();
    let message = |load, slip, speed| steady_point(&rig, load, slip, speed).unwrap_err().to_string();
    assert!(message(1e5, 0.2, 0.5).contains("sinks to its axle"));
    assert!(message(40.0, 0.2, 0.0).contains("impossible"));
    assert!(message(40.0, -1.0, 0.5).contains("locked"));
    assert!(message(40.0, f64::NAN, 0.5).contains("impossible"));
    assert!(steady_point(&rig, f64::NAN, 0.2, 0.5).is_err());
}

/// Drawbar pull, torque and sinkage with one soil parameter shifted by a share of itself.
fn shifted(name: &str, share: f64, slip: f64) -> [f64; 3] {
    let mut rig = dry_sand();
    let value = rig.get(name).unwrap();
    rig.set(name, value * (1.0 + share)).unwrap();
    let point = steady_point(&rig, 40.0, slip, 0.5).unwrap();
    [point.drawbar_pull, point.torque, point.sinkage]
}

#[test]
fn agreement_derivatives_through_the_balance_are_those_of_differences() {
    const STEP: f64 = 1e-5;
    for slip in [-0.3, 0.05, 0.6] {
        for name in FREE {
            let mut rig = dry_sand().map(&Dual::<1>::from);
            rig.visit("", &mut |variable, value| {
                if variable.name == name {
                    *value = value.derivative(0);
                }
            });
            let point = steady_point(&rig, 40.0, slip, 0.5).unwrap();
            let exact = [point.drawbar_pull, point.torque, point.sinkage].map(|x| x.eps.0.map_or(0.0, |d| d[0]));
            let (plus, minus) = (shifted(name, STEP, slip), shifted(name, -STEP, slip));
            let value = dry_sand().get(name).unwrap();
            for k in 0..3 {
                let difference = (plus[k] - minus[k]) / (2.0 * STEP * value);
                let scale = plus[k].abs() / value;
                assert!((exact[k] - difference).abs() < DIFFERENCE * scale, "{name} at {slip}: {exact:?} {difference}");
            }
        }
    }
}

/// An experiment without noise, computed by the model itself from a planted soil.
fn planted(name: &str) -> (PathBuf, Rig) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("compare_single_wheel").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    let rig = dry_sand();
    let mut csv = "load,slip,wheel_speed,drawbar_pull,torque,sinkage\n".to_owned();
    for load in [20.0, 40.0, 70.0] {
        for slip in [0.02, 0.1, 0.2, 0.35, 0.5, 0.7] {
            let p = steady_point(&rig, load, slip, 0.5).unwrap();
            writeln!(csv, "{load},{slip},0.5,{:.9e},{:.9e},{:.9e}", p.drawbar_pull, p.torque, p.sinkage).unwrap();
        }
    }
    std::fs::write(folder.join("run.csv"), csv).unwrap();
    (folder, rig)
}

#[test]
fn property_calibration_recovers_planted_parameters() {
    let (folder, mut rig) = planted("recover");
    let known = "\"wheel.radius\" = 0.1\n\"wheel.width\" = 0.12\n\"soil.k_c\" = 990\n";
    let toml = format!("name = \"p\"\nkind = \"single_wheel\"\n[parameters]\n{known}[[run]]\nfile = \"run.csv\"\n");
    std::fs::write(folder.join("experiment.toml"), toml).unwrap();
    let comparison = run(&Experiment::read(&folder).unwrap(), true);
    let (calibration, fit) = comparison.calibrated.as_ref().unwrap();
    assert!(calibration.converged && calibration.agreeing >= 2, "{calibration:?}");
    assert_eq!(calibration.parameters.iter().map(|p| p.variable.name.as_str()).collect::<Vec<_>>(), FREE);
    for parameter in &calibration.parameters {
        let truth = rig.get(&parameter.variable.name).unwrap();
        assert!((parameter.value / truth - 1.0).abs() < RECOVERY, "{parameter:?}");
        assert!(!parameter.at_bound && parameter.deviation.is_some());
    }
    assert!(fit.rmse["drawbar_pull"] < 1e-6, "{:?}", fit.rmse);
    assert!(comparison.given.as_ref().unwrap().rmse["drawbar_pull"] > 0.5, "the default soil is another one");
    assert_eq!(comparison.noise_floor["torque"].value(), None, "no repeats and nothing stated: unknown");
}

#[test]
fn property_stated_parameters_stay_and_priors_pull() {
    let (folder, _) = planted("prior");
    let write = |more: &str| {
        let known = "\"wheel.radius\" = 0.1\n\"wheel.width\" = 0.12\n\"soil.k_c\" = 990\n\"soil.cohesion\" = 2000\n";
        let toml =
            format!("name = \"p\"\nkind = \"single_wheel\"\n[parameters]\n{known}{more}[[run]]\nfile = \"run.csv\"\n");
        std::fs::write(folder.join("experiment.toml"), toml).unwrap();
        Experiment::read(&folder).unwrap()
    };
    let comparison = run(&write(""), true);
    let fixed = &comparison.calibrated.as_ref().unwrap().0;
    assert!(fixed.parameters.iter().all(|p| p.variable.name != "soil.cohesion"), "stated without a prior: known");
    let noise = "[noise]\ndrawbar_pull = 0.1\ntorque = 0.01\nsinkage = 0.0005\n";
    let shift = |deviation: f64| {
        let comparison = run(&write(&format!("[priors]\n\"soil.cohesion\" = {deviation}\n{noise}")), true);
        let (calibration, _) = comparison.calibrated.unwrap();
        let cohesion = calibration.parameters.into_iter().find(|p| p.variable.name == "soil.cohesion").unwrap();
        (cohesion.value, cohesion.prior_shift().unwrap())
    };
    let (tight, _) = shift(1.0);
    assert!((tight - 2000.0).abs() < 5.0, "a tight prior holds: {tight}");
    let (loose, sigmas) = shift(400.0);
    assert!(loose < 1300.0 && sigmas < -1.7, "a loose one gives way to the data (1040 Pa): {loose}, {sigmas}");
}

#[test]
fn property_wrong_names_are_refused_with_their_place() {
    let (folder, _) = planted("names");
    let message = |lines: &str| {
        let toml = format!("name = \"p\"\nkind = \"single_wheel\"\n{lines}\n");
        std::fs::write(folder.join("experiment.toml"), toml).unwrap();
        match Experiment::read(&folder) {
            Ok(experiment) => compare(&baseline(), &experiment, &CompareOptions::default()).unwrap_err().to_string(),
            Err(refused) => refused.to_string(),
        }
    };
    let unknown = message("[parameters]\n\"soil.cohesoin\" = 1\n[[run]]\nfile = \"run.csv\"");
    assert!(unknown.contains("[parameters]") && unknown.contains("did you mean soil.cohesion"), "{unknown}");
    let range = message("[[run]]\nfile = \"run.csv\"\nparameters = { \"soil.exponent\" = 9 }");
    assert!(range.contains("line 5") && range.contains("soil.exponent") && range.contains("0.3 .. 2"), "{range}");
    let prior = message("[priors]\n\"soil.cohesin\" = { mean = 1000, sd = 1 }\n[[run]]\nfile = \"run.csv\"");
    assert!(prior.contains("[priors]"), "{prior}");
    let soft = message("[parameters]\n\"soil.k_phi\" = 1000\n[[run]]\nfile = \"run.csv\"");
    assert!(soft.contains("row 1") && soft.contains("sinks to its axle"), "{soft}");
}

#[test]
fn property_shipped_experiment_shows_structure_beyond_the_noise() {
    let comparison = run(&shipped(), true);
    let (calibration, fit) = comparison.calibrated.as_ref().unwrap();
    assert!(calibration.converged && calibration.agreeing >= 2, "{calibration:?}");
    for (signal, planted) in PLANTED_NOISE {
        let (floor, rmse) = (comparison.noise_floor[signal].replicates.unwrap(), fit.rmse[signal]);
        println!("{signal}: error {rmse:.5}, floor {floor:?}, planted {planted}");
        assert_eq!(floor.degrees_of_freedom, 18 * 9 - 6 * 9);
        assert!((floor.deviation / planted - 1.0).abs() < NOISE_ESTIMATE, "{signal}: {floor:?}");
        assert!(rmse > STRUCTURE * floor.deviation, "{signal}: {rmse} against {floor:?}");
    }
    // The hidden effect grows with slip, and so does what the model misses.
    for signal in ["torque", "sinkage"] {
        let worst = comparison.failures.iter().find(|failure| failure.signal == signal).unwrap();
        assert_eq!(worst.condition, "slip", "{signal}: {:?}", comparison.failures);
    }
    let by_slip = levels(&comparison.experiment, comparison.given.as_ref().unwrap(), "sinkage", "slip");
    assert!(by_slip.windows(2).all(|pair| pair[1].mean > pair[0].mean), "{by_slip:?}");
    // Calibration tries to swallow it in the angle of maximum stress, and that is seen.
    assert!(calibration.parameters.iter().any(|p| p.variable.name == "soil.c2" && p.at_bound));
}
