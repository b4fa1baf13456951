//! How much arithmetic a step takes, which no implementation can do without: `cargo test --lib operations -- --nocapture`
//! prints it; `cargo bench --bench batch` sets it against what the processor can do.

use super::group::group;
use super::kind::Kind;
use super::shard::Slot;
use crate::contact::rolling;
use crate::model::{Model, Run};
use crate::scalar::{Counted, Lanes, Operations, WIDTH, operations};
use crate::soil::Soil;
use crate::terrain::{Profile, Random, Spectrum, Terrain, Waves};
use crate::wheel::Wheel;
use bekker_modeldescription::Parameters;

type Eight = Lanes<Counted>;

/// A wheel at 20 % slip on a soil of this shear modulus.
fn wheel(shear_modulus: f64) -> Operations {
    let lift = |x: f64| Eight::from(x);
    let soil = Soil { shear_modulus, ..Soil::default() };
    let (wheel, soil) = (Wheel::default().map(&lift), soil.map(&lift));
    operations(|| rolling(&wheel, &soil, lift(0.0), lift(0.01), lift(0.2), lift(2.5))).1
}

/// An inner step of eight rovers of a preset on their way over some ground, on average.
fn step(preset: &str, torque: f64, ground: Profile) -> Operations {
    const STEPS: u64 = 200;
    let mut model = Model::preset(preset).expect("a preset");
    model.rover.terrain = Terrain::new(ground);
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

/// The page on environments and the benchmark give these numbers.
#[test]
fn regress_operations_of_a_step() {
    // The shear of the second changes so much along the rim that it takes 12 nodes a zone in place of 8.
    let (few, more) = (wheel(0.03), wheel(0.002));
    let node = (more.sums_and_products - few.sums_and_products) as f64 / 8.0;
    let waves = || Profile::Waves(Waves { amplitude: 0.02, wavelength: 2.5, start: 0.3 });
    let spectrum = Spectrum { roughness: 0.02, wavelength: 4.0, exponent: 3.0 };
    let rough = Profile::Random(Random::new(spectrum, 1));
    let (two, bogie) = (step("two_wheeled", 1.5, waves()), step("rocker_bogie", 0.3, waves()));
    let rough = step("rocker_bogie", 0.3, rough);
    println!("sums and products of a node {node}\nwheel, 2 x 8 nodes {few:?}\ntwo wheels {two:?}");
    println!("side of a rocker-bogie {bogie:?}\nthe same on random ground {rough:?}");
    assert_eq!(node, 111.5);
    let counts = [few, two, bogie, rough].map(|done| [done.sums_and_products, done.quotients_and_roots]);
    assert_eq!(counts, [[1_955, 12], [10_887, 219], [19_529, 350], [34_966, 357]]);
}
