//! Reading experiment folders: what is right is read to the digit, what is wrong is refused with its place.

use bekker::measurement::{Experiment, Kind, Prior, Problem};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const TOML: &str =
    "name = \"t\"\nkind = \"single_wheel\"\n[parameters]\n\"wheel.radius\" = 0.1\n[[run]]\nfile = \"a.csv\"\n";
const CSV: &str = "load,slip,wheel_speed,drawbar_pull,sinkage\n30,0.1,0.2,-1.5,0.012\n30,0.2,0.2,,0.014\n";
const TRAVERSE: &str = "name = \"t\"\nkind = \"traverse\"\n[[run]]\nfile = \"a.csv\"\n";

/// A folder of its own for each test, with the given files.
fn folder(name: &str, files: &[(&str, &str)]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("experiment_format").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    for (file, text) in files {
        std::fs::write(folder.join(file), text).unwrap();
    }
    folder
}

fn traverse_rows(edit: impl Fn(usize, &mut Vec<String>)) -> String {
    let mut text = "time,wheel[1].speed_command,wheel[2].speed_command,pitch,x\n".to_owned();
    for k in 0..12 {
        let mut row: Vec<String> = ["0.5", "0.5", "0.01", "0.2"].map(str::to_owned).to_vec();
        row.insert(0, format!("{}", k as f64 * 0.1));
        edit(k, &mut row);
        text += &(row.join(",") + "\n");
    }
    text
}

#[test]
fn property_single_wheel_is_read_to_the_digit() {
    let experiment = Experiment::read(folder("good", &[("experiment.toml", TOML), ("a.csv", CSV)])).unwrap();
    assert_eq!(experiment.kind, Kind::SingleWheel);
    assert_eq!(experiment.parameters["wheel.radius"], 0.1);
    assert_eq!(experiment.signals(), ["drawbar_pull", "sinkage"]);
    let data = &experiment.runs[0].data;
    assert_eq!(data.value("drawbar_pull", 0), Some(-1.5));
    assert_eq!(data.value("drawbar_pull", 1), None, "an empty cell is a missing value");
    assert_eq!(data.value("sinkage", 1), Some(0.014));
    assert_eq!(experiment.runs[0].inputs, ["load", "slip", "wheel_speed"]);
}

#[test]
fn property_traverse_with_everything() {
    let toml = "name = \"t\"\nkind = \"traverse\"\nignore = [\"note\"]\n[parameters]\n\"soil.cohesion\" = 1000\n[priors]\n\"soil.exponent\" = { mean = 1.31, sd = 0.09 }\n\"soil.cohesion\" = 200\n[noise]\npitch = 0.01\n\
                [[run]]\nfile = \"a.csv\"\nterrain = \"hill.csv\"\nx0 = 0.6\nparameters = { \"rover.mass\" = 12 }\n";
    let csv = "\u{feff}time, wheel[1].torque_command ,pitch,note,wheel[1].slip\n".to_owned()
        + &(0..10).map(|k| format!("{k},1.0,0.1,hello,0.2\n")).collect::<String>();
    let hill = "x,z\n0,0\n1,0.1\n";
    let experiment =
        Experiment::read(folder("traverse", &[("experiment.toml", toml), ("a.csv", &csv), ("hill.csv", hill)]))
            .unwrap();
    let run = &experiment.runs[0];
    assert_eq!((run.x0, run.parameters["rover.mass"]), (Some(0.6), 12.0));
    assert_eq!(run.terrain.as_ref().unwrap().column("z").unwrap(), [0.0, 0.1]);
    assert_eq!(run.measured, ["pitch", "wheel[1].slip"]);
    assert_eq!(experiment.noise["pitch"], 0.01);
    assert_eq!(experiment.priors["soil.cohesion"], Prior { mean: 1000.0, deviation: 200.0 });
    assert_eq!(experiment.priors["soil.exponent"], Prior { mean: 1.31, deviation: 0.09 });
}

/// Reads a folder that must be refused; returns file name, line, column and the message.
fn refused(name: &str, files: &[(&str, &str)]) -> (String, Option<u64>, Option<String>, String) {
    let error = Experiment::read(folder(name, files)).expect_err(name);
    let file = error.file.file_name().unwrap().to_str().unwrap().to_owned();
    let message = error.to_string();
    assert!(message.contains(&file), "{message}");
    error.line.iter().for_each(|line| assert!(message.contains(&format!("line {line}")), "{message}"));
    error.column.iter().for_each(|column| assert!(message.contains(&format!("`{column}`")), "{message}"));
    (file, error.line, error.column, message)
}

