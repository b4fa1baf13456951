//! The program as its users call it.

mod diagnosis;
mod experiments;
mod planning;
mod program;

use program::{bekker, call, done, file, refused, shown, text};
use std::process::Stdio;

#[test]
fn property_every_preset_simulates() {
    let models = done(&["parameters", "--models"]);
    assert!(models.lines().count() > 1);
    for name in models.lines().filter_map(|line| line.split_whitespace().next()) {
        let out = done(&["simulate", name, "--duration", "1"]);
        assert!(out.contains(name) && !out.contains("NaN") && !out.contains("inf"), "{out}");
    }
}

#[test]
fn property_bad_values_are_refused_in_one_line() {
    refused(&["simulate", "no_such_rover"], &["no_such_rover", "two_wheeled"]);
    refused(&["simulate", "--set", "soil.kohesion=1"], &["soil.kohesion"]);
    refused(&["simulate", "--set", "soil.cohesion=-1"], &["soil.cohesion", "-1"]);
    refused(&["simulate", "--set", "soil.cohesion=much"], &["soil.cohesion", "much"]);
    refused(&["simulate", "--duration", "nan"], &["--duration", "NaN"]);
    refused(&["simulate", "--duration", "0"], &["--duration", "--every"]);
    refused(&["simulate", "--duration", "0.05"], &["--duration 0.05", "--every 0.02"]);
    refused(&["simulate", "--every", "0.003"], &["--every 0.003"]);
    refused(&["simulate", "--input-file", "no_such.csv"], &["no_such.csv"]);
    refused(&["compare", "no_such_folder"], &["no_such_folder"]);
    refused(&["simulate", "--duration", "0.1", "--signals", "no_such_signal"], &["no_such_signal"]);
    refused(&["simulate", "--csv", "no_such_folder/x.csv"], &["no_such_folder/x.csv"]);
}

#[test]
fn property_effects_of_the_users_own_are_set_like_any_other() {
    const OWN: [&str; 2] = ["--effects-from", "../examples/own_effects.toml"];
    fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
        [&["simulate", "two_wheeled_speed", "--duration", "1"], &OWN[..], more].concat()
    }
    let speeds = ["--input", "wheel[1].speed_command=2", "--input", "wheel[2].speed_command=2"];
    let dragged = [&["--set", "cable.k=10"], &speeds[..]].concat();
    assert_ne!(done(&with(&speeds)), done(&with(&dragged)));
    let model = done(&[&["parameters", "two_wheeled", "--toml"], &OWN[..]].concat());
    assert!(model.contains("[[effect]]") && model.contains("\"cable.k\" = 0.0"), "{model}");
    assert!(done(&[&["parameters", "--effects"], &OWN[..]].concat()).contains("stribeck"));
    refused(&with(&["--set", "cable.k=11"]), &["cable.k", "0 .. 10 N/m"]);
    refused(&["simulate", "--effects-from", "no_such.toml"], &["no_such.toml"]);
    let bad = file("bad_effect.toml");
    let text =
        std::fs::read_to_string("../examples/own_effects.toml").expect("the example").replace("travelled", "way");
    std::fs::write(&bad, text).expect("the file is written");
    refused(&["simulate", "--effects-from", shown(&bad)], &["bad_effect.toml", "`cable`", "`way`", "travelled"]);
}

#[test]
fn property_bad_input_files_are_refused() {
    let path = file("inputs.csv");
    let refuse = |content: &str, more: &[&str], names: &[&str]| {
        std::fs::write(&path, content).expect("the file is written");
        let mut arguments = vec!["simulate", "gentle_velocity", "--duration", "0.1", "--input-file", shown(&path)];
        arguments.extend(more);
        refused(&arguments, names);
    };
    refuse("time\n0\n", &[], &["inputs.csv", "velocity_command"]);
    refuse("time,velocity_command\n1,0.2\n", &[], &["inputs.csv", "time"]);
    refuse("time,no_such_input\n0,0.2\n", &[], &["no_such_input"]);
    refuse(
        "time,velocity_command\n0,0.2\n",
        &["--input", "velocity_command=0.1"],
        &["velocity_command", "--input-file"],
    );
}

#[test]
fn property_calls_that_cannot_be_read_exit_with_2() {
    for arguments in [&["no_such_command"][..], &["simulate", "--no-such-option"], &["simulate", "--duration", "long"]]
    {
        let output = call(arguments);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(arguments[arguments.len() - 1]) && !error.contains("panicked"), "{error}");
    }
}

