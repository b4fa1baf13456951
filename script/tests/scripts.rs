//! The scripts of `tests/scripts` in the core, and what a script can say wrong. The same scripts are driven through FMUs
//! and the environment by `env/tests/test_check.py`.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker_script::{Core, Door, Script, drive};
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/scripts")
}

/// A script of its own folder, removed when dropped.
struct Written(PathBuf);

impl Written {
    fn new(test: &str, text: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("bekker-script-{}-{test}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("script.toml"), text).unwrap();
        Self(folder)
    }

    fn path(&self) -> PathBuf {
        self.0.join("script.toml")
    }
}

impl Drop for Written {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A drive that holds 0.2 m/s; `more` comes at the end.
fn holds(more: &str) -> String {
    format!(
        "interval = 0.02\nduration = 0.4\nmodel = 'gentle_velocity'\n[inputs]\nvelocity_command = 0.2\n[expect]\n{more}"
    )
}

#[test]
fn regress_scripts_hold_in_the_core() {
    let mut count = 0;
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let script = Script::read(&path).unwrap();
            let report = script.check(&mut Core::new(&script)).unwrap();
            assert!(report.passed(), "{report}");
            assert!(report.signals.iter().all(|signal| signal.compared > 0), "{report}");
            count += 1;
        }
    }
    assert!(count >= 5, "{count}");
}

#[test]
fn property_a_recording_holds_to_the_last_bit_and_a_changed_one_does_not() {
    let exact = "signals = 'a.csv'\nrecord = ['x', 'wheel.slip']\nrecord_every = 0.1\ntolerance = { default = 0.0 }";
    let written = Written::new("record", &holds(exact));
    let script = Script::read_to_record(&written.path()).unwrap();
    let table = script.write_expected(&drive(&script, &mut Core::new(&script)).unwrap()).unwrap();
    let script = Script::read(&written.path()).unwrap();
    let report = script.check(&mut Core::new(&script)).unwrap();
    assert!(report.passed(), "{report}");
    assert_eq!(report.signals.len(), 3);
    assert!(report.signals.iter().all(|signal| signal.compared == 5), "{report}");

    // The last place of one value of x, and all slips of wheel 2.
    let text = std::fs::read_to_string(&table).unwrap();
    let mut rows: Vec<Vec<String>> = text.lines().map(|l| l.split(',').map(str::to_owned).collect()).collect();
    let x: f64 = rows[3][1].parse().unwrap();
    rows[3][1] = format!("{:?}", x.next_up());
    for (k, row) in rows.iter_mut().enumerate().skip(1) {
        row[3] = format!("{:?}", row[3].parse::<f64>().unwrap() + 0.01 * k as f64);
    }
    let lines: Vec<String> = rows.iter().map(|row| row.join(",")).collect();
    std::fs::write(&table, lines.join("\n")).unwrap();
    let report = {
        let script = Script::read(&written.path()).unwrap();
        script.check(&mut Core::new(&script)).unwrap()
    };
    assert!(!report.passed());
    let failed: Vec<usize> = report.signals.iter().map(|signal| signal.failed).collect();
    assert_eq!(failed, [1, 0, 5], "{report}");
    let (first, largest) = (report.signals[0].first.unwrap(), report.signals[0].largest.unwrap());
    assert_eq!((first.time, first.value, first.expected), (0.2, x, x.next_up()));
    assert_eq!(first, largest);
    let slip = &report.signals[2];
    assert_eq!((slip.first.unwrap().time, slip.largest.unwrap().time), (0.0, 0.4));
    let shown = report.to_string();
    assert!(shown.starts_with("FAIL") && shown.contains("wheel[2].slip: 5 of 5 values off"), "{shown}");
}

#[test]
fn property_what_was_before_a_reset_leaves_nothing_behind() {
    let record = |test: &str, text: String| {
        let written = Written::new(test, &text);
        let script = Script::read_to_record(&written.path()).unwrap();
        drive(&script, &mut Core::new(&script)).unwrap()
    };
    let plain = holds("signals = 'a.csv'");
    let fresh = record("fresh", plain.clone());
    assert_eq!(record("again", format!("reset_after = 0.3\n{plain}")), fresh);
}

