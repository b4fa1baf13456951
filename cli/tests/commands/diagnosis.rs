//! `diagnose`, `compare`, `calibrate` and `separate`.

use crate::program::{SAND, bekker, call, done, file, json, refused, shown, text};
use std::process::{Command, Stdio};

/// Tests of the soil that are shipped.
const PLATES: &str = "../examples/sand_plates";
const SHEAR: &str = "../examples/sand_shear";

/// A diagnosis of the shipped experiment that is quick.
const QUICK: [&str; 6] = ["diagnose", SAND, "--candidates", "slip_sinkage,coulomb_friction", "--draws", "199"];

#[test]
fn property_compare_writes_a_page() {
    let path = file("sand_wheel.html");
    let out = done(&["compare", "../examples/sand_wheel", "two_wheeled", "--html", shown(&path)]);
    assert!(out.contains("where it fails most") && out.contains("drawbar_pull"), "{out}");
    assert!(std::fs::read_to_string(&path).expect("the page is there").contains("id=\"saved\""));
}

#[test]
fn property_diagnose_says_what_is_missing_and_saves_the_wheel_that_was_measured() {
    let (out, model) = (file("diagnosis.json"), file("improved.toml"));
    let mut arguments = QUICK.to_vec();
    arguments.extend(["--json", shown(&out), "--save", shown(&model), "--threads", "1"]);
    let text = done(&arguments);
    for part in
        ["noise floor: replicates", "calibrated", "candidates (p not below 0.0050)", "soil.friction_angle", "bounds"]
    {
        assert!(text.contains(part), "no `{part}` in: {text}");
    }
    let found = json(&out);
    assert!(text.contains(found["verdict"].as_str().expect("a word")), "{text}");
    assert_eq!(found["interrupted"], false);
    let next = found["next_experiment"].as_str().expect("a text");
    assert!(next.is_empty() || text.contains(next), "{text}");
    let point = ["--input", "load=20", "--input", "slip=0.2", "--input", "wheel_speed=0.5"];
    let points = done(&[&["simulate", shown(&model)], &point[..]].concat());
    assert!(points.contains("1 steady points") && points.contains("drawbar_pull"), "{points}");
    // A wheel on a carriage needs the larger library, which says how to get it where it is left out.
    let fmu = file("improved.fmu");
    let to_fmu = ["fmu", shown(&model), "-o", shown(&fmu)];
    match bekker_fmu_package::RIGID_LIBRARY {
        Some(_) => drop(done(&to_fmu)),
        None => refused(&to_fmu, &["a wheel on a carriage", "--features large-library"]),
    }
    // The result does not depend on the threads.
    let again = file("diagnosis2.json");
    let mut arguments = QUICK.to_vec();
    arguments.extend(["--json", shown(&again), "--threads", "3"]);
    done(&arguments);
    assert_eq!(found, json(&again));
}

#[test]
fn property_bad_calls_of_the_diagnosis_are_refused_in_one_line() {
    refused(&["diagnose", SAND, "--candidates", "slip_sinking"], &["slip_sinking", "slip_sinkage"]);
    refused(&["diagnose", SAND, "--candidates", "drag,drag"], &["drag", "twice"]);
    refused(&["diagnose", SAND, "--with", "no_such"], &["no_such", "slip_sinkage"]);
    refused(&["compare", SAND, "--with", "drag,slip_sinkage,drag"], &["drag", "twice"]);
    refused(&["calibrate", SAND, "--with", "no_such"], &["no_such"]);
    refused(&["separate", SAND, "--candidates", "no_such"], &["no_such"]);
    for option in ["--json", "--html", "--save"] {
        refused(&["diagnose", SAND, option, "no_such_folder/x"], &["no_such_folder/x"]);
    }
    refused(&["calibrate", SAND, "--save", "no_such_folder/x.toml"], &["no_such_folder/x.toml"]);
    for command in ["diagnose", "compare", "calibrate", "separate"] {
        refused(&[command, "no_such_folder"], &["no_such_folder"]);
    }
    for arguments in [["diagnose", SAND, "--threads", "0"], ["diagnose", SAND, "--draws", "0"]] {
        assert_eq!(call(&arguments).status.code(), Some(2));
    }
}

