//! Which further tests would determine what the measurements leave open.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::diagnosis::{
    CompareOptions, Determined, Given, Identified, PlatePlan, SeparateOptions, Separation, ShearPlan, compare,
    modelled, separate,
};
use bekker::measurement::{Experiment, Share, Table};
use bekker::model::Model;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Noise of a made test, as a share of each value: that of a soil grows with what it bears.
const NOISE: f64 = 0.01;
/// Tests whose mean scatters by less than 2 %, where beds do by 10 %.
const MANY: usize = 30;

fn shear(normal_stresses: &[f64], repeats: usize) -> Experiment {
    ShearPlan { normal_stresses: normal_stresses.to_vec(), repeats, ..ShearPlan::default() }.experiment().unwrap()
}

fn plates(diameters: &[f64]) -> Experiment {
    PlatePlan { diameters: diameters.to_vec(), repeats: 1, ..PlatePlan::default() }.experiment().unwrap()
}

fn look(experiment: &Experiment) -> Separation {
    separate(Given::default(), experiment, &SeparateOptions::default()).unwrap()
}

fn determined(all: &[Identified], name: &str) -> Option<Determined> {
    all.iter().find(|one| one.name == name).map(|one| one.determined)
}

/// What would be measured, with noise that is stated.
fn made(planned: &Experiment, seed: u64) -> Experiment {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let values = modelled(&Model::preset("two_wheeled").unwrap(), planned).unwrap();
    let usual = (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt();
    let mut values = values.into_iter();
    let mut made = planned.clone();
    for run in &mut made.runs {
        let names = run.data.names().to_vec();
        let mut table = Table::new(names.clone()).unwrap();
        for row in 0..run.data.rows() {
            let cell = |name: &String| {
                if !run.measured.contains(name) {
                    return run.data.value(name, row);
                }
                let noise: f64 = StandardNormal.sample(&mut rng);
                Some(values.next().unwrap() * (1.0 + NOISE * noise))
            };
            table.push_with_gaps(&names.iter().map(cell).collect::<Vec<_>>()).unwrap();
        }
        run.data = table;
    }
    made.noise = made.signals().into_iter().map(|signal| (signal, NOISE * usual)).collect();
    made
}

#[test]
fn analytic_one_normal_stress_gives_one_equation_for_cohesion_and_friction() {
    let separation = look(&shear(&[5e3], MANY));
    // tau = c + sigma tan phi: at one sigma only the sum is measured.
    for name in ["soil.cohesion", "soil.friction_angle"] {
        assert_eq!(determined(&separation.identified, name), Some(Determined::Together), "{:?}", separation.identified);
    }
    let texts: Vec<&str> = separation.additions.iter().map(|addition| addition.text.as_str()).collect();
    // A second line at the same stress or a plate gives no second equation. With 10 % of scatter from bed to bed, least squares by hand leave
    // 174 Pa of cohesion open with one line each at 1 and 20 kPa, and 101 Pa with three: less than a tenth of what its bounds leave, 144 Pa.
    assert_eq!(texts, ["2 shear tests (1, 20 kPa), 3 times each"], "{:?}", separation.additions);
    let addition = &separation.additions[0];
    assert_eq!((addition.runs, addition.determines.len()), (6, 2));
    assert!(addition.open.is_empty());
}

#[test]
fn agreement_an_addition_that_is_made_determines_what_was_promised() {
    // Three times each, so that the repeats tell how little these tests scatter.
    let present = made(&shear(&[5e3], 3), 1);
    let added = made(&shear(&[1e3, 20e3], 3), 2);
    let options = CompareOptions { calibrate: true, ..CompareOptions::default() };
    let alone = compare(Given::default(), &present, &options).unwrap();
    assert_eq!(determined(&alone.identified, "soil.cohesion"), Some(Determined::Together), "{:?}", alone.identified);
    let joint = Experiment::joint(vec![present, added]).unwrap();
    let both = compare(Given::default(), &joint, &options).unwrap();
    for name in ["soil.cohesion", "soil.friction_angle"] {
        assert_eq!(determined(&both.identified, name), Some(Determined::Alone), "{:?}", both.identified);
    }
}

#[test]
fn property_one_plate_is_asked_for_another_size() {
    // With one width of contact k_c is not even free.
    let separation = look(&plates(&[0.1]));
    assert_eq!(determined(&separation.identified, "soil.k_c"), None);
    let first = &separation.additions[0];
    assert!(first.determines.contains(&"soil.k_c".to_owned()), "{:?}", separation.additions);
    assert_eq!(first.text, "2 plate tests (50, 200 mm)");
    // Where all is determined nothing is asked for.
    let all = look(&plates(&[0.05, 0.1, 0.2]));
    assert!(all.additions.is_empty(), "{:?}", all.additions);
}

#[test]
fn property_a_set_is_asked_for_what_all_of_it_leaves_open() {
    let joint = Experiment::joint(vec![shear(&[5e3], MANY), plates(&[0.05, 0.2])]).unwrap();
    let separation = look(&joint);
    assert_eq!(determined(&separation.identified, "soil.k_c"), Some(Determined::Alone), "{:?}", separation.identified);
    let texts: Vec<&str> = separation.additions.iter().map(|addition| addition.text.as_str()).collect();
    assert_eq!(texts, ["2 shear tests (1, 20 kPa), 3 times each"], "{:?}", separation.additions);
}

#[test]
fn property_a_set_with_a_soil_each_is_asked_for_tests_on_the_soil_that_is_open() {
    let parts = vec![("pit".to_owned(), shear(&[5e3], MANY)), ("box".to_owned(), shear(&[1e3, 20e3], MANY))];
    let joint = Experiment::joint_named(parts).unwrap();
    // One vehicle, so a soil each: no folder names either soil.
    let given = Given::default().with_share(&[Share::Vehicle]);
    let separation = separate(given, &joint, &SeparateOptions::default()).unwrap();
    let texts: Vec<&str> = separation.additions.iter().map(|addition| addition.text.as_str()).collect();
    assert_eq!(
        texts,
        ["2 shear tests (1, 20 kPa), 3 times each in pit"],
        "{:?} {:?}",
        separation.additions,
        separation.identified
    );
    assert_eq!(separation.additions[0].determines, ["soil in pit.cohesion", "soil in pit.friction_angle"]);
}
