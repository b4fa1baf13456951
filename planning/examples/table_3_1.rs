//! Table 3.1 again: `cargo run --release -p bekker-planning --example table_3_1 -- FILE [TRIALS [FIRST]]` writes JSON lines, a trial each, every
//! path driven by the core's planar rover. What the file has already is not done again.

use bekker_planning::map::Difficulty;
use bekker_planning::trial::{FRICTION, trial};
use std::collections::HashSet;
use std::error::Error;
use std::fs::OpenOptions;
use std::io::Write;

/// Trials of each ground, three times the thesis's.
const TRIALS: u64 = 30;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().ok_or("expected the file to write to")?;
    let trials = arguments.next().map_or(Ok(TRIALS), |text| text.parse())?;
    let first = arguments.next().map_or(Ok(0), |text| text.parse())?;
    let done = done(&file)?;
    let mut out = OpenOptions::new().create(true).append(true).open(&file)?;
    for seed in first..first + trials {
        for ground in Difficulty::ALL {
            if done.contains(&(serde_json::to_string(&ground)?, seed)) {
                continue;
            }
            let trial = trial(ground, seed, FRICTION, true)?;
            writeln!(out, "{}", serde_json::json!({ "ground": ground, "trial": trial }))?;
        }
    }
    Ok(())
}

/// Ground and seed of the trials in a file; none where there is no file.
fn done(file: &str) -> Result<HashSet<(String, u64)>, Box<dyn Error>> {
    let text = match std::fs::read_to_string(file) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(HashSet::new()),
        text => text?,
    };
    let key = |line: &str| -> Result<(String, u64), Box<dyn Error>> {
        let row: serde_json::Value = serde_json::from_str(line)?;
        Ok((row["ground"].to_string(), row["trial"]["seed"].as_u64().ok_or("a trial without a seed")?))
    };
    text.lines().map(key).collect()
}
