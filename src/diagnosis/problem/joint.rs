//! Several experiments on one soil as one problem.
//!
//! Parameters of what is shared, the soil unless something else is said, have one value in every part that shares it. What a part states of
//! it is known in all of these, and what is known beforehand of a shared parameter counts once. All else, the rig, its noise, errors of its
//! sensors, stays with its part. An effect may act in every part that can show it, with one strength, or in one of them only, or in all but one.

use super::placed::Placed;
use super::shared::Shared;
use super::sharing::Sharing;
use super::{Candidate, Problem, add, scatter, set_unchecked};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::free::{Free, Within};
use crate::diagnosis::given::Given;
use crate::diagnosis::halt::Halt;
use crate::diagnosis::kinds::strategy;
use crate::diagnosis::layout::Layout;
use crate::diagnosis::windows::Windows;
use crate::measurement::{Experiment, Part, SensorError, Share};
use crate::model::Model;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// Between an effect and the part in which it acts.
pub(super) const IN: &str = " in ";
/// Between an effect and the only part in which it does not act.
const NOT_IN: &str = " not in ";

/// An effect without where it acts.
#[must_use]
pub fn plain_effect(id: &str) -> &str {
    id.split_once(NOT_IN).or_else(|| id.split_once(IN)).map_or(id, |(plain, _)| plain)
}

impl<'a> Problem<'a> {
    /// The joint problem of `experiment`'s parts.
    pub(super) fn of_parts(given: &Given, experiment: &'a Experiment, added: &[String]) -> Result<Self, CompareError> {
        let shared = Shared::of(given, &experiment.parts)?;
        let soils = shared.sharing.soils();
        if let (Some((_, name)), true) = (&given.soil, soils.len() > 1) {
            return Err(CompareError::Vehicle(format!(
                "{name}: the experiments stand on {} soils, and this is one; share the soil, or diagnose those on it by themselves",
                soils.len()
            )));
        }
        let mut given = given.clone();
        let calibrated = |name: &str| experiment.parts.iter().any(|part| strategy(&part.experiment).calibrates(name));
        given.calibrated_elsewhere = given.soil().map_or_else(Vec::new, |soil| {
            let names = soil.parameters.iter().map(|parameter| parameter.name.clone());
            names.filter(|name| calibrated(name)).collect()
        });
        let given = &given;
        let mut problems = pose(given, experiment, &shared, &[])?;
        let wide: Vec<usize> = soils.into_iter().filter(|parts| many_widths(&problems, parts)).flatten().collect();
        if !wide.is_empty() {
            problems = pose(given, experiment, &shared, &wide)?;
        }
        let mut base = merged_base(&problems, &shared.sharing)?;
        let parts = experiment.parts.iter().map(|part| part.name.as_str());
        let parts: Vec<(&str, &[Free])> = parts.zip(problems.iter().map(|problem| problem.base.as_slice())).collect();
        let factors = scatter::factors(&base, &parts, &shared.sharing, given.soil_scatter);
        base.extend(factors);
        let library = add(added, merged_library(&problems, experiment), &mut base)?;
        let mut sources = sources(&problems, experiment);
        sources.extend(scattered(&base, given));
        sources.extend(shared.sharing.lines());
        sources.extend(shared.lines(&experiment.parts));
        // All parts are given the same of a known soil.
        let joint = problems.iter().find_map(|problem| problem.joint.clone());
        Ok(Self {
            layout: Layout::new(experiment),
            experiment: Cow::Borrowed(experiment),
            known: problems[0].known.clone(),
            models: problems.iter().flat_map(|problem| problem.models.clone()).collect(),
            steps: Vec::new(),
            own_steps: Vec::new(),
            windows: Windows::new(),
            spared: Windows::new(),
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
            windows: self.windows.get(runs.clone()).map_or_else(Vec::new, <[_]>::to_vec),
            spared: self.spared.get(runs).map_or_else(Vec::new, <[_]>::to_vec),
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
            let mut part = self.part_of(k);
            // What others state of the soil is known here too.
            part.experiment.to_mut().parameters.clone_from(&self.parts[k].experiment.parameters);
            let placed = Placed::of(free, &part, k);
            let values = placed.values(values, free);
            (self.experiment.parts[k].name.clone(), part.saved(&placed.free, &values))
        };
        (0..self.parts.len()).map(saved).collect()
    }

    /// Part number `k` as a problem of its own: with the effects that may act in it, and what the others state of the soil.
    pub fn part_by_itself(&self, k: usize) -> Problem<'static> {
        let mut part = self.part_of(k);
        part.library.clone_from(&self.parts[k].library);
        part.experiment.to_mut().parameters.clone_from(&self.parts[k].experiment.parameters);
        part.owned()
    }

    /// What `values` of the `free` parameters of the whole are in part number `k`, by the names of its own model.
    pub fn values_in_part(&self, k: usize, free: &[Free], values: &[f64]) -> BTreeMap<String, f64> {
        let placed = Placed::of(free, &self.parts[k], k);
        let own = placed.values(values, free);
        placed.free.into_iter().map(|free| free.variable.name).zip(own).collect()
    }

    /// Takes another value for a parameter that is known in part number `k`, by its name there.
    pub fn set_known_in_part(&mut self, k: usize, name: &str, value: f64) {
        Arc::make_mut(&mut self.parts[k]).set_known(name, value);
        for run in self.experiment.runs_of_parts()[k].clone() {
            if !self.experiment.recorded_run(run).parameters.contains_key(name) {
                set_unchecked(&mut self.models[run], name, value);
            }
        }
        self.sensitivities = None;
    }

