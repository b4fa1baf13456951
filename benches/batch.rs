//! Steps of many rovers: `cargo bench --bench batch`. One iteration is 10 inner steps of 2 ms (both stages) of every run
//! of the batch, with new torques; an item is one inner step of one run.
//!
//! The peers in the same run are the same runs one by one ([`Kernel::Single`]). Divan's times are wall clock.

use bekker::batch::{Batch, Kernel};
use bekker::model::{Model, Run};
use bekker::simulation::Status;
use bekker::terrain::{Profile, Random, Spectrum, Terrain, Waves};
use divan::{Bencher, counter::ItemsCount};

/// Inner steps of one iteration: an action of 20 ms.
const STEPS: u64 = 10;
/// Runs in a batch, with the number of threads.
const SIZES: [(usize, usize); 6] = [(1, 1), (8, 1), (64, 1), (1024, 1), (64, 2), (1024, 2)];

fn main() {
    // Steps a second of processor time, which other work on the machine does not change; then divan, which goes by the
    // clock.
    println!("inner steps a CPU second, one thread, batch of 1024 (single runs: 64)");
    for case in CASES {
        for kernel in [Kernel::Single, Kernel::Portable, Kernel::Avx2, Kernel::Avx512] {
            if kernel.is_there() {
                let count = if kernel == Kernel::Single { 64 } else { 1024 };
                println!("{:>28} {kernel:>10?} {:>12.0}", case.name, steps_a_cpu_second(&case, count, kernel));
            }
        }
    }
    #[cfg(target_arch = "x86_64")]
    if Kernel::Avx512.is_there() {
        let (sums, quotients) = arithmetic::a_cpu_second();
        println!(
            "in AVX-512 registers {:.1} G products and sums, {:.2} G quotients a CPU second",
            sums * 1e-9,
            quotients * 1e-9
        );
        for case in &CASES {
            let limit = 1.0 / (case.operations[0] / sums + case.operations[1] / quotients);
            let share = 100.0 * steps_a_cpu_second(case, 1024, Kernel::Avx512) / limit;
            println!("{:>28} {limit:>12.0} steps would take them all, {share:.0} % of that is reached", case.name);
        }
    }
    divan::main();
}

/// What is driven on what ground.
struct Case {
    name: &'static str,
    preset: &'static str,
    /// Of each wheel, N m.
    torque: f64,
    /// The ground of run k, which differs from run to run by a share of 0 to 1.
    ground: fn(usize, f64) -> Profile,
    /// Sums and products, and quotients and roots of an inner step, as `cargo test --lib operations` counts them.
    operations: [f64; 2],
}

const TWO_WHEELS: Case =
    Case { name: "two wheels", preset: "two_wheeled", torque: 1.5, ground: waves, operations: [10_843.0, 203.0] };
const BOGIE: Case = Case {
    name: "side of a rocker-bogie",
    preset: "rocker_bogie",
    torque: 0.3,
    ground: waves,
    operations: [19_426.0, 326.0],
};
const ROUGH: Case = Case { name: "the same on random ground", ground: random, operations: [34_862.0, 333.0], ..BOGIE };
const CASES: [Case; 3] = [TWO_WHEELS, BOGIE, ROUGH];

fn waves(_: usize, share: f64) -> Profile {
    Profile::Waves(Waves { amplitude: 0.01 + 0.02 * share, wavelength: 2.0 + share, start: 0.3 })
}

fn random(k: usize, share: f64) -> Profile {
    let spectrum = Spectrum { roughness: 0.01 + 0.02 * share, wavelength: 4.0, exponent: 3.0 };
    Profile::Random(Random::new(spectrum, k as u32))
}

/// What a core does in a second where nothing keeps it waiting. Products and sums are not fused: neither are those of the
/// physics, so that each processor gives the same bits.
#[cfg(target_arch = "x86_64")]
mod arithmetic {
    use super::cpu_seconds;
    use divan::black_box;
    use std::arch::x86_64::{_mm512_add_pd, _mm512_div_pd, _mm512_mul_pd, _mm512_set1_pd};

    /// Chains that do not wait for each other: more than an addition and a multiplication take cycles.
    const CHAINS: usize = 16;
    const TURNS: usize = 100_000;

    /// Products and sums, half each, and quotients, of single numbers in 512-bit registers.
    pub fn a_cpu_second() -> (f64, f64) {
        assert!(is_x86_feature_detected!("avx512f"), "asked of a processor without AVX-512");
        let numbers = (TURNS * CHAINS * 8) as f64;
        // SAFETY: AVX-512 is there.
        let sums = rate(|| unsafe { sums_and_products(black_box(0.999), black_box(0.001)) });
        let quotients = rate(|| unsafe { quotients(black_box(1.001)) });
        (2.0 * numbers * sums, numbers * quotients)
    }

