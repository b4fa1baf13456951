//! Which further test would determine what the measurements do not: the cheapest one.
//!
//! Tests of the soil and more of what a wheel was already put through are planned beside the experiments at hand, each on a bed of its
//! own, and what all of them together would tell of each parameter follows from the sensitivities at the present values.

use super::separation::{expect_all, models, planned_noise};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::diagnose::sensitivities;
use crate::diagnosis::free::Free;
use crate::diagnosis::given::Given;
use crate::diagnosis::identified::{Determined, Identified, identified_at};
use crate::diagnosis::information::Information;
use crate::diagnosis::kinds::{PlatePlan, ShearPlan, strategy};
use crate::diagnosis::noise::{NoiseModel, Whitening};
use crate::diagnosis::problem::{Problem, written_down};
use crate::measurement::{Experiment, Part, Share};
use crate::model::Model;
use crate::parallel::map_in_order;
use serde::Serialize;
use std::collections::BTreeMap;

/// Name of what is added, among the names of the experiments.
const NEW: &str = "addition";

/// A test that can be added.
#[derive(Clone, Debug)]
pub(crate) struct Test {
    /// What to do.
    pub text: String,
    /// How many runs it takes.
    pub runs: usize,
    pub experiment: Experiment,
}

/// A test that would determine more.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Addition {
    /// What to do.
    pub text: String,
    /// How many runs it takes: its cost.
    pub runs: usize,
    /// The parameters that it would determine and the present measurements do not.
    pub determines: Vec<String>,
    /// Parameters of the soil that would still be open.
    pub open: Vec<String>,
}

/// What is at hand: a problem with values of its free parameters, and the noise of what is measured.
pub(super) struct AtHand<'a> {
    pub given: &'a Given,
    pub added: &'a [String],
    pub problem: &'a Problem<'a>,
    pub values: &'a [f64],
    pub noise: &'a BTreeMap<String, NoiseModel>,
}

/// Whether a parameter is one of a soil.
fn is_of_soil(name: &str) -> bool {
    name.starts_with("soil.") || name.starts_with("soil in ")
}

/// Tests that determine parameters of the soil which `found` leaves open, the cheapest first; each determines more than any cheaper one.
/// What one width of contact cannot tell, k_c, is open too unless it is known.
pub(super) fn additions(at: &AtHand, found: &[Identified]) -> Vec<Addition> {
    // A set that could be posed can be written down.
    let Ok((given, parts)) = written_down(at.given, &at.problem.experiment.parts) else { return Vec::new() };
    let alone = |name: &String| found.iter().any(|one| one.name == *name && one.determined == Determined::Alone);
    let answer = |test: &Test| -> Option<Addition> {
        let (determined, open): (Vec<_>, Vec<_>) =
            at.with(test, &given, &parts).ok()?.into_iter().partition(|(_, alone)| *alone);
        let names = |all: Vec<(String, bool)>| all.into_iter().map(|(name, _)| name).collect::<Vec<_>>();
        let determines = names(determined).into_iter().filter(|name| !alone(name)).collect();
        Some(Addition { text: test.text.clone(), runs: test.runs, determines, open: names(open) })
    };
    let tests = at.tests(&parts);
    let mut all: Vec<Addition> = map_in_order(&tests, answer).into_iter().flatten().collect();
    all.sort_by_key(|addition| (addition.runs, addition.open.len()));
    let mut most = 0;
    all.retain(|addition| {
        let more = addition.determines.len() > most;
        most = most.max(addition.determines.len());
        more
    });
    all
}

