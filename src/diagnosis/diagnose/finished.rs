//! The pieces of a [`Diagnosis`], from a finished search.

use super::bootstrap::p_value;
use super::engine::DiagnoseOptions;
use super::evidence::{Evidence, Probabilities};
use super::held_out::held_out;
use super::prepare::Prepared;
use super::profile::profiles;
use super::result::{CandidateResult, Diagnosis, LackOfFit, PairResult, ParameterResult, Share, Step};
use super::search::Search;
use super::stage::Stage;
use super::untried::lines;
use super::verdict::{Judgement, confused, left, misfit};
use super::watch::Phase;
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::curves::curves_of_steps;
use crate::diagnosis::failure::{Failure, failures};
use crate::diagnosis::fit::Fit;
use crate::diagnosis::linear_algebra::norm;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::separate::{Question, Suggestion, suggest};
use crate::diagnosis::weighted::Weighted;

/// Whitened size, in standard deviations, from which an effect would be found: 80 % power at p = 0.01 corrected for the
/// number of candidates.
pub(crate) const DETECTABLE: f64 = 5.0;

/// A finished search.
pub(crate) struct Inputs<'a> {
    pub search: &'a Search<'a>,
    pub stage: &'a Stage,
    pub prepared: &'a Prepared,
    pub evidence: &'a Evidence,
}

/// Whitened residual of a fitted set, priors' rows last.
pub(crate) fn whitened_residual(
    search: &Search,
    effects: &[String],
    values: &[f64],
) -> Result<Vec<f64>, PredictionError> {
    let free = search.problem.free(effects);
    let modelled = search.modelled(effects)?.unwrap_or_else(|| vec![f64::NAN; search.problem.layout.len()]);
    search.problem.predict(&free, |predict| {
        let weighted = Weighted {
            predict,
            layout: &search.problem.layout,
            free: &free,
            whitening: search.ground.whitening,
            robust: f64::INFINITY,
            whole: true,
        };
        weighted.whitened(&modelled, values)
    })
}

/// Share of the visible effects that could be there at the full range of their parameters without being found.
pub(crate) fn blind_share(stage: &Stage) -> f64 {
    let all = stage.sensitivities.signatures.len();
    let blind = (0..all).filter(|k| largest_size(stage, *k) < DETECTABLE).count();
    if all == 0 { 1.0 } else { blind as f64 / all as f64 }
}

/// Whitened size of what effect number `k` changes beyond the calibration over the range of its parameters.
pub(crate) fn largest_size(stage: &Stage, k: usize) -> f64 {
    stage.projected.views[k].iter().flatten().map(|column| norm(column)).fold(0.0, f64::max)
}

