//! The 18 plate tests of the CMU sand (Pavlov and Johnson), read whole, and what they say of the wheel trials in the same sand.

use bekker::diagnosis::{CompareOptions, Comparison, Control, DiagnoseOptions, Given, compare, diagnose};
use bekker::measurement::Experiment;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The notes beside the data: n = 1.31 +- 0.09 by a power law for each test.
const N: (f64, f64) = (1.31, 0.09);

/// All plate tests: three plates in two boxes of unknown size, three times each.
fn plates(csv: &Path) -> Experiment {
    let mut toml = "name = \"CMU sand\"\nkind = \"plate_sinkage\"\nignore = [\"test\", \"tool\", \"box\"]\n\
                    columns.diameter = { parameter = \"plate.diameter\" }\n"
        .to_owned();
    for (k, diameter) in [0.06, 0.1, 0.08].into_iter().enumerate() {
        for soil_box in ["large", "small"] {
            for test in 1..=3 {
                let number = 3 * k + test;
                write!(toml, "[[run]]\nfile = \"indentation.csv\"\nname = \"{soil_box}_{number}\"\ngroup = \"{soil_box} {diameter}\"\nwhere = {{ test = \"{soil_box}_{number}\" }}\n").unwrap();
            }
        }
    }
    let text = std::fs::read_to_string(csv).unwrap();
    Experiment::from_texts(&[("experiment.toml".to_owned(), toml), ("indentation.csv".to_owned(), text)].into())
        .unwrap()
}

fn calibrated(given: Given, experiment: &Experiment) -> Comparison {
    compare(given, experiment, &CompareOptions { calibrate: true, ..CompareOptions::default() }).unwrap()
}

pub fn agreement_the_cmu_plates_hardly_tell_k_c_from_k_phi_as_their_notes_say([csv]: [PathBuf; 1]) {
    let experiment = plates(&csv);
    assert_eq!(experiment.runs.len(), 18);
    let comparison = calibrated(Given::default(), &experiment);
    let (calibration, _) = comparison.calibrated.as_ref().unwrap();
    let parameter = |name: &str| calibration.parameters.iter().find(|p| p.variable.name == name).unwrap();
    let n = parameter("soil.exponent").value;
    assert!((n - N.0).abs() < 2.0 * N.1, "n = {n}");
    assert!(parameter("soil.k_c").at_bound, "a pair that follows k would need a negative k_c");
    let hardly = "k_c and k_phi cannot be told apart by contact widths of 30 mm to 50 mm: k_c = -";
    assert!(comparison.cautions.iter().any(|caution| caution.starts_with(hardly)), "{:?}", comparison.cautions);
}

pub fn agreement_with_the_plates_as_a_prior_the_smooth_wheel_lacks_slip_sinkage_on_their_soil(
    [csv, folder]: [PathBuf; 2],
) {
    let soil = calibrated(Given::default(), &plates(&csv)).soil.unwrap();
    let experiment = Experiment::read(folder).unwrap();
    let given = Given::default().with_soil(soil, "cmu_plates");
    let diagnosis = diagnose(given, &experiment, &DiagnoseOptions::default(), &Control::default()).unwrap();
    assert_eq!(diagnosis.involved(), ["slip_sinkage"]);
    // Alone the wheel wants an exponent on its bound; held to what the plates found it explains as much.
    let exponent = diagnosis.last().parameters.iter().find(|p| p.fitted.variable.name == "soil.exponent").unwrap();
    let shift = exponent.fitted.prior_shift().unwrap();
    assert!(!exponent.fitted.at_bound && shift.abs() < 2.0, "{} ({shift} standard deviations)", exponent.fitted.value);
}
