//! `import` and `experiment`: folders of experiments, from measurements and planned.

use crate::program::{call, done, file, new_folder, refused, shown, text};

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