#[test]
fn property_actions_are_inputs_over_their_scale() {
    let of = |test: &str, text: &str| {
        let written = Written::new(test, text);
        Script::read(&written.path()).unwrap()
    };
    let head = "interval = 0.02\nduration = 0.1\nmodel = 'two_wheeled'\n";
    let tail = "[expect]\nstatus = 'running'";
    let inputs = "[[inputs]]\ntime = 0\n'wheel[1].torque_command' = 1.5\n[[inputs]]\ntime = 0.04\n\
                  'wheel[1].torque_command' = -0.5\n'wheel[2].torque_command' = 1\n";
    let actions = "[[actions]]\ntime = 0\n'action[1]' = 0.75\n[[actions]]\ntime = 0.04\n'action[1]' = -0.25\n\
                   'action[2]' = 0.5\n";
    let by_inputs = of("inputs", &format!("{head}{inputs}{tail}"));
    let by_actions = of("actions", &format!("{head}action_scale = 2.0\n{actions}{tail}"));
    // Held from their times on; the second wheel's stays at its start until it is given.
    let held = [[1.5, 0.0], [1.5, 0.0], [-0.5, 1.0], [-0.5, 1.0], [-0.5, 1.0]];
    assert_eq!(by_inputs.inputs, held.map(|row| row.to_vec()));
    assert_eq!(by_actions.inputs, by_inputs.inputs);
}

#[test]
fn property_status_times_of_events_and_ranges_are_checked() {
    let check = |test: &str, expect: &str| {
        let written = Written::new(test, &holds(expect));
        let script = Script::read(&written.path()).unwrap();
        script.check(&mut Core::new(&script)).unwrap().to_string()
    };
    assert!(check("status", "status = 'stuck'").contains("status at 0.4 s: running, expected stuck"));
    assert!(check("within", "range = { velocity = [-0.1, 1.0] }").starts_with("ok"));
    let below = check("below", "range = { velocity = [-0.1, 0.05] }");
    assert!(below.starts_with("FAIL") && below.contains("velocity in range"), "{below}");
}

#[test]
fn property_an_event_that_comes_at_another_time_is_said() {
    let text = std::fs::read_to_string(folder().join("sinks_in.toml")).unwrap();
    let early = text.replace("ends_within = [0.2, 10.0]", "ends_within = [0.0, 0.1]");
    assert_ne!(text, early);
    let written = Written::new("event", &early);
    let script = Script::read(&written.path()).unwrap();
    let report = script.check(&mut Core::new(&script)).unwrap();
    assert!(report.to_string().contains("expected within 0 .. 0.1 s"), "{report}");
}