/// Puts the result together.
pub(crate) fn assemble(
    inputs: &Inputs,
    judgement: Judgement,
    chosen: &[String],
    options: &DiagnoseOptions,
) -> Result<Diagnosis, CompareError> {
    let Inputs { search, stage, prepared, .. } = inputs;
    let problem = search.problem;
    let steps = steps(inputs, chosen)?;
    let probabilities = inputs.evidence.probabilities(search, stage, prepared);
    let share = probabilities.as_ref().map_or(Share { enough: f64::NAN, other: f64::NAN }, Probabilities::share);
    let mut candidates = candidates(inputs, &judgement, probabilities.as_ref())?;
    candidates.sort_by(|a, b| b.probability.total_cmp(&a.probability).then(b.gain.total_cmp(&a.gain)));
    let misfit = misfit(stage);
    let last = &steps[steps.len() - 1];
    let fitted = search.fits.get(chosen).unwrap_or(&prepared.baseline);
    let floors = &prepared.floors;
    let given = problem.predict(&problem.base, |predict| {
        predict.answers(&problem.base.iter().map(|free| free.start).collect::<Vec<_>>())
    })?;
    let given = given.ok().filter(|given| given.any(&problem.layout));
    search.watch.begin(Phase::Profiles, "");
    let profiles = profiles(search, chosen);
    let mut cautions = problem.experiment.doubts.clone();
    cautions.extend(prepared.cautions.clone());
    cautions.extend(judgement.cautions.clone());
    cautions.extend(super::cautions::of_parameters(fitted));
    cautions.extend(super::cautions::of_draws(options.draws));
    let left_over = failures(&problem.experiment, &last.fit, floors);
    search.watch.begin(Phase::Next, "");
    let suggestions = suggestions(inputs, &judgement, chosen, fitted, &left_over);
    let interrupted = search.watch.stopped();
    let improved = problem.saved(&problem.free(chosen), &fitted.values());
    cautions.extend(problem.unfit(&improved));
    Ok(Diagnosis {
        experiment: (*problem.experiment).clone(),
        verdict: judgement.verdict,
        noise_floor: floors.clone(),
        noise_floor_source: prepared.source,
        noise: prepared.noise.models.clone(),
        given: given.map(|given| Fit::new(&problem.experiment, &problem.layout, &given.values)),
        unanswered: prepared.unanswered.clone(),
        pairs: pairs(inputs),
        invisible: prepared.invisible.clone(),
        share,
        lack_of_fit: LackOfFit {
            chi_square: stage.observed.chi_square,
            degrees_of_freedom: prepared.baseline.degrees_of_freedom,
            p_value: misfit.all,
            p_common: misfit.common,
            explainable: stage.structure(&stage.residual, &[]).0,
            p_structure: misfit.structure,
        },
        smallest_p: 1.0 / (options.draws as f64 + 1.0),
        explained_share: 1.0 - last.left,
        confused_with: confused(search, stage, &judgement, chosen),
        failures: failures(&problem.experiment, &steps[0].fit, floors),
        failures_left: left_over,
        suggestions,
        cautions,
        improved,
        sources: problem.sources.iter().cloned().chain(super::soil::offer(problem)).collect(),
        effects: judgement.effects,
        candidates,
        profiles,
        curves: curves_of_steps(problem, &steps),
        steps,
        interrupted,
        not_tried: lines(&search.watch.untried()),
    })
}

/// What to measure next.
fn suggestions(
    inputs: &Inputs,
    judgement: &Judgement,
    chosen: &[String],
    fitted: &Calibration,
    left_over: &[Failure],
) -> Vec<Suggestion> {
    let Inputs { search, stage, prepared, .. } = inputs;
    let signatures = stage.sensitivities.signatures.iter().enumerate();
    let unseen = signatures.filter(|(k, _)| largest_size(stage, *k) < DETECTABLE).map(|(_, s)| s.id.clone());
    let blind: Vec<String> = unseen.chain(prepared.invisible.iter().cloned()).collect();
    let pairs = confused(search, stage, judgement, chosen);
    let question = Question {
        problem: search.problem,
        values: &fitted.values()[..search.problem.base.len()],
        noise: &prepared.noise.models,
        verdict: judgement.verdict,
        named: &judgement.effects,
        pairs: &pairs,
        // Telling apart what is named or tied comes first.
        blind: if pairs.is_empty() { &blind } else { &[] },
        failures: left_over,
        repeated: !search.problem.experiment.replicates().is_empty(),
        watch: search.watch,
    };
    suggest(&question)
}

fn steps(inputs: &Inputs, chosen: &[String]) -> Result<Vec<Step>, CompareError> {
    let Inputs { search, stage, prepared, .. } = inputs;
    let problem = search.problem;
    let mut steps = Vec::new();
    for count in 0..=chosen.len() {
        let effects = &chosen[..count];
        let Some(fit) = search.fits.get(effects) else { continue };
        let values = fit.values();
        // After a stop the baseline is not simulated again: the stage knows what it gives.
        let known = effects.is_empty() && search.watch.stopped() && fit.chi_square == stage.fit.chi_square;
        let modelled = if known { Some(stage.modelled.clone()) } else { search.modelled(effects)? };
        let Some(modelled) = modelled else { continue };
        let shown = Fit::new(&problem.experiment, &problem.layout, &modelled);
        let left = match count {
            0 => 1.0,
            _ => left(search, stage, effects, &whitened_residual(search, effects, &values)?).0,
        };
        let held = match inputs.evidence.of(effects) {
            Some(held) => Some(held.clone()),
            None if inputs.evidence.no_time(search, effects) => None,
            None => held_out(problem, &prepared.noise, effects, fit, &inputs.evidence.folds),
        };
        steps.push(Step {
            added: effects.last().cloned(),
            rmse: shown.rmse.clone(),
            heldout_rmse: held.map(|held| held.rmse).unwrap_or_default(),
            parameters: parameters(problem.base.len(), fit),
            chi_square: fit.chi_square,
            degrees_of_freedom: fit.degrees_of_freedom,
            left,
            fit: shown,
        });
    }
    Ok(steps)
}

