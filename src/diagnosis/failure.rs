//! Where the model fails: mean residuals by level of each condition, against the noise.

use super::fit::Fit;
use super::kinds::strategy;
use super::noise::NoiseFloor;
use super::thresholds::{HELD, SAME_LEVEL, SET_POINT};
use crate::measurement::Experiment;
use crate::signals::{BodySignals, LinkSignals, WheelSignals};
use crate::soil_test::SoilTestSignals;
use bekker_modeldescription::{Lookup, Unit};
use serde::Serialize;
use std::collections::BTreeMap;

/// Up to this many different values are levels of their own; more are put into classes of equal count.
const DISTINCT_LEVELS: usize = 12;
const CLASSES: usize = 8;

/// A level that covers more than this share of a condition's range is no place.
const WHOLE: f64 = 0.9;

/// Share of a condition's range to which the ends of a level are written.
const RESOLVED: f64 = 0.02;

/// Mean residual of one signal where a condition lies within a range.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Failure {
    /// The signal.
    pub signal: String,
    /// The condition, for example `slip` or `time`.
    pub condition: String,
    /// The worst level.
    #[serde(flatten)]
    pub level: Level,
    /// How much the mean residual changes over the levels of this condition (largest less smallest).
    pub spread: f64,
    /// Standard deviation of one sample, where it is known.
    pub noise: Option<f64>,
    /// Lowest and highest value of the condition over all levels.
    pub range: [f64; 2],
}

impl Failure {
    /// Size of the mean residual in standard deviations of one sample.
    #[must_use]
    pub fn ratio(&self) -> Option<f64> {
        self.noise.map(|noise| self.level.mean.abs() / noise)
    }

    /// Where the level lies, with its unit: `slip 0.4 to 0.6`, `load 22 N`. `None` where it covers nearly the whole range.
    #[must_use]
    pub fn place(&self) -> Option<String> {
        let [lowest, highest] = self.range;
        if self.level.high - self.level.low > WHOLE * (highest - lowest) {
            return None;
        }
        let unit = unit(&self.condition);
        // The range's own size says how many digits tell the levels apart.
        let [low, high] = [self.level.low, self.level.high].map(|value| to_step(value, RESOLVED * (highest - lowest)));
        let place = if low == high { low } else { format!("{low} to {high}") };
        Some(format!("{} {place} {unit}", self.condition).trim_end().to_owned())
    }

    /// Change over the levels in standard deviations of one sample.
    #[must_use]
    pub fn spread_ratio(&self) -> Option<f64> {
        self.noise.map(|noise| self.spread / noise)
    }
}

/// A value of a column in SI with its unit, to two significant digits.
pub(crate) fn quantity(column: &str, value: f64) -> String {
    let step = 10_f64.powf(value.abs().log10().floor() - 1.0);
    let number = if value == 0.0 || !value.is_finite() { value.to_string() } else { to_step(value, step) };
    format!("{number} {}", unit(column)).trim_end().to_owned()
}

/// A number rounded to the power of ten at or below `step`, without trailing zeros.
fn to_step(value: f64, step: f64) -> String {
    let digits = -step.log10().floor();
    let scale = 10_f64.powf(digits);
    let text = format!("{:.*}", digits.clamp(0.0, 12.0) as usize, (value * scale).round() / scale);
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// SI unit of a column of an experiment: an input, time or a signal; empty for a number without unit.
fn unit(column: &str) -> &'static str {
    let field = column.rsplit('.').next().unwrap_or(column);
    let unit = match field {
        "time" => Unit::SECOND,
        "load" => Unit::NEWTON,
        "torque_command" => Unit::NEWTON_METRE,
        "wheel_speed" | "speed_command" => Unit::RADIAN_PER_SECOND,
        _ => {
            let (mut wheel, mut body, mut link) =
                (WheelSignals::<f64>::default(), BodySignals::<f64>::default(), LinkSignals::<f64>::default());
            let mut test = SoilTestSignals::<f64>::default();
            let mut listed = wheel.list().into_iter().chain(body.list()).chain(link.list()).chain(test.list());
            listed.find(|(variable, _)| variable.name == field).map_or(Unit::ONE, |(variable, _)| variable.unit)
        }
    };
    if unit.symbol == "1" { "" } else { unit.symbol }
}

