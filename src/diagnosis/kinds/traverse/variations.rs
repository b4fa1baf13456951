//! Variations of a traverse: a hill, another mass or speed, the way back, more signals.

use super::plan::{TraversePlan, all_signals, reach};
use crate::diagnosis::halt::Halt;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::separate::plan::handy;
use crate::diagnosis::separate::variation::{
    Change, REPEATS, Repeated, Variation, combine, is_one_speed, range, second_speed, spread, with,
};
use crate::measurement::{Experiment, Run};
use crate::model::Model;

/// Slopes to be tried, degrees, the steepest first, and the longest run, s, and shortest time between rows, s.
const SLOPES: [f64; 3] = [8.0, 5.0, 3.0];
const LONGEST: f64 = 20.0;
const EVERY: f64 = 0.2;
/// A second mass, as a share of the present one.
const HEAVIER: f64 = 1.3;
/// Rim speed where only torques were commanded, m/s.
const SPEED: f64 = 0.1;

/// Variations of the experiment that the model can compute, unless `halt` asks to end.
pub(super) fn variations(model: &Model, experiment: &Experiment, halt: Halt) -> Vec<Variation> {
    let radius = experiment.parameters.get("wheel.radius").copied().unwrap_or(model.rover.wheel.radius);
    let commands = |run: &Run| {
        let speeds = run.inputs.iter().filter(|_| run.imposes_speeds());
        let all = speeds.flat_map(|name| run.data.column(name).unwrap_or_default());
        all.map(|speed| radius * speed).filter(|speed| *speed != 0.0).collect::<Vec<_>>()
    };
    let speeds = range(experiment, commands).unwrap_or([SPEED; 3]);
    let lengths = |run: &Run| {
        let time = run.data.column("time").unwrap_or_default();
        vec![time.last().unwrap_or(&0.0) - time.first().unwrap_or(&0.0)]
    };
    let Some(durations) = range(experiment, lengths) else { return Vec::new() };
    let wheels = model.rover.wheels.len();
    let present = TraversePlan {
        name: experiment.name.clone(),
        speeds: spread(speeds).into_iter().filter(|speed| *speed != 0.0).collect(),
        slopes: vec![0.0],
        masses: masses(experiment),
        and_back: false,
        duration: handy(durations[1].min(LONGEST)).max(10.0 * EVERY),
        every: EVERY,
        repeats: REPEATS,
        signals: experiment.signals(),
        parameters: experiment.parameters.clone(),
        wheels,
        radius,
        reach: reach(model),
    };
    let mass = experiment.parameters.get("rover.mass").copied().unwrap_or(model.rover.body.mass);
    let ground = experiment.runs.iter().find(|run| run.terrain.is_some());
    let climbs = |degrees: &f64| {
        let hill = TraversePlan { slopes: vec![degrees.to_radians()], repeats: 1, ..present.clone() };
        let hill = with(String::new(), 0, experiment, hill.experiment());
        hill.is_some_and(|hill| reaches_the_end(model, &hill.experiment, halt))
    };
    let hill = SLOPES.into_iter().filter(|_| ground.is_none()).find(climbs);
    let changes = changes(&present, hill, mass, speeds);
    // A traverse takes seconds to simulate: no pairs of changes.
    let planned = combine(&present, &changes, false).into_iter();
    let mut variations: Vec<Variation> =
        planned.filter_map(|(text, cost, plan)| with(text, cost, experiment, plan.experiment())).collect();
    if let Some(ground) = ground {
        // The ground at hand stays: it is uneven already.
        for run in variations.iter_mut().flat_map(|variation| &mut variation.experiment.runs) {
            (run.terrain, run.x0) = (ground.terrain.clone(), ground.x0);
        }
    }
    variations
}

/// Whether the model can compute every row, unless `halt` asks to end.
fn reaches_the_end(model: &Model, experiment: &Experiment, halt: Halt) -> bool {
    let Ok(mut problem) = Problem::new(model, experiment, &[]) else { return false };
    problem.halt = halt;
    matches!(problem.predict(&[], |predict| predict.values(&[])), Ok(Ok(_)))
}

/// Lightest and heaviest mass that runs state; empty where they do not differ.
fn masses(experiment: &Experiment) -> Vec<f64> {
    let stated = |run: &Run| run.parameters.get("rover.mass").copied().into_iter().collect::<Vec<_>>();
    range(experiment, stated)
        .filter(|range| range[0] < range[2])
        .map_or_else(Vec::new, |range| vec![range[0], range[2]])
}

fn changes(present: &TraversePlan, hill: Option<f64>, mass: f64, speeds: [f64; 3]) -> Vec<Change<TraversePlan>> {
    let mut changes: Vec<Change<TraversePlan>> = Vec::new();
    if let Some(degrees) = hill {
        let text = format!("a hill of {degrees} degrees driven up and down");
        changes.push((text, Box::new(move |plan| plan.slopes = vec![0.0, degrees.to_radians()])));
    }
    if present.masses.is_empty() {
        let heavy = handy(HEAVIER * mass);
        let text = format!("a second, known mass of {heavy} kg");
        changes.push((text, Box::new(move |plan| plan.masses = vec![mass, heavy])));
    }
    if is_one_speed(speeds) {
        let second = second_speed(speeds[1]);
        let text = format!("a second wheel speed of {} rad/s", handy(second / present.radius));
        changes.push((text, Box::new(move |plan| plan.speeds.push(second))));
    }
    if speeds[0] * speeds[2] > 0.0 {
        let text = "the way driven back in reverse".to_owned();
        changes.push((text, Box::new(|plan| plan.and_back = true)));
    }
    let missing = all_signals(present.wheels).into_iter();
    let missing: Vec<String> = missing.filter(|name| !present.signals.contains(name)).collect();
    if !missing.is_empty() {
        let mut fields: Vec<&str> = missing.iter().map(|name| name.rsplit('.').next().unwrap_or(name)).collect();
        fields.sort_unstable();
        fields.dedup();
        let text = format!("{} measured too", fields.join(" and "));
        changes.push((text, Box::new(move |plan| plan.signals.extend(missing.clone()))));
    }
    changes
}

impl Repeated for TraversePlan {
    fn repeats(&mut self) -> &mut usize {
        &mut self.repeats
    }
}