fn parameters(base: usize, fit: &Calibration) -> Vec<ParameterResult> {
    let result = |(k, fitted): (usize, &crate::diagnosis::CalibratedParameter)| ParameterResult {
        fitted: fitted.clone(),
        effect: k >= base,
    };
    fit.parameters.iter().enumerate().map(result).collect()
}

fn candidates(
    inputs: &Inputs,
    judgement: &Judgement,
    probabilities: Option<&Probabilities>,
) -> Result<Vec<CandidateResult>, CompareError> {
    let Inputs { search, stage, .. } = inputs;
    let baseline = inputs.evidence.of(&[]);
    let mut all = Vec::new();
    for (k, signature) in stage.sensitivities.signatures.iter().enumerate() {
        let set = vec![signature.id.clone()];
        let fit = search.fits.get(&set);
        let held = inputs.evidence.of(&set).zip(baseline);
        let gain = if fit.is_some() { search.gain(&set) } else { stage.gains.singles[k].0 };
        let left = match fit {
            // After a stop nothing is simulated any more.
            Some(fit) if !search.watch.stopped() || search.is_modelled(&set) => {
                left(search, stage, &set, &whitened_residual(search, &set, &fit.values())?).0
            }
            _ => (1.0 - gain / stage.structure(&stage.residual, &[]).0.max(gain).max(1.0)).clamp(0.0, 1.0),
        };
        let of_effect =
            |fit: &Calibration| parameters(search.problem.base.len(), fit).split_off(search.problem.base.len());
        all.push(CandidateResult {
            probability: probabilities.map_or(f64::NAN, |known| known.of(&signature.id)),
            tied: judgement.tied.contains(&signature.id),
            heldout_gain: held.map(|(own, base)| own.density.iter().sum::<f64>() - base.density.iter().sum::<f64>()),
            better: inputs.evidence.better(&set, &[]),
            p_value: p_value(&stage.draws, |draw| draw.single, gain),
            gain,
            left,
            refitted: fit.is_some(),
            visible_share: visible_share(inputs, k),
            parameters: fit.map(of_effect).unwrap_or_default(),
            effect: signature.id.clone(),
        });
    }
    Ok(all)
}

/// The part of a signature that the calibrated parameters cannot absorb.
fn visible_share(inputs: &Inputs, k: usize) -> f64 {
    let Inputs { search, stage, .. } = inputs;
    let view = stage.gains.singles[k].1;
    let Some(view) = stage.sensitivities.signatures[k].views.get(view) else { return 0.0 };
    let outside = &stage.projected.views[k][stage.gains.singles[k].1];
    let whole: f64 = view.columns.iter().map(|c| norm(&search.ground.whitening.apply(&c.values)).powi(2)).sum();
    let kept: f64 = outside.iter().map(|column| norm(column).powi(2)).sum();
    if whole > 0.0 { (kept / whole).sqrt().min(1.0) } else { 0.0 }
}

fn pairs(inputs: &Inputs) -> Vec<PairResult> {
    let Inputs { search, stage, .. } = inputs;
    let id = |k: usize| stage.sensitivities.signatures[k].id.clone();
    let mut pairs: Vec<PairResult> = stage
        .gains
        .pairs
        .iter()
        .map(|(i, j, screened)| {
            let effects = [id(*i), id(*j)];
            let refitted = search.fits.get(&effects).is_some();
            PairResult { gain: if refitted { search.gain(&effects) } else { *screened }, effects, refitted }
        })
        .collect();
    pairs.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    pairs
}
