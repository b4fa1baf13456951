//! What several experiments know of the soil, the vehicle and the drive that they share: each is posed with what all of them know.

use super::sharing::Sharing;
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::given::Given;
use crate::diagnosis::kinds::strategy;
use crate::measurement::{Experiment, Kind, Part, Prior, Share};
use std::collections::BTreeMap;

/// Shared knowledge, and who shares what.
pub(super) struct Shared {
    pub sharing: Sharing,
    /// By part: values that it does not state and another does with which it shares the parameter, with the name of the first that does.
    stated: Vec<BTreeMap<String, (f64, String)>>,
    /// By part: the priors of what is shared, each different one once, taken together.
    priors: Vec<BTreeMap<String, Prior>>,
    classes: Vec<Option<String>>,
}

impl Shared {
    /// # Errors
    /// [`CompareError::Vehicle`] where parts contradict each other.
    pub fn of(given: &Given, parts: &[Part]) -> Result<Self, CompareError> {
        same_effects(parts)?;
        let sharing = Sharing::of(given, parts)?;
        agree(&sharing, given, parts)?;
        let each = || 0..parts.len();
        Ok(Self {
            stated: each().map(|k| stated_elsewhere(&sharing, parts, k)).collect(),
            priors: each().map(|k| priors(&sharing, parts, k)).collect(),
            classes: each().map(|k| class(&sharing, parts, k)).collect::<Result<_, _>>()?,
            sharing,
        })
    }

    /// The experiment of part `k` with all that is known of what it shares.
    pub fn known_in(&self, k: usize, part: &Part) -> Experiment {
        let mut experiment = part.experiment.clone();
        experiment.parameters.extend(self.stated[k].iter().map(|(name, (value, _))| (name.clone(), *value)));
        experiment.priors.extend(self.priors[k].iter().map(|(name, prior)| (name.clone(), *prior)));
        experiment.soil_class.clone_from(&self.classes[k]);
        experiment
    }

    /// Lines on values that one part states and that hold in others, which would have fitted them.
    pub fn lines(&self, parts: &[Part]) -> Vec<String> {
        let mut held: BTreeMap<(&String, String), Vec<&str>> = BTreeMap::new();
        for (k, part) in parts.iter().enumerate() {
            let fits = |name: &str| strategy(&part.experiment).calibrates(name) && !self.priors[k].contains_key(name);
            for (name, (value, place)) in self.stated[k].iter().filter(|(name, _)| fits(name)) {
                let line = format!("{name}: {value}, which {place} states, holds in");
                held.entry((name, line)).or_default().push(&part.name);
            }
        }
        held.into_iter().map(|((_, line), parts)| format!("{line} {} too", parts.join(", "))).collect()
    }
}

/// Fails where two parts state different values of what they share, unless what is set by hand decides.
fn agree(sharing: &Sharing, given: &Given, parts: &[Part]) -> Result<(), CompareError> {
    for (k, part) in parts.iter().enumerate() {
        let open = |name: &&String| !given.values().contains_key(*name);
        for (name, value) in part.experiment.parameters.iter().filter(|(name, _)| open(name)) {
            for j in sharing.with(name, k).into_iter().filter(|j| *j < k) {
                let Some(other) = parts[j].experiment.parameters.get(name).filter(|other| *other != value) else {
                    continue;
                };
                let share = Share::of(name).map_or("parameter", Share::name);
                return Err(CompareError::Vehicle(format!(
                    "{name} is {other} in {} and {value} in {}, which share one {share}: state it once, set it by hand, or leave it free and give it a prior",
                    parts[j].name, part.name
                )));
            }
        }
    }
    Ok(())
}

/// Values that part `k` does not state and another does with which it shares the parameter.
fn stated_elsewhere(sharing: &Sharing, parts: &[Part], k: usize) -> BTreeMap<String, (f64, String)> {
    let own = &parts[k].experiment;
    let mut all: BTreeMap<String, (f64, String)> = BTreeMap::new();
    for (j, part) in parts.iter().enumerate() {
        for (name, value) in &part.experiment.parameters {
            if !own.parameters.contains_key(name) && has(own, name) && sharing.with(name, k).contains(&j) {
                all.entry(name.clone()).or_insert_with(|| (*value, part.name.clone()));
            }
        }
    }
    all
}

/// Whether the model of an experiment has a shared parameter: a test of the soil has no vehicle.
fn has(experiment: &Experiment, name: &str) -> bool {
    matches!(experiment.kind, Kind::SingleWheel | Kind::Traverse) || Share::of(name) == Some(Share::Soil)
}

/// Products of the different priors that parts have of one parameter that they share with part `k`.
fn priors(sharing: &Sharing, parts: &[Part], k: usize) -> BTreeMap<String, Prior> {
    let mut all: BTreeMap<String, Vec<Prior>> = BTreeMap::new();
    for (j, part) in parts.iter().enumerate() {
        let shared = |name: &str| has(&parts[k].experiment, name) && sharing.with(name, k).contains(&j);
        for (name, prior) in part.experiment.priors.iter().filter(|(name, _)| shared(name)) {
            let known = all.entry(name.clone()).or_default();
            if !known.contains(prior) {
                known.push(*prior);
            }
        }
    }
    all.into_iter().map(|(name, priors)| (name, together(&priors))).collect()
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

/// The class of the soil that parts on the soil of part `k` name.
fn class(sharing: &Sharing, parts: &[Part], k: usize) -> Result<Option<String>, CompareError> {
    let on_it = sharing.with("soil.", k).into_iter().map(|j| &parts[j]);
    let mut classes = on_it.filter_map(|part| Some((part.experiment.soil_class.as_ref()?, &part.name)));
    let Some((first, place)) = classes.next() else { return Ok(None) };
    match classes.find(|(class, _)| *class != first) {
        None => Ok(Some(first.clone())),
        Some((other, name)) => Err(CompareError::Vehicle(format!(
            "the soil's class is {first} in {place} and {other} in {name}, which share one soil"
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