    /// Calls a CPU second.
    fn rate(mut act: impl FnMut()) -> f64 {
        let (start, mut calls) = (cpu_seconds(), 0.0);
        while cpu_seconds() < start + 1.0 {
            act();
            calls += 1.0;
        }
        calls / (cpu_seconds() - start)
    }

    #[target_feature(enable = "avx512f")]
    fn sums_and_products(factor: f64, term: f64) {
        let (factor, term) = (_mm512_set1_pd(factor), _mm512_set1_pd(term));
        let mut numbers = [term; CHAINS];
        for _ in 0..TURNS {
            numbers = numbers.map(
                #[inline(always)]
                |number| _mm512_add_pd(_mm512_mul_pd(number, factor), term),
            );
        }
        black_box(numbers);
    }

    #[target_feature(enable = "avx512f")]
    fn quotients(divisor: f64) {
        let divisor = _mm512_set1_pd(divisor);
        let mut numbers = [divisor; CHAINS];
        for _ in 0..TURNS {
            numbers = numbers.map(
                #[inline(always)]
                |number| _mm512_div_pd(number, divisor),
            );
        }
        black_box(numbers);
    }
}

/// Time this thread has had a processor, s (Linux).
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split_whitespace().next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(f64::NAN) * 1e-9
}

fn steps_a_cpu_second(case: &Case, count: usize, kernel: Kernel) -> f64 {
    let mut drive = Drive::new(case, (count, 1), kernel);
    (0..5).for_each(|_| drive.step());
    let (start, mut turns) = (cpu_seconds(), 0);
    while cpu_seconds() < start + 1.0 && turns < 100_000 {
        drive.step();
        turns += 1;
    }
    (turns * STEPS * count as u64) as f64 / (cpu_seconds() - start)
}

/// Runs of one vehicle, each with its own soil and ground.
fn runs(case: &Case, count: usize) -> Vec<Run> {
    let base = Model::preset(case.preset).expect("a preset");
    let run = |k: usize| {
        let mut model = base.clone();
        let share = (k as f64 * 0.618_034).fract();
        model.rover.terrain = Terrain::new((case.ground)(k, share));
        model.rover.soil.shear_modulus *= 0.8 + 0.4 * share;
        model.rover.soil.cohesion *= 0.8 + 0.4 * share;
        model.start().expect("starts")
    };
    (0..count).map(run).collect()
}

/// A batch under torques that drive forward, a little other in every run and iteration.
struct Drive {
    runs: Vec<Run>,
    batch: Batch,
    inputs: Vec<f64>,
    torque: f64,
    turn: usize,
}

impl Drive {
    fn new(case: &Case, (count, threads): (usize, usize), kernel: Kernel) -> Self {
        let runs = runs(case, count);
        let batch = Batch::on(runs.clone(), threads, kernel).expect("a batch");
        Self { inputs: vec![0.0; count * batch.input_count()], runs, batch, torque: case.torque, turn: 0 }
    }

    fn step(&mut self) {
        for (i, input) in self.inputs.iter_mut().enumerate() {
            *input = self.torque * (0.85 + 0.3 * ((i * 7 + self.turn * 13) % 32) as f64 / 32.0);
        }
        self.batch.step(&self.inputs, STEPS, None).expect("steps");
        self.turn += 1;
        // Those that have ended start again.
        for (index, run) in self.runs.iter().enumerate() {
            if self.batch.statuses()[index] != Status::Running {
                self.batch.replace(index, run.clone()).expect("the same structure");
            }
        }
    }
}

fn step(bencher: Bencher, case: &Case, size: (usize, usize), kernel: Kernel) {
    let mut drive = Drive::new(case, size, kernel);
    bencher.counter(ItemsCount::new(STEPS * size.0 as u64)).bench_local(|| drive.step());
}

#[divan::bench(args = SIZES)]
fn two_wheels(bencher: Bencher, size: (usize, usize)) {
    step(bencher, &TWO_WHEELS, size, Kernel::best());
}

#[divan::bench(args = SIZES)]
fn rocker_bogie_side(bencher: Bencher, size: (usize, usize)) {
    step(bencher, &BOGIE, size, Kernel::best());
}

/// The same runs on other instructions, and one by one.
mod kernels {
    use super::*;

    const KERNELS: [Kernel; 4] = [Kernel::Single, Kernel::Portable, Kernel::Avx2, Kernel::Avx512];

    #[divan::bench(args = KERNELS)]
    fn two_wheels(bencher: Bencher, kernel: Kernel) {
        step(bencher, &TWO_WHEELS, (1024, 1), kernel);
    }

    #[divan::bench(args = KERNELS)]
    fn rocker_bogie_side(bencher: Bencher, kernel: Kernel) {
        step(bencher, &BOGIE, (1024, 1), kernel);
    }
}
