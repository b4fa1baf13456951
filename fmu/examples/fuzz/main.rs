//! Random calls on the C borders of both versions: right and wrong ones, in any order, with good and bad arguments.
//!
//! `cargo run -p bekker-fmu --example fuzz -- [CALLS] [SEED]`; `fmu/scripts/fuzz.sh` runs it under valgrind. It fails by
//! crashing, by a panic that the border reports, or by an instance that does not simulate as ever after a reset.
#![allow(clippy::unwrap_used, reason = "a test program may fail by panicking")]

mod fmi2;
mod fmi3;
mod importer;

use bekker::model::Model;
use bekker_fmu::fmi2::fmi2FreeInstance;
use bekker_fmu::fmi3::fmi3FreeInstance;
use importer::{Fuzz, REFUSALS};
use std::path::PathBuf;
use std::sync::atomic::Ordering;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let calls: u64 = arguments.next().map_or(20_000, |text| text.parse().unwrap());
    let seed: u64 = arguments.next().map_or(1, |text| text.parse().unwrap());
    let folder: PathBuf = std::env::temp_dir().join(format!("bekker-fuzz-{}", std::process::id()));
    let mut model = Model::preset("two_wheeled").unwrap();
    model.stepping.step_size = 0.001;
    let mut fuzz = Fuzz::new(&folder, &model, seed);
    let before = fuzz.drive();
    for call in 0..calls {
        // SAFETY: the calls' own arguments are in order; what is wrong is what the library promises to find out.
        unsafe { if call % 2 == 0 { fuzz.call2() } else { fuzz.call3() } }
        if call % 500 == 499 {
            fuzz.two.drain(2..).for_each(|c| fmi2FreeInstance(c));
            fuzz.three.drain(2..).for_each(|c| fmi3FreeInstance(c));
            fuzz.states.truncate(2);
        }
    }
    fuzz.two.drain(..).for_each(|c| fmi2FreeInstance(c));
    fuzz.three.drain(..).for_each(|c| fmi3FreeInstance(c));
    assert_eq!(before, fuzz.drive(), "a new instance simulates as before");
    std::fs::remove_dir_all(&folder).unwrap();
    println!("{calls} calls, {} messages, seed {seed}", REFUSALS.load(Ordering::Relaxed));
}
