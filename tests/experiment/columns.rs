//! Columns in names, units and forms of their own: `[columns]`, `[file]`, `[inputs]`, `where`.

use bekker::measurement::{Experiment, ExperimentError};
use std::collections::BTreeMap;

/// Rounding of one multiplication by a unit's factor.
const ROUNDING: f64 = 1e-15;

const HEAD: &str = "name = \"t\"\nkind = \"single_wheel\"\n";
const RIG: &str = "[parameters]\n\"wheel.radius\" = 0.1\n\"wheel.width\" = 0.05\n";
const RUN: &str = "[[run]]\nfile = \"a.csv\"\n";

fn read(toml: &str, csv: &str) -> Result<Experiment, ExperimentError> {
    let texts = [("experiment.toml", toml), ("a.csv", csv)].map(|(name, text)| (name.to_owned(), text.to_owned()));
    Experiment::from_texts(&BTreeMap::from(texts))
}

fn wheel(settings: &str, csv: &str) -> Result<Experiment, ExperimentError> {
    read(&format!("{HEAD}{settings}\n{RIG}{RUN}"), csv)
}

fn rover(settings: &str, csv: &str) -> Result<Experiment, ExperimentError> {
    read(&format!("name = \"t\"\nkind = \"traverse\"\n{settings}\n{RIG}{RUN}"), csv)
}

fn close(found: Option<f64>, expected: f64) {
    let found = found.unwrap();
    assert!((found - expected).abs() <= 2.0 * ROUNDING * expected.abs(), "{found} is not {expected}");
}

#[test]
fn property_units_signs_scales_and_offsets() {
    let columns = r#"[columns]
"DP [kN]" = { signal = "drawbar_pull", unit = "kN" }
"W" = { signal = "load", unit = "kg" }
"s" = { signal = "slip", unit = "%" }
"n" = { signal = "wheel_speed", unit = "rpm" }
"z" = { signal = "sinkage", unit = "mm", sign = -1, offset = 0.001 }
"T" = { signal = "torque", unit = "N mm", scale = 2.0 }
"#;
    let csv = "DP [kN],W,s,n,z,T\n-0.0015,3,10,3,-12,500\n0.004,3,20,3,-14,900\n0.009,3,30,3,-15,1500\n";
    let experiment = wheel(columns, csv).unwrap();
    let data = &experiment.runs[0].data;
    close(data.value("drawbar_pull", 0), -1.5);
    close(data.value("load", 0), 3.0 * 9.80665);
    close(data.value("slip", 1), 0.2);
    close(data.value("wheel_speed", 0), std::f64::consts::PI / 10.0);
    close(data.value("sinkage", 0), 0.013);
    close(data.value("torque", 0), 1.0);
    assert_eq!(experiment.runs[0].inputs, ["load", "slip", "wheel_speed"]);
    assert_eq!(experiment.doubts, [] as [String; 0]);
    // Gravity that the experiment states makes the weight.
    let moon = read(&format!("{HEAD}{columns}{RIG}gravity = 1.62\n{RUN}"), csv).unwrap();
    close(moon.runs[0].data.value("load", 0), 3.0 * 1.62);
}

#[test]
fn property_units_of_parameters_priors_noise_and_inputs() {
    let settings = format!(
        "{HEAD}inputs = {{ load = {{ value = 3.0, unit = \"kg\" }}, wheel_speed = {{ value = 6, unit = \"deg/s\" }} }}\n\
         [noise]\nsinkage = {{ value = 0.5, unit = \"mm\" }}\n\
         [priors]\n\"soil.friction_angle\" = {{ mean = 30.0, sd = 2.0, unit = \"deg\" }}\n\"soil.cohesion\" = {{ sd = 100 }}\n\
         [parameters]\n\"soil.cohesion\" = {{ value = 0.8, unit = \"kPa\" }}\n\"wheel.radius\" = {{ value = 58, unit = \"mm\" }}\n{RUN}"
    );
    let experiment = read(&settings, "slip,sinkage\n0.1,0.01\n0.2,0.011\n").unwrap();
    close(experiment.noise.get("sinkage").copied(), 5e-4);
    close(Some(experiment.priors["soil.friction_angle"].mean), 30.0_f64.to_radians());
    close(Some(experiment.priors["soil.friction_angle"].deviation), 2.0_f64.to_radians());
    close(Some(experiment.priors["soil.cohesion"].mean), 800.0);
    close(experiment.parameters.get("wheel.radius").copied(), 0.058);
    close(experiment.runs[0].data.value("load", 1), 3.0 * 9.80665);
    close(experiment.runs[0].data.value("wheel_speed", 1), 6.0_f64.to_radians());
}

