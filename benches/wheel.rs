//! Wheel force evaluations: `cargo bench --bench wheel`.

use bekker::contact::{Hold, Motion, Surface, rolling, touch};
use bekker::{soil::Soil, wheel::Wheel};
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

/// Driving at 20 % slip, n = 1 (2 x 8 nodes) and n = 1.1.
#[divan::bench(args = [1.0, 1.1])]
fn driving(bencher: Bencher, exponent: f64) {
    let (wheel, soil) = (Wheel::default(), Soil { exponent, ..Soil::default() });
    bencher.bench(|| rolling(black_box(&wheel), black_box(&soil), 0.0, 0.01, 0.2, 2.5));
}

/// Skidding, where the interval is split at j = 0.
#[divan::bench]
fn skidding(bencher: Bencher) {
    let (wheel, soil) = (Wheel::default(), Soil::default());
    bencher.bench(|| rolling(black_box(&wheel), black_box(&soil), 0.0, 0.01, 0.255, 2.5));
}

/// The contact of the rover's dynamics, with slopes and memory.
#[divan::bench]
fn dynamic_contact(bencher: Bencher) {
    let (wheel, soil) = (Wheel::default(), Soil::default());
    let surface = Surface::default();
    let motion = Motion { sinkage: 0.01, normal_velocity: 0.0, velocity: 0.2, spin: 2.5, hold: Hold::default() };
    bencher.bench(|| touch(black_box(&wheel), black_box(&soil), &surface, black_box(&motion)));
}
