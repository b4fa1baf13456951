//! A drive that tests of traverses share; what it measured is no answer of the model.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use crate::measurement::{Experiment, Kind, Run, Table};
use std::collections::BTreeMap;

/// A drive of 20 s over waves of 3 cm, or of 25 cm where they are `steep`.
fn run(k: usize, drive: &str, steep: bool) -> Run {
    let commands = [1, 2].map(|wheel| format!("wheel[{wheel}].{drive}"));
    let measured = ["x", "velocity", "pitch", "wheel[1].torque", "wheel[2].sinkage"];
    let mut data = Table::new(["time", &commands[0], &commands[1]].into_iter().chain(measured)).unwrap();
    for row in 0..201 {
        let time = 0.1 * f64::from(row);
        let speed = 1.5 + 0.2 * k as f64 + 0.5 * (0.4 * time + k as f64).sin();
        let moved = 0.14 * time;
        data.push(&[time, speed, 0.9 * speed, moved, 0.14, 0.0, 0.5, 0.01]).unwrap();
    }
    let mut terrain = Table::new(["x", "z"]).unwrap();
    for i in -60..300 {
        let x = 0.05 * f64::from(i);
        terrain.push(&[x, if steep { 0.25 } else { 0.03 } * (1.5 * x).sin()]).unwrap();
    }
    Run {
        name: format!("run {k}"),
        file: format!("{k}.csv").into(),
        group: None,
        parameters: BTreeMap::new(),
        terrain: Some(terrain),
        x0: Some(0.0),
        data,
        conditions: Vec::new(),
        inputs: commands.to_vec(),
        measured: measured.map(str::to_owned).to_vec(),
    }
}

/// Three such drives, with commands of the signal `drive`.
pub(crate) fn experiment(drive: &str, steep: bool) -> Experiment {
    Experiment {
        effects: Vec::new(),
        name: "drives".to_owned(),
        kind: Kind::Traverse,
        folder: "drives".into(),
        parameters: BTreeMap::new(),
        priors: BTreeMap::new(),
        soil_class: None,
        shared: BTreeMap::new(),
        sensors: BTreeMap::new(),
        model: None,
        noise: BTreeMap::new(),
        runs: (0..3).map(|k| run(k, drive, steep)).collect(),
        doubts: Vec::new(),
        parts: Vec::new(),
    }
}