    /// The parts of a joint experiment in which an effect acts, by name; none of a single experiment, in which it acts everywhere.
    pub fn parts_with(&self, id: &str) -> Vec<String> {
        let name = |k: usize| self.experiment.parts[k].name.clone();
        let all = (0..self.parts.len()).map(name);
        let own = self.candidate(id).and_then(|candidate| candidate.free.first()?.within.as_ref());
        own.map_or_else(|| all.collect(), |within| within.parts.iter().map(|k| name(*k)).collect())
    }
}

/// Each part by itself, with what is known of what it shares; `other_widths` are those parts in which k_c is told from k_phi by others.
fn pose(
    given: &Given,
    experiment: &Experiment,
    shared: &Shared,
    other_widths: &[usize],
) -> Result<Vec<Problem<'static>>, CompareError> {
    let of = |(k, part): (usize, &Part)| {
        let known = shared.known_in(k, part);
        let problem = Problem::single(given, &known, &[], other_widths.contains(&k));
        problem.map(Problem::owned).map_err(|error| error.of_part(&part.name))
    };
    experiment.parts.iter().enumerate().map(of).collect()
}

/// Whether the parts on one soil press it with several widths, so that k_c can be told from k_phi.
fn many_widths(problems: &[Problem], parts: &[usize]) -> bool {
    let own = parts.iter().map(|k| &problems[*k]).filter(|problem| problem.strategy().calibrates("soil.k_c"));
    let of = |problem: &Problem| problem.strategy().contact_widths(&problem.experiment, &problem.models);
    let mut widths: Vec<f64> = own.flat_map(of).collect();
    widths.sort_by(f64::total_cmp);
    widths.dedup();
    widths.len() > 1
}

/// What is said of the parts: once where it is the same for all, else with the name of the part.
fn sources(problems: &[Problem], experiment: &Experiment) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for (problem, part) in problems.iter().zip(&experiment.parts) {
        for line in &problem.sources {
            let shared = problems.iter().all(|other| other.sources.contains(line));
            let line = if shared { line.clone() } else { format!("{}: {line}", part.name) };
            if !all.contains(&line) {
                all.push(line);
            }
        }
    }
    all
}

/// A line on the scatter of the soil that is assumed.
fn scattered(base: &[Free], given: &Given) -> Option<String> {
    let (percent, option) =
        (100.0 * given.soil_scatter, if given.set_by == "--set" { "--soil-scatter" } else { "soil_scatter" });
    let why = if given.soil_scatter == scatter::USUAL {
        format!("an assumption, which so few experiments do not tell; {option} changes it, 0 for one bed")
    } else {
        format!("as {option} says")
    };
    base.iter().any(Free::is_factor).then(|| {
        format!(
            "the soil is taken to differ by {} % from one experiment to the next (standard deviation of k, c and K; a fifth of it of the friction angle): {why}",
            (100.0 * percent).round() / 100.0
        )
    })
}

/// Free parameters of the calibration: what is shared once, all others for each part.
fn merged_base(problems: &[Problem], sharing: &Sharing) -> Result<Vec<Free>, CompareError> {
    let mut base: Vec<Free> = Vec::new();
    for (k, problem) in problems.iter().enumerate() {
        for free in &problem.base {
            let shared = sharing.with(&free.variable.name, k);
            // A part that knows the parameter otherwise, or not at all, has no use for it.
            let moves = |own: &usize| problems[*own].base.iter().any(|other| other.variable.name == free.variable.name);
            let suffix = sharing.names_of(&shared).map(|names| format!("{IN}{names}"));
            let own = match (Share::of(&free.variable.name), suffix) {
                (Some(Share::Soil), None) => free.clone(),
                (_, suffix) => {
                    let parts: Vec<usize> = shared.into_iter().filter(moves).collect();
                    within(free, &parts, &suffix.unwrap_or_default())
                }
            };
            let Some(known) = base.iter_mut().find(|known| known.variable.name == own.variable.name) else {
                base.push(own);
                continue;
            };
            known.variable.min = known.variable.min.max(free.variable.min);
            known.variable.max = known.variable.max.min(free.variable.max);
            if known.variable.min >= known.variable.max {
                let share = Share::of(&free.variable.name).map_or("parameter", Share::name);
                return Err(CompareError::Vehicle(format!(
                    "{}: no value is within the bounds of every experiment, and they share one {share}",
                    free.variable.name
                )));
            }
        }
    }
    Ok(base)
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
pub(super) fn within(free: &Free, parts: &[usize], suffix: &str) -> Free {
    let name = free.variable.name.clone();
    let mut own = free.clone();
    own.variable.name = placed_name(&name, suffix);
    own.within = Some(Within { parts: parts.to_vec(), name, factor_of: Vec::new() });
    own
}

/// The name of a parameter with `suffix` on what it belongs to.
fn placed_name(name: &str, suffix: &str) -> String {
    let split = if SensorError::is_named(name) { name.rsplit_once('.') } else { name.split_once('.') };
    split.map_or_else(|| format!("{name}{suffix}"), |(of, field)| format!("{of}{suffix}.{field}"))
}

/// Name of a known parameter of one of several experiments among those of all: its own where they share it.
pub(crate) fn name_in_part(name: &str, part: &Part) -> String {
    if Share::of(name) == Some(Share::Soil) {
        name.to_owned()
    } else {
        placed_name(name, &format!("{IN}{}", part.name))
    }
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
            // Where an effect is not tried in single parts nothing tells which of them show it.
            let tried = single.iter().any(|(id, _)| *id == plain)
                || gone.iter().any(|id| *id != plain && plain_effect(id) == plain);
            let shows = |k: &usize| !tried || single.iter().any(|(id, part)| *id == plain && part == k);
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
                if !self.experiment.recorded_run(run).parameters.contains_key(&own.variable.name) {
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