#[test]
fn property_wrong_mappings_are_named() {
    let csv = "DP,load,slip,wheel_speed,sinkage\n1,30,0.1,0.2,0.01\n";
    let cases = [
        ("\"DP\" = { signal = \"drawbar_pull\", unit = \"mm\" }", "multiple of m, not of N; expected one of N, kN"),
        ("\"DP\" = { signal = \"drawbar_pull\", unit = \"furlong\" }", "unknown unit `furlong`; expected one of N"),
        ("\"DP\" = \"drawbar_pul\"", "did you mean drawbar_pull?"),
        ("\"DP\" = { signal = \"drawbar_pull\", sign = 2 }", "`sign` is 1 or -1"),
        ("\"DP\" = { signal = \"drawbar_pull\", units = \"N\" }", "unknown field `units`"),
        ("\"DP\" = { parameter = \"wheel.radus\", unit = \"mm\" }", "did you mean wheel.radius"),
        ("\"DP\" = { signal = \"drawbar_pull\", wheels = [1, 2] }", "has one wheel"),
        ("\"DP\" = { unit = \"N\" }", "expected one of `signal"),
        ("\"DP\" = { time_stamp = true }", "only a `traverse` has time"),
        ("\"DP\" = \"load\"", "gives load, as column `DP` does"),
        ("\"DP\" = \"drawbar_pull\"\n\"DPP\" = \"torque\"", "no file has this column; did you mean DP?"),
    ];
    for (line, words) in cases {
        let message = wheel(&format!("[columns]\n{line}"), csv).unwrap_err().to_string();
        assert!(message.contains(words), "{line}: {message}");
    }
    let error = wheel("ignore = [\"DP\"]\n[columns]\n\"DP\" = \"drawbar_pull\"", csv).unwrap_err();
    assert_eq!((error.line, error.column.as_deref()), (Some(5), Some("columns.DP")), "{error}");
}

#[test]
fn property_all_unknown_columns_in_one_message() {
    let csv = "load,slip,wheel_speed,sinkge,DP [kN],beta,note\n30,0.1,0.2,0.01,0.001,0,a\n";
    let message = wheel("ignore = [\"no*\"]", csv).unwrap_err().to_string();
    for words in [
        "columns `sinkge` (did you mean sinkage?)",
        "`DP [kN]` (perhaps \"DP [kN]\" = { signal = \"drawbar_pull\", unit = \"kN\" }",
        "`beta`",
        "ignore = [..]",
    ] {
        assert!(message.contains(words), "{message}");
    }
    assert!(!message.contains("`note`"), "{message}");
}

/// All bits of a run; missing values, which equal nothing, included.
fn text(experiment: &Experiment) -> String {
    let mut text = Vec::new();
    experiment.runs[0].data.write_csv(&mut text).unwrap();
    String::from_utf8(text).unwrap()
}

