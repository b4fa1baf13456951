//! Delay, gain and bias of sensors: they act on modelled signals, come back beside the soil, and are never named as an effect.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "support/schema.rs"]
mod schema;

use bekker::diagnosis::{
    CalibratedParameter, CompareOptions, Comparison, Control, DiagnoseOptions, Verdict, compare, diagnose, modelled,
    sensitivity,
};
use bekker::measurement::{Experiment, ExperimentError, Prior};
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use schema::faults;
use std::fmt::Write;

/// Time between rows, s; rows of a drive that is replayed as a whole, and of one that is cut into windows.
const PERIOD: f64 = 0.05;
const SHORT: usize = 81;
const LONG: usize = 481;
/// Step of recorded drive and calibration, s.
const STEP: f64 = 0.005;
/// Planted soil, and planted errors of the sensors: a velocity one row late, a driver that reads currents high, a tilted
/// inclinometer.
const FRICTION: f64 = 0.55;
const DELAY: f64 = PERIOD;
const GAIN: f64 = 1.04;
const BIAS: f64 = 0.02;
/// Planted values come back to where the search ends, and to what the priors pull, which are wide beside the noise.
const RECOVERY: f64 = 2e-3;
/// In windows a delayed signal goes on straight before each first row, and places between rows are means.
const IN_WINDOWS: f64 = 2e-2;

/// The priors of all planted errors.
const SENSORS: &str = "[sensors]\nvelocity = { delay = { sd = 0.1 } }\n\"wheel[1+2].current\" = { gain = 0.1 }\n\
                       pitch.bias = { sd = 3, unit = \"deg\" }\n";
const NOISE: &str = "[noise]\nx = 0.002\nvelocity = 0.001\npitch = 0.001\n\"wheel[1+2].current\" = 0.01\n[[run]]\nfile = \"drive.csv\"\n";

fn rover() -> Model {
    let mut model = Model::preset("two_wheeled_speed").unwrap();
    model.stepping.step_size = STEP;
    model
}

/// A drive with the planted soil, recorded by sensors with the planted errors.
fn drive(rows: usize) -> String {
    let mut model = rover();
    model.set("soil.friction_angle", FRICTION).unwrap();
    let mut run = model.start().unwrap();
    let mut csv = "time,wheel[1].speed_command,wheel[2].speed_command,x,velocity,pitch,wheel[1+2].current\n".to_owned();
    let mut late = run.signals().body.velocity;
    for row in 0..rows {
        let (body, wheels) = (&run.signals().body, &run.signals().wheels);
        let current: f64 = GAIN * wheels.iter().map(|wheel| wheel.current).sum::<f64>();
        let command = 2.0 + (row as f64 * 0.15).sin();
        let (time, x, pitch) = (row as f64 * PERIOD, body.x, body.pitch + BIAS);
        writeln!(csv, "{time:?},{command:?},{command:?},{x:?},{late:?},{pitch:?},{current:?}").unwrap();
        late = body.velocity;
        run.inputs_mut().set_all(&[command; 2]).unwrap();
        run.advance((PERIOD / STEP).round() as u64).unwrap();
    }
    csv
}

fn read(settings: &str, csv: String) -> Result<Experiment, ExperimentError> {
    let soil = rover().rover.soil;
    let toml = format!(
        "name = \"sensors\"\nkind = \"traverse\"\n[parameters]\n\"soil.cohesion\" = {}\n\"soil.k_phi\" = {}\n\
         \"soil.exponent\" = 1\n\"soil.shear_modulus\" = {}\n\"soil.c1\" = 0.4\n\"soil.c2\" = 0.2\n{settings}",
        soil.cohesion, soil.k_phi, soil.shear_modulus
    );
    Experiment::from_texts(&[("experiment.toml".to_owned(), toml), ("drive.csv".to_owned(), csv)].into())
}

fn with(sensors: &str, rows: usize) -> Experiment {
    read(&format!("{sensors}{NOISE}"), drive(rows)).unwrap()
}

fn calibrated(experiment: &Experiment) -> Comparison {
    compare(&rover(), experiment, &CompareOptions { calibrate: true, ..CompareOptions::default() }).unwrap()
}

fn found(comparison: &Comparison) -> &[CalibratedParameter] {
    &comparison.calibrated.as_ref().unwrap().0.parameters
}

fn assert_planted(found: &[CalibratedParameter], tolerance: f64) {
    let planted = [
        ("soil.friction_angle", FRICTION),
        ("sensors.velocity.delay", DELAY),
        ("sensors.wheel[1+2].current.gain", GAIN),
        ("sensors.pitch.bias", BIAS),
    ];
    assert_eq!(found.len(), planted.len(), "{found:?}");
    for (name, value) in planted {
        let parameter = found.iter().find(|parameter| parameter.variable.name == name).unwrap();
        assert!((parameter.value / value - 1.0).abs() < tolerance, "{name} {}, planted {value}", parameter.value);
        let error = parameter.deviation.unwrap();
        assert!(error > 0.0 && parameter.prior.is_none_or(|prior| error < prior.deviation), "{parameter:?}");
    }
}

