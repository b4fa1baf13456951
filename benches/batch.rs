//! Steps of many rovers: `cargo bench --bench batch`. One iteration is 10 inner steps of 2 ms (both stages) of every run
//! of the batch, with new torques; an item is one inner step of one run.
//!
//! The peers in the same run are the same runs one by one ([`Kernel::Single`]). Divan's times are wall clock.

use bekker::batch::{Batch, Kernel};
use bekker::model::{Model, Run};
use bekker::terrain::{Profile, Terrain, Waves};
use divan::{Bencher, counter::ItemsCount};

/// Inner steps of one iteration: an action of 20 ms.
const STEPS: u64 = 10;
/// Runs in a batch, with the number of threads.
const SIZES: [(usize, usize); 6] = [(1, 1), (8, 1), (64, 1), (1024, 1), (64, 2), (1024, 2)];

fn main() {
    divan::main();
}

/// Runs of one vehicle over waves, each with its own soil, ground and start.
fn runs(preset: &str, count: usize) -> Vec<Run> {
    let mut model = Model::preset(preset).expect("a preset");
    let run = |k: usize| {
        let share = (k as f64 * 0.618_034).fract();
        let waves = Waves { amplitude: 0.01 + 0.02 * share, wavelength: 2.0 + share, start: 0.3 };
        model.rover.terrain = Terrain::new(Profile::Waves(waves));
        model.rover.soil.shear_modulus *= 0.8 + 0.4 * share;
        model.rover.soil.cohesion *= 0.8 + 0.4 * share;
        model.start().expect("starts")
    };
    (0..count).map(run).collect()
}

/// Torques that drive forward, a little other in every run and iteration.
fn step(bencher: Bencher, preset: &str, torque: f64, (count, threads): (usize, usize), kernel: Kernel) {
    let runs = runs(preset, count);
    let wheels = runs[0].signals().wheels.len();
    let mut fresh = Batch::on(runs.clone(), threads, kernel).expect("a batch");
    let mut inputs = vec![0.0; count * wheels];
    let mut turn = 0usize;
    bencher.counter(ItemsCount::new(STEPS * count as u64)).bench_local(|| {
        for (i, input) in inputs.iter_mut().enumerate() {
            *input = torque * (0.85 + 0.3 * ((i * 7 + turn * 13) % 32) as f64 / 32.0);
        }
        fresh.step(&inputs, STEPS, None).expect("steps");
        turn += 1;
        // Those that have ended start again.
        for index in 0..count {
            if fresh.statuses()[index] != bekker::simulation::Status::Running {
                fresh.replace(index, runs[index].clone()).expect("the same structure");
            }
        }
    });
}

#[divan::bench(args = SIZES)]
fn two_wheels(bencher: Bencher, size: (usize, usize)) {
    step(bencher, "two_wheeled", 1.5, size, Kernel::best());
}

#[divan::bench(args = SIZES)]
fn rocker_bogie_side(bencher: Bencher, size: (usize, usize)) {
    step(bencher, "rocker_bogie", 0.3, size, Kernel::best());
}

/// The same runs on other instructions, and one by one.
mod kernels {
    use super::*;

    const KERNELS: [Kernel; 4] = [Kernel::Single, Kernel::Portable, Kernel::Avx2, Kernel::Avx512];

    #[divan::bench(args = KERNELS)]
    fn two_wheels(bencher: Bencher, kernel: Kernel) {
        step(bencher, "two_wheeled", 1.5, (1024, 1), kernel);
    }

    #[divan::bench(args = KERNELS)]
    fn rocker_bogie_side(bencher: Bencher, kernel: Kernel) {
        step(bencher, "rocker_bogie", 0.3, (1024, 1), kernel);
    }
}
