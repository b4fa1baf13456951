//! Rows of a carriage that the model cannot answer: left out, counted and listed; an error only where too few are left.

use bekker::diagnosis::{
    CompareError, CompareOptions, Comparison, Control, DiagnoseOptions, Rig, compare, diagnose, steady_point,
};
use bekker::measurement::Experiment;
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use std::fmt::Write;
use std::path::Path;

/// Planted values come back to the rounding of the data files (9 digits), magnified by the fit's conditioning.
const RECOVERY: f64 = 1e-3;

/// Friction angle (rad) and shear modulus (m) of the soil that was measured; the default soil is weaker.
const TRUTH: [(&str, f64); 2] = [("soil.friction_angle", 0.6), ("soil.shear_modulus", 0.018)];

const KNOWN: &str = "[parameters]\n\"soil.cohesion\" = 1000\n\"soil.k_phi\" = 8.5e5\n\"soil.exponent\" = 1\n\"soil.c1\" = 0.4\n\"soil.c2\" = 0.2\n";

fn baseline() -> Model {
    Model::preset("two_wheeled").unwrap()
}

/// Rows of a planted soil at loads from 20 N to 60 N, then `bad` ones as they are.
fn written(name: &str, bad: &[&str]) -> Experiment {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("compare_unanswered").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    let mut rig = Rig::of(&baseline().rover);
    for (name, value) in TRUTH {
        rig.set(name, value).unwrap();
    }
    let mut csv = "load,slip,wheel_speed,drawbar_pull,sinkage\n".to_owned();
    for row in bad {
        writeln!(csv, "{row}").unwrap();
    }
    for load in [20.0, 40.0, 60.0] {
        for slip in [0.02, 0.1, 0.2, 0.35, 0.5, 0.7] {
            let point = steady_point(&rig, load, slip, 0.5).unwrap();
            writeln!(csv, "{load},{slip},0.5,{:.9e},{:.9e}", point.drawbar_pull, point.sinkage).unwrap();
        }
    }
    std::fs::write(folder.join("t.csv"), csv).unwrap();
    let toml = format!("name = \"rows\"\nkind = \"single_wheel\"\n{KNOWN}[[run]]\nfile = \"t.csv\"\n");
    std::fs::write(folder.join("experiment.toml"), toml).unwrap();
    Experiment::read(&folder).unwrap()
}

fn compared(experiment: &Experiment, calibrate: bool) -> Result<Comparison, CompareError> {
    compare(&baseline(), experiment, &CompareOptions { calibrate, ..CompareOptions::default() })
}

/// A load that no soil within the bounds carries, entered for 20.6 N.
const TYPO: &str = "20600,0.2,0.5,3.1,0.012";

#[test]
fn regress_one_row_that_the_soil_does_not_carry_is_left_out() {
    let comparison = compared(&written("one", &[TYPO]), false).unwrap();
    let [rows] = comparison.unanswered.as_slice() else { panic!("{:?}", comparison.unanswered) };
    assert_eq!((rows.run.as_str(), rows.rows, rows.count()), ("t", (1, 1), 1));
    assert!(rows.to_string().contains("run t, row 1: the soil does not carry 20600.00 N"), "{rows}");
    assert_eq!(comparison.given_unanswered, comparison.unanswered);
    // The error is that of the other rows.
    let clean = compared(&written("none", &[]), false).unwrap();
    assert!(clean.unanswered.is_empty());
    assert_eq!(comparison.fit().rmse, clean.fit().rmse);
    let pull = comparison.fit().runs[0].signal("drawbar_pull").unwrap();
    assert!(pull.measured[0] == 3.1 && pull.modelled[0].is_nan() && pull.residual[0].is_nan());
}