#[test]
fn property_every_broken_script_says_what_and_where() {
    let model = "model = 'two_wheeled'\n";
    let clock = "interval = 0.02\nduration = 0.2\n";
    let expect = "[expect]\nstatus = 'running'\n";
    let cases: &[(String, &str)] = &[
        ("interval = ".into(), "script.toml: TOML parse error"),
        (format!("{clock}{model}colour = 1\n{expect}"), "unknown field `colour`"),
        (format!("{clock}model = 'unknown'\n{expect}"), "unknown preset `unknown`"),
        (format!("{clock}model = 3\n{expect}"), "key `model` = 3: expected a built-in model"),
        (format!("{clock}model = 'none.toml'\n{expect}"), "none.toml"),
        (format!("{clock}model = {{ preset = 'two_wheeled', parameters = {{ 'soil.c' = 1 }} }}\n{expect}"), "`soil.c`"),
        (format!("interval = 0.003\nduration = 0.2\n{model}{expect}"), "`interval` = 0.003: expected a whole number"),
        (format!("interval = 0.02\nduration = 0.05\n{model}{expect}"), "`duration` = 0.05: expected a whole number"),
        (format!("{clock}{model}reset_after = -1\n{expect}"), "`reset_after` = -1"),
        (format!("{clock}{model}inputs = 'none.csv'\n{expect}"), "none.csv"),
        (format!("{clock}{model}inputs = {{ speed = 1.0 }}\n{expect}"), "`speed` is none of this model's"),
        (
            format!("{clock}{model}inputs = {{ 'wheel[1].torque_command' = 1e9 }}\n{expect}"),
            "`wheel[1].torque_command` = 1000000000 is outside",
        ),
        (
            format!("{clock}{model}[[inputs]]\ntime = 0.03\n'wheel[1].torque_command' = 1\n{expect}"),
            "key `inputs, first time` = 0.03: expected 0 or before",
        ),
        (
            format!(
                "{clock}{model}[[inputs]]\ntime = 0\n'wheel[1].torque_command' = 1\n[[inputs]]\ntime = 0.03\n{expect}"
            ),
            "key `inputs, time` = 0.03: expected a whole number of intervals",
        ),
        (format!("{clock}{model}[actions]\n'action[1]' = 0.5\n{expect}"), "expected an `action_scale`"),
        (
            format!("{clock}{model}action_scale = 1\n[actions]\n'action[1]' = 1.5\n{expect}"),
            "key `action[1] at time 0` = 1.5: expected -1 to 1",
        ),
        (
            format!("{clock}{model}[expect]\nstatus = 'parked'"),
            "key `expect.status` = \"parked\": expected running, stuck",
        ),
        (format!("{clock}{model}[expect]\n"), "expected at least one of"),
        (format!("{clock}{model}[expect]\nends_within = [0.1, 0.2]"), "expected a `status` other than"),
        (format!("{clock}{model}[expect]\nrange = {{ pitch = [1, 0] }}"), "key `expect.range.pitch` = [1, 0]"),
        (format!("{clock}{model}[expect]\nrange = {{ yaw = [0, 1] }}"), "`yaw` is no signal of this rover"),
        (
            format!("{clock}{model}[expect]\nstatus = 'running'\ntolerance = {{ x = -1.0 }}"),
            "key `expect.tolerance.x` = -1",
        ),
        (
            format!("{clock}{model}[expect]\n[[expect.signals]]\ntime = 0.05\nx = 0.0"),
            "key `expect.signals, time` = 0.05",
        ),
        (format!("{clock}{model}[expect]\n[[expect.signals]]\nx = 0.0"), "the row has no `time`"),
        (
            format!("{clock}{model}[expect]\n[[expect.signals]]\ntime = 0\nx = 'far'"),
            "x` = \"far\": expected a finite number",
        ),
    ];
    for (number, (text, expected)) in cases.iter().enumerate() {
        let written = Written::new(&format!("broken-{number}"), text);
        let refused = Script::read(&written.path()).expect_err(text).to_string();
        assert!(refused.contains(expected) && refused.contains("script.toml"), "{text}\n{refused}");
    }
}

/// A door that gives nothing but NaN.
struct Nothing;

impl Door for Nothing {
    fn name(&self) -> String {
        "nothing".into()
    }
    fn reset(&mut self) -> Result<(), String> {
        Ok(())
    }
    fn step(&mut self, _: &[f64]) -> Result<(), String> {
        Ok(())
    }
    fn time(&self) -> f64 {
        0.0
    }
    fn signals(&mut self, out: &mut [f64]) -> Result<(), String> {
        out.fill(f64::NAN);
        Ok(())
    }
    fn status(&mut self) -> Result<String, String> {
        Ok("running".into())
    }
}

#[test]
fn property_what_is_not_a_number_is_never_as_expected() {
    let rows = "[[expect.signals]]\ntime = 0\nx = 0\n[[expect.signals]]\ntime = 0.2\nx = 0.1\n";
    let written = Written::new("nothing", &holds(&format!("tolerance = {{ x = 1e9 }}\n{rows}")));
    let report = Script::read(&written.path()).unwrap().check(&mut Nothing).unwrap();
    assert_eq!(report.signals[0].failed, 1, "{report}");
    assert!(report.to_string().contains("no sample at 0.2 s (1 of 2 missing)"), "{report}");
}
