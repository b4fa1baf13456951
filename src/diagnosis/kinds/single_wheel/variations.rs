//! Variations of an experiment with a wheel on a carriage: more loads, wider slips, other speeds, more signals.

use super::plan::{SingleWheelPlan, carried};
use crate::carriage::Rig;
use crate::diagnosis::separate::additions::Test;
use crate::diagnosis::separate::plan::handy;
use crate::diagnosis::separate::variation::{
    Change, REPEATS, Repeated, Variation, combine, is_one_speed, range, second_speed, spread, with,
};
use crate::measurement::{Experiment, Run};
use crate::model::Model;
use bekker_modeldescription::Lookup;

/// Loads of a variation as shares of the present one in the middle, and slips.
const LOADS: [f64; 3] = [0.5, 1.0, 2.0];
const WIDE: [f64; 9] = [-0.3, -0.15, 0.0, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8];
/// Ranges count as wide from these: ratio of loads; lowest and highest slip.
const WIDE_LOADS: f64 = 2.5;
const WIDE_SLIPS: (f64, f64) = (-0.05, 0.6);

/// What a wheel is put through, the rig that does it, and lowest, middle and highest loads, slips and wheel speeds.
fn present(model: &Model, experiment: &Experiment) -> Option<(SingleWheelPlan, Rig, [[f64; 3]; 3])> {
    let column = |name: &'static str| move |run: &Run| run.data.column(name).unwrap_or_default().to_vec();
    let loads = range(experiment, column("load"))?;
    let slips = range(experiment, column("slip"))?;
    let speeds = range(experiment, column("wheel_speed"))?;
    let mut rig_model = model.clone();
    for (name, value) in &experiment.parameters {
        rig_model.set(name, *value).ok()?;
    }
    let plan = SingleWheelPlan {
        name: experiment.name.clone(),
        loads: spread(loads),
        slips: (0..9).map(|k| slips[0] + (slips[2] - slips[0]) * f64::from(k) / 8.0).collect(),
        wheel_speeds: spread(speeds).into_iter().filter(|speed| *speed != 0.0).collect(),
        repeats: REPEATS,
        signals: experiment.signals(),
        parameters: experiment.parameters.clone(),
    };
    Some((plan, Rig::of(&rig_model.rover), [loads, slips, speeds]))
}

/// One run over the slips of the others under half their lightest load, and one under twice their heaviest, as far as the soil carries it.
pub(super) fn more_loads(model: &Model, experiment: &Experiment) -> Vec<Test> {
    let Some((plan, rig, [loads, ..])) = present(model, experiment) else { return Vec::new() };
    let Some(speed) = plan.wheel_speeds.first().copied() else { return Vec::new() };
    let heavy = carried(&rig, LOADS[2] * loads[2], &plan.slips, &[speed]);
    let one = |load: f64| {
        let plan = SingleWheelPlan { loads: vec![load], wheel_speeds: vec![speed], repeats: 1, ..plan.clone() };
        let text = format!("one more load of {load} N on {}", experiment.name);
        let variation = with(text, 1, experiment, plan.experiment())?;
        Some(Test { text: variation.text, runs: 1, experiment: variation.experiment })
    };
    let ends = [handy(LOADS[0] * loads[0]), handy(heavy)];
    ends.into_iter().filter(|load| *load < loads[0] || *load > loads[2]).filter_map(one).collect()
}

/// Variations that the model can be asked about.
pub(super) fn variations(model: &Model, experiment: &Experiment) -> Vec<Variation> {
    let Some((present, rig, [loads, slips, speeds])) = present(model, experiment) else { return Vec::new() };
    let changes = changes(&present, &rig, loads, slips, speeds);
    combine(&present, &changes, true)
        .into_iter()
        .filter_map(|(text, cost, plan)| with(text, cost, experiment, plan.experiment()))
        .collect()
}

fn changes(
    present: &SingleWheelPlan,
    rig: &Rig,
    loads: [f64; 3],
    slips: [f64; 3],
    speeds: [f64; 3],
) -> Vec<Change<SingleWheelPlan>> {
    let mut changes: Vec<Change<SingleWheelPlan>> = Vec::new();
    if loads[2] < WIDE_LOADS * loads[0] {
        let heaviest = carried(rig, LOADS[2] * loads[1], &WIDE, &present.wheel_speeds);
        let heavy = handy(heaviest);
        let set: Vec<f64> = LOADS.iter().map(|share| handy(share / LOADS[2] * heaviest)).collect();
        let text = format!("three loads between {} and {heavy} N", set[0]);
        changes.push((text, Box::new(move |plan| plan.loads.clone_from(&set))));
    }
    if slips[0] > WIDE_SLIPS.0 || slips[2] < WIDE_SLIPS.1 {
        let text = format!("slips from {} to {}", WIDE[0], WIDE[WIDE.len() - 1]);
        changes.push((text, Box::new(|plan| plan.slips = WIDE.to_vec())));
    }
    if is_one_speed(speeds) {
        let second = second_speed(rig.wheel.radius * speeds[1]) / rig.wheel.radius;
        let second = handy(second);
        let text = format!("a second wheel speed of {second} rad/s");
        changes.push((text, Box::new(move |plan| plan.wheel_speeds.push(second))));
    }
    if speeds[0] * speeds[2] > 0.0 {
        let back = -handy(speeds[1]);
        let text = format!("runs in reverse, at {back} rad/s");
        changes.push((text, Box::new(move |plan| plan.wheel_speeds.push(back))));
    }
    let missing = ["drawbar_pull", "torque", "sinkage"].map(str::to_owned);
    let missing: Vec<String> = missing.into_iter().filter(|name| !present.signals.contains(name)).collect();
    if !missing.is_empty() {
        let text = format!("{} measured too", missing.join(" and "));
        changes.push((text, Box::new(move |plan| plan.signals.extend(missing.clone()))));
    }
    changes
}

impl Repeated for SingleWheelPlan {
    fn repeats(&mut self) -> &mut usize {
        &mut self.repeats
    }
}
