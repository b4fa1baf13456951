//! How much arithmetic a step takes: what bounds the speed of a batch. `cargo test --lib operations -- --nocapture`.

use super::group::{Kind, group};
use super::shard::Slot;
use crate::contact::rolling;
use crate::model::{Model, Run};
use crate::scalar::{Counted, Lanes, Operations, WIDTH, operations};
use crate::soil::Soil;
use crate::terrain::{Profile, Terrain, Waves};
use crate::wheel::Wheel;
use bekker_modeldescription::Parameters;

type Eight = Lanes<Counted>;

/// How far a count may be from the one that the page on environments gives: its figures have two digits.
const TOLERANCE: f64 = 0.05;

/// A wheel at 20 % slip on a soil of this shear modulus.
fn wheel(shear_modulus: f64) -> Operations {
    let lift = |x: f64| Eight::from(x);
    let soil = Soil { shear_modulus, ..Soil::default() };
    let (wheel, soil) = (Wheel::default().map(&lift), soil.map(&lift));
    operations(|| rolling(&wheel, &soil, lift(0.0), lift(0.01), lift(0.2), lift(2.5))).1
}

/// An inner step of eight rovers of a preset on their way over waves.
fn step(preset: &str, torque: f64) -> Operations {
    const STEPS: u64 = 200;
    let mut model = Model::preset(preset).expect("a preset");
    model.rover.terrain = Terrain::new(Profile::Waves(Waves { amplitude: 0.02, wavelength: 2.5, start: 0.3 }));
    let run: Run = model.start().expect("starts");
    let mut group = group::<Counted>(Kind::of(&run).expect("goes side by side"), &run).expect("a group");
    let mut slots: Vec<Slot> = (0..WIDTH).map(|_| Slot::new(run.clone())).collect();
    for (k, slot) in slots.iter_mut().enumerate() {
        slot.active = true;
        let inputs = slot.run.inputs_mut();
        let mut wheels = 0;
        inputs.values(&mut |_| wheels += 1);
        inputs.set_all(&vec![torque; wheels]).expect("torques");
        assert!(group.join(k));
    }
    let ((), done) = operations(|| group.step(&mut slots, STEPS));
    assert_eq!(group.steps_made(), STEPS * WIDTH as u64, "no run may have left the group");
    let per_step = |count: u64| count / STEPS;
    Operations {
        sums_and_products: per_step(done.sums_and_products),
        quotients_and_roots: per_step(done.quotients_and_roots),
        choices: per_step(done.choices),
    }
}

fn near(what: &str, found: f64, published: f64) {
    assert!((found / published - 1.0).abs() < TOLERANCE, "{what}: {found}, the page says {published}");
}

/// The counts stand on the page on environments, beside what this machine can do in a second.
#[test]
fn regress_operations_of_a_step() {
    // The shear of the second changes so much along the rim that it takes 12 nodes a zone in place of 8.
    let (few, more) = (wheel(0.03), wheel(0.002));
    let node = (more.flops() - few.flops()) as f64 / 8.0;
    let (two, bogie) = (step("two_wheeled", 1.5), step("rocker_bogie", 0.3));
    println!("flops a node {node}\nwheel, 2 x 8 nodes {few:?}\ntwo wheels {two:?}\nside of a rocker-bogie {bogie:?}");
    near("node", node, 110.0);
    near("wheel", few.flops() as f64, 2000.0);
    near("two wheels", two.flops() as f64, 11_000.0);
    near("rocker-bogie", bogie.flops() as f64, 20_000.0);
}
