//! The course of a diagnosis.

use super::bootstrap::p_value;
use super::choose::choose;
use super::control::Control;
use super::folds::{Fold, folds};
use super::held_out::{HeldOut, held_out};
use super::prepare::{Prepared, prepare};
use super::report_parts as parts;
use super::result::{Diagnosis, Verdict};
use super::search::{Fits, Search};
use super::stage::{Ground, Stage};
use super::untried::{Untried, named};
use super::verdict::{self, Case, Finding, NAMED};
use super::watch::{Phase, Watch};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::noise::Whitening;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::problem::Problem;
use crate::measurement::Experiment;
use crate::model::Model;
use std::collections::{BTreeMap, BTreeSet};
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
    pub(crate) fn problem<'a>(&self, model: &Model, experiment: &'a Experiment) -> Result<Problem<'a>, CompareError> {
        let mut problem = Problem::new(model, experiment, &self.added)?;
        if let Some(candidates) = &self.candidates {
            problem.keep_candidates(candidates)?;
        }
        problem.coarsen();
        Ok(problem)
    }
}

/// A rival is refitted in the place of an effect from this cosine of signatures.
const WORTH_A_SWAP: f64 = 0.5;

/// Single effects that compete on left-out data: the best fits; the others gain nothing worth predicting.
const COMPETING_SINGLES: usize = 6;

/// Pairs beside the chosen ones that compete in the probabilities.
const COMPETING_PAIRS: usize = 3;

/// What predicting the left-out conditions with one set costs, in single fits: six short refits on a carriage; less on a
/// traverse.
const PREDICTION: f64 = 1.0;

/// Compares the model with an experiment and looks for the effect that is missing.
///
/// Without a budget of time the result depends neither on the number of threads nor on the clock. Once `control.stop` says
/// yes, the work in hand is cut short and what is known by then is returned, marked as interrupted. What was not tried for
/// that reason, or because `control.budget` had no time for it, is listed in [`Diagnosis::not_tried`].
///
/// # Errors
/// [`CompareError`] where the experiment does not fit the model, or the model cannot compute it;
/// [`CompareError::Interrupted`] where there was a stop before the baseline and its noise were known.
pub fn diagnose(
    model: &Model,
    experiment: &Experiment,
    options: &DiagnoseOptions,
    control: &Control,
) -> Result<Diagnosis, CompareError> {
    let mut problem = options.problem(model, experiment)?;
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
    let folds = folds(experiment);
    let held = all_held_out(&search, &folds, &chosen);
    watch.begin(Phase::Rivals, "");
    let mut finding = judge(&mut search, &stage, &chosen, &held)?;
    if !prepared.noise_is_known {
        finding.verdict = Verdict::Undetermined;
    }
    incomplete(&mut finding, &watch.untried(), stage.draws.len(), options.draws);
    let inputs = parts::Inputs { search: &search, stage: &stage, prepared: &prepared, folds: &folds, held: &held };
    let diagnosis = parts::assemble(&inputs, finding, &chosen, options)?;
    watch.begin(Phase::Done, "");
    Ok(diagnosis)
}

/// What was not tried limits the verdict: nothing is named while an effect that could stand in its place is untried, and
/// without all effects nobody knows that none is missing or that none explains the misfit.
fn incomplete(finding: &mut Finding, untried: &[Untried], draws: usize, asked: usize) {
    if draws < asked {
        finding.cautions.push(format!("interrupted: p-values rest on {draws} of {asked} bootstrap draws"));
        finding.verdict = Verdict::Undetermined;
    }
    let named = &finding.effects;
    let rivals = |set: &[String]| {
        finding.verdict != Verdict::EffectMissing
            || (set.len() == named.len() && set.iter().filter(|id| !named.contains(id)).count() == 1)
    };
    if untried.iter().filter_map(Untried::unknown).any(rivals) {
        finding.cautions.push("some effects were not tried: the verdict is open".to_owned());
        finding.verdict = Verdict::Undetermined;
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

/// Left-out predictions of the baseline, the fitted singles, the chosen sets and a few competing pairs.
fn all_held_out(search: &Search, folds: &[Fold], chosen: &[String]) -> BTreeMap<Vec<String>, HeldOut> {
    let mut sets: Vec<Vec<String>> = vec![Vec::new()];
    sets.extend((2..=chosen.len()).rev().map(|count| chosen[..count].to_vec()));
    let mut singles: Vec<&Vec<String>> = search.fits.of(1).map(|(set, _)| set).collect();
    singles.sort_by(|a, b| search.net_gain(b).total_cmp(&search.net_gain(a)));
    sets.extend(singles.into_iter().take(COMPETING_SINGLES).cloned());
    let mut pairs: Vec<&Vec<String>> = search.fits.of(2).map(|(set, _)| set).collect();
    pairs.sort_by(|a, b| search.net_gain(b).total_cmp(&search.net_gain(a)));
    sets.extend(pairs.into_iter().take(COMPETING_PAIRS).cloned());
    sets.iter_mut().for_each(|set| set.sort());
    // In the order of their importance, in case there is no time for all.
    let mut known = BTreeSet::new();
    sets.retain(|set| known.insert(set.clone()));
    let predict = |set: &Vec<String>| held_out(search.problem, search.noise, set, search.fits.get(set)?, folds);
    let untried = |set: &Vec<String>| Untried::LeftOut(set.clone());
    let held = search.watch.pieces(&sets, PREDICTION, |set| named(set), untried, predict);
    sets.into_iter().zip(held).filter_map(|(set, held)| Some((set, held?))).collect()
}

/// The verdict.
fn judge(
    search: &mut Search,
    stage: &Stage,
    chosen: &[String],
    held: &BTreeMap<Vec<String>, HeldOut>,
) -> Result<Finding, PredictionError> {
    if chosen.is_empty() {
        return Ok(verdict::without_effects(stage, parts::blind_share(stage)));
    }
    search.rivals(stage, chosen, WORTH_A_SWAP);
    let all: Vec<String> = stage.sensitivities.signatures.iter().map(|signature| signature.id.clone()).collect();
    let Some(fit) = search.fits.get(chosen) else {
        return Ok(verdict::without_effects(stage, 0.0));
    };
    let residual = parts::whitened_residual(search, chosen, &fit.values())?;
    let has_priors = search.problem.base.iter().any(|free| free.prior.is_some());
    let without_priors = (has_priors && !search.watch.stopped()).then(|| {
        let (base, with) = (search.without_priors(&[]), search.without_priors(chosen));
        let gain = base.zip(with).map_or(0.0, |(base, with)| base.chi_square - with.chi_square);
        p_value(&stage.draws, |draw| if chosen.len() > 1 { draw.pair } else { draw.single }, gain) < NAMED
    });
    let mut set = chosen.to_vec();
    set.sort();
    let case = Case {
        effects: chosen,
        left: verdict::left(search, stage, chosen, &residual),
        rivals: verdict::rivals(search, chosen, &all),
        baseline: held.get(&Vec::new()),
        held_out: held.get(&set),
        without_priors,
    };
    Ok(verdict::with_effects(&case))
}
