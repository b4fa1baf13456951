//! Runs in a batch beside the same runs alone: the same bits, for all vehicles, grounds, effects and instruction sets.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::batch::{Batch, Kernel};
use bekker::model::{Model, Run};
use bekker::modeldescription::Parameters;

/// Steps runs alone and in a batch and compares every signal, status and error.
fn compare(what: &str, runs: Vec<Run>, kernel: Kernel, turns: usize, steps: u64, input: impl Fn(usize, usize) -> f64) {
    let mut alone = runs.clone();
    let count = runs.len();
    let mut batch = Batch::on(runs, 1, kernel).unwrap();
    let width = batch.input_count();
    let mut out = vec![0.0; count * batch.signal_count()];
    for turn in 0..turns {
        let inputs: Vec<f64> = (0..count * width).map(|i| input(i, turn)).collect();
        batch.step(&inputs, steps, None).unwrap();
        batch.signals(&mut out);
        for (k, run) in alone.iter_mut().enumerate() {
            run.inputs_mut().set_all(&inputs[k * width..(k + 1) * width]).unwrap();
            let error = run.advance(steps).err();
            if batch.error(k).is_some() || error.is_some() {
                assert_eq!(batch.error(k), error.as_ref(), "{what}: run {k}, turn {turn}");
            }
            assert_eq!(batch.statuses()[k], run.status(), "{what}: run {k}, turn {turn}");
            assert_eq!(batch.time(k), run.time(), "{what}: run {k}, turn {turn}");
            let mut row = Vec::new();
            run.signals().values(&mut |x| row.push(x.to_bits()));
            let got: Vec<u64> = out[k * row.len()..(k + 1) * row.len()].iter().map(|x| x.to_bits()).collect();
            assert_eq!(got, row, "{what}: run {k}, turn {turn}");
        }
    }
}

#[test]
fn agreement_presets() {
    for preset in ["two_wheeled", "two_wheeled_speed", "rocker_bogie"] {
        let model = Model::preset(preset).unwrap();
        let runs: Vec<Run> = (0..11).map(|_| model.start().unwrap()).collect();
        compare(preset, runs, Kernel::Portable, 40, 10, |i, turn| 0.3 + 0.2 * ((i * 5 + turn * 3) % 7) as f64);
    }
}
