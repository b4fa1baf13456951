//! The course of a diagnosis.

use super::choose::choose;
use super::control::Control;
use super::evidence::Evidence;
use super::judge::judge;
use super::prepare::{Prepared, prepare};
use super::report_parts as parts;
use super::result::Diagnosis;
use super::search::{Fits, Search};
use super::stage::Ground;
use super::untried::Untried;
use super::verdict::Judgement;
use super::watch::{Phase, Watch};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::given::Given;
use crate::diagnosis::noise::Whitening;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::unanswered::UnansweredRows;
use crate::measurement::Experiment;
use std::collections::BTreeMap;
use std::sync::Mutex;

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
    pub(crate) fn problem<'a>(
        &self,
        given: impl Into<Given>,
        experiment: &'a Experiment,
    ) -> Result<Problem<'a>, CompareError> {
        let mut problem = Problem::new(given, experiment, &self.added)?;
        if let Some(candidates) = &self.candidates {
            problem.keep_candidates(candidates)?;
        }
        problem.coarsen();
        Ok(problem)
    }
}

/// Compares the model with an experiment and looks for the effect that is missing.
///
/// Where values come from is said at [`Given`]; a plain model is one that is named. An effect that the model has switched on
/// is part of the baseline, held at its value.
///
/// Without a budget of time the result depends neither on the number of threads nor on the clock. Once `control.stop` says
/// yes, the work in hand is cut short and what is known by then is returned, marked as interrupted. What was not tried for
/// that reason, or because `control.budget` had no time for it, is listed in [`Diagnosis::not_tried`].
///
/// # Errors
/// [`CompareError`] where the experiment does not fit the model, or the model cannot compute it;
/// [`CompareError::Interrupted`] where there was a stop before the baseline and its noise were known.
pub fn diagnose(
    given: impl Into<Given>,
    experiment: &Experiment,
    options: &DiagnoseOptions,
    control: &Control,
) -> Result<Diagnosis, CompareError> {
    let mut problem = options.problem(given, experiment)?;
    let watch = Watch::new(control, experiment.kind);
    problem.halt = watch.halt();
    let free: Vec<&str> = problem.base.iter().map(|free| free.variable.name.as_str()).collect();
    watch.begin(Phase::Baseline, &free.join(", "));
    let nothing_yet = |error: CompareError| if watch.stopped() { CompareError::Interrupted } else { error };
    let prepared = prepare(&mut problem).map_err(nothing_yet)?;
    let problem = problem;
    let whitening = prepared.noise.whitening(&problem, &|_, _| true).ok_or(CompareError::NoFit)?;
    let mut search = search(&problem, &prepared, &whitening, options, control, &watch);
    search.fits.insert(&[], prepared.baseline.clone());
    watch.begin(Phase::Noise, "");
    let stage = search.stage(&[])?.ok_or(CompareError::NoFit).map_err(nothing_yet)?;
    watch.begin(Phase::Singles, "");
    let stage = search.escaped(stage)?;
    search.singles(&stage);
    if stage.fit.is_far() {
        search.afresh(&stage);
    }
    watch.begin(Phase::Sets, "");
    let chosen = choose(&mut search, &stage, options)?;
    watch.begin(Phase::LeftOut, "");
    let mut evidence = Evidence::new(&search, &chosen);
    watch.begin(Phase::Rivals, "");
    let mut judged = judge(&mut search, &stage, &prepared, &mut evidence, chosen)?;
    if !prepared.noise_is_known {
        judged.judgement.undecided();
    }
    judged.judgement.with_unanswered(share_unanswered(experiment, &prepared));
    if watch.stopped() && judged.judgement.names() {
        judged.judgement.open("interrupted: not all that may speak against the name was looked for".to_owned());
    }
    incomplete(&mut judged.judgement, &watch.untried(), stage.draws.len(), options.draws);
    let inputs = parts::Inputs { search: &search, stage: &stage, prepared: &prepared, evidence: &evidence };
    let diagnosis = parts::assemble(&inputs, judged.judgement, &judged.chosen, options)?;
    watch.begin(Phase::Done, "");
    Ok(diagnosis)
}

/// Share of an experiment's rows that the calibrated baseline cannot answer.
fn share_unanswered(experiment: &Experiment, prepared: &Prepared) -> f64 {
    let all: usize = experiment.runs.iter().map(|run| run.data.rows()).sum();
    let without: usize = prepared.unanswered.iter().map(UnansweredRows::count).sum();
    without as f64 / all.max(1) as f64
}

/// What was not tried limits the verdict: nothing is named while an effect that could stand in its place is untried, and
/// without all effects nobody knows that none is missing or that none explains the misfit.
fn incomplete(judgement: &mut Judgement, untried: &[Untried], draws: usize, asked: usize) {
    if draws < asked {
        judgement.open(format!("interrupted: p-values rest on {draws} of {asked} bootstrap draws"));
    }
    let named = judgement.effects.clone();
    let names_them = judgement.names();
    let rivals = |set: &[String]| {
        !names_them || (set.len() == named.len() && set.iter().filter(|id| !named.contains(id)).count() == 1)
    };
    if untried.iter().filter_map(Untried::unknown).any(rivals) {
        judgement.open("some effects were not tried: the verdict is open".to_owned());
    }
}

fn search<'a>(
    problem: &'a Problem<'a>,
    prepared: &'a Prepared,
    whitening: &'a Whitening,
    options: &DiagnoseOptions,
    control: &'a Control<'a>,
    watch: &'a Watch<'a>,
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
    let (fits, looks, settled, modelled) = (Fits::default(), BTreeMap::new(), BTreeMap::new(), Mutex::default());
    Search { problem, noise: &prepared.noise, ground, control, watch, fits, looks, settled, modelled }
}