#[test]
fn regress_a_calibration_leaves_the_row_out_and_finds_the_planted_soil() {
    for (name, bad) in [("typo", TYPO), ("locked", "20600,-1,0,-20,0.05"), ("contradiction", "20.6,-1,0.5,-20,0.05")] {
        let experiment = written(name, &[bad]);
        let comparison = compared(&experiment, true).unwrap();
        let (calibration, fit) = comparison.calibrated.as_ref().unwrap();
        for (parameter, (name, truth)) in calibration.parameters.iter().zip(TRUTH) {
            assert_eq!(parameter.variable.name, name);
            assert!((parameter.value / truth - 1.0).abs() < RECOVERY, "{bad}: {parameter:?}");
        }
        assert!(fit.rmse["drawbar_pull"] < 1e-6, "{:?}", fit.rmse);
        assert_eq!(comparison.unanswered.len(), 1, "{:?}", comparison.unanswered);
        assert_eq!(comparison.unanswered[0].rows, (1, 1));
        assert!(comparison.cautions.iter().any(|caution| caution.contains("1 of 19 rows left out")));
    }
}

#[test]
fn property_rows_that_the_calibrated_soil_carries_are_not_left_out() {
    let experiment = written("soft", &[]);
    let mut free = experiment.clone();
    free.parameters.remove("soil.k_phi");
    let mut soft = baseline();
    soft.set("soil.k_phi", 3e4).unwrap();
    let options = CompareOptions { calibrate: true, ..CompareOptions::default() };
    let comparison = compare(&soft, &free, &options).unwrap();
    // The soft soil carries 20 N, and 40 N at low slip.
    let without: usize = comparison.given_unanswered.iter().map(|rows| rows.count()).sum();
    assert!((6..18).contains(&without), "{:?}", comparison.given_unanswered);
    assert!(comparison.unanswered.is_empty(), "{:?}", comparison.unanswered);
    let (calibration, _) = comparison.calibrated.as_ref().unwrap();
    let stiffness = calibration.parameters.iter().find(|p| p.variable.name == "soil.k_phi").unwrap();
    assert!((stiffness.value / 8.5e5 - 1.0).abs() < RECOVERY, "{stiffness:?}");
}

#[test]
fn property_too_few_answers_are_an_error() {
    let bad = [TYPO; 19];
    let experiment = written("few", &bad);
    assert_eq!(compared(&experiment, false).unwrap().unanswered[0].rows, (1, 19), "given, the others are compared");
    let message = compared(&experiment, true).unwrap_err().to_string();
    assert!(message.contains("18 of 37") && message.contains("run t, row 1"), "{message}");
    let mut none = experiment;
    none.runs[0].data = only_first_rows(&none, 19);
    let refused = compared(&none, false).unwrap_err().to_string();
    assert!(refused.contains("run t, row 1: the soil does not carry"), "{refused}");
}

/// The first rows of the only run.
fn only_first_rows(experiment: &Experiment, count: usize) -> bekker::measurement::Table {
    let data = &experiment.runs[0].data;
    let mut table = bekker::measurement::Table::new(data.names().iter().cloned()).unwrap();
    for row in 0..count {
        let values: Vec<f64> = data.names().iter().map(|name| data.value(name, row).unwrap()).collect();
        table.push(&values).unwrap();
    }
    table
}

#[test]
fn property_a_diagnosis_lists_the_rows_it_leaves_out() {
    let experiment = written("diagnosed", &[TYPO]);
    let candidates = Some(vec!["slip_sinkage".to_owned()]);
    let options = DiagnoseOptions { candidates, draws: 19, max_effects: 1, ..DiagnoseOptions::default() };
    let diagnosis = diagnose(&baseline(), &experiment, &options, &Control::default()).unwrap();
    assert_eq!(diagnosis.unanswered.len(), 1);
    assert!(diagnosis.given.is_some(), "the given soil answers the others");
    assert!(diagnosis.baseline().fit.runs[0].signals[0].residual[0].is_nan());
    assert!(diagnosis.cautions.iter().any(|caution| caution.contains("rows left out")));
    #[cfg(feature = "report")]
    {
        let json = diagnosis.to_json();
        let rows = &json["unanswered"][0];
        assert_eq!(
            (rows["run"].as_str(), rows["first_row"].as_u64(), rows["last_row"].as_u64()),
            (Some("t"), Some(1), Some(1))
        );
        assert!(rows["reason"].as_str().unwrap().contains("sinks to its axle"), "{rows}");
    }
}
