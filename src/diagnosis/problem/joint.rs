//! Several experiments on one soil as one problem.
//!
//! Parameters of the soil are shared: one value holds in every part. What a part states of its soil is known in all of them, and what is
//! known beforehand of a shared parameter counts once. All else, the rig, its noise, errors of its sensors, stays with its part. An
//! effect may act in every part that can show it, with one strength, or in one of them only, or in all but one.

use super::placed::Placed;
use super::{Candidate, Problem, add, scatter, set_unchecked};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::free::{Free, Within};
use crate::diagnosis::given::Given;
use crate::diagnosis::halt::Halt;
use crate::diagnosis::kinds::strategy;
use crate::diagnosis::layout::Layout;
use crate::diagnosis::windows::Windows;
use crate::measurement::{Experiment, Part, Prior, SensorError};
use crate::model::Model;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// Between an effect and the part in which it acts.
const IN: &str = " in ";
/// Between an effect and the only part in which it does not act.
const NOT_IN: &str = " not in ";

/// An effect without where it acts.
#[must_use]
pub fn plain_effect(id: &str) -> &str {
    id.split_once(NOT_IN).or_else(|| id.split_once(IN)).map_or(id, |(plain, _)| plain)
}

/// Whether experiments on one soil share a parameter.
fn is_shared(name: &str) -> bool {
    name.starts_with("soil.")
}

impl<'a> Problem<'a> {
    /// The joint problem of `experiment`'s parts.
    pub(super) fn of_parts(given: &Given, experiment: &'a Experiment, added: &[String]) -> Result<Self, CompareError> {
        let stated = stated(&experiment.parts)?;
        one_class(&experiment.parts)?;
        let mut problems = pose(given, experiment, false)?;
        let models: Vec<Model> = problems.iter().flat_map(|problem| problem.models.clone()).collect();
        if strategy(experiment).contact_widths(experiment, &models).len() > 1 {
            problems = pose(given, experiment, true)?;
        }
        for (name, (value, _)) in &stated {
            problems.iter_mut().for_each(|problem| problem.set_known(name, *value));
        }
        let mut base = merged_base(&problems, experiment, &stated)?;
        let parts = experiment.parts.iter().map(|part| part.name.as_str());
        let parts: Vec<(&str, &[Free])> = parts.zip(problems.iter().map(|problem| problem.base.as_slice())).collect();
        let factors = scatter::factors(&base, &parts, given.soil_scatter);
        base.extend(factors);
        let library = add(added, merged_library(&problems, experiment), &mut base)?;
        let named = |(problem, part): (&Problem, &Part)| {
            let name = part.name.clone();
            problem.sources.iter().map(move |line| format!("{name}: {line}")).collect::<Vec<_>>()
        };
        let mut sources: Vec<String> = problems.iter().zip(&experiment.parts).flat_map(named).collect();
        sources.extend(scattered(&base, given.soil_scatter));
        sources.extend(held_lines(&stated, &problems, experiment));
        // Each kind of experiment uses of a known soil what it can tell.
        let joint = problems.iter().filter_map(|problem| problem.joint.clone()).max_by_key(|j| j.soil.parameters.len());
        Ok(Self {
            layout: Layout::new(experiment),
            experiment: Cow::Borrowed(experiment),
            known: problems[0].known.clone(),
            models: problems.iter().flat_map(|problem| problem.models.clone()).collect(),
            steps: Vec::new(),
            own_steps: Vec::new(),
            windows: Windows::new(),
            guided: false,
            halt: Halt::default(),
            joint,
            base,
            library,
            sensitivities: None,
            sources,
            found: problems[0].found,
            set: given.values().clone(),
            parts: problems.into_iter().map(Arc::new).collect(),
        })
    }

