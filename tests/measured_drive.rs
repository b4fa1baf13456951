//! Logs without commands: the measured speeds of the wheels drive the rover, and the result says so.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::diagnosis::{CompareOptions, Comparison, compare};
use bekker::measurement::{Experiment, ExperimentError};
use bekker::model::{ControlKind, Model};
use bekker::modeldescription::Lookup;
use std::f64::consts::PI;

/// Time between rows, s, and rows of a drive.
const PERIOD: f64 = 0.05;
const ROWS: usize = 81;
/// Step of recorded drive and calibration, s: the planted soil comes back without the error of another step.
const STEP: f64 = 0.005;
/// Planted values come back to where the search ends.
const RECOVERY: f64 = 1e-3;
/// A straight line through values given to 15 digits, rad/s.
const ROUNDING: f64 = 1e-12;

/// Speed of a wheel at a row, rad/s.
fn speed(row: usize) -> f64 {
    2.0 + (row as f64 * 0.3).sin()
}

/// The speed that a wheel has on average until the next row.
fn between(row: usize) -> f64 {
    0.5 * (speed(row) + speed((row + 1).min(ROWS - 1)))
}

fn read(settings: &str, csv: &str) -> Result<Experiment, ExperimentError> {
    let run = "[[run]]\nfile = \"drive.csv\"\n";
    let toml = format!("name = \"log\"\nkind = \"traverse\"\n{settings}{run}");
    let texts = [("experiment.toml", toml.as_str()), ("drive.csv", csv)];
    Experiment::from_texts(&texts.map(|(name, text)| (name.to_owned(), text.to_owned())).into())
}

/// A log with these columns of the wheels, the same for both.
fn log(columns: &str, cell: impl Fn(usize) -> f64) -> String {
    let mut csv = format!("time,{columns},x\n");
    for row in 0..ROWS {
        csv += &format!("{:?},{1:?},{1:?},{2:?}\n", row as f64 * PERIOD, cell(row), 0.01 * row as f64);
    }
    csv
}

fn rover(control: ControlKind) -> Model {
    let mut model = Model::preset("two_wheeled_speed").unwrap();
    model.stepping.step_size = STEP;
    model.control.kind = control;
    model
}

fn compared(experiment: &Experiment, model: &Model, calibrate: bool) -> Comparison {
    compare(model, experiment, &CompareOptions { calibrate, ..CompareOptions::default() }).unwrap()
}

#[test]
fn agreement_measured_speeds_drive_as_commands_of_their_means_do() {
    let measured = read("", &log("wheel[1].speed,wheel[2].speed", speed)).unwrap();
    let commanded = read("", &log("wheel[1].speed_command,wheel[2].speed_command", between)).unwrap();
    assert_eq!(measured.runs[0].inputs, ["wheel[1].speed", "wheel[2].speed"]);
    assert_eq!(measured.signals(), ["x"], "what drives is not compared");
    let b = compared(&commanded, &rover(ControlKind::Speed), false);
    // A model that is commanded torques, and one whose drives have a loop, follow measured speeds as well.
    for control in [ControlKind::Speed, ControlKind::Torque, ControlKind::SpeedLoop] {
        let a = compared(&measured, &rover(control), false);
        let modelled = |comparison: &Comparison| comparison.fit().runs[0].signal("x").unwrap().modelled.clone();
        assert_eq!(modelled(&a), modelled(&b), "{control:?}");
        assert!(a.sources.iter().any(|line| line.contains("measured wheel speeds drive")), "{:?}", a.sources);
        assert!(b.sources.iter().all(|line| !line.contains("measured wheel speeds")), "{:?}", b.sources);
    }
}

#[test]
fn property_a_calibration_on_measured_speeds_finds_a_planted_soil() {
    let mut model = rover(ControlKind::Speed);
    let soil = model.rover.soil;
    model.set("soil.friction_angle", 0.55).unwrap();
    model.set("soil.shear_modulus", 0.018).unwrap();
    let mut run = model.start().unwrap();
    let mut csv = "time,rim,x,velocity,wheel[1].torque,wheel[2].torque\n".to_owned();
    for row in 0..ROWS {
        let signals = run.signals();
        let torques: Vec<f64> = signals.wheels.iter().map(|wheel| wheel.torque).collect();
        let (time, rim) = (row as f64 * PERIOD, speed(row) * model.rover.wheel.radius);
        let (x, velocity) = (signals.body.x, signals.body.velocity);
        csv += &format!("{time:?},{rim:?},{x:?},{velocity:?},{:?},{:?}\n", torques[0], torques[1]);
        run.inputs_mut().set_all(&[between(row); 2]).unwrap();
        run.advance((PERIOD / STEP).round() as u64).unwrap();
    }
    // One encoder a side, as a speed of the rim.
    let settings = format!(
        "[columns]\nrim = {{ signal = \"rim_speed\", wheels = [1, 2] }}\n[parameters]\n\"wheel.radius\" = {:?}\n\
         \"soil.cohesion\" = {:?}\n\"soil.k_phi\" = {:?}\n\"soil.exponent\" = 1\n\"soil.c1\" = 0.4\n\"soil.c2\" = 0.2\n",
        model.rover.wheel.radius, soil.cohesion, soil.k_phi
    );
    let comparison = compared(&read(&settings, &csv).unwrap(), &rover(ControlKind::Speed), true);
    let (calibration, _) = comparison.calibrated.as_ref().unwrap();
    for (name, planted) in [("soil.friction_angle", 0.55), ("soil.shear_modulus", 0.018)] {
        let found = calibration.parameters.iter().find(|p| p.variable.name == name).unwrap().value;
        assert!((found / planted - 1.0).abs() < RECOVERY, "{name} {found}, planted {planted}");
    }
}

