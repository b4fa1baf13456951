//! Diagnoses of real measurements: the smooth wheel of the robomechanics data (Pavlov and Johnson), and the rows of Ding et
//! al. 2011. The files are not part of the project; without them the tests say so and pass.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::diagnosis::{Control, DiagnoseOptions, Diagnosis, FloorSource, Verdict, diagnose};
use bekker::measurement::Experiment;
use bekker::model::Model;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Share of the left-out error that a named effect has to take away, frozen in `tests/real_data/answers.toml`.
const CUT: f64 = 0.3;

fn data(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: no {name}");
    None
}

fn diagnosed(experiment: &Experiment) -> Diagnosis {
    let model = Model::preset("two_wheeled").unwrap();
    let diagnosis = diagnose(&model, experiment, &DiagnoseOptions::default(), &Control::default()).unwrap();
    println!("{}: {:?} {:?}", experiment.name, diagnosis.verdict, diagnosis.effects);
    for step in &diagnosis.steps {
        println!("  {:?}: {:?}, left out {:?}", step.added, step.rmse, step.heldout_rmse);
    }
    println!("  {:?}", diagnosis.cautions);
    diagnosis
}

#[test]
fn published_slip_sinkage_is_what_the_smooth_wheel_lacks() {
    let Some(folder) = data("cmu_smooth") else { return };
    let diagnosis = diagnosed(&Experiment::read(folder).unwrap());
    assert_eq!(diagnosis.noise_floor_source, FloorSource::Replicates);
    assert_eq!(diagnosis.involved(), ["slip_sinkage"]);
    let (before, after) = (diagnosis.baseline(), diagnosis.last());
    for signal in ["drawbar_pull", "sinkage"] {
        let (before, after) = (before.heldout_rmse[signal], after.heldout_rmse[signal]);
        assert!(after < (1.0 - CUT) * before, "{signal}: {before} -> {after}");
    }
    // The baseline hides its error in absurd parameters, and the first reader of the report is told so.
    let bound = |step: &bekker::diagnosis::Step| step.parameters.iter().any(|parameter| parameter.fitted.at_bound);
    assert!(bound(before));
    assert_eq!(bound(after), diagnosis.cautions.iter().any(|caution| caution.contains("on its bound")));
}

/// The rows of Ding's smooth or lugged wheel as an experiment: digitised, without repeats.
fn ding(lugs: &str) -> Option<Experiment> {
    let csv = data("ding2011_single_wheel.csv")?;
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("published_wheel_diagnosis").join(lugs);
    std::fs::create_dir_all(&folder).unwrap();
    let mut out = "load,slip,wheel_speed,drawbar_pull,torque,sinkage\n".to_owned();
    for line in std::fs::read_to_string(csv).unwrap().lines().filter(|line| line.contains(lugs)) {
        let cells: Vec<&str> = line.split(',').collect();
        // Load, slip; drawbar pull, sinkage, torque stand in columns 9 to 13. The speed of the rim is not given; the
        // baseline does not depend on it.
        writeln!(out, "{},{},0.1,{},{},{}", cells[8], cells[9], cells[10], cells[12], cells[11]).unwrap();
    }
    std::fs::write(folder.join("rows.csv"), out).unwrap();
    let toml = format!(
        "name = \"Ding 2011, {lugs}\"\nkind = \"single_wheel\"\n[parameters]\n\"wheel.radius\" = 0.15735\n\"wheel.width\" = 0.165\n[[run]]\nfile = \"rows.csv\"\n"
    );
    std::fs::write(folder.join("experiment.toml"), toml).unwrap();
    Some(Experiment::read(&folder).unwrap())
}

#[test]
fn published_rows_of_ding_have_no_floor_and_no_confident_name() {
    for lugs in ["ding2011_smooth", "ding2011_lug10"] {
        let Some(experiment) = ding(lugs) else { return };
        assert_eq!(experiment.runs[0].data.rows(), 6);
        let diagnosis = diagnosed(&experiment);
        assert_eq!(diagnosis.noise_floor_source, FloorSource::Unknown);
        assert!(diagnosis.cautions.iter().any(|caution| caution.contains("noise floor unknown")));
        // Six digitised points a signal and seven soil parameters: nothing can be told from them.
        assert_ne!(diagnosis.verdict, Verdict::EffectMissing, "{lugs}: {:?}", diagnosis.effects);
    }
}
