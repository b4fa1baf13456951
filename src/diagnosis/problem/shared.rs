//! What several experiments know of the one soil on which they were made: each is posed with what all of them know.

use crate::diagnosis::compare::CompareError;
use crate::diagnosis::given::Given;
use crate::diagnosis::kinds::strategy;
use crate::measurement::{Experiment, Part, Prior};
use std::collections::BTreeMap;

/// Whether experiments on one soil share a parameter.
pub(super) fn is_shared(name: &str) -> bool {
    name.starts_with("soil.")
}

/// Shared knowledge.
pub(super) struct Shared {
    /// Values that a part states, with the name of the first that does.
    stated: BTreeMap<String, (f64, String)>,
    /// The parts' own priors, each different one once, taken together.
    priors: BTreeMap<String, Prior>,
    class: Option<String>,
}

impl Shared {
    /// # Errors
    /// [`CompareError::Vehicle`] where parts contradict each other.
    pub fn of(given: &Given, parts: &[Part]) -> Result<Self, CompareError> {
        same_effects(parts)?;
        Ok(Self { stated: stated(given, parts)?, priors: priors(parts), class: class(parts)? })
    }

    /// A part's experiment with all that is known of the soil.
    pub fn known_in(&self, part: &Part) -> Experiment {
        let mut experiment = part.experiment.clone();
        for (name, (value, _)) in &self.stated {
            experiment.parameters.entry(name.clone()).or_insert(*value);
        }
        experiment.priors.extend(self.priors.iter().map(|(name, prior)| (name.clone(), *prior)));
        experiment.soil_class.clone_from(&self.class);
        experiment
    }

    /// Lines on values that one part states and that hold in others, which would have fitted them.
    pub fn lines(&self, parts: &[Part]) -> Vec<String> {
        let line = |(name, (value, place)): (&String, &(f64, String))| {
            let fits = |part: &&Part| {
                !part.experiment.parameters.contains_key(name) && strategy(&part.experiment).calibrates(name)
            };
            let others: Vec<&str> = parts.iter().filter(fits).map(|part| part.name.as_str()).collect();
            let held = !others.is_empty() && !self.priors.contains_key(name);
            held.then(|| format!("{name}: {value}, which {place} states, holds in {} too", others.join(", ")))
        };
        self.stated.iter().filter_map(line).collect()
    }
}

/// Values of the soil in the parts' `[parameters]`; two may differ only where what is set by hand decides.
fn stated(given: &Given, parts: &[Part]) -> Result<BTreeMap<String, (f64, String)>, CompareError> {
    let mut all: BTreeMap<String, (f64, String)> = BTreeMap::new();
    for part in parts {
        for (name, value) in part.experiment.parameters.iter().filter(|(name, _)| is_shared(name)) {
            match all.get(name) {
                Some((other, place)) if other != value && !given.values().contains_key(name) => {
                    return Err(CompareError::Vehicle(format!(
                        "{name} is {other} in {place} and {value} in {}: experiments that are fitted together share one soil; state it once, set it by hand, or leave it free and give it a prior",
                        part.name
                    )));
                }
                Some(_) => {}
                None => drop(all.insert(name.clone(), (*value, part.name.clone()))),
            }
        }
    }
    Ok(all)
}

/// Products of the different priors that parts have of one parameter of the soil.
fn priors(parts: &[Part]) -> BTreeMap<String, Prior> {
    let mut own: BTreeMap<String, Vec<Prior>> = BTreeMap::new();
    for (name, prior) in parts.iter().flat_map(|part| &part.experiment.priors).filter(|(name, _)| is_shared(name)) {
        let known = own.entry(name.clone()).or_default();
        if !known.contains(prior) {
            known.push(*prior);
        }
    }
    own.into_iter().map(|(name, priors)| (name, together(&priors))).collect()
}

fn together(priors: &[Prior]) -> Prior {
    if let [one] = priors {
        return *one;
    }
    let weight = |prior: &Prior| 1.0 / (prior.deviation * prior.deviation);
    let whole: f64 = priors.iter().map(weight).sum();
    let mean = priors.iter().map(|prior| weight(prior) * prior.mean).sum::<f64>() / whole;
    Prior { mean, deviation: 1.0 / whole.sqrt() }
}

/// The class of the soil that parts name.
fn class(parts: &[Part]) -> Result<Option<String>, CompareError> {
    let mut classes = parts.iter().filter_map(|part| Some((part.experiment.soil_class.as_ref()?, &part.name)));
    let Some((first, place)) = classes.next() else { return Ok(None) };
    match classes.find(|(class, _)| *class != first) {
        None => Ok(Some(first.clone())),
        Some((other, name)) => Err(CompareError::Vehicle(format!(
            "the soil's class is {first} in {place} and {other} in {name}: experiments that are fitted together share one soil"
        ))),
    }
}

/// Fails where two parts define an effect of one name differently.
fn same_effects(parts: &[Part]) -> Result<(), CompareError> {
    for (k, part) in parts.iter().enumerate() {
        for effect in &part.experiment.effects {
            for other in &parts[..k] {
                if other.experiment.effects.iter().any(|own| own.id == effect.id && own != effect) {
                    return Err(CompareError::Vehicle(format!(
                        "the effect `{}` is defined differently in {} and {}: give one of them another name",
                        effect.id, other.name, part.name
                    )));
                }
            }
        }
    }
    Ok(())
}
