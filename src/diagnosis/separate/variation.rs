//! Variations of an experiment that can be simulated: more loads, wider slips, other speeds, slopes, masses, signals.

use super::plan::{PlanError, SingleWheelPlan, TraversePlan, all_signals, carried, handy, reach};
use crate::carriage::Rig;
use crate::diagnosis::halt::Halt;
use crate::diagnosis::problem::Problem;
use crate::measurement::{Experiment, Kind, Run};
use crate::model::Model;
use bekker_modeldescription::Lookup;

/// A variation of an experiment.
#[derive(Clone, Debug)]
pub(crate) struct Variation {
    /// What to do, as the end of "repeat with ..".
    pub text: String,
    pub experiment: Experiment,
    /// How much more work it is than the experiment at hand: the number of things that are new in it.
    pub cost: usize,
}

/// Loads of a variation as shares of the present one in the middle, and slips.
const LOADS: [f64; 3] = [0.5, 1.0, 2.0];
const WIDE: [f64; 9] = [-0.3, -0.15, 0.0, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8];
/// Ranges count as wide from these: ratio of loads, of speeds; lowest and highest slip.
const WIDE_LOADS: f64 = 2.5;
const WIDE_SPEEDS: f64 = 2.0;
const WIDE_SLIPS: (f64, f64) = (-0.05, 0.6);
/// A second speed is so many times the present one, or that part of it where the rim is already fast, m/s.
const FASTER: f64 = 4.0;
const FAST: f64 = 0.1;
/// Slopes to be tried, degrees, the steepest first, and the longest run, s, and shortest time between rows, s.
const SLOPES: [f64; 3] = [8.0, 5.0, 3.0];
const LONGEST: f64 = 20.0;
const EVERY: f64 = 0.2;
const HEAVIER: f64 = 1.3;
/// Repeats of a variation.
const REPEATS: usize = 3;
/// Rim speed where only torques were commanded, m/s.
const SPEED: f64 = 0.1;

/// Variations of an experiment that the model can be asked about.
pub(crate) fn variations(model: &Model, experiment: &Experiment, halt: Halt) -> Vec<Variation> {
    match experiment.kind {
        Kind::SingleWheel => single_wheel(model, experiment),
        Kind::Traverse => traverse(model, experiment, halt),
    }
}

fn with(text: String, cost: usize, like: &Experiment, planned: Result<Experiment, PlanError>) -> Option<Variation> {
    let planned = planned.ok()?;
    let measured = planned.signals();
    let mut experiment = Experiment { runs: planned.runs, ..like.clone() };
    experiment.noise.retain(|signal, _| measured.contains(signal));
    Some(Variation { text, experiment, cost })
}

/// Lowest, middle and highest value of a column over all runs.
fn range(experiment: &Experiment, column: impl Fn(&Run) -> Vec<f64>) -> Option<[f64; 3]> {
    let mut values: Vec<f64> = experiment.runs.iter().flat_map(column).filter(|value| !value.is_nan()).collect();
    values.sort_by(f64::total_cmp);
    Some([*values.first()?, values[values.len() / 2], *values.last()?])
}

fn single_wheel(model: &Model, experiment: &Experiment) -> Vec<Variation> {
    let column = |name: &'static str| move |run: &Run| run.data.column(name).unwrap_or_default().to_vec();
    let ranges = (
        range(experiment, column("load")),
        range(experiment, column("slip")),
        range(experiment, column("wheel_speed")),
    );
    let (Some(loads), Some(slips), Some(speeds)) = ranges else { return Vec::new() };
    let mut rig_model = model.clone();
    for (name, value) in &experiment.parameters {
        if rig_model.set(name, *value).is_err() {
            return Vec::new();
        }
    }
    let rig = Rig::of(&rig_model.rover);
    let present = SingleWheelPlan {
        name: experiment.name.clone(),
        loads: spread(loads),
        slips: (0..9).map(|k| slips[0] + (slips[2] - slips[0]) * f64::from(k) / 8.0).collect(),
        wheel_speeds: spread(speeds).into_iter().filter(|speed| *speed != 0.0).collect(),
        repeats: REPEATS,
        signals: experiment.signals(),
        parameters: experiment.parameters.clone(),
    };
    let changes = carriage_changes(&present, &rig, loads, slips, speeds);
    combine(&present, &changes, true)
        .into_iter()
        .filter_map(|(text, cost, plan)| with(text, cost, experiment, plan.experiment()))
        .collect()
}

/// Few levels that span a range.
fn spread(range: [f64; 3]) -> Vec<f64> {
    let [low, _, high] = range.map(handy);
    if low == high { vec![low] } else { vec![low, high] }
}

/// Another rim speed, far enough from the present one, m/s.
fn second_speed(present: f64) -> f64 {
    handy(if present.abs() > FAST { present / FASTER } else { present * FASTER })
}

type Change<P> = (String, Box<dyn Fn(&mut P)>);

fn carriage_changes(
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
    if speeds[2].abs() < WIDE_SPEEDS * speeds[0].abs() {
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

fn traverse(model: &Model, experiment: &Experiment, halt: Halt) -> Vec<Variation> {
    let radius = experiment.parameters.get("wheel.radius").copied().unwrap_or(model.rover.wheel.radius);
    let commands = |run: &Run| {
        let speeds = run.inputs.iter().filter(|name| name.ends_with(".speed_command"));
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
    let changes = rover_changes(&present, hill, mass, speeds);
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

fn rover_changes(present: &TraversePlan, hill: Option<f64>, mass: f64, speeds: [f64; 3]) -> Vec<Change<TraversePlan>> {
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
    if speeds[2].abs() < WIDE_SPEEDS * speeds[0].abs() {
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

/// Each change alone, on request every two, all together, and more repeats.
fn combine<P: Clone + Repeated>(present: &P, changes: &[Change<P>], pairs: bool) -> Vec<(String, usize, P)> {
    let mut sets: Vec<Vec<usize>> = (0..changes.len()).map(|k| vec![k]).collect();
    for i in (0..changes.len()).filter(|_| pairs && changes.len() > 2) {
        sets.extend((i + 1..changes.len()).map(|j| vec![i, j]));
    }
    if changes.len() > 1 {
        sets.push((0..changes.len()).collect());
    }
    let mut all = Vec::new();
    for set in sets {
        let mut plan = present.clone();
        set.iter().for_each(|k| changes[*k].1(&mut plan));
        let texts: Vec<&str> = set.iter().map(|k| changes[*k].0.as_str()).collect();
        all.push((texts.join(", "), set.len(), plan));
    }
    let mut more = present.clone();
    *more.repeats() *= 3;
    all.push((format!("{} repeats of every run", *more.repeats()), 1, more));
    all
}

/// A plan whose runs are repeated.
trait Repeated {
    fn repeats(&mut self) -> &mut usize;
}

impl Repeated for SingleWheelPlan {
    fn repeats(&mut self) -> &mut usize {
        &mut self.repeats
    }
}

impl Repeated for TraversePlan {
    fn repeats(&mut self) -> &mut usize {
        &mut self.repeats
    }
}
