//! Public measurements read as their authors wrote them.

use bekker::measurement::{Experiment, Kind, Proposal};
use std::path::{Path, PathBuf};

/// The file gives means over a trial, and the mean of a ratio is not the ratio of the means.
const OF_MEANS: f64 = 1e-3;

fn read(toml: &str, file: &Path) -> Experiment {
    let texts = [("experiment.toml", toml.to_owned()), ("a.csv", std::fs::read_to_string(file).unwrap())];
    Experiment::from_texts(&texts.map(|(name, text)| (name.to_owned(), text)).into()).unwrap()
}

const CMU: &str = r#"name = "smooth wheel"
kind = "single_wheel"
ignore = ["Vry", "trial", "Fs", "s*"]
file = { where = { beta = 0 } }
[columns]
DP = "drawbar_pull"
W = "load"
z = { signal = "sinkage", unit = "mm" }
Vx = { signal = "carriage_speed", unit = "mm/s" }
Vr = { signal = "rim_speed", unit = "mm/s" }
[parameters]
"wheel.radius" = { value = 58, unit = "mm" }
"wheel.width" = { value = 50, unit = "mm" }
[[run]]
file = "a.csv"
"#;

pub fn agreement_cmu_speeds_give_the_recorded_slip([file]: [PathBuf; 1]) {
    let recorded = read(CMU, &file);
    // The same with the file's own slip left out: it follows from the speeds.
    let computed = read(&CMU.replace("\"s*\"]", "\"s*\", \"slip\"]"), &file);
    let (a, b) = (&recorded.runs[0].data, &computed.runs[0].data);
    assert_eq!((a.rows(), recorded.signals()), (27, vec!["drawbar_pull".to_owned(), "sinkage".to_owned()]));
    for row in 0..a.rows() {
        let (recorded, computed) = (a.value("slip", row).unwrap(), b.value("slip", row).unwrap());
        assert!((recorded - computed).abs() < OF_MEANS, "row {row}: {recorded}, {computed}");
    }
    assert_eq!(recorded.doubts, [] as [String; 0]);
    // The first row with beta 0, in mm in the file.
    assert!((a.value("sinkage", 0).unwrap() - 0.024_770_011_901_855_47).abs() < f64::EPSILON);
}

pub fn property_dings_columns_give_parameters([file]: [PathBuf; 1]) {
    let toml = r#"name = "Ding"
kind = "single_wheel"
ignore = ["source", "case_id", "grouser_count", "soil_simulant", "status", "citation", "notes"]
inputs = { wheel_speed = 0.1 }
[columns]
wheel_radius_m = { parameter = "wheel.radius" }
wheel_width_m = { parameter = "wheel.width" }
grouser_height_m = { parameter = "grousers.height", unit = "m" }
soil_shear_modulus_k_m = { parameter = "soil.shear_modulus" }
vertical_load_n = "load"
meas_drawbar_pull_n = "drawbar_pull"
meas_sinkage_m = "sinkage"
meas_torque_nm = "torque"
[[run]]
file = "a.csv"
"#;
    let experiment = read(toml, &file);
    let runs: Vec<_> = experiment.runs.iter().map(|run| (run.name.as_str(), run.data.rows())).collect();
    assert_eq!(runs, [("a#1", 6), ("a#2", 6)]);
    assert_eq!(experiment.runs[1].parameters["grousers.height"], 0.01);
    assert_eq!(experiment.doubts, [] as [String; 0]);
}

fn import(name: &str, files: &[PathBuf]) -> (Proposal, Result<Experiment, String>) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("real_data").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    let proposal = Proposal::of(files, None).unwrap();
    let read = proposal.write(&folder).unwrap().read.map_err(|error| error.to_string());
    (proposal, read)
}

pub fn property_public_files_are_imported([cmu, ding, cuadriga, asphalt, loam]: [PathBuf; 5]) {
    let radius = |problem: Result<Experiment, String>| {
        let problem = problem.unwrap_err();
        assert!(problem.contains("needs \"wheel.radius\""), "{problem}");
    };
    let (proposal, read) = import("cmu", &[cmu]);
    assert_eq!(proposal.kind, Kind::SingleWheel);
    radius(read);
    let (proposal, read) = import("ding", &[ding]);
    assert_eq!(proposal.kind, Kind::SingleWheel);
    let problem = read.unwrap_err();
    assert!(
        problem.contains("`wheel_speed`") && proposal.missing.iter().any(|m| m.starts_with("wheel_speed")),
        "{problem}"
    );
    let (proposal, read) = import("cuadriga", &[cuadriga]);
    assert_eq!(proposal.kind, Kind::Traverse);
    assert!(read.unwrap().signals().contains(&"wheel[1+2].current".to_owned()));
    let (proposal, read) = import("husky", &[asphalt, loam]);
    assert_eq!(proposal.kind, Kind::Traverse);
    assert!(proposal.settings.contains("\"run\" = { run = true }"));
    radius(read);
}