#[test]
fn property_a_bad_cell_is_named_by_file_line_and_column() {
    // What replaces the third line, the column at fault, and words that the message must have.
    let cases = [
        ("text", "30,0.2,0.2,abc,0.014", "drawbar_pull", "`abc` is not a finite number"),
        ("nan", "30,0.2,0.2,NaN,0.014", "drawbar_pull", "not a finite number"),
        ("infinite", "30,0.2,0.2,1,inf", "sinkage", "not a finite number"),
        ("no_input", "30,,0.2,1,0.014", "slip", "may not be missing"),
        ("per_cent", "30,20,0.2,1,0.014", "slip", "per cent"),
        ("millimetres", "30,0.2,0.2,1,14", "sinkage", "millimetres"),
        ("rpm", "30,0.2,900,1,0.014", "wheel_speed", "rpm"),
        ("no_load", "0,0.2,0.2,1,0.014", "load", "positive load in N"),
        ("milli_newton", "30,0.2,0.2,-4500,0.014", "drawbar_pull", "expected a force in N"),
    ];
    for (name, row, column, words) in cases {
        let csv = format!("load,slip,wheel_speed,drawbar_pull,sinkage\n30,0.1,0.2,-1.5,0.012\n{row}\n");
        let (file, line, at, message) = refused(name, &[("experiment.toml", TOML), ("a.csv", &csv)]);
        assert_eq!((file.as_str(), line, at.as_deref()), ("a.csv", Some(3), Some(column)), "{message}");
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn property_a_bad_table_is_named() {
    let cases = [
        ("unknown", "load,slip,wheel_speed,drawbar_pull,depth\n30,0.1,0.2,1,2\n", Some(1), Some("depth"), "ignore"),
        ("missing", "load,slip,drawbar_pull\n30,0.1,1\n", Some(1), Some("wheel_speed"), "needs this column"),
        ("twice", "load,slip,slip,wheel_speed,sinkage\n30,0,0,1,0.01\n", Some(1), Some("slip"), "twice"),
        ("ragged", "load,slip,wheel_speed,sinkage\n30,0.1,0.2,0.01\n30,0.1,0.2\n", Some(3), None, "3 cells"),
        ("few", "load,slip,wheel_speed,sinkage\n", None, None, "0 rows; at least 1"),
        ("nothing", "load,slip,wheel_speed,sinkage\n30,0.1,0.2,\n", None, None, "nothing is measured"),
        ("blank", "", None, None, "the file is empty"),
    ];
    for (name, csv, line, column, words) in cases {
        let (file, at_line, at, message) = refused(name, &[("experiment.toml", TOML), ("a.csv", csv)]);
        assert_eq!((file.as_str(), at_line, at.as_deref()), ("a.csv", line, column), "{message}");
        assert!(message.contains(words), "{message}");
    }
    let (file, .., message) = refused("absent", &[("experiment.toml", TOML)]);
    assert!(file == "a.csv" && message.contains("cannot be read"), "{message}");
}

#[test]
fn property_a_bad_traverse_is_named() {
    let backwards = traverse_rows(|k, row| {
        if k == 5 {
            row[0] = "0.1".to_owned()
        }
    });
    let degrees = traverse_rows(|k, row| {
        if k == 3 {
            row[3] = "12".to_owned()
        }
    });
    let gap = traverse_rows(|k, row| {
        if k == 7 {
            row[2].clear()
        }
    });
    let short = "time,wheel[1].speed_command,x\n0,1,0\n1,1,0\n".to_owned();
    let mixed = "time,wheel[1].speed_command,wheel[2].torque_command,x\n".to_owned()
        + &(0..10).map(|k| format!("{k},1,1,0\n")).collect::<String>();
    let bare = "time,x\n".to_owned() + &(0..10).map(|k| format!("{k},0\n")).collect::<String>();
    let cases = [
        ("backwards", &backwards, Some(7), Some("time"), "does not come after"),
        ("degrees", &degrees, Some(5), Some("pitch"), "degrees"),
        ("gap", &gap, Some(9), Some("wheel[2].speed_command"), "may not be missing"),
        ("short", &short, None, None, "2 rows; at least 10"),
        ("mixed", &mixed, Some(1), None, "speed and torque commands"),
        ("bare", &bare, Some(1), Some("wheel[1].speed_command"), "needs this column"),
    ];
    for (name, csv, line, column, words) in cases {
        let (_, at_line, at, message) = refused(name, &[("experiment.toml", TRAVERSE), ("a.csv", csv)]);
        assert_eq!((at_line, at.as_deref()), (line, column), "{message}");
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn property_bad_settings_are_named_by_line() {
    let with = |lines: &str| format!("name = \"t\"\nkind = \"single_wheel\"\n{lines}\n[[run]]\nfile = \"a.csv\"\n");
    let cases = [
        ("key", with("colour = 1"), Some(3), "unknown field `colour`"),
        ("kind", TOML.replace("single_wheel", "boat"), Some(2), "unknown variant `boat`"),
        ("quotes", with("[parameters]\nwheel.radius = 0.1"), Some(4), "quoted"),
        ("type", with("[parameters]\n\"wheel.radius\" = \"big\""), Some(4), "expected f64"),
        ("nan", with("[parameters]\n\"wheel.radius\" = nan"), Some(4), "not a finite number"),
        ("prior", with("[priors]\n\"soil.cohesion\" = 0.0"), Some(4), "positive"),
        ("noise", with("[noise]\ntorque = 0.1"), Some(4), "no run measures this signal"),
        ("runs", "name = \"t\"\nkind = \"single_wheel\"\nrun = []\n".to_owned(), None, "at least one"),
        ("terrain", TOML.to_owned() + "terrain = \"h.csv\"\n", Some(7), "only a `traverse`"),
        ("syntax", TOML.replace("name = ", "name "), Some(1), ""),
    ];
    for (name, toml, line, words) in cases {
        let (file, at_line, _, message) =
            refused(&format!("toml_{name}"), &[("experiment.toml", &toml), ("a.csv", CSV)]);
        assert_eq!((file.as_str(), at_line), ("experiment.toml", line), "{message}");
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn property_runs_of_a_group_must_repeat_each_other() {
    let toml = format!("{TOML}group = \"g\"\n[[run]]\nfile = \"b.csv\"\ngroup = \"g\"\n");
    let header = "load,slip,wheel_speed,sinkage\n";
    let a = format!("{header}30,0.1,0.2,0.01\n30,0.5,0.2,0.01\n");
    let fewer = format!("{header}30,0.1,0.2,0.01\n");
    let other = format!("{header}30,0.1,0.2,0.01\n30,0.3,0.2,0.01\n");
    for (name, b, words) in [("fewer", &fewer, "1 rows, where a"), ("other", &other, "row 2 has slip 0.3")] {
        let (file, .., message) = refused(name, &[("experiment.toml", &toml), ("a.csv", &a), ("b.csv", b)]);
        assert!(file == "b.csv" && message.contains(words), "{message}");
    }
    let close = format!("{header}30,0.11,0.2,0.01\n30,0.49,0.2,0.01\n");
    let experiment =
        Experiment::read(folder("close", &[("experiment.toml", &toml), ("a.csv", &a), ("b.csv", &close)])).unwrap();
    assert_eq!(experiment.replicates().len(), 2);
}

#[test]
fn property_conditions_pair_uneven_repeats() {
    let csv = "condition,load,slip,wheel_speed,sinkage\np,30,0.1,0.2,0.01\nq,30,0.5,0.2,0.02\np,31,0.1,0.2,0.011\n,30,0.5,0.2,0.02\n";
    let experiment = Experiment::read(folder("labels", &[("experiment.toml", TOML), ("a.csv", csv)])).unwrap();
    let sets = experiment.replicates();
    assert_eq!(sets.len(), 1);
    assert_eq!(sets[0].iter().map(|s| s.row).collect::<Vec<_>>(), [0, 2]);
    let toml = format!("{TOML}group = \"g\"\n");
    let error = Experiment::read(folder("both", &[("experiment.toml", &toml), ("a.csv", csv)])).unwrap_err();
    assert!(matches!(*error.problem, Problem::NotARepeat(_)), "{error}");
}

#[test]
fn property_texts_give_what_the_folder_gives() {
    let toml = "name = \"t\"\nkind = \"traverse\"\n[[run]]\nfile = \"a.csv\"\nterrain = \"hill.csv\"\n\
                [[run]]\nfile = \"b.csv\"\nterrain = \"hill.csv\"\n";
    let (rows, hill) = (traverse_rows(|_, _| ()), "x,z\n0,0\n1,0.1\n");
    let files = [("experiment.toml", toml), ("a.csv", &rows), ("b.csv", &rows), ("hill.csv", hill)];
    let folder = folder("texts", &files);
    let texts = Experiment::texts(&folder).unwrap();
    assert_eq!(texts.len(), files.len());
    let (read, made) = (Experiment::read(&folder).unwrap(), Experiment::from_texts(&texts).unwrap());
    let runs = read.runs.iter().zip(&made.runs);
    assert!(runs.clone().all(|(a, b)| (&a.name, &a.data, &a.terrain) == (&b.name, &b.data, &b.terrain)));
    assert_eq!((read.signals(), runs.len()), (made.signals(), 2));
}

#[test]
fn property_texts_are_checked_like_files() {
    let texts =
        |csv: &str| [("experiment.toml", TOML), ("a.csv", csv)].map(|(n, t)| (n.to_owned(), t.to_owned())).into();
    let refused = Experiment::from_texts(&texts("load,slip,wheel_speed,sinkage\n30,0.1,0.2,inf\n")).unwrap_err();
    assert_eq!((refused.line, refused.column.as_deref()), (Some(2), Some("sinkage")));
    assert_eq!(refused.file, Path::new("a.csv"));
    let mut texts: BTreeMap<_, _> = texts(CSV);
    texts.remove("a.csv");
    let refused = Experiment::from_texts(&texts).unwrap_err();
    assert!(matches!(*refused.problem, Problem::Unreadable(_)), "{refused}");
}

/// The blocks of TOML of the page that are whole settings.
fn examples() -> Vec<String> {
    let page = include_str!("../../examples/experiments.md");
    page.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap().to_owned()).collect()
}

fn texts<const N: usize>(toml: &str, files: [(&str, String); N]) -> BTreeMap<String, String> {
    let files = files.into_iter().chain([("experiment.toml", toml.to_owned())]);
    files.map(|(name, text)| (name.to_owned(), text)).collect()
}

#[test]
fn regress_examples_of_the_page_can_be_read() {
    let [wheel, rover, route, sensors] = examples().try_into().unwrap();
    let trials = "beta,DP,W [kg],z,Vx,Vr,h,Fs,sDP\n0,2,2.5,-12,10,20,0,0,1\n0,2.1,2.5,-13,10,20,5,0,1\n15,2,2.5,-12,10,20,0,0,1\n";
    let experiment = Experiment::from_texts(&texts(&wheel, [("trials.csv", trials.to_owned())])).unwrap();
    assert_eq!((experiment.runs.len(), experiment.doubts.len()), (2, 0), "{:?}", experiment.doubts);
    assert_eq!(experiment.runs[1].parameters["grousers.height"], 0.005);
    let rows = (0..10).map(|k| format!("2019-01-29T10:53:0{k},120;a;2,5;800;-1,5;0;0;790\n"));
    let log = "stamp;drive;command;I_left;imu_pitch;imu_roll;imu_yaw;I_right\n".to_owned() + &rows.collect::<String>();
    let hill = "x,z\n0,0\n2,0.1\n".to_owned();
    let experiment = Experiment::from_texts(&texts(&rover, [("2019_01_29.csv", log), ("hill.csv", hill)])).unwrap();
    assert_eq!(experiment.signals(), ["wheel[1+2].current", "pitch"]);
    assert_eq!((experiment.runs[0].name.as_str(), experiment.doubts.len()), ("2019_01_29#a", 0));
    let row = |k: usize| format!("{},170,{},-10,0.5,23,23,2,3\n", 0.1 * k as f64, 0.05 * k as f64);
    let log = "time,imu_yaw_deg,utm_e,utm_n,dem_z,rpm_left,rpm_right,amps_left,amps_right\n".to_owned();
    let log = log + &(0..100).map(row).collect::<String>();
    let experiment = Experiment::from_texts(&texts(&route, [("drive.csv", log)])).unwrap();
    assert_eq!(
        (experiment.signals(), experiment.doubts),
        (vec!["wheel[1+2].current".to_owned(), "x".to_owned()], vec![])
    );
    assert!(experiment.runs[0].terrain.is_some());
    let drive = "name = \"log\"\nkind = \"traverse\"\n[[run]]\nfile = \"log.csv\"\n";
    let rows = (0..10).map(|k| format!("{k},1,1,0.1,2\n"));
    let log = "time,wheel[1].speed,wheel[2].speed,velocity,wheel[1+2].current\n".to_owned() + &rows.collect::<String>();
    let experiment = Experiment::from_texts(&texts(&format!("{drive}{sensors}"), [("log.csv", log)])).unwrap();
    assert_eq!(experiment.sensors["velocity"].delay, Some(Prior { mean: 0.0, deviation: 0.05 }));
    assert_eq!(experiment.sensors["wheel[1+2].current"].bias, Some(Prior { mean: 0.1, deviation: 0.05 }));
}
