//! A rover on a profile against measurements: the replay is the simulation, and planted parameters come back.

use bekker::diagnosis::{CompareOptions, DiagnoseOptions, Noise, NoiseModel, Task, compare, fit_task};
use bekker::measurement::{Experiment, Record};
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use bekker::terrain::{Profile, Samples};
use std::path::{Path, PathBuf};

/// Time between rows, s, and rows of a run.
const PERIOD: f64 = 0.05;
const ROWS: usize = 81;
/// Planted values come back to the rounding of central differences, magnified by the fit's conditioning.
const RECOVERY: f64 = 1e-3;

/// Step with which drives are recorded, that of a calibration, s: the planted soil comes back without the error of another step.
const STEP: f64 = 0.005;

const MEASURED: [&str; 6] = ["x", "pitch", "velocity", "wheel[1].torque", "wheel[2].torque", "wheel[2].sinkage"];

/// Waves on a plane of this slope.
fn hill(slope: f64) -> (Vec<f64>, Vec<f64>) {
    let x: Vec<f64> = (0..121).map(|k| -2.0 + 0.05 * f64::from(k)).collect();
    let z = x.iter().map(|x| slope * x + 0.03 * (2.0 * x).sin()).collect();
    (x, z)
}

/// A rover with planted friction angle and shear modulus.
fn planted(kind: &str) -> Model {
    planted_on(0.0, kind)
}

fn planted_on(slope: f64, kind: &str) -> Model {
    let mut model = Model::preset(kind).unwrap();
    model.set("soil.friction_angle", 0.55).unwrap();
    model.set("soil.shear_modulus", 0.018).unwrap();
    let (x, z) = hill(slope);
    model.rover.terrain.profile = Profile::Samples(Samples::new(&x, &z).unwrap().into());
    model.start.x0 = 0.2;
    model.stepping.step_size = STEP;
    model
}

/// The model as it ships, with the step of the recorded drives.
fn shipped(kind: &str) -> Model {
    let mut model = Model::preset(kind).unwrap();
    model.stepping.step_size = STEP;
    model
}

/// Drives the planted rover with a command that changes from row to row, and writes the folder.
fn recorded(name: &str, kind: &str, commands: &str, command: impl Fn(usize) -> f64, settings: &str) -> PathBuf {
    recorded_on(0.0, name, kind, commands, command, settings)
}

fn recorded_on(
    slope: f64,
    name: &str,
    kind: &str,
    commands: &str,
    command: impl Fn(usize) -> f64,
    settings: &str,
) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("compare_traverse").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    let mut run = planted_on(slope, kind).start().unwrap();
    let names = MEASURED.map(str::to_owned);
    let mut record = Record::new(&mut run.signals().clone(), Some(&names)).unwrap();
    let steps = (PERIOD / run.step_size()).round() as u64;
    let mut lines = Vec::new();
    for row in 0..ROWS {
        record.push(row as f64 * PERIOD, run.signals()).unwrap();
        let values = [command(row), 0.9 * command(row)];
        lines.push(values);
        run.inputs_mut().set_all(&values).unwrap();
        run.advance(steps).unwrap();
    }
    let mut bytes = Vec::new();
    record.table().write_csv(&mut bytes).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let mut rows = text.lines();
    let mut csv = format!("{},wheel[2].{commands},wheel[1].{commands}\n", rows.next().unwrap());
    for (row, [rear, front]) in rows.zip(&lines) {
        csv += &format!("{row},{front:?},{rear:?}\n");
    }
    std::fs::write(folder.join("drive.csv"), csv).unwrap();
    let (x, z) = hill(slope);
    let hill: String = x.iter().zip(&z).map(|(x, z)| format!("{x:?},{z:?}\n")).collect();
    std::fs::write(folder.join("hill.csv"), format!("x,z\n{hill}")).unwrap();
    std::fs::write(folder.join("experiment.toml"), toml(settings)).unwrap();
    folder
}

fn toml(settings: &str) -> String {
    let run = "[[run]]\nfile = \"drive.csv\"\nterrain = \"hill.csv\"\nx0 = 0.2\n";
    format!("name = \"hill\"\nkind = \"traverse\"\n{settings}{run}")
}

const TRUTH: &str = "[parameters]\n\"soil.friction_angle\" = 0.55\n\"soil.shear_modulus\" = 0.018\n";