#[test]
fn property_a_closed_pipe_is_no_failure() {
    for arguments in
        [&["parameters"][..], &["simulate", "--duration", "0.1"], &["compare", "../examples/sand_wheel", "two_wheeled"]]
    {
        let mut child = bekker().args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("starts");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("ends");
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
        assert!(!text(&output.stderr).contains("panicked"));
    }
}

#[test]
fn property_printed_model_is_accepted() {
    let path = file("printed.toml");
    std::fs::write(&path, done(&["parameters", "rocker_bogie_velocity", "--toml"])).expect("the file is written");
    assert_eq!(
        done(&["simulate", shown(&path), "--duration", "0.2"]).lines().nth(1),
        done(&["simulate", "rocker_bogie_velocity", "--duration", "0.2"]).lines().nth(1)
    );
}

#[test]
fn property_fmu_is_a_zip() {
    let path = file("x.fmu");
    let said = done(&["fmu", "two_wheeled", "-o", shown(&path)]);
    assert!(said.contains("which runs on") && said.contains(std::env::consts::ARCH), "{said}");
    assert!(std::fs::read(&path).expect("the FMU is there").starts_with(b"PK"));
    let system = file("x.ssp");
    let said = done(&["fmu", "gentle_rtc", "-o", shown(&system)]);
    assert!(said.contains("delays the torques by one of its steps"), "{said}");
    refused(&["fmu", "gentle_rtc", "-o", shown(&system), "--fmi", "3"], &["SSP 1.0 holds FMUs of FMI 2.0"]);
    refused(&["fmu", "gentle_rtc", "-o", shown(&path), "--library", shown(&system)], &["x.ssp", "library of FMUs"]);
}

#[test]
fn property_the_demo_names_what_it_wrote_and_wrote_it() {
    let out = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("demo");
    let done = std::process::Command::new(env!("CARGO_BIN_EXE_bekker"))
        .args(["demo", "--out"])
        .arg(&out)
        .output()
        .expect("runs");
    let text = String::from_utf8_lossy(&done.stdout);
    assert!(done.status.success(), "{text}{}", String::from_utf8_lossy(&done.stderr));
    assert!(text.contains("thesis, RTC") && !text.contains("NaN"), "{text}");
    for name in ["gentle_velocity_K30mm.csv", "gentle_rtc_K10mm.csv", "gentle_rtc.fmu", "sand_wheel.html"] {
        assert!(text.contains(name), "{name} is not named in: {text}");
        assert!(std::fs::metadata(out.join(name)).is_ok_and(|file| file.len() > 10_000), "{name} is missing or small");
    }
    let improved = bekker::model::Model::read(&out.join("improved.toml")).expect("a model");
    assert!(text.contains("improved.toml") && improved.rover.effects.slip_sinkage.n1 > 0.0);
}

#[test]
fn property_steady_points_are_written_row_by_row() {
    let (model, rows, out) = (file("wheel.toml"), file("points.csv"), file("steady.csv"));
    std::fs::write(&model, "[rig]\nkind = \"carriage\"\n[parameters]\nsoil.shear_modulus = 0.012\n").expect("written");
    std::fs::write(&rows, "load,slip\n20,0.1\n20,0.4\n40,0.4\n").expect("written");
    let table = ["simulate", shown(&model), "--input-file", shown(&rows), "--input", "wheel_speed=0.5"];
    done(&[&table[..], &["--csv", shown(&out)]].concat());
    let written = bekker::measurement::Table::read(&out).expect("a table");
    assert_eq!(written.names(), ["load", "slip", "wheel_speed", "drawbar_pull", "torque", "sinkage"]);
    let rig = bekker::model::Model::read(&model).expect("a model").rig();
    for row in 0..3 {
        let value = |name: &str| written.value(name, row).expect("a number");
        let point = bekker::carriage::steady_point(&rig, value("load"), value("slip"), 0.5).expect("a point");
        assert_eq!((value("torque"), value("sinkage")), (point.torque, point.sinkage));
    }
    refused(&["simulate", shown(&model), "--input", "load=20", "--input", "slip=0.2"], &["wheel_speed", "missing"]);
    refused(&[&table[..], &["--input", "slip=0.2"]].concat(), &["slip", "twice"]);
    refused(&[&table[..], &["--duration", "2"]].concat(), &["--duration", "steady point"]);
    std::fs::write(&rows, "load,slip\n20,0.1\n1e5,0.4\n").expect("written");
    refused(&table, &["points.csv", "line 3", "sinks to its axle"]);
    std::fs::write(&rows, "load,slip,speed\n20,0.1,1\n").expect("written");
    refused(&table, &["speed", "no input", "wheel_speed"]);
    assert!(done(&["parameters", shown(&model)]).contains("drawbar_pull [N]"));
}