#[test]
fn property_dialects_read_alike() {
    let plain = wheel("", "load,slip,wheel_speed,drawbar_pull\n30,0.1,0.2,-1.5\n1234.5,0.2,0.2,\n").unwrap();
    let texts = [
        "load;slip;wheel_speed;drawbar_pull\n30;0,1;0,2;-1,5\n1234,5;0,2;0,2;\n",
        "\u{feff}# a comment\n\nload\tslip\twheel_speed\tdrawbar_pull\r\n30\t0.1\t0.2\t-1.5\r\n% another; one\n1234.5\t0.2\t0.2\t\r\n",
        "load,slip,wheel_speed,drawbar_pull,\n[N],[-],[rad/s],[N],\n30,0.1,0.2,-1.5,\n1234.5,0.2,0.2,,\n,,,,\n",
        "\"load\";\"slip\";\"wheel_speed\";\"drawbar_pull\"\n\"30\";0.1;0.2;-1.5\n1.2345e3;0.2;0.2;\n",
    ];
    for csv in texts {
        let read = wheel("", csv).unwrap();
        assert_eq!(text(&read), text(&plain), "{csv}");
    }
    let read = wheel(
        "file = { missing = [\"-9999\"], separator = \"space\" }",
        "load slip wheel_speed  drawbar_pull\n30 0.1  0.2 -1.5\n 1234.5 0.2 0.2 -9999\n",
    )
    .unwrap();
    assert_eq!(text(&read), text(&plain));
    let header = "made on Monday, by hand\n# load,slip,wheel_speed,drawbar_pull\n30,0.1,0.2,-1.5\n1234.5,0.2,0.2,\n";
    let read = wheel("file = { header_line = 2 }", header).unwrap();
    assert_eq!(text(&read), text(&plain));
}

#[test]
fn property_what_a_dialect_leaves_open_is_said() {
    let cases = [
        ("", "load,slip;wheel_speed,sinkage\n30,0.1;0.2,0.01\n", "the separator is not clear"),
        (
            "",
            "load;slip;wheel_speed;sinkage\n30;0,1;0.2;0,01\n",
            "the decimal mark is not clear: line 2 has `0,1` and line 2 `0.2`",
        ),
        ("", "load,slip,wheel_speed,sinkage\n30,\"0,1\",0.2,0.01\n", "read with `,` between cells and a decimal point"),
        ("", "# load,slip,wheel_speed,sinkage\n30,0.1,0.2,0.01\n", "`header_line` under [file]"),
        ("file = { separator = \"|\" }", "load,slip\n", "unknown variant `|`"),
        ("file = { seperator = \";\" }", "load,slip\n", "unknown field `seperator`"),
        (
            "",
            "load,slip,wheel_speed,sinkage\nN,-,rad/s,mm\n30,0.1,0.2,1\n",
            "gives its unit as `mm`, and it is read in m; write under [columns]: \"sinkage\" = { signal = \"sinkage\", unit = \"mm\" }",
        ),
    ];
    for (settings, csv, words) in cases {
        let message = wheel(settings, csv).unwrap_err().to_string();
        assert!(message.contains(words), "{csv}: {message}");
    }
}

#[test]
fn property_rows_are_filtered_and_parted_by_parameters() {
    let columns = "[file]\nwhere = { beta = 0, kind = [\"a\", \"b\"], slip = { min = 0.0 } }\n[columns]\n\"h\" = { parameter = \"grousers.height\", unit = \"mm\" }\n\"c\" = \"condition\"";
    let csv = "beta,kind,h,c,load,slip,wheel_speed,sinkage\n\
               0,a,0,p,30,0.1,0.2,0.010\n0.0,b,10,p,30,0.1,0.2,0.011\n15,a,0,p,30,0.1,0.2,0.012\n\
               0,c,0,p,30,0.1,0.2,0.013\n0,a,0.0,q,30,0.2,0.2,0.014\n0,a,0,p,30,-0.2,0.2,0.015\n";
    let experiment = wheel(columns, csv).unwrap();
    let runs: Vec<_> = experiment.runs.iter().map(|run| (run.name.as_str(), run.data.rows())).collect();
    assert_eq!(runs, [("a#1", 2), ("a#2", 1)]);
    assert_eq!(experiment.runs[0].parameters["grousers.height"], 0.0);
    close(experiment.runs[1].parameters.get("grousers.height").copied(), 0.01);
    assert_eq!(experiment.runs[0].conditions, [Some("p".to_owned()), Some("q".to_owned())]);
    assert_eq!(experiment.runs[0].data.column("sinkage").unwrap(), [0.010, 0.014]);
    let nothing = columns.replace("beta = 0", "beta = 7");
    let message = wheel(&nothing, csv).unwrap_err().to_string();
    assert!(message.contains("no row has what `where` wants"), "{message}");
    let unknown = columns.replace("beta = 0", "beta = 0, gamma = 0");
    let message = wheel(&unknown, csv).unwrap_err().to_string();
    assert!(message.contains("column `gamma`") && message.contains("the file has beta"), "{message}");
}