#[test]
fn agreement_a_replay_is_the_simulation_bit_for_bit() {
    let speed = |row: usize| 2.0 + (row as f64 * 0.3).sin();
    // Driven for 0.8 s, then coasting to a stop: a constant torque would run off the hill.
    let torque = |row: usize| if row < 16 { 3.0 } else { 0.0 };
    for (name, kind, commands, folder) in [
        (
            "speed",
            "two_wheeled_speed",
            "speed_command",
            recorded("s", "two_wheeled_speed", "speed_command", speed, TRUTH),
        ),
        ("torque", "two_wheeled", "torque_command", recorded("t", "two_wheeled", "torque_command", torque, TRUTH)),
    ] {
        let experiment = Experiment::read(&folder).unwrap();
        let comparison = compare(&shipped(kind), &experiment, &CompareOptions::default()).unwrap();
        for (signal, rmse) in &comparison.fit().rmse {
            assert_eq!(*rmse, 0.0, "{name} {commands}: {signal}");
        }
        let x = comparison.fit().runs[0].signal("x").unwrap().measured.clone();
        assert!(x[ROWS - 1] - x[0] > 0.3, "{name}: the rover moved, {x:?}");
    }
}

/// Everything of the soil but its friction angle and shear modulus, so that a drive has two values to tell.
fn all_but_two() -> String {
    let soil = Model::preset("two_wheeled").unwrap().rover.soil;
    format!(
        "[parameters]\n\"soil.cohesion\" = {}\n\"soil.k_phi\" = {}\n\"soil.exponent\" = 1\n\"soil.c1\" = 0.4\n\"soil.c2\" = 0.2\n",
        soil.cohesion, soil.k_phi
    )
}

#[test]
fn property_calibration_recovers_a_planted_soil_from_a_drive() {
    let settings = all_but_two();
    let folder = recorded("r", "two_wheeled_speed", "speed_command", |row| 2.0 + (row as f64 * 0.3).sin(), &settings);
    let experiment = Experiment::read(&folder).unwrap();
    let model = Model::preset("two_wheeled_speed").unwrap();
    let comparison =
        compare(&model, &experiment, &CompareOptions { calibrate: true, ..CompareOptions::default() }).unwrap();
    let (calibration, fit) = comparison.calibrated.as_ref().unwrap();
    let mut truth = planted("two_wheeled_speed");
    assert_eq!(calibration.parameters.len(), 2, "{calibration:?}");
    for parameter in &calibration.parameters {
        let planted = truth.get(&parameter.variable.name).unwrap();
        assert!((parameter.value / planted - 1.0).abs() < RECOVERY, "{parameter:?}");
    }
    let given = comparison.given.as_ref().unwrap();
    assert!(fit.rmse["x"] < 1e-3 * given.rmse["x"], "{:?} {:?}", fit.rmse, given.rmse);
}

/// Rows of a run in which contacts break loose: of these drives a fifth, less than the time in which their wheels roll in.
const NOT_COUNTED: usize = ROWS / 5;

#[test]
fn property_how_contacts_break_loose_does_not_count() {
    let command = |row: usize| 2.0 + (row as f64 * 0.3).sin();
    let kind = "two_wheeled_speed";
    let recovered = |rows: usize| {
        let folder = recorded("loose", kind, "speed_command", command, &all_but_two());
        let text = std::fs::read_to_string(folder.join("drive.csv")).unwrap();
        let mut csv = String::new();
        for (k, line) in text.lines().enumerate() {
            // Time stays; all that is measured is far off in the first rows.
            let far = |(j, cell): (usize, &str)| match cell.parse::<f64>() {
                Ok(value) if (1..=rows).contains(&k) && (1..=MEASURED.len()).contains(&j) => {
                    format!("{}", value + 0.02)
                }
                _ => cell.to_owned(),
            };
            csv += &(line.split(',').enumerate().map(far).collect::<Vec<_>>().join(",") + "\n");
        }
        std::fs::write(folder.join("drive.csv"), csv).unwrap();
        let options = CompareOptions { calibrate: true, ..CompareOptions::default() };
        let experiment = Experiment::read(&folder).unwrap();
        let comparison = compare(&Model::preset(kind).unwrap(), &experiment, &options).unwrap();
        let (calibration, _) = comparison.calibrated.as_ref().unwrap();
        let mut truth = planted(kind);
        calibration.parameters.iter().all(|parameter| {
            let planted = truth.get(&parameter.variable.name).unwrap();
            (parameter.value / planted - 1.0).abs() < RECOVERY
        })
    };
    assert!(recovered(NOT_COUNTED));
    // One bad row more would count as a bad sample, which does not lead the fit.
    assert!(!recovered(2 * NOT_COUNTED), "the next rows count");
}