    /// Part number `k` with the rows that count, steps and windows of the whole.
    pub fn part_of(&self, k: usize) -> Problem<'_> {
        let (own, experiment) = (&self.parts[k], &self.experiment.parts[k].experiment);
        let runs = self.experiment.runs_of_parts()[k].clone();
        let of_runs = |runs: &Range<usize>| runs.clone().collect::<Vec<_>>();
        Problem {
            layout: self.layout.of_runs(experiment, &of_runs(&runs)),
            experiment: Cow::Borrowed(experiment),
            known: own.known.clone(),
            models: self.models[runs.clone()].to_vec(),
            steps: self.steps.clone(),
            own_steps: self.own_steps.get(runs.clone()).map_or_else(Vec::new, <[f64]>::to_vec),
            windows: self.windows.get(runs).map_or_else(Vec::new, <[_]>::to_vec),
            guided: self.guided,
            halt: self.halt,
            joint: None,
            base: own.base.clone(),
            library: Vec::new(),
            sensitivities: None,
            sources: Vec::new(),
            found: own.found,
            set: self.set.clone(),
            parts: Vec::new(),
        }
    }

    /// The model of each part with fitted values, by the part's name, as [`saved`](Self::saved) keeps it; none of a single experiment.
    pub fn saved_parts(&self, free: &[Free], values: &[f64]) -> Vec<(String, Model)> {
        let saved = |k: usize| {
            let part = self.part_of(k);
            let placed = Placed::of(free, &part, k);
            let values = placed.values(values, free);
            (self.experiment.parts[k].name.clone(), part.saved(&placed.free, &values))
        };
        (0..self.parts.len()).map(saved).collect()
    }

    /// The parts of a joint experiment in which an effect acts, by name; none of a single experiment, in which it acts everywhere.
    pub fn parts_with(&self, id: &str) -> Vec<String> {
        let name = |k: usize| self.experiment.parts[k].name.clone();
        let all = (0..self.parts.len()).map(name);
        let own = self.candidate(id).and_then(|candidate| candidate.free.first()?.within.as_ref());
        own.map_or_else(|| all.collect(), |within| within.parts.iter().map(|k| name(*k)).collect())
    }
}

/// Each part by itself.
fn pose(given: &Given, experiment: &Experiment, other_widths: bool) -> Result<Vec<Problem<'static>>, CompareError> {
    let of = |part: &Part| {
        let problem = Problem::single(given, &part.experiment, &[], other_widths);
        problem.map(Problem::owned).map_err(|error| error.of_part(&part.name))
    };
    experiment.parts.iter().map(of).collect()
}

