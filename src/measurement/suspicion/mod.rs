//! Signs, units and sizes that cannot be right, or hardly, by the physics.
//!
//! What cannot be right is an error. What is unlikely is a doubt: the experiment is read as it is, and
//! [`Experiment::doubts`] says what may be mistaken and which line would mend it.

pub(super) mod single_wheel;
pub(super) mod traverse;

use super::columns::mend_sign;
use super::doubts::Doubts;
use super::error::{ExperimentError, Problem};
use super::experiment::{Experiment, Kind, Prior};
use super::grid::Grid;
use super::vocabulary;
use crate::effects::EffectDefinition;
use bekker_modeldescription::{Unit, Variable};

/// Sinkages above the ground by less than this, m, may be a sensor's zero; rows that are needed to say all.
const ZERO_OF_SINKAGE: f64 = 5e-4;
const ALL_ROWS: usize = 3;

/// Smallest positive cohesion, Pa, and modulus, N/m^(n+2), that are believed without a word: published soils have at
/// least 100 Pa where they have any, and 1e4; a tenth of the first, and less of the second, is a value in kPa or kN.
const LEAST_COHESION: f64 = 10.0;
const LEAST_MODULUS: f64 = 1e4;

/// Looks at the rows of one run; `radius` and `width` of the wheel (m) are `None` where the experiment does not state them.
pub(super) fn look(
    kind: Kind,
    grid: &Grid,
    radius: Option<f64>,
    width: Option<f64>,
    doubts: &mut Doubts,
) -> Result<(), ExperimentError> {
    let found = kind.format().look(grid, radius, width)?;
    found.into_iter().for_each(|doubt| doubts.add(&grid.file, doubt));
    Ok(())
}

/// Fails where a wheel is said to stand above the ground in every row.
pub(super) fn sinkage(grid: &Grid, name: &str) -> Result<(), ExperimentError> {
    let Some(column) = grid.column(name) else { return Ok(()) };
    let present: Vec<f64> = present(&column.values).collect();
    let all_negative = present.len() >= ALL_ROWS && present.iter().all(|value| *value < 0.0);
    if all_negative && median(&present) < -ZERO_OF_SINKAGE {
        let problem = Problem::Suspicious(format!(
            "all values are negative; a sinkage is positive downward: write under [columns]: {}",
            mend_sign(&column.source, name)
        ));
        return Err(grid.error(problem).at_column(&column.source));
    }
    Ok(())
}

/// Fails where a soil test is recorded upward or backward: all values of what presses or shears the soil are negative.
pub(super) fn downward(grid: &Grid, names: &[&str]) -> Result<(), ExperimentError> {
    for column in names.iter().filter_map(|name| grid.column(name)) {
        let values: Vec<f64> = present(&column.values).collect();
        if values.len() >= ALL_ROWS && median(&values) < 0.0 && values.iter().all(|value| *value <= 0.0) {
            let problem = Problem::Suspicious(format!(
                "no value is positive; what presses or shears the soil counts positive: write under [columns]: {}",
                mend_sign(&column.source, &column.name)
            ));
            return Err(grid.error(problem).at_column(&column.source));
        }
    }
    Ok(())
}

/// Fails where a parameter's value lies outside what the model allows, with the unit that would bring it inside. Unknown
/// parameters are left to the model.
pub(super) fn parameter(name: &str, value: f64, effects: &[EffectDefinition]) -> Result<(), String> {
    let Ok(variable) = vocabulary::parameter(name, effects) else { return Ok(()) };
    if variable.allows(value) {
        return Ok(());
    }
    let mend = likely_unit(&variable, value).map_or_else(String::new, |unit| {
        format!("; if it is in {unit}, write {{ value = {value}, unit = \"{unit}\" }}")
    });
    Err(format!("{value} {} cannot be right: expected {}{mend}", variable.unit.symbol, variable.range()))
}

/// The same for the mean of a prior.
pub(super) fn prior(name: &str, prior: Prior, effects: &[EffectDefinition]) -> Result<(), String> {
    let Ok(variable) = vocabulary::parameter(name, effects) else { return Ok(()) };
    if variable.allows(prior.mean) {
        return Ok(());
    }
    let (unit, range) = (variable.unit.symbol, variable.range());
    Err(format!(
        "a mean of {} {unit} cannot be right: expected {range}{}",
        prior.mean,
        mend_prior(&variable, prior, prior.mean)
    ))
}

/// Doubts a deviation that is wider than all that the model allows: it says nothing, or is in another unit.
fn wide(name: &str, prior: Prior, effects: &[EffectDefinition]) -> Option<String> {
    let variable = vocabulary::parameter(name, effects).ok()?;
    let deviation = prior.deviation;
    (deviation > variable.max - variable.min).then(|| {
        let mend = mend_prior(&variable, prior, deviation);
        format!(
            "priors: the standard deviation {deviation} {} of `{name}` is wider than its range {}{mend}",
            variable.unit.symbol,
            variable.range()
        )
    })
}

/// The prior in the unit in which `value`, its mean or its deviation, would be within the bounds.
fn mend_prior(variable: &Variable, Prior { mean, deviation }: Prior, value: f64) -> String {
    likely_unit(variable, value).map_or_else(String::new, |unit| {
        format!("; if it is in {unit}, write {{ mean = {mean}, sd = {deviation}, unit = \"{unit}\" }}")
    })
}

/// The first of the other units in which the value lies within the bounds.
fn likely_unit(variable: &Variable, value: f64) -> Option<&'static str> {
    let inside =
        |symbol: &&'static str| variable.unit.factor_of(symbol).is_ok_and(|factor| variable.allows(value * factor));
    variable.unit.symbols().into_iter().skip(1).find(inside)
}

/// Doubts about parameters and priors.
pub(super) fn of_parameters(experiment: &Experiment) -> Vec<String> {
    let stated = experiment.parameters.iter().map(|(name, value)| (name, *value, "parameters"));
    let runs = experiment.runs.iter().flat_map(|run| &run.parameters);
    let own = runs.map(|(name, value)| (name, *value, "parameters of a run"));
    let priors = experiment.priors.iter().map(|(name, prior)| (name, prior.mean, "priors"));
    let too_wide = |(name, prior): (&String, &Prior)| wide(name, *prior, &experiment.effects);
    let mut doubts: Vec<String> = experiment.priors.iter().filter_map(too_wide).collect();
    for (name, value, table) in stated.chain(own).chain(priors) {
        let (least, unit) = match name.as_str() {
            "soil.cohesion" => (LEAST_COHESION, "kPa"),
            "soil.k_phi" => (LEAST_MODULUS, "kN/m^(n+2)"),
            _ => continue,
        };
        let si = vocabulary::parameter(name, &[]).map_or(Unit::ONE, |variable| variable.unit);
        if value > 0.0 && value < least {
            let key = if table == "priors" { "mean" } else { "value" };
            let doubt = format!(
                "{table}: `{name}` is {value} {}, less than any published soil; in {unit} it would be written {{ {key} = {value}, unit = \"{unit}\" }}",
                si.symbol
            );
            if !doubts.contains(&doubt) {
                doubts.push(doubt);
            }
        }
    }
    doubts
}

/// Values that are there.
fn present(values: &[f64]) -> impl Iterator<Item = f64> + '_ {
    values.iter().copied().filter(|value| !value.is_nan())
}

/// The largest size of the values that are there; `None` where there is none.
fn largest(values: &[f64]) -> Option<f64> {
    present(values).map(f64::abs).reduce(f64::max)
}

/// The value in the middle; 0 of none.
fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

/// The mean; `None` of none.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0_usize), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f64)
}