/// A log in which the speed of wheel 2 is missing in these rows.
fn with_gaps(gaps: &[usize]) -> String {
    let mut csv = "time,wheel[1].speed,encoder,x\n".to_owned();
    for row in 0..ROWS {
        let front = if gaps.contains(&row) { String::new() } else { format!("{:?}", 0.1 * row as f64 + PI) };
        csv += &format!("{:?},2,{front},0\n", row as f64 * PERIOD);
    }
    csv
}

const ENCODER: &str = "[columns]\nencoder = \"wheel[2].speed\"\n";

#[test]
fn property_missing_speeds_are_interpolated_and_said() {
    let experiment = read(ENCODER, &with_gaps(&[5, 20, 21, 22])).unwrap();
    for row in [5, 20, 21, 22] {
        let filled = experiment.runs[0].data.value("wheel[2].speed", row).unwrap();
        assert!((filled - (0.1 * row as f64 + PI)).abs() < ROUNDING, "{filled} in row {row}");
    }
    let doubts = experiment.doubts.join("\n");
    assert!(doubts.contains("`encoder` has no value in 4 of 81 rows"), "{doubts}");
    assert!(read(ENCODER, &with_gaps(&[])).unwrap().doubts.is_empty());
}

#[test]
fn property_a_speed_that_nothing_near_tells_is_refused_by_its_column() {
    let long: Vec<usize> = (30..40).collect();
    for (gaps, line) in [(vec![0], 2), (vec![ROWS - 1], ROWS as u64 + 1), (long, 32)] {
        let error = read(ENCODER, &with_gaps(&gaps)).unwrap_err();
        assert_eq!((error.line, error.column.as_deref()), (Some(line), Some("encoder")), "{error}");
        assert!(error.to_string().contains("drives the rover"), "{error}");
    }
}

#[test]
fn property_speeds_beside_commands_are_compared_and_may_be_missing() {
    let mut csv = "time,wheel[1].torque_command,wheel[1].speed,x\n".to_owned();
    (0..ROWS).for_each(|row| csv += &format!("{:?},0.5,{},0\n", row as f64 * PERIOD, if row == 7 { "" } else { "2" }));
    let experiment = read("", &csv).unwrap();
    let run = &experiment.runs[0];
    assert_eq!(
        (run.inputs.join(","), run.measured.join(",")),
        ("wheel[1].torque_command".into(), "wheel[1].speed,x".into())
    );
    assert_eq!(experiment.measured_drive(), None);
    assert_eq!(run.data.value("wheel[1].speed", 7), None);
}

#[test]
fn regress_a_written_log_is_driven_by_its_speeds_again() {
    let experiment = read("", &log("wheel[1].speed,wheel[2].speed", speed)).unwrap();
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("measured_drive_written");
    let _ = std::fs::remove_dir_all(&folder);
    experiment.write(&folder).unwrap();
    let again = Experiment::read(&folder).unwrap();
    assert_eq!(again.runs[0].inputs, experiment.runs[0].inputs);
    assert_eq!(again.runs[0].data, experiment.runs[0].data);
}

#[test]
fn property_the_note_names_the_runs_without_commands() {
    let toml = "name = \"two\"\nkind = \"traverse\"\n[[run]]\nfile = \"a.csv\"\n[[run]]\nfile = \"b.csv\"\n";
    let files = [
        ("experiment.toml", toml.to_owned()),
        ("a.csv", log("wheel[1].speed,wheel[2].speed", speed)),
        ("b.csv", log("wheel[1].speed_command,wheel[2].speed_command", speed)),
    ];
    let experiment = Experiment::from_texts(&files.map(|(name, text)| (name.to_owned(), text)).into()).unwrap();
    let note = experiment.measured_drive().unwrap();
    assert!(note.contains("no command was recorded in a; there the measured wheel speeds drive"), "{note}");
    let [measured, commanded] = experiment.runs.as_slice() else { panic!("{:?}", experiment.runs) };
    assert!(measured.follows_measured_speeds() && !commanded.follows_measured_speeds());
    assert_eq!((measured.held_inputs(2)[3], commanded.held_inputs(2)[3]), (between(3), speed(3)));
}
