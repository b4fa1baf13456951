//! Tests on public measurements, which are not part of the project. Where a file is missing its tests are ignored, and their
//! status says what they need; `tests/run.sh` counts and names them at its end.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod diagnosis;
mod import;
mod plates;
mod smooth_wheel;

use libtest_mimic::{Arguments, Completion, Trial};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Files of the folder of measurements.
const CMU: &str = "cmu_smooth_189trials.csv";
const CMU_FOLDER: &str = "cmu_smooth";
const PLATES: &str = "cmu_plates/indentation.csv";
const DING: &str = "ding2011_single_wheel.csv";
const CUADRIGA: &str = "cuadriga_2019/2019_01_29_10_53_36.csv";
const ASPHALT: &str = "husky/borealtc_asphalt.csv";
const LOAM: &str = "husky/borealtc_sandy_loam.csv";

fn main() -> ExitCode {
    /// A trial of the name of its function.
    macro_rules! trial {
        ($module:ident::$name:ident, $files:expr) => {
            trial(stringify!($name), $files, $module::$name)
        };
    }
    let trials = vec![
        trial!(import::agreement_cmu_speeds_give_the_recorded_slip, [CMU]),
        trial!(import::property_dings_columns_give_parameters, [DING]),
        trial!(import::property_public_files_are_imported, [CMU, DING, CUADRIGA, ASPHALT, LOAM]),
        trial!(smooth_wheel::regress_baseline_error_and_bounds_of_the_smooth_wheel, [CMU]),
        trial!(smooth_wheel::agreement_experiment_folder_gives_the_same_as_the_trials, [CMU, CMU_FOLDER]),
        trial!(diagnosis::agreement_the_smooth_wheel_lacks_slip_sinkage_as_an_expert_says, [CMU_FOLDER]),
        trial!(diagnosis::agreement_rows_of_ding_have_no_floor_and_no_confident_name, [DING]),
        trial!(plates::agreement_the_cmu_plates_hardly_tell_k_c_from_k_phi_as_their_notes_say, [PLATES]),
        trial!(
            plates::agreement_with_the_plates_as_a_prior_the_smooth_wheel_lacks_slip_sinkage_on_their_soil,
            [PLATES, CMU_FOLDER]
        ),
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

/// A test that gets the paths of the files that it needs, and is ignored where one of them is missing.
fn trial<const N: usize>(name: &str, files: [&'static str; N], test: fn([PathBuf; N])) -> Trial {
    Trial::ignorable_test(name, move || {
        let folder = folder();
        if let Some(missing) = files.iter().find(|file| !folder.join(file).exists()) {
            return Ok(Completion::ignored_with(format!("needs the measurements {missing}")));
        }
        test(files.map(|file| folder.join(file)));
        Ok(Completion::Completed)
    })
}

/// The folder of measurements: what the variable `BEKKER_DATA` says, otherwise `shared/data` beside the repository.
fn folder() -> PathBuf {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    std::env::var_os("BEKKER_DATA").map_or_else(beside, PathBuf::from)
}
