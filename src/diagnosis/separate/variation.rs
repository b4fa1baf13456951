//! Variations of an experiment that can be simulated: what those of all kinds share. Which there are of a kind of experiment
//! stands with its [kind](crate::diagnosis::kinds).

use super::plan::{PlanError, handy};
use crate::measurement::{Experiment, Run};

/// A variation of an experiment.
#[derive(Clone, Debug)]
pub(crate) struct Variation {
    /// What to do, as the end of "repeat with ..".
    pub text: String,
    pub experiment: Experiment,
    /// How much more work it is than the experiment at hand: the number of things that are new in it.
    pub cost: usize,
}

/// Ratio of speeds from which a range of speeds counts as wide.
const WIDE_SPEEDS: f64 = 2.0;
/// A second speed is so many times the present one, or that part of it where the rim is already fast, m/s.
const FASTER: f64 = 4.0;
const FAST: f64 = 0.1;
/// Repeats of a variation.
pub(crate) const REPEATS: usize = 3;

/// A planned experiment as a variation of the one at hand; `None` where the plan is impossible.
pub(crate) fn with(
    text: String,
    cost: usize,
    like: &Experiment,
    planned: Result<Experiment, PlanError>,
) -> Option<Variation> {
    let planned = planned.ok()?;
    let measured = planned.signals();
    let mut experiment = Experiment { runs: planned.runs, ..like.clone() };
    experiment.noise.retain(|signal, _| measured.contains(signal));
    Some(Variation { text, experiment, cost })
}

/// Lowest, middle and highest value of a column over all runs.
pub(crate) fn range(experiment: &Experiment, column: impl Fn(&Run) -> Vec<f64>) -> Option<[f64; 3]> {
    let mut values: Vec<f64> = experiment.runs.iter().flat_map(column).filter(|value| !value.is_nan()).collect();
    values.sort_by(f64::total_cmp);
    Some([*values.first()?, values[values.len() / 2], *values.last()?])
}

/// Few levels that span a range.
pub(crate) fn spread(range: [f64; 3]) -> Vec<f64> {
    let [low, _, high] = range.map(handy);
    if low == high { vec![low] } else { vec![low, high] }
}

/// Another rim speed, far enough from the present one, m/s.
pub(crate) fn second_speed(present: f64) -> f64 {
    handy(if present.abs() > FAST { present / FASTER } else { present * FASTER })
}

/// A change of a plan, in words and as what it does to the plan.
pub(crate) type Change<P> = (String, Box<dyn Fn(&mut P)>);

/// Whether all speeds of a range are about the same, so that a second one would tell more.
pub(crate) fn is_one_speed(speeds: [f64; 3]) -> bool {
    speeds[2].abs() < WIDE_SPEEDS * speeds[0].abs()
}

/// Each change alone, on request every two, all together, and more repeats.
pub(crate) fn combine<P: Clone + Repeated>(present: &P, changes: &[Change<P>], pairs: bool) -> Vec<(String, usize, P)> {
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
pub(crate) trait Repeated {
    fn repeats(&mut self) -> &mut usize;
}
