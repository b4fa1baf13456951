//! The course of a diagnosis.

use super::bootstrap::p_value;
use super::control::{Control, Progress};
use super::held_out::{Fold, HeldOut, folds, held_out};
use super::prepare::{Prepared, prepare};
use super::report_parts as parts;
use super::result::{Diagnosis, Verdict};
use super::search::{Fits, Search};
use super::stage::{Ground, Stage};
use super::verdict::{self, Case, Finding, NAMED};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::noise::Whitening;
use crate::diagnosis::prediction::PredictionError;
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

/// A rival is refitted in the place of an effect from this cosine of signatures.
const WORTH_A_SWAP: f64 = 0.5;

/// Single effects that compete on left-out data: the best fits; the others gain nothing worth predicting.
const COMPETING_SINGLES: usize = 6;

/// Pairs beside the chosen ones that compete in the probabilities.
const COMPETING_PAIRS: usize = 3;

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
    clock.tell("looking for the best set", 0.5);
    let chosen = choose(&mut search, &stage, options, &clock)?;
    clock.tell("predicting what was left out", 0.75);
    let folds = folds(experiment);
    let held = all_held_out(&search, &folds, &chosen);
    let mut finding = judge(&mut search, &stage, &chosen, &held)?;
    if !prepared.noise_is_known {
        finding.verdict = Verdict::Undetermined;
    }
    clock.tell("profiles", 0.9);
    let inputs = parts::Inputs { search: &search, stage: &stage, prepared: &prepared, folds: &folds, held: &held };
    let diagnosis = parts::assemble(&inputs, finding, &chosen, options)?;
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

    fn stopped(&self) -> bool {
        (self.control.stop)()
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
    Search { problem, noise: &prepared.noise, ground, control, fits: Fits::default(), looks: BTreeMap::new() }
}

/// The effects that gain more than noise alone, in the order of their gains.
fn choose(
    search: &mut Search,
    stage: &Stage,
    options: &DiagnoseOptions,
    clock: &Clock,
) -> Result<Vec<String>, PredictionError> {
    let best = best_of(search, 1);
    let p_single = best.as_ref().map_or(1.0, |set| p_value(&stage.draws, |draw| draw.single, search.gain(set)));
    let p_pair = p_value(&stage.draws, |draw| draw.pair, stage.observed.pair);
    let mut chosen = best.clone().filter(|_| p_single < NAMED && options.max_effects > 0).unwrap_or_default();
    if options.max_effects < 2 || (chosen.is_empty() && p_pair >= NAMED) || clock.stopped() {
        return Ok(chosen);
    }
    let further = if chosen.is_empty() { None } else { further(search, &chosen)? };
    if further.is_some() || chosen.is_empty() {
        search.pairs(stage);
        if let Some(pair) = best_pair(search, &chosen, further)? {
            chosen = pair;
        }
    }
    while chosen.len() >= 2 && chosen.len() < options.max_effects && !clock.stopped() {
        let Some(set) = self::further(search, &chosen)? else { break };
        chosen = set;
    }
    Ok(chosen)
}

/// The set of `count` effects with the largest net gain.
fn best_of(search: &Search, count: usize) -> Option<Vec<String>> {
    let sets = search.fits.of(count).map(|(effects, _)| effects);
    sets.max_by(|a, b| search.net_gain(a).total_cmp(&search.net_gain(b))).cloned()
}

/// The set with one more effect where that gains more than noise alone, even after the strengths of those in the set may
/// vary with the conditions.
fn further(search: &mut Search, chosen: &[String]) -> Result<Option<Vec<String>>, PredictionError> {
    let Some(stage) = search.stage(chosen)? else { return Ok(None) };
    if Search::p_of_best(&stage) >= NAMED {
        return Ok(None);
    }
    search.singles(&stage);
    let with = |set: &&Vec<String>| chosen.iter().all(|id| set.contains(id));
    let sets = search.fits.of(chosen.len() + 1).map(|(effects, _)| effects).filter(with);
    let best = sets.max_by(|a, b| search.net_gain(a).total_cmp(&search.net_gain(b))).cloned();
    let Some(best) = best else { return Ok(None) };
    let gains = |search: &Search| {
        let step = search.gain(&best) - search.gain(chosen);
        p_value(&stage.draws, |draw| draw.single, step) < NAMED
    };
    if gains(search) {
        search.settle_below(&best, chosen);
    }
    let needed = gains(search);
    let Some(new) = best.iter().find(|id| !chosen.contains(id)).cloned() else { return Ok(None) };
    let mut ordered = chosen.to_vec();
    ordered.push(new);
    Ok(needed.then_some(ordered))
}

/// The best pair: the one that grew from the best single effect, unless another is better by more than a tie and each of
/// its members is needed beside the other.
fn best_pair(
    search: &mut Search,
    single: &[String],
    grown: Option<Vec<String>>,
) -> Result<Option<Vec<String>>, PredictionError> {
    let Some(best) = best_of(search, 2) else { return Ok(grown) };
    if single.iter().all(|id| best.contains(id)) && !single.is_empty() {
        return Ok(grown);
    }
    let known = grown.as_ref().map_or_else(|| search.net_gain(single), |set| search.net_gain(set));
    if search.net_gain(&best) <= known + verdict::REACH {
        return Ok(grown);
    }
    for id in &best {
        let alone = std::slice::from_ref(id);
        let Some(stage) = search.stage(alone)? else { return Ok(grown) };
        let step = search.gain(&best) - search.gain(alone);
        if p_value(&stage.draws, |draw| draw.single, step) >= NAMED || Search::p_of_best(&stage) >= NAMED {
            return Ok(grown);
        }
    }
    let mut ordered = best;
    ordered.sort_by(|a, b| {
        let gain = |id: &String| search.net_gain(std::slice::from_ref(id));
        gain(b).total_cmp(&gain(a))
    });
    Ok(Some(ordered))
}

/// Left-out predictions of the baseline, the fitted singles, the chosen sets and a few competing pairs.
fn all_held_out(search: &Search, folds: &[Fold], chosen: &[String]) -> BTreeMap<Vec<String>, HeldOut> {
    let mut sets: Vec<Vec<String>> = vec![Vec::new()];
    let mut singles: Vec<&Vec<String>> = search.fits.of(1).map(|(set, _)| set).collect();
    singles.sort_by(|a, b| search.net_gain(b).total_cmp(&search.net_gain(a)));
    sets.extend(singles.into_iter().take(COMPETING_SINGLES).cloned());
    sets.extend((2..=chosen.len()).map(|count| chosen[..count].to_vec()));
    let mut pairs: Vec<&Vec<String>> = search.fits.of(2).map(|(set, _)| set).collect();
    pairs.sort_by(|a, b| search.net_gain(b).total_cmp(&search.net_gain(a)));
    sets.extend(pairs.into_iter().take(COMPETING_PAIRS).cloned());
    sets.iter_mut().for_each(|set| set.sort());
    sets.sort();
    sets.dedup();
    let predict = |set: &Vec<String>| {
        if (search.control.stop)() {
            return None;
        }
        let fit = search.fits.get(set)?;
        held_out(search.problem, search.noise, set, fit, folds).map(|held| (set.clone(), held))
    };
    crate::parallel::map_in_order(&sets, predict).into_iter().flatten().collect()
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
    let without_priors = has_priors.then(|| {
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
