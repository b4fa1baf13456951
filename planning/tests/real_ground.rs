//! Real hills, which are not part of the project. Where the file is missing its test is ignored, and its status says what it needs;
//! `tests/run.sh` counts and names it at its end.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker_planning::map::{CsvGrid, Doubt, ElevationMap};
use libtest_mimic::{Arguments, Completion, Trial};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Heights of the University of Malaga's rescue area on a grid of 1 m (MIT licence), rows from the south.
const HILLS: &str = "uma_hills/uma_rescue_area_1m_dem.csv";

fn main() -> ExitCode {
    let trials = vec![trial("property_the_hills_are_read_and_their_spikes_named", spikes)];
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

fn trial(name: &str, test: fn(&Path)) -> Trial {
    Trial::ignorable_test(name, move || {
        let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
        let file = std::env::var_os("BEKKER_DATA").map_or_else(beside, PathBuf::from).join(HILLS);
        if !file.exists() {
            return Ok(Completion::ignored_with(format!("needs the measurements {HILLS}")));
        }
        test(&file);
        Ok(Completion::Completed)
    })
}

fn spikes(file: &Path) {
    let map = ElevationMap::read(file, &CsvGrid::default()).unwrap();
    assert_eq!((map.columns(), map.rows()), (200, 200));
    let spiky = map.doubts().into_iter().any(|doubt| matches!(doubt, Doubt::Spikes { row, .. } if row < 20));
    assert!(spiky, "{:?}", map.doubts());
    let (smooth, count) = map.without_spikes(2.0).unwrap();
    assert!(count > 0 && !smooth.doubts().iter().any(|doubt| matches!(doubt, Doubt::Spikes { .. })));
}
