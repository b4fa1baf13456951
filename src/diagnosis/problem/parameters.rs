//! Which parameters a calibration moves, and which effects may be added.

use super::Candidate;
use crate::diagnosis::bounds::believable;
use crate::diagnosis::free::Free;
use crate::diagnosis::prior_rows::JointPrior;
use crate::measurement::{Experiment, Prior};
use crate::model::Model;
use crate::soil_class::SoilClass;
use bekker_modeldescription::{Lookup, Role, Variable};
use std::collections::{BTreeMap, BTreeSet};

/// Priors of the soil's class for what is not known otherwise; none where the experiment names no class.
pub(in crate::diagnosis) fn class_priors(experiment: &Experiment, held: &BTreeSet<String>) -> BTreeMap<String, Prior> {
    let class = experiment.soil_class.as_deref().and_then(SoilClass::find);
    let all = class.iter().flat_map(|class| class.priors);
    let open = all.filter(|(name, ..)| !held.contains(*name) && !experiment.priors.contains_key(*name));
    open.map(|(name, mean, deviation)| ((*name).to_owned(), Prior { mean: *mean, deviation: *deviation })).collect()
}

/// What a default calibration moves: parameters with the role that are not held, and all that have a prior. At a single
/// wheel width k_c and k_phi act as one, and k_c stays.
pub(super) fn base_parameters(
    model: &mut Model,
    experiment: &Experiment,
    held: &BTreeSet<String>,
    priors: &BTreeMap<String, Prior>,
    joint: Option<&JointPrior>,
    many_widths: bool,
) -> Vec<Free> {
    let is_free = |name: &str, role: Role| {
        priors.contains_key(name)
            || joint.is_some_and(|joint| joint.of(name).is_some())
            || (role == Role::Calibrated && !held.contains(name) && (name != "soil.k_c" || many_widths))
    };
    let class = experiment.soil_class.as_deref().and_then(SoilClass::find);
    let chosen = model.list().into_iter().filter(|(variable, _)| is_free(&variable.name, variable.role));
    chosen
        .map(|(mut variable, start)| {
            let prior = priors.get(&variable.name).copied();
            let shared = joint.and_then(|joint| joint.of(&variable.name));
            if let Some((mut low, mut high)) = believable(&variable.name) {
                // What the experiment or a model states stays reachable, and so does all that the soil's class allows.
                for value in [start, prior.or(shared).map_or(start, |prior| prior.mean)] {
                    (low, high) = (low.min(value), high.max(value));
                }
                if let Some(allowed) = class.and_then(|class| class.allows(&variable.name)) {
                    (low, high) = (low.min(*allowed.start()), high.max(*allowed.end()));
                }
                variable.min = variable.min.max(low);
                variable.max = variable.max.min(high);
            }
            Free { prior, shared, within: None, variable, start }
        })
        .collect()
}

/// Effects of the vocabulary whose parameters are neither held nor free already.
pub(super) fn library(model: &mut Model, held: &BTreeSet<String>, base: &[Free]) -> Vec<Candidate> {
    let mut library: Vec<Candidate> = Vec::new();
    for (variable, value) in model.list() {
        let known = held.contains(&variable.name) || base.iter().any(|free| free.variable.name == variable.name);
        if variable.role != Role::Effect || known {
            continue;
        }
        let id = effect_id(&variable).to_owned();
        let free = Free { variable, start: value, prior: None, shared: None, within: None };
        match library.iter_mut().find(|candidate| candidate.id == id) {
            Some(candidate) => candidate.free.push(free),
            None => library.push(Candidate { id, free: vec![free] }),
        }
    }
    library
}

/// The effect that a parameter belongs to: what stands before the dot.
fn effect_id(variable: &Variable) -> &str {
    variable.name.split('.').next().unwrap_or_default()
}
