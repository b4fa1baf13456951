//! Table 3.1 again: `cargo run --release -p bekker-planning --example table_3_1 -- TRIALS [drive]`, as JSON lines, a
//! trial each; with `drive` the core's planar rover drives every path, which takes longer than planning it.

use bekker_planning::map::Difficulty;
use bekker_planning::trial::trial;

/// Coefficient of friction of the ground, which the thesis does not give.
const FRICTION: f64 = 0.6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let trials: u64 = std::env::args().nth(1).map_or(Ok(30), |text| text.parse())?;
    let drive = std::env::args().nth(2).is_some_and(|word| word == "drive");
    for seed in 0..trials {
        for difficulty in Difficulty::ALL {
            let done = trial(difficulty, seed, FRICTION, drive)?;
            println!("{}", serde_json::json!({ "ground": difficulty, "trial": done }));
        }
    }
    Ok(())
}
