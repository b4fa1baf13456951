//! Currents of a rover over real hills, predicted and measured: `BEKKER_DATA=FOLDER cargo run --release -p bekker-planning --example
//! cuadriga`, where the folder holds `uma_hills` and `cuadriga_2019` of the University of Malaga (MIT licence, not part of the project).

mod prediction;

use prediction::{Split, hills, judged, stretches};
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let data =
        PathBuf::from(std::env::var_os("BEKKER_DATA").ok_or("expected the folder of the measurements in BEKKER_DATA")?);
    let (surface, stretches) = (hills(&data)?, stretches(&data)?);
    println!(
        "{} straight stretches of 10 m; errors in % of the judged stretches' mean absolute current",
        stretches.len()
    );
    for split in Split::ALL {
        let (name, found) = (split.name(), judged(&surface, &stretches, split)?);
        let season = if split.crosses_seasons() { " (another season)" } else { "" };
        println!(
            "{name}{season}: calibrated on {}, judged on {}; mean error {:.1} (RMS {:.1}), best line in the slope {:.1} (RMS {:.1}), distance \
             alone {:.1}; {:.4} A/N, resistance beside the slope {:.0} N",
            found.calibrated,
            found.judged,
            found.model[0],
            found.model[1],
            found.line[0],
            found.line[1],
            found.distance[0],
            found.current_per_force,
            found.resistance
        );
    }
    Ok(())
}
