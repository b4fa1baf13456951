//! A drive over waves, recorded from the model itself with another soil, as an experiment in memory.

use bekker::measurement::{Experiment, Kind, Record, Run, Table};
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use bekker::terrain::{Profile, Samples};
use std::collections::BTreeMap;

/// Time between rows, s, and length of a drive, rows: some windows long.
pub const PERIOD: f64 = 0.1;
pub const ROWS: usize = 241;
/// The soil of the drive.
pub const PLANTED: [(&str, f64); 2] = [("soil.friction_angle", 0.55), ("soil.shear_modulus", 0.018)];
/// What is recorded of it.
pub const MEASURED: [&str; 6] = ["x", "pitch", "velocity", "wheel[1].torque", "wheel[2].torque", "wheel[2].sinkage"];

/// Points of the ground, x and z.
pub fn hill() -> (Vec<f64>, Vec<f64>) {
    let x: Vec<f64> = (0..321).map(|k| -2.0 + 0.05 * f64::from(k)).collect();
    let z = x.iter().map(|x| 0.03 * (2.0 * x).sin()).collect();
    (x, z)
}

/// The rover as it ships, on the hill.
pub fn shipped() -> Model {
    let mut model = Model::preset("two_wheeled_speed").unwrap();
    let (x, z) = hill();
    model.rover.terrain.profile = Profile::Samples(Samples::new(&x, &z).unwrap().into());
    model.start.x0 = 0.2;
    model.stepping.step_size = 0.005;
    model
}

/// A drive of the planted rover with changing speeds; `change` may alter its rows.
pub fn drive(change: impl Fn(usize, &mut Vec<Option<f64>>) -> bool) -> Experiment {
    drive_with(&[], change)
}

/// The same with other parameters besides.
pub fn drive_with(besides: &[(&str, f64)], change: impl Fn(usize, &mut Vec<Option<f64>>) -> bool) -> Experiment {
    let mut model = shipped();
    for (name, value) in PLANTED.iter().chain(besides) {
        model.set(name, *value).unwrap();
    }
    let mut run = model.start().unwrap();
    let names = MEASURED.map(str::to_owned);
    let mut record = Record::new(&mut run.signals().clone(), Some(&names)).unwrap();
    let mut commands = Vec::new();
    for row in 0..ROWS {
        record.push(row as f64 * PERIOD, run.signals()).unwrap();
        let speed = 2.0 + (row as f64 * 0.15).sin();
        run.inputs_mut().set_all(&[0.9 * speed, speed]).unwrap();
        run.advance((PERIOD / run.step_size()).round() as u64).unwrap();
        commands.push([0.9 * speed, speed]);
    }
    let table = record.into_table();
    let columns = ["time", "wheel[1].speed_command", "wheel[2].speed_command"].iter().chain(&MEASURED);
    let mut data = Table::new(columns.copied()).unwrap();
    for (row, command) in commands.iter().enumerate() {
        let mut cells = vec![Some(row as f64 * PERIOD), Some(command[0]), Some(command[1])];
        cells.extend(MEASURED.map(|name| table.value(name, row)));
        if change(row, &mut cells) {
            data.push_with_gaps(&cells).unwrap();
        }
    }
    let (x, z) = hill();
    let mut terrain = Table::new(["x", "z"]).unwrap();
    x.iter().zip(&z).for_each(|(x, z)| terrain.push(&[*x, *z]).unwrap());
    let soil = shipped().rover.soil;
    let known = [
        ("soil.cohesion", soil.cohesion),
        ("soil.k_phi", soil.k_phi),
        ("soil.exponent", soil.exponent),
        ("soil.c1", soil.c1),
        ("soil.c2", soil.c2),
    ];
    let noise = [0.01, 0.002, 0.004, 0.02, 0.02, 0.0005];
    Experiment {
        effects: Vec::new(),
        name: "drive".to_owned(),
        kind: Kind::Traverse,
        folder: "drive".into(),
        parameters: known.map(|(name, value)| (name.to_owned(), value)).into(),
        priors: BTreeMap::new(),
        soil_class: None,
        shared: BTreeMap::new(),
        sensors: BTreeMap::new(),
        model: None,
        noise: MEASURED.iter().zip(noise).map(|(name, noise)| ((*name).to_owned(), noise)).collect(),
        runs: vec![Run {
            name: "run".to_owned(),
            file: "run.csv".into(),
            group: None,
            parameters: BTreeMap::new(),
            terrain: Some(terrain),
            x0: Some(0.2),
            data,
            conditions: Vec::new(),
            inputs: vec!["wheel[1].speed_command".to_owned(), "wheel[2].speed_command".to_owned()],
            measured: MEASURED.map(str::to_owned).to_vec(),
        }],
        doubts: Vec::new(),
        parts: Vec::new(),
    }
}