/// Values of shared parameters that some part states, with the name of that part.
fn stated(parts: &[Part]) -> Result<BTreeMap<String, (f64, String)>, CompareError> {
    let mut all: BTreeMap<String, (f64, String)> = BTreeMap::new();
    for part in parts {
        for (name, value) in part.experiment.parameters.iter().filter(|(name, _)| is_shared(name)) {
            match all.get(name) {
                Some((other, place)) if other != value => {
                    return Err(CompareError::Vehicle(format!(
                        "{name} is {other} in {place} and {value} in {}: experiments that are diagnosed together share one soil; state it once, or leave it free and give it a prior",
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

/// Fails where parts name different classes of soil.
fn one_class(parts: &[Part]) -> Result<(), CompareError> {
    let mut classes = parts.iter().filter_map(|part| Some((part.experiment.soil_class.as_ref()?, &part.name)));
    let Some((first, place)) = classes.next() else { return Ok(()) };
    classes.find(|(class, _)| *class != first).map_or(Ok(()), |(other, name)| {
        Err(CompareError::Vehicle(format!(
            "the soil's class is {first} in {place} and {other} in {name}: experiments that are diagnosed together share one soil"
        )))
    })
}

/// A line on the scatter of the soil that is assumed.
fn scattered(base: &[Free], deviation: f64) -> Option<String> {
    base.iter().any(Free::is_factor).then(|| {
        format!(
            "the soil is taken to differ by {:.0} % from one experiment to the next (standard deviation of k, c and K; a fifth of it of the friction angle): an assumption, which so few experiments do not tell; --soil-scatter changes it, 0 for one bed",
            100.0 * deviation
        )
    })
}

/// Lines on values that a part states and that hold in others, which would have fitted them.
fn held_lines(stated: &BTreeMap<String, (f64, String)>, problems: &[Problem], experiment: &Experiment) -> Vec<String> {
    let line = |(name, (value, place)): (&String, &(f64, String))| {
        let free = |problem: &Problem| problem.base.iter().any(|free| free.variable.name == *name);
        let others = problems.iter().zip(&experiment.parts).filter(|(problem, _)| free(problem));
        let others: Vec<&str> = others.map(|(_, part)| part.name.as_str()).collect();
        (!others.is_empty())
            .then(|| format!("{name}: {value}, which {place} states, holds in {} too", others.join(", ")))
    };
    stated.iter().filter_map(line).collect()
}

/// Free parameters of the calibration: those of the soil once, all others for each part.
fn merged_base(
    problems: &[Problem],
    experiment: &Experiment,
    stated: &BTreeMap<String, (f64, String)>,
) -> Result<Vec<Free>, CompareError> {
    let mut base: Vec<Free> = Vec::new();
    for (k, problem) in problems.iter().enumerate() {
        for free in &problem.base {
            let name = &free.variable.name;
            if !is_shared(name) {
                base.push(within(free, &[k], &format!("{IN}{}", experiment.parts[k].name)));
            } else if stated.contains_key(name) {
            } else if let Some(known) = base.iter_mut().find(|known| known.variable.name == *name) {
                known.variable.min = known.variable.min.max(free.variable.min);
                known.variable.max = known.variable.max.min(free.variable.max);
                if known.variable.min >= known.variable.max {
                    return Err(CompareError::Vehicle(format!(
                        "{name}: no value is within the bounds of every experiment; they share one soil"
                    )));
                }
            } else {
                base.push(free.clone());
            }
        }
    }
    for free in base.iter_mut().filter(|free| free.within.is_none()) {
        free.prior = shared_prior(&free.variable.name, problems, experiment);
        free.start = free.prior.or(free.shared).map_or(free.start, |prior| prior.mean);
        free.start = free.start.clamp(free.variable.min, free.variable.max);
    }
    Ok(base)
}

/// What is known of a shared parameter: the parts' own priors, each different one once, taken together; else that of the soil's class.
fn shared_prior(name: &str, problems: &[Problem], experiment: &Experiment) -> Option<Prior> {
    let mut own: Vec<Prior> = Vec::new();
    for prior in experiment.parts.iter().filter_map(|part| part.experiment.priors.get(name)) {
        if !own.contains(prior) {
            own.push(*prior);
        }
    }
    if own.is_empty() {
        let of_class = |problem: &Problem| problem.base.iter().find(|free| free.variable.name == name)?.prior;
        return problems.iter().find_map(of_class);
    }
    let weight = |prior: &Prior| 1.0 / (prior.deviation * prior.deviation);
    let whole: f64 = own.iter().map(weight).sum();
    let mean = own.iter().map(|prior| weight(prior) * prior.mean).sum::<f64>() / whole;
    Some(Prior { mean, deviation: 1.0 / whole.sqrt() })
}

/// The effects: in every part that has them, and in some of these only.
fn merged_library(problems: &[Problem], experiment: &Experiment) -> Vec<Candidate> {
    let mut library: Vec<Candidate> = Vec::new();
    let ids = problems.iter().flat_map(|problem| problem.library.iter().map(|candidate| &candidate.id));
    for id in ids {
        if library.iter().any(|known| known.id == *id) {
            continue;
        }
        let parts: Vec<usize> = (0..problems.len()).filter(|k| problems[*k].candidate(id).is_some()).collect();
        let mut add = |places: &[usize], suffix: String| {
            let Some(own) = places.first().and_then(|k| problems[*k].candidate(id)) else { return };
            let free = own.free.iter().map(|free| within(free, places, &suffix)).collect();
            library.push(Candidate { id: format!("{id}{suffix}"), free });
        };
        add(&parts, String::new());
        if parts.len() < 2 {
            continue;
        }
        for k in &parts {
            add(&[*k], format!("{IN}{}", experiment.parts[*k].name));
        }
        for k in parts.iter().filter(|_| parts.len() > 2) {
            let others: Vec<usize> = parts.iter().copied().filter(|other| other != k).collect();
            add(&others, format!("{NOT_IN}{}", experiment.parts[*k].name));
        }
    }
    library
}

/// A parameter that acts in some parts; `suffix` on the name of what it belongs to says where.
fn within(free: &Free, parts: &[usize], suffix: &str) -> Free {
    let name = free.variable.name.clone();
    let split = if SensorError::is_named(&name) { name.rsplit_once('.') } else { name.split_once('.') };
    let mut own = free.clone();
    own.variable.name = split.map_or_else(|| format!("{name}{suffix}"), |(of, field)| format!("{of}{suffix}.{field}"));
    own.within = Some(Within { parts: parts.to_vec(), name, factor_of: Vec::new() });
    own
}

impl Problem<'_> {
    /// Of several experiments: takes out of the candidates that are `kept` those that act in other words where another one does, since
    /// some part cannot show the effect, and out of those that are `gone` all that are not effects of their own.
    pub fn in_visible_parts<T>(&self, kept: &mut Vec<(Candidate, T)>, gone: &mut Vec<String>) {
        if self.parts.is_empty() {
            return;
        }
        let places =
            |candidate: &Candidate| candidate.free.first().and_then(|free| free.within.clone()).map(|w| w.parts);
        let single: Vec<(String, usize)> = kept
            .iter()
            .filter(|(candidate, _)| plain_effect(&candidate.id) != candidate.id)
            .filter_map(|(candidate, _)| match places(candidate)?.as_slice() {
                [one] => Some((plain_effect(&candidate.id).to_owned(), *one)),
                _ => None,
            })
            .collect();
        let mut seen: Vec<(String, Vec<usize>)> = Vec::new();
        kept.retain_mut(|(candidate, _)| {
            let plain = plain_effect(&candidate.id).to_owned();
            let shows = |k: &usize| single.iter().any(|(id, part)| *id == plain && part == k);
            for free in &mut candidate.free {
                let Some(within) = &mut free.within else { continue };
                if within.parts.len() > 1 {
                    within.parts.retain(shows);
                }
            }
            let Some(places) = places(candidate) else { return true };
            if places.is_empty() {
                gone.push(plain);
                return false;
            }
            let place = (plain, places);
            let new = !seen.contains(&place);
            seen.push(place);
            new
        });
        gone.retain(|id| plain_effect(id) == id);
    }

    /// Sets a free parameter, as it is called in this problem, on the runs in which it acts and that do not state their own value.
    pub(super) fn fix_in_parts(&mut self, name: &str, value: f64) {
        let known = self.base.iter().chain(self.library.iter().flat_map(|candidate| &candidate.free));
        let Some(free) = known.into_iter().find(|free| free.variable.name == name).cloned() else { return };
        for (k, runs) in self.experiment.runs_of_parts().into_iter().enumerate() {
            let Some(own) = free.in_part(k) else { continue };
            for run in runs {
                if !self.experiment.runs[run].parameters.contains_key(&own.variable.name) {
                    set_unchecked(&mut self.models[run], &own.variable.name, value);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::plain_effect;

    #[test]
    fn property_an_effect_is_found_behind_where_it_acts() {
        assert_eq!(plain_effect("slip_sinkage"), "slip_sinkage");
        assert_eq!(plain_effect("slip_sinkage in wheel_2"), "slip_sinkage");
        assert_eq!(plain_effect("slip_sinkage not in wheel in sand"), "slip_sinkage");
    }
}
