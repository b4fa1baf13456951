//! What an experiment can tell apart, and which would tell more.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::diagnosis::{
    CompareError, CompareOptions, Likeness, NoiseSource, SeparateOptions, Separation, SingleWheelPlan, TraversePlan,
    compare, separate,
};
use bekker::measurement::Experiment;
use bekker::model::Model;
use bekker::modeldescription::Lookup;

fn wheel() -> (Model, SingleWheelPlan) {
    let mut model = Model::preset("two_wheeled_speed").unwrap();
    model.set("soil.shear_modulus", 0.015).unwrap();
    let plan = SingleWheelPlan { loads: vec![20.0], ..SingleWheelPlan::of(&model) };
    (model, plan)
}

fn look(model: &Model, experiment: &Experiment) -> Separation {
    separate(model, experiment, &SeparateOptions::default()).unwrap()
}

#[test]
fn show() {
    let (model, plan) = wheel();
    for loads in [vec![20.0], vec![10.0, 20.0, 40.0]] {
        let plan = SingleWheelPlan { loads, ..plan.clone() };
        println!("{:#?}", look(&model, &plan.experiment().unwrap()).effects);
        for pair in look(&model, &plan.experiment().unwrap()).pairs { println!("{pair:?}"); }
    }
    let plan = TraversePlan::of(&model);
    let t = std::time::Instant::now();
    let s = look(&model, &plan.experiment().unwrap());
    println!("{:#?} {:?}", s, t.elapsed());
}