/// Mean residuals of `signal` by level of `condition` (a column of the runs), in rising order; empty where the condition is
/// not recorded or does not vary. A load or a speed that is held at one set-point varies by what the rig's control leaves
/// only: that is no condition.
#[must_use]
pub fn levels(experiment: &Experiment, fit: &Fit, signal: &str, condition: &str) -> Vec<Level> {
    let mut samples: Vec<(f64, f64)> = Vec::new();
    for (run, fit) in experiment.runs.iter().zip(&fit.runs) {
        let (Some(at), Some(fit)) = (run.data.column(condition), fit.signal(signal)) else { continue };
        samples.extend(at.iter().copied().zip(fit.residual.iter().copied()));
    }
    if is_commanded(condition) && is_held(&samples) {
        return Vec::new();
    }
    levels_of(samples)
}

/// Whether a condition is set by the rig and has a natural zero, so that its relative variation means something.
fn is_commanded(condition: &str) -> bool {
    let named = |end: &str| condition.ends_with(end);
    condition == "load" || condition == "wheel_speed" || named("_command") || named("].speed")
}

fn is_held(samples: &[(f64, f64)]) -> bool {
    let values = samples.iter().map(|(at, _)| *at).filter(|at| !at.is_nan());
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    high - low <= HELD * low.abs().max(high.abs())
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
        for condition in strategy(experiment).conditions(experiment) {
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
                range: [levels[0].low, levels[levels.len() - 1].high],
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

#[cfg(test)]
mod tests {
    use super::*;

    fn failure(condition: &str, low: f64, high: f64, range: [f64; 2]) -> Failure {
        Failure {
            signal: "drawbar_pull".to_owned(),
            condition: condition.to_owned(),
            level: Level { low, high, mean: -0.3, samples: 9 },
            spread: 0.5,
            noise: None,
            range,
        }
    }

    #[test]
    fn property_a_place_is_written_with_its_unit_and_no_more_digits_than_it_has() {
        let place = |condition, low, high, range| failure(condition, low, high, range).place();
        assert_eq!(place("slip", 0.400_001, 0.6, [-0.1, 0.8]).as_deref(), Some("slip 0.4 to 0.6"));
        // One set-point of several, held roughly.
        assert_eq!(place("load", 21.588, 21.592, [10.0, 40.0]).as_deref(), Some("load 21.6 N"));
        assert_eq!(place("time", 3.0, 6.02, [0.0, 24.0]).as_deref(), Some("time 3 to 6 s"));
        assert_eq!(place("x", -0.001, 0.001, [-0.001, 3.0]).as_deref(), Some("x 0 m"));
        assert_eq!(
            place("wheel[1].speed_command", 2.0, 2.0, [1.0, 2.0]).as_deref(),
            Some("wheel[1].speed_command 2 rad/s")
        );
        // The whole range is no place.
        assert_eq!(place("slip", -0.1, 0.8, [-0.1, 0.8]), None);
    }

    #[test]
    fn property_a_quantity_has_two_digits_and_its_unit() {
        assert_eq!(quantity("drawbar_pull", 1.2345), "1.2 N");
        assert_eq!(quantity("wheel[2].sinkage", 0.001_234), "0.0012 m");
        assert_eq!(quantity("torque", 0.0), "0 N.m");
        assert_eq!(quantity("load", 1234.5), "1200 N");
    }

    #[test]
    fn property_a_held_load_is_no_condition_and_levels_of_it_are() {
        let samples = |loads: [f64; 3]| loads.map(|load| (load, 0.1)).to_vec();
        assert!(is_held(&samples([21.589, 21.590, 21.591])));
        assert!(!is_held(&samples([20.0, 21.0, 22.0])));
        assert!(is_commanded("wheel[2].speed_command") && !is_commanded("slip") && !is_commanded("time"));
    }
}
