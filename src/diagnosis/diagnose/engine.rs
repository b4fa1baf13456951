//! The course of a diagnosis.

use super::choose::choose;
use super::control::{Control, Progress};
use super::evidence::Evidence;
use super::judge::judge;
use super::prepare::{Prepared, prepare};
use super::report_parts as parts;
use super::result::Diagnosis;
use super::search::{Fits, Search};
use super::stage::Ground;
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::noise::Whitening;
use crate::diagnosis::problem::Problem;
use crate::measurement::Experiment;
use crate::model::Model;
use std::collections::BTreeMap;

/// How to diagnose.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagnoseOptions {
    /// Candidate effects; `None` for all that the model has.
    pub candidates: Option<Vec<String>>,
    /// Effects that are part of the baseline, with free parameters.
    pub added: Vec<String>,
    /// Most effects that are added.
    pub max_effects: usize,
    /// Bootstrap draws; p-values are not below 1/(draws + 1), so that fewer than 100 can never name an effect.
    pub draws: usize,
}

impl Default for DiagnoseOptions {
    fn default() -> Self {
        Self { candidates: None, added: Vec::new(), max_effects: 3, draws: 399 }
    }
}

impl DiagnoseOptions {
    /// What is diagnosed, with the candidates that are asked for.
    pub(crate) fn problem<'a>(&self, model: &Model, experiment: &'a Experiment) -> Result<Problem<'a>, CompareError> {
        let mut problem = Problem::new(model, experiment, &self.added)?;
        if let Some(candidates) = &self.candidates {
            problem.keep_candidates(candidates)?;
        }
        problem.coarsen();
        Ok(problem)
    }
}

/// Compares the model with an experiment and looks for the effect that is missing.
///
/// The result does not depend on the number of threads. Once `control.stop` says yes, the work in hand is cut short and
/// what is known by then is returned, marked as interrupted.
///
/// # Errors
/// [`CompareError`] where the experiment does not fit the model, or the model cannot compute it.
pub fn diagnose(
    model: &Model,
    experiment: &Experiment,
    options: &DiagnoseOptions,
    control: &Control,
) -> Result<Diagnosis, CompareError> {
    let mut problem = options.problem(model, experiment)?;
    let clock = Clock { control };
    clock.tell("calibrating the baseline", 0.0);
    let prepared = prepare(&mut problem)?;
    let problem = problem;
    let whitening = prepared.noise.whitening(&problem, &|_, _| true).ok_or(CompareError::NoFit)?;
    let mut search = search(&problem, &prepared, &whitening, options, control);
    search.fits.insert(&[], prepared.baseline.clone());
    clock.tell("what noise alone would give", 0.15);
    let stage = search.stage(&[])?.ok_or(CompareError::NoFit)?;
    clock.tell("fitting each effect", 0.3);
    let stage = search.escaped(stage)?;
    search.singles(&stage);
    if stage.fit.is_far() {
        search.afresh(&stage);
    }
    clock.tell("looking for the best set", 0.5);
    let chosen = choose(&mut search, &stage, options)?;
    clock.tell("predicting what was left out", 0.75);
    let mut evidence = Evidence::new(&search, &chosen);
    let mut judged = judge(&mut search, &stage, &prepared, &mut evidence, chosen)?;
    if !prepared.noise_is_known {
        judged.judgement.without_a_floor();
    }
    clock.tell("profiles", 0.9);
    let inputs = parts::Inputs { search: &search, stage: &stage, prepared: &prepared, evidence: &evidence };
    let diagnosis = parts::assemble(&inputs, judged.judgement, &judged.chosen, options)?;
    clock.tell("done", 1.0);
    Ok(diagnosis)
}

/// Tells the caller how far the work is.
struct Clock<'a> {
    control: &'a Control<'a>,
}

impl Clock<'_> {
    fn tell(&self, stage: &'static str, done: f64) {
        (self.control.progress)(Progress { stage, done, total: 1.0 });
    }
}

fn search<'a>(
    problem: &'a Problem<'a>,
    prepared: &'a Prepared,
    whitening: &'a Whitening,
    options: &DiagnoseOptions,
    control: &'a Control<'a>,
) -> Search<'a> {
    let ground = Ground {
        problem,
        noise: &prepared.noise,
        whitening,
        repeats: prepared.repeats.as_ref(),
        flexible: &prepared.flexible,
        modulations: &prepared.modulations,
        draws: options.draws,
    };
    let (fits, looks, settled) = (Fits::default(), BTreeMap::new(), BTreeMap::new());
    Search { problem, noise: &prepared.noise, ground, control, fits, looks, settled }
}
