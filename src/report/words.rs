//! Where the model fails, in words computed from the numbers.

use super::kinds::of;
use super::units::{digits, of_column, spoken};
use crate::diagnosis::{Comparison, Failure, FloorSource, NoiseFloor};
use crate::measurement::Experiment;
use std::collections::BTreeMap;

/// An error up to this multiple of the noise floor passes for noise: the floor itself is known to some 10 %.
pub(super) const NOISE_ONLY: f64 = 1.15;

/// A sentence's beginning.
pub(super) fn first_capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// What was done, in one sentence.
pub(super) fn what_was_measured(experiment: &Experiment) -> String {
    let rows: usize = experiment.runs.iter().map(|run| run.data.rows()).sum();
    let what = of(experiment).what();
    let sets = experiment.replicates();
    let repeats = if sets.is_empty() {
        "nothing was repeated".to_owned()
    } else {
        format!("{} set-points were repeated", sets.len())
    };
    let signals = experiment.signals().iter().map(|s| spoken(s)).collect::<Vec<_>>().join(", ");
    let runs = match experiment.runs.len() {
        1 => "1 run".to_owned(),
        n => format!("{n} runs"),
    };
    format!("{what}: {runs}, {rows} rows; measured: {signals}; {repeats}.")
}

/// The sentences of the first screen: how large the error is against the noise, and where it is worst.
pub(super) fn summary(comparison: &Comparison) -> Vec<String> {
    let fit = comparison.fit();
    let model = if comparison.calibrated.is_some() { "the calibrated model" } else { "the model as given" };
    let mut above = Vec::new();
    let mut unknown = Vec::new();
    for (signal, rmse) in &fit.rmse {
        match comparison.noise_floor.get(signal).and_then(|floor| floor.value()) {
            Some(noise) if *rmse > NOISE_ONLY * noise => {
                above.push(format!("{} {} times", spoken(signal), digits(rmse / noise)))
            }
            Some(_) => {}
            None => unknown.push(spoken(signal)),
        }
    }
    let mut sentences = Vec::new();
    if !above.is_empty() {
        sentences.push(format!("The error of {model} is above the noise: {}.", above.join(", ")));
        sentences.extend(comparison.failures.first().map(sentence));
    } else if unknown.is_empty() {
        sentences.push(format!("The error of {model} is within the noise in every signal."));
    }
    if !unknown.is_empty() {
        let names = unknown.join(", ");
        sentences.push(format!("Floor unknown for {names}: nothing was repeated and no noise is stated, so this page cannot say how much of that error is noise."));
    }
    let bound: Vec<&str> = comparison
        .calibrated
        .iter()
        .flat_map(|(calibration, _)| &calibration.parameters)
        .filter(|parameter| parameter.at_bound && !parameter.is_off())
        .map(|parameter| parameter.variable.name.as_str())
        .collect();
    if !bound.is_empty() {
        let names = bound.join(", ");
        sentences.push(format!("On a bound after calibration: {names}. A fit that wants to go further than any published soil may be hiding a missing effect."));
    }
    sentences
}

/// One failure as a sentence.
pub(super) fn sentence(failure: &Failure) -> String {
    let (signal, condition) = (of_column(&failure.signal), of_column(&failure.condition));
    let level = &failure.level;
    let (low, high) = (condition.plain(level.low), condition.plain(level.high));
    let place = if low == high { low } else { format!("{low} to {high}") };
    let side = if level.mean > 0.0 { "above" } else { "below" };
    let mean = signal.number(level.mean.abs());
    let times =
        failure.ratio().map_or_else(String::new, |ratio| format!(", {} times the noise of one sample", digits(ratio)));
    format!(
        "At {} {place} the measured {} lies {mean} {side} the model on average over {} samples{times}.",
        spoken(&failure.condition),
        spoken(&failure.signal),
        level.samples
    )
}

/// The noise floor's source for the table.
pub(super) fn source(floors: &BTreeMap<String, NoiseFloor>, signal: &str) -> String {
    let Some(floor) = floors.get(signal) else { return String::new() };
    match (floor.source(), floor.replicates) {
        (FloorSource::Replicates, Some(pooled)) => format!("repeats ({} d.o.f.)", pooled.degrees_of_freedom),
        (FloorSource::Stated, Some(pooled)) => {
            format!("stated; repeats show {}", of_column(signal).number(pooled.deviation))
        }
        (source, _) => source.name().to_owned(),
    }
}
