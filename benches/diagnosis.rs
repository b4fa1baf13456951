//! The model on a whole experiment, with derivatives: `cargo bench --bench diagnosis`.
//!
//! 18 different runs of 25 s at 10 Hz, two wheels with commanded speeds on waves: what one evaluation of a fit costs.
//! `RAYON_NUM_THREADS=1` shows the cost on one core. And a diagnosis from beginning to end.

use bekker::diagnosis::{Control, DiagnoseOptions, diagnose, modelled, sensitivity};
use bekker::measurement::{Experiment, Kind, Run, Table};
use bekker::model::Model;
use divan::{Bencher, black_box};
use std::collections::BTreeMap;

/// Free parameters, the usual ones first.
const FREE: [&str; 12] = [
    "soil.cohesion",
    "soil.friction_angle",
    "soil.k_phi",
    "soil.exponent",
    "soil.shear_modulus",
    "soil.c1",
    "soil.c2",
    "slip_sinkage.n1",
    "exit_angle.lambda",
    "coulomb_friction.torque",
    "drag.force",
    "viscous_friction.coefficient",
];

fn main() {
    divan::main();
}

/// A run whose wheels follow speeds of their own; the measured values do not matter here.
fn run(k: usize) -> Run {
    let names = ["time", "wheel[1].speed_command", "wheel[2].speed_command", "x", "wheel[1].torque", "wheel[2].torque"];
    let mut data = Table::new(names).expect("no name twice");
    for row in 0..251 {
        let time = 0.1 * f64::from(row);
        let speed = 1.5 + 0.05 * k as f64 + 0.5 * (0.4 * time + k as f64).sin();
        data.push(&[time, speed, 0.9 * speed, 0.0, 0.0, 0.0]).expect("finite");
    }
    let mut terrain = Table::new(["x", "z"]).expect("no name twice");
    for i in -40..200 {
        let x = 0.05 * f64::from(i);
        terrain.push(&[x, 0.03 * (1.5 * x).sin()]).expect("finite");
    }
    Run {
        name: format!("run {k}"),
        file: format!("{k}.csv").into(),
        group: None,
        parameters: BTreeMap::new(),
        terrain: Some(terrain),
        x0: Some(0.05 * k as f64),
        data,
        conditions: Vec::new(),
        inputs: names[1..3].iter().map(|name| (*name).to_owned()).collect(),
        measured: names[3..].iter().map(|name| (*name).to_owned()).collect(),
    }
}

fn experiment() -> Experiment {
    Experiment {
        effects: Vec::new(),
        name: "bench".to_owned(),
        kind: Kind::Traverse,
        folder: "bench".into(),
        parameters: BTreeMap::new(),
        priors: BTreeMap::new(),
        soil_class: None,
        shared: BTreeMap::new(),
        sensors: BTreeMap::new(),
        model: None,
        noise: BTreeMap::new(),
        runs: (0..18).map(run).collect(),
        doubts: Vec::new(),
        parts: Vec::new(),
    }
}

fn model() -> Model {
    Model::preset("two_wheeled_speed").expect("a preset")
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn traverse_values(bencher: Bencher) {
    let (model, experiment) = (model(), experiment());
    bencher.bench(|| modelled(black_box(&model), &experiment).expect("runs"));
}

#[divan::bench(args = [4, 6, 8, 12], sample_count = 2, sample_size = 1)]
fn traverse_slopes(bencher: Bencher, free: usize) {
    let (model, experiment) = (model(), experiment());
    bencher.bench(|| sensitivity(black_box(&model), &experiment, &FREE[..free]).expect("runs"));
}

/// The whole diagnosis of the shipped experiment: 3 loads, 2 speeds, 9 slips, 3 repeats, all effects alone and in pairs.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn sand_wheel_diagnosed(bencher: Bencher) {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/sand_wheel");
    let (model, experiment) =
        (Model::preset("two_wheeled").expect("a preset"), Experiment::read(folder).expect("reads"));
    bencher.bench(|| {
        diagnose(&model, black_box(&experiment), &DiagnoseOptions::default(), &Control::default()).expect("an answer")
    });
}
