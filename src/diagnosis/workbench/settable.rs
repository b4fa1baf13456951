//! What a trial may set.

use super::{Values, Workbench};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::free::Free;
use crate::diagnosis::problem::{Problem, name_in_part, plain_effect};
use crate::measurement::Prior;
use bekker_modeldescription::{Lookup, ParameterError, Role, Variable};
use std::collections::BTreeMap;

/// Share of the way from neutral to the farther bound at which an effect shows, where the effect itself names no such value.
const USUAL_STRENGTH: f64 = 0.25;

/// A parameter that a trial may set.
#[derive(Clone, Debug, PartialEq)]
pub struct Adjustable {
    /// Name, unit and meaning; the bounds are those of a calibration.
    pub variable: Variable,
    /// Its value in the model as given.
    pub start: f64,
    /// What a separate test says of it.
    pub prior: Option<Prior>,
    /// The effect that it belongs to; `None` where a calibration of the baseline moves it.
    pub effect: Option<String>,
    /// A value at which the effect shows; `start` for others.
    pub typical: f64,
    /// Of several experiments on one soil the numbers of those in which it acts; `None` where it acts in all.
    pub parts: Option<Vec<usize>>,
}

/// Everything that a trial may set: it is the same for every trial.
#[derive(Clone, Debug)]
pub(super) struct Settable {
    /// What a calibration moves, then the parameters of the effects that may be added.
    pub movable: Vec<Adjustable>,
    /// What no calibration moves.
    pub known: Vec<Adjustable>,
    /// Of several experiments: how each of `known` is called in those in which it is.
    names_in_parts: BTreeMap<String, String>,
}

impl Settable {
    pub fn of(problem: &Problem) -> Self {
        let base = problem.base.iter().map(|free| adjustable(free, None, free.start));
        let effects = problem.library.iter().flat_map(|candidate| {
            let of_effect = |free| adjustable(free, Some(candidate.id.clone()), typical(problem, &candidate.id, free));
            candidate.free.iter().map(of_effect)
        });
        let movable: Vec<Adjustable> = base.chain(effects).collect();
        let known = known(problem, &movable);
        Self { movable, known, names_in_parts: BTreeMap::new() }
    }

    /// Of several experiments, with what is known in each of them.
    pub fn of_parts(problem: &Problem, parts: &[Workbench]) -> Self {
        let mut all = Self::of(problem);
        for (k, (part, bench)) in problem.experiment.parts.iter().zip(parts).enumerate() {
            for own in &bench.settable.known {
                let name = name_in_part(&own.variable.name, part);
                if all.is_movable(&name) {
                    continue;
                }
                if let Some(known) = all.known.iter_mut().find(|known| known.variable.name == name) {
                    known.parts.iter_mut().for_each(|parts| parts.push(k));
                    continue;
                }
                let variable = Variable { name: name.clone(), ..own.variable.clone() };
                all.known.push(Adjustable { variable, parts: Some(vec![k]), ..own.clone() });
                let _ = all.names_in_parts.insert(name, own.variable.name.clone());
            }
        }
        all
    }

    /// Where a known parameter of several experiments is, and how it is called there.
    pub fn places(&self, name: &str) -> Option<(&[usize], &str)> {
        let known = self.known.iter().find(|own| own.variable.name == name)?;
        Some((known.parts.as_deref()?, self.names_in_parts.get(name)?))
    }

    /// Whether a calibration moves it, or it belongs to an effect that may be added.
    pub fn is_movable(&self, name: &str) -> bool {
        self.movable.iter().any(|own| own.variable.name == name)
    }

    /// Whether a trial may set it.
    pub fn has(&self, name: &str) -> bool {
        self.is_movable(name) || self.known.iter().any(|own| own.variable.name == name)
    }

    /// Refuses names and values that a trial may not have.
    pub fn check(&self, problem: &Problem, values: &Values) -> Result<(), CompareError> {
        let place = || "trial".to_owned();
        for (name, value) in values {
            let mut all = self.movable.iter().chain(&self.known);
            let Some(parameter) = all.find(|parameter| parameter.variable.name == *name) else {
                let source = problem.known.clone().unknown(name);
                return Err(CompareError::Parameter { place: place(), source });
            };
            if !parameter.variable.allows(*value) {
                let range = parameter.variable.range();
                let source = ParameterError::OutOfRange { name: name.clone(), value: *value, range };
                return Err(CompareError::Parameter { place: place(), source });
            }
        }
        Ok(())
    }
}

fn adjustable(free: &Free, effect: Option<String>, typical: f64) -> Adjustable {
    Adjustable {
        variable: free.variable.clone(),
        start: free.start,
        prior: free.prior.or(free.shared),
        effect,
        typical,
        parts: free.within.as_ref().map(|within| within.parts.clone()),
    }
}

/// Parameters that are taken as known, since no calibration of this experiment moves them.
fn known(problem: &Problem, movable: &[Adjustable]) -> Vec<Adjustable> {
    let is_known = |variable: &Variable| {
        matches!(variable.role, Role::Fixed | Role::Rig | Role::Calibrated)
            && variable.min < variable.max
            && movable.iter().all(|own| own.variable.name != variable.name)
    };
    let all = problem.strategy().parameters(&problem.known).into_iter();
    let adjustable =
        |(variable, start)| Adjustable { variable, start, prior: None, effect: None, typical: start, parts: None };
    all.filter(|(variable, _)| is_known(variable)).map(adjustable).collect()
}

/// A value at which an effect shows.
pub(super) fn typical(problem: &Problem, id: &str, free: &Free) -> f64 {
    let plain = plain_effect(id);
    let name = free.within.as_ref().map_or(&free.variable.name, |within| &within.name);
    let own = problem.known.facts_of(plain).and_then(|facts| {
        let named = |(field, _): &&(&str, f64)| *name == format!("{plain}.{field}");
        facts.typical.iter().find(named).map(|(_, value)| *value)
    });
    let usual = own.unwrap_or_else(|| free.start + USUAL_STRENGTH * free.span());
    usual.clamp(free.variable.min, free.variable.max)
}