#[test]
fn property_errors_of_sensors_come_back_beside_the_soil() {
    let comparison = calibrated(&with(SENSORS, SHORT));
    assert_planted(found(&comparison), RECOVERY);
    let pitch = |comparison: &Comparison| comparison.fit().rmse["pitch"];
    assert!(pitch(&comparison) < RECOVERY * BIAS, "{:?}", comparison.fit().rmse);
    assert!(pitch(&calibrated(&with("", SHORT))) > 0.9 * BIAS, "the soil cannot take the tilt on");
}

#[test]
fn property_errors_of_sensors_come_back_from_windows() {
    let experiment = with(SENSORS, LONG);
    assert_planted(found(&calibrated(&experiment)), IN_WINDOWS);
}

#[test]
fn analytic_readings_are_gain_times_signal_plus_bias() {
    let plain = modelled(&rover(), &with("", SHORT)).unwrap();
    let perfect = "[sensors]\nvelocity = { delay = 0.1, gain = 0.1, bias = 0.1 }\n";
    assert_eq!(modelled(&rover(), &with(perfect, SHORT)).unwrap(), plain, "to the last bit");
    let wrong = "[sensors]\nvelocity = { gain = { mean = 120, sd = 1, unit = \"%\" }, bias = { mean = 5, sd = 1, unit = \"cm/s\" } }\n";
    let read = modelled(&rover(), &with(wrong, SHORT)).unwrap();
    // Rows of x, then of the velocity, then of the other two.
    for (k, (read, plain)) in read.iter().zip(&plain).enumerate() {
        let expected = if (SHORT..2 * SHORT).contains(&k) { 1.2 * plain + 0.05 } else { *plain };
        assert_eq!(*read, expected, "{k}");
    }
}

#[test]
fn agreement_derivatives_in_errors_agree_with_differences() {
    let errors = [("delay", 0.03), ("gain", 1.1), ("bias", 0.2)];
    let stated = |moved: &str, by: f64| {
        let entry = |(name, mean): (&str, f64)| {
            let mean = if name == moved { mean + by } else { mean };
            format!("{name} = {{ mean = {mean:?}, sd = 0.1 }}")
        };
        with(&format!("[sensors]\nvelocity = {{ {} }}\n", errors.map(entry).join(", ")), SHORT)
    };
    let names = errors.map(|(name, _)| format!("sensors.velocity.{name}"));
    let mut names: Vec<&str> = names.iter().map(String::as_str).collect();
    names.insert(1, "soil.friction_angle");
    let exact = sensitivity(&rover(), &stated("", 0.0), &names).unwrap();
    // Central differences, whose error is of the order of 1e-10 by rounding.
    let h = 1e-6;
    for (slope, name) in [(0, "delay"), (2, "gain"), (3, "bias")] {
        let at = |by: f64| modelled(&rover(), &stated(name, by)).unwrap();
        for (k, (above, below)) in at(h).iter().zip(at(-h)).enumerate() {
            let difference = (above - below) / (2.0 * h);
            let exact = exact.slopes[slope][k];
            assert!((exact - difference).abs() < 1e-7, "{name}, value {k}: {exact} and {difference}");
        }
    }
    // What the model's parameters change is read late and 1.1 times as large.
    let plain = sensitivity(&rover(), &with("", SHORT), &["soil.friction_angle"]).unwrap();
    let largest = |slopes: &[f64]| slopes[SHORT..2 * SHORT].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let ratio = largest(&exact.slopes[1]) / largest(&plain.slopes[0]);
    assert!((0.9..1.2).contains(&ratio), "{ratio}");
    assert_eq!(exact.slopes[1][..SHORT], plain.slopes[0][..SHORT], "places are read as they are");
}

