//! The core's own diagnosis, for `test_diagnosis.py`: `core_diagnosis EXPERIMENT DRAWS CANDIDATE ...` prints the JSON.

use bekker::diagnosis::{Control, DiagnoseOptions, diagnose};
use bekker::measurement::Experiment;
use bekker::model::Model;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [experiment, draws, candidates @ ..] = arguments.as_slice() else {
        return Err("expected EXPERIMENT DRAWS CANDIDATE ...".into());
    };
    let options =
        DiagnoseOptions { candidates: Some(candidates.to_vec()), draws: draws.parse()?, ..DiagnoseOptions::default() };
    let model = Model::preset("two_wheeled")?;
    let diagnosis = diagnose(&model, &Experiment::read(experiment)?, &options, &Control::default())?;
    println!("{}", diagnosis.to_json());
    Ok(())
}