#[test]
fn property_calibration_leads_out_of_a_soil_in_which_the_rover_is_stuck() {
    let command = |row: usize| 2.0 + (row as f64 * 0.3).sin();
    let kind = "two_wheeled_speed";
    let folder = recorded_on(0.1, "stuck", kind, "speed_command", command, &all_but_two());
    let mut weak = Model::preset(kind).unwrap();
    weak.set("soil.friction_angle", 0.3).unwrap();
    let experiment = Experiment::read(&folder).unwrap();
    let options = CompareOptions { calibrate: true, ..CompareOptions::default() };
    let comparison = compare(&weak, &experiment, &options).unwrap();
    let [stuck] = comparison.given_unanswered.as_slice() else { panic!("{:?}", comparison.given_unanswered) };
    assert!(stuck.reason.contains("stuck") && stuck.rows.1 == ROWS, "{stuck}");
    assert!(comparison.unanswered.is_empty(), "the calibrated rover gets through: {:?}", comparison.unanswered);
    let (calibration, _) = comparison.calibrated.as_ref().unwrap();
    let mut truth = planted(kind);
    for parameter in &calibration.parameters {
        let planted = truth.get(&parameter.variable.name).unwrap();
        assert!((parameter.value / planted - 1.0).abs() < RECOVERY, "{parameter:?}");
    }
    // Without a calibration the rows up to there are compared.
    let compared = compare(&weak, &experiment, &CompareOptions::default()).unwrap();
    let x = compared.fit().runs[0].signal("x").unwrap().clone();
    let reached = stuck.rows.0 - 1;
    assert!(reached > NOT_COUNTED && x.residual[NOT_COUNTED..reached].iter().all(|e| !e.is_nan()));
    assert!(x.residual[reached..].iter().all(|e| e.is_nan()) && x.measured.iter().all(|x| !x.is_nan()));
    assert_eq!(compared.unanswered, comparison.given_unanswered);
}

/// Cuts the ground of a recorded drive off beyond an x, m.
fn cut(folder: &Path, end: f64) -> Experiment {
    let text = std::fs::read_to_string(folder.join("hill.csv")).unwrap();
    let known = |line: &&str| line.split(',').next().unwrap().parse::<f64>().map_or(true, |x| x <= end);
    let kept: Vec<&str> = text.lines().filter(known).collect();
    std::fs::write(folder.join("hill.csv"), kept.join("\n") + "\n").unwrap();
    Experiment::read(folder).unwrap()
}

#[test]
fn regress_a_drive_that_leaves_its_terrain_is_compared_up_to_there() {
    let command = |row: usize| 2.0 + (row as f64 * 0.3).sin();
    let kind = "two_wheeled_speed";
    let folder = recorded("left", kind, "speed_command", command, TRUTH);
    let all = Experiment::read(&folder).unwrap();
    let x = all.runs[0].data.column("x").unwrap();
    // The front wheel is ahead of the reference point, so the rover leaves the ground in the last fifth of its way.
    let end = x[ROWS - 1] - 0.2 * (x[ROWS - 1] - x[0]) + Model::preset(kind).unwrap().get("wheel[2].x").unwrap();
    let experiment = cut(&folder, end);
    let model = shipped(kind);
    let given = compare(&model, &experiment, &CompareOptions::default()).unwrap();
    let [rows] = given.unanswered.as_slice() else { panic!("{:?}", given.unanswered) };
    assert!(rows.reason.contains("left the terrain") && rows.rows.1 == ROWS, "{rows}");
    assert!((ROWS / 2..ROWS - 3).contains(&rows.rows.0), "{rows}");
    assert!(given.fit().rmse.values().all(|rmse| *rmse < SAME_GROUND), "{:?}", given.fit().rmse);
    // A calibration finds the planted soil from the rows before.
    std::fs::write(folder.join("experiment.toml"), toml(&all_but_two())).unwrap();
    let experiment = Experiment::read(&folder).unwrap();
    let options = CompareOptions { calibrate: true, ..CompareOptions::default() };
    let comparison = compare(&model, &experiment, &options).unwrap();
    let mut truth = planted(kind);
    for parameter in &comparison.calibrated.as_ref().unwrap().0.parameters {
        let planted = truth.get(&parameter.variable.name).unwrap();
        assert!((parameter.value / planted - 1.0).abs() < RECOVERY, "{parameter:?}");
    }
    assert_eq!(comparison.unanswered.len(), 1, "{:?}", comparison.unanswered);
    assert!(comparison.unanswered[0].reason.contains("left the terrain"));
}

