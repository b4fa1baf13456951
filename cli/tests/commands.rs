//! The program as its users call it.

use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

fn bekker() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_bekker"));
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

fn call(arguments: &[&str]) -> Output {
    bekker().args(arguments).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Stdout of a call that must succeed.
fn done(arguments: &[&str]) -> String {
    let output = call(arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn shown(path: &std::path::Path) -> &str {
    path.to_str().expect("the path is UTF-8")
}

/// A call that must be refused with exit 1 and one line on stderr that holds every one of `names`.
fn refused(arguments: &[&str], names: &[&str]) {
    let output = call(arguments);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {error}");
    assert_eq!(error.trim_end().lines().count(), 1, "{arguments:?}: {error}");
    assert!(!error.contains("panicked"), "{arguments:?}: {error}");
    for name in names {
        assert!(error.contains(name), "{arguments:?} does not name `{name}`: {error}");
    }
}

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
fn property_compare_writes_a_page() {
    let path = file("sand_wheel.html");
    let out = done(&["compare", "../examples/sand_wheel", "two_wheeled", "--html", shown(&path)]);
    assert!(out.contains("where it fails most") && out.contains("drawbar_pull"), "{out}");
    assert!(std::fs::read_to_string(&path).expect("the page is there").to_lowercase().contains("plotly"));
}

#[test]
fn property_import_proposes_a_folder_that_the_other_commands_read() {
    let (csv, folder) = (file("rig.csv"), file("imported"));
    let _ = std::fs::remove_dir_all(&folder);
    let rows = (0..6).map(|k| format!("{};{};30;{};3\n", 10 * k, 2 * k - 2, 12 + k)).collect::<String>();
    std::fs::write(&csv, format!("slip_percent;DP [N];W [N];z [mm];rpm\n{rows}")).expect("the file can be written");
    let out = done(&["import", shown(&csv), "--output", shown(&folder)]);
    for words in ["a single_wheel experiment", "to be checked:", "wheel.radius", "it can be read: 1 runs, 6 rows"] {
        assert!(out.contains(words), "`{words}` is not in {out}");
    }
    assert!(done(&["compare", shown(&folder)]).contains("drawbar_pull"));
    refused(&["import", shown(&csv), "--output", shown(&folder)], &["imported", "give a new folder"]);
    for command in ["import", "diagnose", "compare", "calibrate", "separate"] {
        assert!(done(&[command, "--help"]).contains("examples/experiments.md"), "{command}");
    }
    // What is doubtful is said by every command, beside its result.
    let settings = folder.join("experiment.toml");
    let text = std::fs::read_to_string(&settings).expect("the settings are there");
    let text = text.replace("[parameters]", "[parameters]\n\"soil.cohesion\" = 1.2");
    std::fs::write(&settings, text).expect("the file can be written");
    let output = call(&["compare", shown(&folder)]);
    assert!(self::text(&output.stderr).contains("doubt: parameters: `soil.cohesion` is 1.2 Pa"), "{output:?}");
}

#[test]
fn property_fmu_is_a_zip() {
    let path = file("x.fmu");
    done(&["fmu", "two_wheeled", "-o", shown(&path)]);
    assert!(std::fs::read(&path).expect("the FMU is there").starts_with(b"PK"));
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

/// The shipped experiment and a diagnosis of it that is quick.
const SAND: &str = "../examples/sand_wheel";
const QUICK: [&str; 6] = ["diagnose", SAND, "--candidates", "slip_sinkage,coulomb_friction", "--draws", "199"];

fn json(path: &std::path::Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(path).expect("the file is there")).expect("it is JSON")
}

/// An empty place for a folder.
fn new_folder(name: &str) -> PathBuf {
    let folder = file(name);
    let _ = std::fs::remove_dir_all(&folder);
    folder
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
fn property_a_planned_experiment_can_be_asked_but_not_compared() {
    let folder = new_folder("planned");
    let plan = [
        "experiment",
        shown(&folder),
        "two_wheeled",
        "--loads",
        "15,30",
        "--slips",
        "-0.1,0,0.1,0.3,0.5",
        "--repeats",
        "2",
    ];
    let text = done(&plan);
    assert!(text.contains("8 runs, 40 rows") && text.contains("3.000e-1 (default)"), "{text}");
    let header = std::fs::read_to_string(folder.join("runs/load15_speed0.2_a.csv")).expect("a run");
    assert!(header.starts_with("load,slip,wheel_speed,drawbar_pull,torque,sinkage\n15.0,-0.1,0.2,,,\n"), "{header}");
    // The plan is read by `separate` and says the same.
    let again = done(&["separate", shown(&folder), "two_wheeled"]);
    assert!(text.ends_with(&again), "{text}\n{again}");
    for command in ["compare", "diagnose", "calibrate"] {
        refused(&[command, shown(&folder), "two_wheeled"], &["nothing is measured yet", "load15"]);
    }
    refused(&plan, &["is there already"]);
}

#[test]
fn property_a_planned_traverse_is_written_with_its_ground() {
    let folder = new_folder("planned_traverse");
    let text = done(&[
        "experiment",
        shown(&folder),
        "two_wheeled_speed",
        "--set",
        "soil.shear_modulus=0.01",
        "--kind",
        "traverse",
        "--slopes",
        "0,4",
        "--wheel-speeds",
        "2",
        "--masses",
        "10",
        "--duration",
        "5",
        "--repeats",
        "1",
        "--signals",
        "x,pitch,wheel[1].torque",
    ]);
    assert!(text.contains("2 runs, 102 rows") && text.contains("pitch"), "{text}");
    assert!(std::fs::read_to_string(folder.join("ground1.csv")).expect("the hill").starts_with("x,z\n"));
    let settings = std::fs::read_to_string(folder.join("experiment.toml")).expect("settings");
    assert!(settings.contains("ground1.csv") && settings.contains("rover.mass"), "{settings}");
}

#[test]
fn property_bad_plans_are_refused_in_one_line() {
    let folder = new_folder("bad_plan");
    let bad = |more: &[&str], names: &[&str]| {
        let mut arguments = vec!["experiment", shown(&folder), "two_wheeled"];
        arguments.extend(more);
        refused(&arguments, names);
        assert!(!folder.join("experiment.toml").exists());
    };
    bad(&["--loads", "-3"], &["loads", "-3"]);
    bad(&["--slips", "2"], &["slips", "2"]);
    bad(&["--repeats", "0"], &["repeats"]);
    bad(&["--slopes", "5"], &["--slopes", "traverse"]);
    bad(&["--kind", "traverse", "--loads", "5"], &["--loads", "single_wheel"]);
    bad(&["--kind", "traverse", "--slopes", "60"], &["slopes"]);
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