#[test]
fn property_a_file_that_is_read_twice_gives_runs_of_different_names() {
    let toml = format!(
        "{HEAD}{RIG}[[run]]\nfile = \"a.csv\"\nwhere = {{ part = 1 }}\n[[run]]\nfile = \"a.csv\"\nwhere = {{ part = 2 }}\n[[run]]\nfile = \"a.csv\"\nname = \"all\"\nwhere = {{ part = [1, 2] }}\n"
    );
    let csv = "part,load,slip,wheel_speed,sinkage\n1,30,0.1,0.2,0.01\n2,30,0.2,0.2,0.02\n";
    let experiment = read(&toml, csv).unwrap();
    let names: Vec<&str> = experiment.runs.iter().map(|run| run.name.as_str()).collect();
    assert_eq!(names, ["a#1", "a#2", "all"]);
}

#[test]
fn analytic_slip_and_wheel_speed_follow_from_recorded_speeds() {
    // Vx and Vr in mm/s, driving, skidding and locked: i = 1 - V/(r omega), r omega/V - 1.
    let columns = "[columns]\nVx = { signal = \"carriage_speed\", unit = \"mm/s\" }\nVr = { signal = \"rim_speed\", unit = \"mm/s\" }";
    let csv = "load,Vx,Vr,sinkage\n30,10,20,0.01\n30,10,5,0.01\n30,10,0,0.01\n30,10,10,0.01\n";
    let experiment = wheel(columns, csv).unwrap();
    let data = &experiment.runs[0].data;
    for (row, (slip, speed)) in [(0.5, 0.2), (-0.5, 0.05), (-1.0, 0.0), (0.0, 0.1)].into_iter().enumerate() {
        assert!((data.value("slip", row).unwrap() - slip).abs() < ROUNDING, "row {row}");
        assert!((data.value("wheel_speed", row).unwrap() - speed).abs() < ROUNDING, "row {row}");
    }
    assert_eq!(data.names(), ["load", "wheel_speed", "sinkage", "slip"]);
    // The other way round: wheel speed from slip and carriage speed.
    let csv = "load,slip,Vx,sinkage\n30,0.5,10,0.01\n30,-0.5,10,0.01\n";
    let one = "[columns]\nVx = { signal = \"carriage_speed\", unit = \"mm/s\" }";
    let data = wheel(one, csv).unwrap().runs[0].data.clone();
    assert!((data.value("wheel_speed", 0).unwrap() - 0.2).abs() < ROUNDING);
    assert!((data.value("wheel_speed", 1).unwrap() - 0.05).abs() < ROUNDING);
    let message = wheel(one, "load,slip,Vx,sinkage\n30,1.0,10,0.01\n").unwrap_err().to_string();
    assert!(message.contains("no wheel_speed follows") && message.contains("line 2"), "{message}");
    let message = read(&format!("{HEAD}{columns}\n{RUN}"), "load,Vx,Vr,sinkage\n30,10,20,0.01\n").unwrap_err();
    assert!(message.to_string().contains("needs \"wheel.radius\""), "{message}");
    // A slip that the speeds contradict is doubted.
    let csv = "load,slip,Vx,Vr,sinkage\n30,0.5,10,20,0.01\n30,1.0,10,20,0.01\n";
    let doubts = wheel(columns, csv).unwrap().doubts.join("\n");
    assert!(doubts.contains("differs from that of the recorded speeds in 1 of 2 rows"), "{doubts}");
}

fn log(header: &str, row: impl Fn(usize) -> String) -> String {
    format!("{header}\n") + &(0..12).map(|k| row(k) + "\n").collect::<String>()
}