/// A cut changes the slope of a sampled profile in its last piece, 0.05 m long; on the ground before it nothing.
const SAME_GROUND: f64 = 0.05;

/// Share to which a led rover gives the planted friction angle back. Between rows the hand holds the velocity of the last, which
/// is half a row old on average: with a command of 2 + sin(0.3 k) in row k that is 0.15 times 2/pi of 2, 5 % of the speed.
const LED_RECOVERY: f64 = 0.05;

#[test]
fn property_a_led_rover_does_not_get_stuck() {
    let command = |row: usize| 2.0 + (row as f64 * 0.3).sin();
    let kind = "two_wheeled_speed";
    let folder = recorded_on(0.1, "led", kind, "speed_command", command, "");
    let experiment = Experiment::read(&folder).unwrap();
    let mut weak = Model::preset(kind).unwrap();
    weak.set("soil.friction_angle", 0.3).unwrap();
    let deviations = [0.01, 0.002, 0.004, 0.05, 0.05, 0.001];
    let models = MEASURED
        .iter()
        .zip(deviations)
        .map(|(signal, deviation)| ((*signal).to_owned(), NoiseModel { deviation, run_share: 0.0, correlation: 0.0 }));
    let noise = Noise::new(models.collect());
    let calibrated = ["cohesion", "friction_angle", "k_phi", "exponent", "shear_modulus", "c1", "c2"];
    let given = calibrated.map(|name| weak.get(&format!("soil.{name}")).unwrap()).to_vec();
    let task = Task {
        effects: vec![],
        parameters: vec![],
        starts: vec![given],
        scouting: Some(0),
        guided: true,
        left_out: vec![],
        unanswered: vec![],
        prior_factor: 1.0,
    };
    let outcome = fit_task(&weak, &experiment, &DiagnoseOptions::default(), &noise, &task).unwrap().unwrap();
    let friction = outcome.values[1];
    assert!((friction / 0.55 - 1.0).abs() < LED_RECOVERY, "{friction}");
    let alone = compare(&weak, &experiment, &CompareOptions::default()).unwrap();
    assert!(alone.unanswered[0].reason.contains("stuck"), "by itself it is stuck: {:?}", alone.unanswered);
}

#[cfg(feature = "report")]
#[test]
fn property_the_page_shows_a_drive_over_time() {
    let folder = recorded("page", "two_wheeled_speed", "speed_command", |row| 2.0 + (row as f64 * 0.3).sin(), "");
    let model = Model::preset("two_wheeled_speed").unwrap();
    let comparison = compare(&model, &Experiment::read(&folder).unwrap(), &CompareOptions::default()).unwrap();
    let page = bekker::report::comparison_page(&comparison);
    std::fs::write(folder.join("page.html"), &page).unwrap();
    assert!(page.contains("velocity against time") && page.contains("torque of wheel 1 against pitch"));
    assert_eq!(page.matches("data-plot=\"").count(), 6 * 3 - 2, "x and pitch are not drawn against themselves");
    assert!(page.contains("Floor unknown"));
}

#[test]
fn property_a_run_that_does_not_fit_the_model_is_refused() {
    let folder = recorded("w", "two_wheeled_speed", "speed_command", |_| 2.0, "");
    let experiment = Experiment::read(&folder).unwrap();
    let six = Model::preset("rocker_bogie_speed").unwrap();
    let wheels = compare(&six, &experiment, &CompareOptions::default()).unwrap_err().to_string();
    assert!(wheels.contains("commands for 2 wheels") && wheels.contains("drive"), "{wheels}");
    let mut heavy = Model::preset("two_wheeled_speed").unwrap();
    heavy.set("rover.mass", 150.0).unwrap();
    let ended = compare(&heavy, &experiment, &CompareOptions::default()).unwrap();
    let [rows] = ended.unanswered.as_slice() else { panic!("{:?}", ended.unanswered) };
    assert!(rows.to_string().starts_with("run drive, rows"), "{rows}");
}
