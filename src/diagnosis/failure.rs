//! Where the model fails: mean residuals by level of each condition, against the noise.

use super::fit::Fit;
use super::noise::NoiseFloor;
use crate::measurement::{Experiment, Kind};
use std::collections::BTreeMap;

/// Up to this many different values are levels of their own; more are put into classes of equal count.
const DISTINCT_LEVELS: usize = 12;
const CLASSES: usize = 8;

/// Values that differ by less than this share of the range are one level: set-points that a rig holds roughly.
const SAME_LEVEL: f64 = 0.02;

/// Values of one set-point lie within this share of the range.
const SET_POINT: f64 = 0.15;

/// Mean residual of one signal where a condition lies within a range.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Lowest value of the condition.
    pub low: f64,
    /// Highest value of the condition.
    pub high: f64,
    /// Mean residual, measured minus modelled, in the signal's unit.
    pub mean: f64,
    /// Number of samples.
    pub samples: usize,
}

/// The level of one condition at which a signal's mean residual is largest.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The signal.
    pub signal: String,
    /// The condition, for example `slip` or `time`.
    pub condition: String,
    /// The worst level.
    pub level: Level,
    /// How much the mean residual changes over the levels of this condition (largest less smallest).
    pub spread: f64,
    /// Standard deviation of one sample, where it is known.
    pub noise: Option<f64>,
}

impl Failure {
    /// Size of the mean residual in standard deviations of one sample.
    #[must_use]
    pub fn ratio(&self) -> Option<f64> {
        self.noise.map(|noise| self.level.mean.abs() / noise)
    }

    /// Change over the levels in standard deviations of one sample.
    #[must_use]
    pub fn spread_ratio(&self) -> Option<f64> {
        self.noise.map(|noise| self.spread / noise)
    }
}

/// Names of the columns that serve as conditions of a kind of experiment.
pub(crate) fn conditions(experiment: &Experiment) -> Vec<String> {
    match experiment.kind {
        Kind::SingleWheel => ["slip", "load", "wheel_speed"].map(str::to_owned).to_vec(),
        Kind::Traverse => {
            let mut names = vec!["time".to_owned()];
            names.extend(experiment.runs.first().into_iter().flat_map(|run| run.inputs.clone()));
            names.extend(["x", "pitch"].map(str::to_owned));
            names
        }
    }
}

/// Mean residuals of `signal` by level of `condition` (a column of the runs), in rising order; empty where the condition is
/// not recorded or does not vary.
#[must_use]
pub fn levels(experiment: &Experiment, fit: &Fit, signal: &str, condition: &str) -> Vec<Level> {
    let mut samples: Vec<(f64, f64)> = Vec::new();
    for (run, fit) in experiment.runs.iter().zip(&fit.runs) {
        let (Some(at), Some(fit)) = (run.data.column(condition), fit.signal(signal)) else { continue };
        samples.extend(at.iter().copied().zip(fit.residual.iter().copied()));
    }
    levels_of(samples)
}

/// Mean residuals by level of a condition, from values of the condition and the residual; empty where it does not vary.
pub(crate) fn levels_of(mut samples: Vec<(f64, f64)>) -> Vec<Level> {
    samples.retain(|(at, residual)| !at.is_nan() && !residual.is_nan());
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else { return Vec::new() };
    if last.0 == first.0 {
        return Vec::new();
    }
    let gap = SAME_LEVEL * (last.0 - first.0);
    let groups: Vec<&[(f64, f64)]> = samples.chunk_by(|a, b| b.0 - a.0 <= gap).collect();
    // A cloud with a few stray values is no row of set-points.
    let widest = groups.iter().map(|group| group[group.len() - 1].0 - group[0].0).fold(0.0, f64::max);
    let fits = (2..=DISTINCT_LEVELS).contains(&groups.len()) && widest <= SET_POINT * (last.0 - first.0);
    let groups = if fits { groups } else { classes(&samples) };
    groups
        .into_iter()
        .map(|group| Level {
            low: group[0].0,
            high: group[group.len() - 1].0,
            mean: group.iter().map(|(_, residual)| residual).sum::<f64>() / group.len() as f64,
            samples: group.len(),
        })
        .collect()
}

/// Classes of equal count, to one sample.
fn classes(samples: &[(f64, f64)]) -> Vec<&[(f64, f64)]> {
    let edge = |k: usize| k * samples.len() / CLASSES;
    (0..CLASSES).map(|k| &samples[edge(k)..edge(k + 1)]).filter(|class| !class.is_empty()).collect()
}

/// The worst level of every condition for every signal, the worst first.
pub(crate) fn failures(experiment: &Experiment, fit: &Fit, floors: &BTreeMap<String, NoiseFloor>) -> Vec<Failure> {
    let mut all = Vec::new();
    for (signal, floor) in floors {
        for condition in conditions(experiment) {
            if condition == *signal {
                continue;
            }
            let levels = levels(experiment, fit, signal, &condition);
            let Some(worst) = levels.iter().max_by(|a, b| a.mean.abs().total_cmp(&b.mean.abs())) else { continue };
            let (low, high) = levels
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), l| (low.min(l.mean), high.max(l.mean)));
            all.push(Failure {
                signal: signal.clone(),
                condition,
                level: worst.clone(),
                spread: high - low,
                noise: floor.value(),
            });
        }
    }
    // A signal without a noise floor is judged against its own error.
    let size = |failure: &Failure| {
        let scale = failure.noise.or_else(|| fit.rmse.get(&failure.signal).copied()).unwrap_or(1.0);
        failure.level.mean.abs() / scale
    };
    all.sort_by(|a, b| size(b).total_cmp(&size(a)));
    all
}