#[test]
fn property_calibrate_saves_what_it_prints() {
    let (out, model) = (file("calibration.json"), file("calibrated.toml"));
    let text = done(&["calibrate", SAND, "--with", "slip_sinkage", "--json", shown(&out), "--save", shown(&model)]);
    assert!(text.contains("slip_sinkage.n1") && text.contains("weights"), "{text}");
    let found = json(&out);
    let saved = done(&["parameters", shown(&model)]);
    for name in ["slip_sinkage.n1", "soil.friction_angle"] {
        let value = found["parameters"][name]["value"].as_f64().expect("a number");
        let line = saved.lines().find(|line| line.starts_with(name)).expect("the parameter is listed");
        let shown: f64 = line.split_whitespace().nth(2).expect("a value").parse().expect("a number");
        assert!((shown - value).abs() <= 1e-6 * value.abs(), "{line} is not {value}");
    }
    let after = found["rmse"]["drawbar_pull"].as_f64().expect("a number");
    let with = done(&["compare", SAND, "--with", "slip_sinkage"]);
    assert!(with.contains(&format!("{after:.5}")), "{after} is not in {with}");
    // The same on a rover that is named.
    let rover = file("calibrated_rover.toml");
    let save = ["--save", shown(&rover), "--vehicle", "gentle_velocity"];
    let saved = done(&[&["calibrate", SAND, "--with", "slip_sinkage"], &save[..]].concat());
    assert!(!saved.contains("warning: the rover"), "{saved}");
    done(&["simulate", shown(&rover), "--duration", "0.2"]);
    assert_eq!(call(&["compare", SAND, "--vehicle", "gentle_velocity"]).status.code(), Some(2), "nothing is saved");
}

/// The line of an error by signal.
fn errors(text: &str) -> Vec<&str> {
    text.lines().filter(|line| line.starts_with("drawbar_pull") || line.starts_with("sinkage")).collect()
}

#[test]
fn regress_what_compare_saves_compares_alike() {
    let model = file("compared.toml");
    let first = done(&["compare", SAND, "--set", "soil.k_phi=9e5", "--save", shown(&model)]);
    let again = done(&["compare", SAND, shown(&model)]);
    assert!(errors(&first).len() == 2 && errors(&first) == errors(&again), "{first}{again}");
    // What disagrees is said.
    let set = done(&["compare", SAND, shown(&model), "--set", "wheel.radius=0.11"]);
    assert!(set.contains("note: wheel.radius: 0.11 m from --set, not 0.1 m from"), "{set}");
}

#[test]
fn property_a_wheel_that_no_rover_can_use_is_saved_and_said() {
    let model = file("unfit.toml");
    // Wheels of 2 cm: the belly of the rover, 3 cm below their axles, is in the ground.
    let small = ["--set", "wheel.radius=0.025", "--set", "soil.k_phi=2e7"];
    let save = ["--save", shown(&model), "--vehicle", "two_wheeled"];
    let text = done(&[&["compare", SAND], &small[..], &save[..]].concat());
    assert!(text.contains("warning: the rover `two_wheeled`"), "{text}");
    assert!(bekker::model::Model::read(&model).is_ok());
}

#[test]
fn property_separate_tells_what_an_experiment_can_show() {
    let out = file("separation.json");
    let text = done(&["separate", SAND, "--as-given", "two_wheeled", "--json", shown(&out)]);
    assert!(text.contains("coulomb_friction.torque") && text.contains("without any signature"), "{text}");
    let found = json(&out);
    assert_eq!(found["calibrated"], false);
    assert!(found["pairs"].as_array().expect("pairs").iter().all(|pair| pair["cosine"].as_f64() <= Some(1.0)));
}

#[test]
fn property_separate_plans_the_cheapest_test_for_a_set() {
    let out = file("set_separation.json");
    let text = done(&["separate", SAND, SHEAR, "--candidates", "slip_sinkage", "--json", shown(&out)]);
    assert!(text.contains("determined by these measurements: ") && text.contains("cheapest additions"), "{text}");
    let found = json(&out);
    assert!(found["determined"].as_array().expect("parameters").iter().any(|one| one["name"] == "soil.exponent"));
    let additions = found["additions"].as_array().expect("additions");
    assert!(additions[0]["runs"].as_u64() >= Some(1) && additions[0]["determines"][0].is_string(), "{additions:?}");
}

#[test]
fn property_what_experiments_share_is_said_on_the_command_line() {
    let text = done(&["calibrate", PLATES, SHEAR, "--share", "vehicle"]);
    assert!(text.contains("a soil of its own in each experiment"), "{text}");
    assert!(text.contains("soil in sand_plates.k_phi") && text.contains("soil in sand_shear.cohesion"), "{text}");
    refused(&["calibrate", SAND, "--share", "soil"], &["--share", "single experiment"]);
    assert_eq!(call(&["calibrate", PLATES, SHEAR, "--share", "wheels"]).status.code(), Some(2));
    let soil = file("several_soils.toml");
    refused(
        &["calibrate", PLATES, SHEAR, "--share", "drive", "--save-soil", shown(&soil)],
        &["several soils", shown(&soil)],
    );
}

#[cfg(unix)]
#[test]
fn property_an_interrupted_diagnosis_writes_what_it_has() {
    let out = file("interrupted.json");
    let _ = std::fs::remove_file(&out);
    let child = bekker()
        .args(["diagnose", SAND, "--draws", "200000", "--json", shown(&out)])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    // Long enough to be at work, far too short for so many draws.
    std::thread::sleep(std::time::Duration::from_secs(3));
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill is there");
    assert!(killed.success());
    let output = child.wait_with_output().expect("ends");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("interrupted"), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("interrupted"), "{}", text(&output.stdout));
    assert_eq!(json(&out)["interrupted"], true);
}