#[test]
fn property_time_stamps_commands_of_several_wheels_and_sums() {
    let columns = "[columns]\nstamp = { time_stamp = true }\ncmd = { signal = \"speed_command\", wheels = [1, 2], unit = \"rpm\" }\nI_left = { signal = \"current\", wheels = [2, 1], unit = \"mA\" }\npitch = { signal = \"pitch\", unit = \"deg\" }";
    let csv = log("stamp;cmd;I_left;pitch", |k| format!("2019-01-29T10:{k:02}:59,500;6;1500,5;-3,0"));
    let experiment = rover(columns, &csv).unwrap();
    let run = &experiment.runs[0];
    assert_eq!(run.inputs, ["wheel[1].speed_command", "wheel[2].speed_command"]);
    assert_eq!(run.measured, ["wheel[1+2].current", "pitch"]);
    close(run.data.value("wheel[1+2].current", 3), 1.5005);
    close(run.data.value("wheel[2].speed_command", 3), std::f64::consts::PI / 5.0);
    close(run.data.value("pitch", 0), -3.0_f64.to_radians());
    assert_eq!(run.data.value("time", 0), Some(0.0));
    assert_eq!(run.data.value("time", 11), Some(660.0));
    // A sum has its own name in files too.
    let csv = log("time,wheel[1].speed_command,wheel[2].speed_command,wheel[1+2].current", |k| format!("{k},1,1,2"));
    assert_eq!(rover("", &csv).unwrap().signals(), ["wheel[1+2].current"]);
    for (bad, words) in [
        (
            "signal = \"speed\", wheels = [1, 2]",
            "one measured speed for several wheels drives them where there is no command",
        ),
        ("signal = \"slip\", wheels = [1, 2]", "no meaning is known for the sum of `slip`"),
        ("signal = \"current\", wheels = [1, 1]", "expected different numbers"),
        ("signal = \"current\"", "belongs to a wheel"),
        ("signal = \"current\", wheels = [1, 3]", "unknown column"),
    ] {
        let csv = log("time,wheel[1].speed_command,wheel[2].speed_command,I", |k| format!("{k},1,1,2"));
        let message = rover(&format!("[columns]\nI = {{ {bad} }}"), &csv).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
    let late = log("stamp,wheel[1].speed_command,x", |k| {
        format!("{},1,0", if k == 4 { "soon".to_owned() } else { format!("10:00:{k:02}") })
    });
    let error = rover("[columns]\nstamp = { time_stamp = true }", &late).unwrap_err();
    assert_eq!((error.line, error.column.as_deref()), (Some(6), Some("stamp")), "{error}");
}

#[test]
fn property_labels_part_a_log_into_runs() {
    let csv = log("run,time,rim_left,x", |k| format!("{:02},{},0.1,0.5", k / 10, k % 10))
        + &(2..10).map(|k| format!("01,{k},0.1,0.5\n")).collect::<String>();
    let columns = "[columns]\nrun = { run = true }\nrim_left = { signal = \"rim_speed_command\", wheels = [1, 2] }";
    let experiment = rover(columns, &csv).unwrap();
    let names: Vec<&str> = experiment.runs.iter().map(|run| run.name.as_str()).collect();
    assert_eq!(names, ["a#00", "a#01"]);
    close(experiment.runs[1].data.value("wheel[1].speed_command", 0), 1.0);
}

#[test]
fn regress_a_label_that_looks_like_a_comment_survives_writing() {
    let csv = "load,slip,wheel_speed,sinkage,condition\n30,0.1,0.2,0.01,#1\n30,0.2,0.2,0.02,// 2\n";
    let experiment = wheel("", csv).unwrap();
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("experiment_columns_labels");
    let _ = std::fs::remove_dir_all(&folder);
    experiment.write(&folder).unwrap();
    let read = Experiment::read(&folder).unwrap();
    assert_eq!(read.runs[0].conditions, experiment.runs[0].conditions);
    assert_eq!(read.runs[0].data, experiment.runs[0].data);
}