impl AtHand<'_> {
    /// The experiments at hand, which are `parts` unless there is but one, with their models.
    fn with_models<'e>(&'e self, parts: &'e [Part]) -> Vec<(&'e Experiment, Model)> {
        let whole = &*self.problem.experiment;
        let free = &self.problem.base;
        if parts.is_empty() {
            return vec![(whole, self.problem.improved(free, self.values))];
        }
        let models = self.problem.saved_parts(free, self.values).into_iter().map(|(_, model)| model);
        parts.iter().map(|part| &part.experiment).zip(models).collect()
    }

    fn tests(&self, parts: &[Part]) -> Vec<Test> {
        let parts = self.with_models(parts);
        let mut all: Vec<Test> = parts.iter().flat_map(|(part, model)| strategy(part).more(model, part)).collect();
        // On each soil that is named, else on the one that all share.
        let mut soils: Vec<Option<&String>> = parts.iter().map(|(part, _)| part.shared.get(&Share::Soil)).collect();
        soils.sort();
        soils.dedup();
        for soil in &soils {
            let place = soil.filter(|_| soils.len() > 1).map_or_else(String::new, |name| format!(" in {name}"));
            for mut test in soil_tests() {
                test.text.push_str(&place);
                test.experiment.shared.extend(soil.map(|name| (Share::Soil, name.clone())));
                all.push(test);
            }
        }
        all
    }

    /// The soil's parameters, by the names that they have in the problem at hand, and whether each is determined once this test is made, too.
    fn with(&self, test: &Test, given: &Given, parts: &[Part]) -> Result<Vec<(String, bool)>, CompareError> {
        let whole = &*self.problem.experiment;
        let mut named: Vec<(String, Experiment)> = if parts.is_empty() {
            vec![("present".to_owned(), whole.clone())]
        } else {
            parts.iter().map(|part| (part.name.clone(), part.experiment.clone())).collect()
        };
        let count = named.len();
        named.push((NEW.to_owned(), test.experiment.clone()));
        let joint = Experiment::joint_named(named).map_err(|error| CompareError::Vehicle(error.to_string()))?;
        let mut problem = Problem::new(given.clone(), &joint, self.added)?;
        problem.library.clear();
        expect_all(&mut problem);
        let old = |free: &Free| (0..count).find_map(|k| self.own(free.in_part(k)?.variable.name.as_str(), k));
        let value = |free: &Free| old(free).map_or(free.start, |own| self.values[own]);
        let values: Vec<f64> = problem.base.iter().map(value).collect();
        let modelled = problem.predict(&problem.base, |predict| predict.values(&values))??;
        problem.layout.scale = problem.strategy().noise_scale(&problem, &modelled);
        let mut noise = models(&planned_noise(&problem, &modelled));
        for (signal, known) in self.noise {
            let signal = if parts.is_empty() { format!("present.{signal}") } else { signal.clone() };
            noise.insert(signal, *known);
        }
        let information = information_at(&problem, &values, &noise)?;
        let found = identified_at(&problem, &values, &information);
        let called = |one: &Identified| {
            let free = problem.base.iter().find(|free| free.variable.name == one.name)?;
            // Of what is new only k_c is asked for, which k_phi stands in for at one width of contact.
            let name = match old(free) {
                Some(own) => &self.problem.base[own].variable.name,
                None if one.name.ends_with(".k_c") && self.has("soil.k_phi") => &one.name,
                None => return None,
            };
            is_of_soil(name).then(|| (name.clone(), one.determined == Determined::Alone))
        };
        Ok(found.iter().filter_map(called).collect())
    }

    fn has(&self, name: &str) -> bool {
        self.problem.base.iter().any(|free| free.variable.name == name)
    }

    /// Number of the free parameter at hand that part `k` knows by this name.
    fn own(&self, name: &str, k: usize) -> Option<usize> {
        let called = |free: &Free| free.in_part(k).is_some_and(|own| own.variable.name == name);
        self.problem.base.iter().position(called)
    }
}

/// How often a test of a soil may have to be made, each time on a bed prepared anew: means of six scatter by 4 % where beds do by 10 %.
const TIMES: [usize; 3] = [1, 3, 6];

/// Plates and shear tests, one and more of each, once and several times.
fn soil_tests() -> Vec<Test> {
    let mut all = Vec::new();
    for repeats in TIMES {
        for diameters in [vec![0.1], vec![0.05, 0.2], vec![0.05, 0.1, 0.2]] {
            let sizes: Vec<String> = diameters.iter().map(|d| format!("{:.0}", 1e3 * d)).collect();
            let plan = PlatePlan { diameters, repeats, ..PlatePlan::default() };
            all.extend(plan.experiment().ok().map(|experiment| test("plate", &sizes, "mm", repeats, experiment)));
        }
        for normal_stresses in [vec![5e3], vec![2e3, 10e3], vec![1e3, 20e3], vec![2e3, 5e3, 10e3]] {
            let stresses: Vec<String> = normal_stresses.iter().map(|stress| format!("{:.0}", 1e-3 * stress)).collect();
            let plan = ShearPlan { normal_stresses, repeats, ..ShearPlan::default() };
            all.extend(plan.experiment().ok().map(|experiment| test("shear", &stresses, "kPa", repeats, experiment)));
        }
    }
    all
}

/// Tests of one kind at these settings, so many times each.
fn test(kind: &str, settings: &[String], unit: &str, repeats: usize, experiment: Experiment) -> Test {
    let count = settings.len();
    let plural = if count == 1 { "" } else { "s" };
    let mut text = format!("{count} {kind} test{plural} ({} {unit})", settings.join(", "));
    if repeats > 1 {
        text.push_str(&format!(", {repeats} times{}", if count == 1 { "" } else { " each" }));
    }
    Test { text, runs: count * repeats, experiment }
}

/// What the rows of an experiment, made or planned, tell of its free parameters at these values.
pub(super) fn information_at(
    problem: &Problem,
    values: &[f64],
    noise: &BTreeMap<String, NoiseModel>,
) -> Result<Information, CompareError> {
    let whitening = Whitening::new(&problem.layout, noise, &|_, _| true).ok_or(CompareError::NoFit)?;
    let base = sensitivities(problem, &[], values)?.base;
    Ok(Information::of(problem, values, &whitening, &base))
}
