//! Diagnoses of real measurements: the smooth wheel of the robomechanics data (Pavlov and Johnson), and the rows of Ding et
//! al. 2011.

use bekker::diagnosis::{Control, DiagnoseOptions, Diagnosis, FloorSource, Verdict, diagnose};
use bekker::measurement::Experiment;
use bekker::model::Model;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Share of the left-out error that a named effect has to take away, frozen in `tests/real_data/answers.toml`.
const CUT: f64 = 0.3;

fn diagnosed(experiment: &Experiment) -> Diagnosis {
    let model = Model::preset("two_wheeled").unwrap();
    diagnose(&model, experiment, &DiagnoseOptions::default(), &Control::default()).unwrap()
}

pub fn agreement_the_smooth_wheel_lacks_slip_sinkage_as_an_expert_says([folder]: [PathBuf; 1]) {
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
fn ding(csv: &Path, lugs: &str) -> Experiment {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("real_data").join(lugs);
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
    Experiment::read(&folder).unwrap()
}

pub fn agreement_rows_of_ding_have_no_floor_and_no_confident_name([csv]: [PathBuf; 1]) {
    for lugs in ["ding2011_smooth", "ding2011_lug10"] {
        let experiment = ding(&csv, lugs);
        assert_eq!(experiment.runs[0].data.rows(), 6);
        let diagnosis = diagnosed(&experiment);
        assert_eq!(diagnosis.noise_floor_source, FloorSource::Unknown);
        assert!(diagnosis.cautions.iter().any(|caution| caution.contains("noise floor unknown")));
        // Six digitised points a signal and seven soil parameters: nothing can be told from them.
        assert_ne!(diagnosis.verdict, Verdict::EffectMissing, "{lugs}: {:?}", diagnosis.effects);
    }
}
