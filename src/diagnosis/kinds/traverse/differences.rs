//! Differences between windows, and between whole runs with feedback loops, that go side by side.

use super::prediction::TraversePrediction;
use super::slopes::Traces;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::recorded::{Recorded, Variant, traced};
use crate::model::Model;
use bekker_modeldescription::{Parameters, Role, Variable};

/// Forward differences, where a run is cut into windows, over this share of a parameter's range or value, whichever is smaller, but no
/// less than [`LEAST_DIFFERENCE`] of the range: rounding of a window, about 1e-12, and the curvature over the difference both stay near
/// 1e-6 of a derivative.
const SMALL_DIFFERENCE: f64 = 1e-6;
const LEAST_DIFFERENCE: f64 = 1e-9;
/// The same for the place (m) and the velocity (m/s) in which a window begins.
pub(super) const SHIFT: f64 = 1e-6;

/// Central differences, where there is a feedback loop, at both sides of a value over this share of a parameter's range or value, whichever is
/// smaller: the error of the integrator, about 1e-9, divided by it stays under 1e-4.
const DIFFERENCE: f64 = 1e-4;

/// A parameter whose derivatives are differences between windows side by side, and the two values between which these are taken: of
/// windows the first is the parameter's own value, of runs with feedback loops the two lie around it.
pub(super) struct Change {
    pub parameter: usize,
    pub from: f64,
    pub to: f64,
}

pub(super) type Changes = Vec<Change>;

impl TraversePrediction<'_> {
    /// Between which values of each free parameter its difference is, run by run; `None` for a run whose windows do not go side by side.
    pub(super) fn changes(&self, free: &[f64]) -> Result<Vec<Option<Changes>>, PredictionError> {
        let of_run = |run: &Recorded| {
            let variant = Variant::new(run, self.model(run, free)?);
            if !variant.is_separable() {
                return Ok(None);
            }
            let of = |k: &usize| {
                let (variable, value) = (&self.free[*k].variable, free[*k]);
                let (from, to) = match variant.is_looped() {
                    true => around(variable, value),
                    false => (value, value + difference(variable, value)),
                };
                Change { parameter: *k, from, to }
            };
            // Exact derivatives are not there in a loop.
            let exact = |k: usize| {
                let variable = &self.free[k].variable;
                !variant.is_looped() && is_neutral(variable, free[k]) && !is_smooth(&variant.model, &variable.name)
            };
            Ok(Some(run.felt.iter().filter(|k| !exact(**k)).map(of).collect()))
        };
        self.runs.iter().map(of_run).collect()
    }

    /// Values and derivatives by `changes`, run by run.
    pub(super) fn side_by_side(
        &self,
        free: &[f64],
        changes: &[Option<Changes>],
    ) -> Result<Vec<Option<Traces>>, PredictionError> {
        let mut variants = Vec::new();
        for (run, changes) in self.runs.iter().zip(changes) {
            let Some(changes) = changes else { continue };
            variants.push(Variant::new(run, self.model(run, free)?));
            for Change { parameter, from, to } in changes {
                let ends = [*from, *to].into_iter().filter(|value| *value != free[*parameter]);
                for value in ends {
                    let mut changed = free.to_vec();
                    changed[*parameter] = value;
                    variants.push(Variant::new(run, self.model(run, &changed)?));
                }
            }
        }
        let mut all = traced(&variants, self.halt).into_iter();
        let mut of_run = |(run, changes): (&Recorded, &Option<Changes>)| {
            let Some(changes) = changes else { return Ok(None) };
            let own = all.next().unwrap_or(Err(PredictionError::Interrupted))?;
            let mut slopes = Vec::new();
            for Change { parameter, from, to } in changes {
                let mut at = |value: f64| match value == free[*parameter] {
                    true => Ok(None),
                    false => all.next().unwrap_or(Err(PredictionError::Interrupted)).map(Some),
                };
                let (low, high) = (at(*from)?, at(*to)?);
                slopes.push(run.slope(low.as_ref().unwrap_or(&own), high.as_ref().unwrap_or(&own), to - from));
            }
            Ok(Some(Traces { values: own.values, slopes, ended: own.ended }))
        };
        self.runs.iter().zip(changes).map(&mut of_run).collect()
    }
}

/// Whether a parameter is one of an effect and at its neutral value.
fn is_neutral(variable: &Variable, value: f64) -> bool {
    variable.role == Role::Effect && value == variable.default
}

/// Whether a difference gives the derivative in an effect's parameter at its neutral value: the effect acts by another one of its parameters, and
/// lists this one as smooth there.
fn is_smooth(model: &Model, name: &str) -> bool {
    let Some((id, own)) = name.split_once('.') else { return false };
    if !model.facts_of(id).is_some_and(|facts| facts.smooth_at_neutral.contains(&own)) {
        return false;
    }
    let mut acts = false;
    model.rover.effects.clone().visit("", &mut |variable, value| {
        let of_effect = variable.name.split_once('.').is_some_and(|(other, _)| other == id);
        acts |= of_effect && !is_neutral(&variable, *value);
    });
    acts
}

/// By how much a parameter is changed for a difference: within its bounds.
fn difference(variable: &Variable, value: f64) -> f64 {
    let range = variable.max - variable.min;
    let own = if value == 0.0 { f64::INFINITY } else { SMALL_DIFFERENCE * value.abs() };
    let step = own.clamp(LEAST_DIFFERENCE * range, SMALL_DIFFERENCE * range);
    if value + step > variable.max { -step } else { step }
}

/// The values at both sides of one for a central difference, within the bounds.
fn around(variable: &Variable, value: f64) -> (f64, f64) {
    let range = DIFFERENCE * (variable.max - variable.min);
    let step = if value == 0.0 { range } else { range.min(DIFFERENCE * value.abs()) };
    ((value - step).max(variable.min), (value + step).min(variable.max))
}
