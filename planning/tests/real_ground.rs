//! Real hills, which are not part of the project. Where the file is missing its test is ignored, and its status says what it needs;
//! `tests/run.sh` counts and names it at its end.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "../examples/cuadriga/prediction.rs"]
mod prediction;

use bekker::soil::Soil;
use bekker::wheel::Wheel;
use bekker_planning::anisotropic::{Grid, GroundEnergy, SlopeEnergy, arrival, path_cost, path_from};
use bekker_planning::map::{CsvGrid, Doubt, ElevationMap, Interpolation, Surface};
use libtest_mimic::{Arguments, Completion, Trial};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Heights of the University of Malaga's rescue area on a grid of 1 m (MIT licence), rows from the south.
const HILLS: &str = "uma_hills/uma_rescue_area_1m_dem.csv";

/// Drives over them with the currents of the motors.
const DRIVES: &str = "cuadriga_2019";

fn main() -> ExitCode {
    let trials = vec![
        trial("property_the_hills_are_read_and_their_spikes_named", HILLS, |data| spikes(&data.join(HILLS))),
        trial("agreement_paths_over_the_hills_are_those_of_a_grid_twice_as_fine", HILLS, |data| {
            paths(&data.join(HILLS))
        }),
        trial("published_currents_of_drives_over_the_hills_are_predicted", DRIVES, currents),
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

fn trial(name: &str, needs: &'static str, test: fn(&Path)) -> Trial {
    Trial::ignorable_test(name, move || {
        let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
        let data = std::env::var_os("BEKKER_DATA").map_or_else(beside, PathBuf::from);
        if !data.join(needs).exists() {
            return Ok(Completion::ignored_with(format!("needs the measurements {needs}")));
        }
        test(&data);
        Ok(Completion::Completed)
    })
}

/// Mean error of predicted currents of drives of the same days, % of the mean absolute current: the bound of the issue of this work.
const CURRENT: f64 = 15.0;

/// Calibrated on every other drive and judged on those between them, both ways; from one season to the other the ground has changed, and
/// only distance alone is outdone.
fn currents(data: &Path) {
    let surface = prediction::hills(data).unwrap();
    let stretches = prediction::stretches(data).unwrap();
    for split in prediction::Split::ALL {
        let found = prediction::judged(&surface, &stretches, split).unwrap();
        let (name, [model, _]) = (split.name(), found.model);
        println!("{name}: {} stretches, {model:.1} %, {:.4} A/N", found.judged, found.current_per_force);
        assert!(found.judged >= 10 && found.calibrated >= 10 && found.resistance > 0.0, "{name}");
        assert!(model < 0.6 * found.distance[0], "{name}: {model} {:?}", found.distance);
        assert!(split.crosses_seasons() || model <= CURRENT.max(found.line[0]), "{name}: {model} {:?}", found.line);
    }
}

fn spikes(file: &Path) {
    let map = ElevationMap::read(file, &CsvGrid::default()).unwrap();
    assert_eq!((map.columns(), map.rows()), (200, 200));
    let spiky = map.doubts().into_iter().any(|doubt| matches!(doubt, Doubt::Spikes { row, .. } if row < 20));
    assert!(spiky, "{:?}", map.doubts());
    let (smooth, count) = map.without_spikes(2.0).unwrap();
    assert!(count > 0 && !smooth.doubts().iter().any(|doubt| matches!(doubt, Doubt::Spikes { .. })));
}

/// What the cost of a path may differ from that of a finer grid, which the issue of this work sets.
const PATH: f64 = 0.01;

/// A vehicle of 400 kg on dry loose ground.
fn paths(file: &Path) {
    let map = ElevationMap::read(file, &CsvGrid::default()).unwrap().without_spikes(2.0).unwrap().0;
    let surface = Surface::new(map, Interpolation::Smooth);
    let soil = Soil { cohesion: 0.0, friction_angle: 0.7, k_c: 0.0, k_phi: 2e7, exponent: 1.0, ..Soil::default() };
    let wheel = Wheel { radius: 0.2, width: 0.15, ..Wheel::default() };
    let energy = SlopeEnergy::new(&soil, &wheel, 400.0 * 9.81, 4, 0.6).unwrap();
    let cost = GroundEnergy::new(&surface, &energy, 200.0);
    // No straight way joins either pair: ground lies between that is steeper than the 12 degrees that it climbs there.
    for (start, goal) in [([58.0, 114.0], [100.0, 60.0]), ([30.0, 120.0], [90.0, 115.0])] {
        let solve = |fine: usize| {
            let nodes = 199 * fine + 1;
            let field =
                arrival(&cost, Grid { columns: nodes, rows: nodes, cell: 1.0 / fine as f64, origin: [0.0; 2] }, start)
                    .unwrap();
            path_from(&field, &cost, goal).unwrap()
        };
        let (coarse, fine) = (solve(1), solve(2));
        let ratio = coarse.cost / fine.cost;
        assert!((ratio - 1.0).abs() < PATH, "{start:?} to {goal:?}: {} {}", coarse.cost, fine.cost);
        assert!(path_cost(&cost, &[start, goal], 0.5).is_infinite());
    }
}
