//! Parts of a result whose JSON differs from their form in memory.

use super::result::ParameterResult;
use crate::diagnosis::noise::NoiseFloor;
use crate::diagnosis::problem::plain_effect;
use crate::measurement::Experiment;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// An experiment as its name.
pub(super) fn name_of<S: Serializer>(experiment: &Experiment, to: S) -> Result<S::Ok, S::Error> {
    experiment.name.serialize(to)
}

/// Effects without where they act, each once.
pub(super) fn plain<S: Serializer>(effects: &[String], to: S) -> Result<S::Ok, S::Error> {
    let mut plain: Vec<&str> = Vec::new();
    for id in effects.iter().map(|id| plain_effect(id)) {
        if !plain.contains(&id) {
            plain.push(id);
        }
    }
    plain.serialize(to)
}

/// Noise floors as the standard deviation of one sample; null where it is unknown.
pub(super) fn deviations<S: Serializer>(floors: &BTreeMap<String, NoiseFloor>, to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(floors.iter().map(|(signal, floor)| (signal, floor.value())))
}

/// A fitted parameter beside its name.
#[derive(Serialize)]
struct Parameter {
    value: f64,
    std: Option<f64>,
    at_bound: bool,
    unit: &'static str,
    bounds: [f64; 2],
    prior_shift: Option<f64>,
    effect: bool,
}

/// Parameters by their names.
pub(super) fn by_name<S: Serializer>(all: &[ParameterResult], to: S) -> Result<S::Ok, S::Error> {
    let one = |ParameterResult { fitted, effect }: &ParameterResult| Parameter {
        value: fitted.value,
        std: fitted.deviation,
        at_bound: fitted.at_bound,
        unit: fitted.variable.unit.symbol,
        bounds: [fitted.variable.min, fitted.variable.max],
        prior_shift: fitted.prior_shift(),
        effect: *effect,
    };
    to.collect_map(all.iter().map(|parameter| (&parameter.fitted.variable.name, one(parameter))))
}