#[test]
fn property_an_error_of_a_sensor_is_no_effect() {
    let options = DiagnoseOptions {
        candidates: Some(["pitch_bias", "payload"].map(str::to_owned).to_vec()),
        draws: 199,
        ..DiagnoseOptions::default()
    };
    let without = "[sensors]\nvelocity = { delay = { sd = 0.1 } }\n\"wheel[1+2].current\" = { gain = 0.1 }\n";
    let diagnosed = |sensors: &str| {
        // Rows with a little noise, without which nothing is decided.
        let experiment = read(&format!("{sensors}{NOISE}"), noisy(&drive(SHORT))).unwrap();
        diagnose(&rover(), &experiment, &options, &Control::default()).unwrap()
    };
    let named = diagnosed(without);
    assert!(named.steps.iter().any(|step| step.added.as_deref() == Some("pitch_bias")), "{:?}", named.verdict);
    let explained = diagnosed(SENSORS);
    assert_eq!(explained.verdict, Verdict::Explained, "{:?}", explained.cautions);
    for diagnosis in [&named, &explained] {
        let json = diagnosis.to_json();
        let schema: serde_json::Value =
            serde_json::from_str(include_str!("../src/diagnosis/diagnose/result.schema.json")).unwrap();
        assert!(faults(&schema, &json).is_empty(), "{:?}", faults(&schema, &json));
        #[cfg(feature = "report")]
        assert!(bekker::report::diagnosis_page(diagnosis).contains("sensors.velocity.delay"));
        for step in json["steps"].as_array().unwrap() {
            let delay = &step["parameters"]["sensors.velocity.delay"];
            assert!((delay["value"].as_f64().unwrap() / DELAY - 1.0).abs() < 0.2, "{delay}");
        }
    }
}

/// Adds noise of half the stated size to what is measured.
fn noisy(csv: &str) -> String {
    let deviations = [0.001, 0.0005, 0.0005, 0.005];
    let mut lines = csv.lines();
    let mut noisy = format!("{}\n", lines.next().unwrap());
    let mut state = 1_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    for line in lines {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let measured = cells[3..].iter().zip(deviations).map(|(cell, sd)| cell + sd * 12.0_f64.sqrt() * uniform());
        let all: Vec<String> = cells[..3].iter().copied().chain(measured).map(|cell| format!("{cell:?}")).collect();
        noisy += &(all.join(",") + "\n");
    }
    noisy
}

#[test]
fn property_a_wrong_statement_is_named() {
    for (sensors, key, words) in [
        ("velocty = { delay = 0.1 }", "sensors.velocty", "is no signal of a `traverse` experiment; did you mean"),
        ("z = { bias = 0.1 }", "sensors.z", "no run measures this signal; measured are x, velocity, pitch"),
        ("pitch = { bias = { sd = -0.1 } }", "sensors.pitch.bias", "a standard deviation is positive"),
        ("pitch = { delay = 0 }", "sensors.pitch.delay", "a standard deviation is positive"),
        ("pitch = { bias = { sd = 1, unit = \"mm\" } }", "sensors.pitch.bias", "rad"),
        ("pitch = { delay = { sd = 1, unit = \"deg\" } }", "sensors.pitch.delay", "ms"),
        (
            "pitch = { gain = { mean = -1, sd = 0.1 } }",
            "sensors.pitch.gain",
            "a mean gain of -1 (unit 1) cannot be right: expected 0.1 .. 10",
        ),
        ("pitch = { delay = { mean = 20, sd = 5 } }", "sensors.pitch.delay", "expected -1 .. 1 (unit s)"),
        ("pitch = { bias = { mean = inf, sd = 5 } }", "sensors.pitch.bias", "expected a finite number"),
        ("pitch = {}", "sensors.pitch", "at least one of `delay`, `gain`, `bias`"),
    ] {
        let error = read(&format!("[sensors]\n{sensors}\n{NOISE}"), drive(SHORT)).unwrap_err();
        let message = error.to_string();
        assert_eq!(error.column.as_deref(), Some(key), "{message}");
        assert!(error.line.is_some() && message.contains(words), "{message}");
    }
    let error = read(&format!("[sensors]\npitch = {{ lag = 0.1 }}\n{NOISE}"), drive(SHORT)).unwrap_err().to_string();
    assert!(error.contains("unknown field `lag`") && error.contains("delay"), "{error}");
    let toml = "name = \"a\"\nkind = \"single_wheel\"\n[sensors]\ntorque = { gain = 0.1 }\n[[run]]\nfile = \"a.csv\"\n";
    let csv = "load,slip,wheel_speed,torque\n30,0.1,0.2,1\n";
    let texts = [("experiment.toml".to_owned(), toml.to_owned()), ("a.csv".to_owned(), csv.to_owned())];
    let error = Experiment::from_texts(&texts.into()).unwrap_err().to_string();
    assert!(error.contains("only a `traverse` has `[sensors]`"), "{error}");
}

#[test]
fn property_sensors_are_written_and_read_again() {
    let experiment = with(SENSORS, SHORT);
    let bias = experiment.sensors["pitch"].bias;
    assert_eq!(bias, Some(Prior { mean: 0.0, deviation: 3.0_f64.to_radians() }));
    assert_eq!(experiment.sensors["wheel[1+2].current"].gain, Some(Prior { mean: 1.0, deviation: 0.1 }));
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("sensor_errors_written");
    let _ = std::fs::remove_dir_all(&folder);
    experiment.write(&folder).unwrap();
    assert_eq!(Experiment::read(&folder).unwrap().sensors, experiment.sensors);
}
