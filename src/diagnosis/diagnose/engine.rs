//! The course of a diagnosis.

use super::bootstrap::p_value;
use super::choose::choose;
use super::control::{Control, Progress};
use super::folds::{Fold, folds};
use super::held_out::{HeldOut, held_out};
use super::prepare::{Prepared, prepare};
use super::report_parts as parts;
use super::result::{Diagnosis, Verdict};
use super::search::{Fits, Search};
use super::stage::{Ground, Stage};
use super::verdict::{self, Case, Finding, NAMED};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::given::Given;
use crate::diagnosis::noise::Whitening;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::problem::Problem;
use crate::measurement::Experiment;
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

/// A rival is refitted in the place of an effect from this cosine of signatures.
const WORTH_A_SWAP: f64 = 0.5;

/// Single effects that compete on left-out data: the best fits; the others gain nothing worth predicting.
const COMPETING_SINGLES: usize = 6;

/// Pairs beside the chosen ones that compete in the probabilities.
const COMPETING_PAIRS: usize = 3;

/// Compares the model with an experiment and looks for the effect that is missing.
///
/// Where values come from is said at [`Given`]; a plain model is one that is named. An effect that the model has switched on
/// is part of the baseline, held at its value.
///
/// The result does not depend on the number of threads. Once `control.stop` says yes, the work in hand is cut short and
/// what is known by then is returned, marked as interrupted.
///
/// # Errors
/// [`CompareError`] where the experiment does not fit the model, or the model cannot compute it.
pub fn diagnose(
    given: impl Into<Given>,
    experiment: &Experiment,
    options: &DiagnoseOptions,
    control: &Control,
) -> Result<Diagnosis, CompareError> {
    let mut problem = options.problem(given, experiment)?;
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
