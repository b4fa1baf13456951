//! From a finished search and its verdict to the [`Diagnosis`]: steps, candidates, profiles, the next experiment.

use super::bootstrap::p_value;
use super::engine::DiagnoseOptions;
use super::evidence::{Evidence, Probabilities};
use super::held_out::held_out;
use super::prepare::Prepared;
use super::profile::profiles;
use super::result::{CandidateResult, Diagnosis, LackOfFit, PairResult, ParameterResult, Share, Step, TriedFit};
use super::search::Search;
use super::stage::Stage;
use super::verdict::{Judgement, confused, left, misfit};
use super::watch::Phase;
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::curves::curves_of_steps;
use crate::diagnosis::failure::{Failure, failures};
use crate::diagnosis::fit::Fit;
use crate::diagnosis::found_soil::moved;
use crate::diagnosis::linear_algebra::norm;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::separate::{Question, Suggestion, suggest};
use crate::diagnosis::thresholds::DETECTABLE;
use crate::diagnosis::uncounted::uncounted;
use crate::diagnosis::workbench::Workbench;
use crate::model::Model;
use std::collections::BTreeMap;

/// A finished search.
pub(crate) struct Finished<'a> {
    pub search: &'a Search<'a>,
    pub stage: &'a Stage,
    pub prepared: &'a Prepared,
    pub evidence: &'a Evidence,
}

impl Finished<'_> {
    /// Puts the result together, but for the next experiment and what was not tried.
    ///
    /// # Errors
    /// [`CompareError`] where the model has no answer at a fit.
    pub fn diagnosis(
        &self,
        judgement: &Judgement,
        chosen: &[String],
        options: &DiagnoseOptions,
    ) -> Result<Diagnosis, CompareError> {
        let Finished { search, stage, prepared, .. } = self;
        let problem = search.problem;
        let steps = steps(self, chosen)?;
        let probabilities = self.evidence.probabilities(search, stage, prepared);
        let share = probabilities.as_ref().map_or(Share { enough: f64::NAN, other: f64::NAN }, Probabilities::share);
        let mut candidates = candidates(self, judgement, probabilities.as_ref())?;
        candidates.sort_by(|a, b| b.probability.total_cmp(&a.probability).then(b.gain.total_cmp(&a.gain)));
        let last = &steps[steps.len() - 1];
        let floors = &prepared.floors;
        let given = self.given()?;
        search.watch.begin(Phase::Profiles, "");
        let profiles = profiles(search, chosen);
        let improved = problem.saved(&problem.free(chosen), &self.fitted(chosen).values());
        Ok(Diagnosis {
            experiment: (*problem.experiment).clone(),
            verdict: judgement.verdict,
            noise_floor: floors.clone(),
            noise_floor_source: prepared.source,
            noise: prepared.noise.models.clone(),
            given,
            unanswered: prepared.unanswered.clone(),
            uncounted: uncounted(problem, &prepared.noise.odd, &prepared.unanswered),
            whole_drive: None,
            workbench: Workbench::prepared(problem, prepared),
            tried: self.tried(chosen),
            pairs: pairs(self),
            invisible: prepared.invisible.clone(),
            share,
            lack_of_fit: self.lack_of_fit(),
            smallest_p: 1.0 / (options.draws as f64 + 1.0),
            explained_share: 1.0 - last.left,
            confused_with: confused(search, stage, judgement, chosen),
            failures: failures(&problem.experiment, &steps[0].fit, floors),
            failures_left: failures(&problem.experiment, &last.fit, floors),
            suggestions: Vec::new(),
            cautions: self.cautions(judgement, chosen, options, &improved),
            improved,
            improved_parts: problem.saved_parts(&problem.free(chosen), &self.fitted(chosen).values()),
            places: places(problem, judgement),
            sources: problem.sources.iter().cloned().chain(super::soil::offer(problem)).collect(),
            effects: judgement.effects.clone(),
            possible_beside: judgement.beside.clone(),
            candidates,
            profiles,
            curves: curves_of_steps(problem, &steps),
            steps,
            interrupted: false,
            not_tried: Vec::new(),
        })
    }

    /// The final fit.
    fn fitted(&self, chosen: &[String]) -> &Calibration {
        self.search.fits.get(chosen).unwrap_or(&self.prepared.baseline)
    }

    /// The fits of each effect alone, and of the effects that were chosen, one more at a time.
    fn tried(&self, chosen: &[String]) -> Vec<TriedFit> {
        let steps = (2..=chosen.len()).map(|count| chosen[..count].to_vec());
        let alone = self.search.problem.library.iter().map(|candidate| vec![candidate.id.clone()]);
        let of = |effects: Vec<String>| {
            let calibration = self.search.fits.get(&effects)?.clone();
            Some(TriedFit { effects, calibration })
        };
        alone.chain(steps).filter_map(of).collect()
    }

    /// What the given parameters give; `None` where they have no answer.
    fn given(&self) -> Result<Option<Fit>, CompareError> {
        let problem = self.search.problem;
        let start: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
        let given = problem.shown().predict(&problem.base, |predict| predict.answers(&start))?;
        let given = given.ok().filter(|given| given.any(&problem.layout));
        let shown = given.map(|given| Fit::new(&problem.experiment, &problem.layout, &given.values));
        Ok(shown.map(|fit| fit.in_motion(problem, &[], &start)).transpose()?)
    }

    fn lack_of_fit(&self) -> LackOfFit {
        let misfit = misfit(self.stage);
        LackOfFit {
            chi_square: self.stage.observed.chi_square,
            degrees_of_freedom: self.prepared.baseline.degrees_of_freedom,
            p_value: misfit.all,
            p_common: misfit.common,
            explainable: self.stage.structure(&self.stage.residual, &[]).0,
            p_structure: misfit.structure,
        }
    }

    fn cautions(
        &self,
        judgement: &Judgement,
        chosen: &[String],
        options: &DiagnoseOptions,
        improved: &Model,
    ) -> Vec<String> {
        let problem = self.search.problem;
        let mut cautions = problem.experiment.doubts.clone();
        cautions.extend(self.prepared.cautions.clone());
        cautions.extend(judgement.cautions.clone());
        cautions.extend(super::cautions::of_parameters(self.fitted(chosen)));
        cautions.extend(moved(problem.joint.as_ref(), self.fitted(chosen)));
        cautions.extend(super::cautions::of_draws(options.draws));
        cautions.extend(problem.strategy().unfit(improved));
        cautions
    }

    /// What to measure next; `left_over` is where the final model still fails.
    pub fn next_experiment(&self, judgement: &Judgement, chosen: &[String], left_over: &[Failure]) -> Vec<Suggestion> {
        let Finished { search, stage, prepared, .. } = self;
        let signatures = stage.sensitivities.signatures.iter().enumerate();
        let unseen = signatures.filter(|(k, _)| stage.largest_size(*k) < DETECTABLE).map(|(_, s)| s.id.clone());
        let blind: Vec<String> = unseen.chain(prepared.invisible.iter().cloned()).collect();
        let pairs = confused(search, stage, judgement, chosen);
        let question = Question {
            problem: search.problem,
            values: &self.fitted(chosen).values()[..search.problem.base.len()],
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
}

/// Of several experiments, those in which the effects that the verdict is about act.
fn places(problem: &Problem, judgement: &Judgement) -> BTreeMap<String, Vec<String>> {
    let involved = judgement.effects.iter().chain(&judgement.tied);
    let places = involved.map(|id| (id.clone(), problem.parts_with(id)));
    places.filter(|(_, parts)| !parts.is_empty()).collect()
}

fn steps(finished: &Finished, chosen: &[String]) -> Result<Vec<Step>, CompareError> {
    let Finished { search, stage, prepared, .. } = finished;
    let problem = search.problem;
    let mut steps = Vec::new();
    for count in 0..=chosen.len() {
        let effects = &chosen[..count];
        let Some(fit) = search.fits.get(effects) else { continue };
        let values = fit.values();
        // After a stop the baseline is not simulated again: the stage holds its modelled values.
        let known = effects.is_empty() && search.watch.stopped() && fit.chi_square == stage.fit.chi_square;
        let modelled = if known { Some(stage.modelled.clone()) } else { search.modelled(effects)? };
        let Some(modelled) = modelled else { continue };
        let modelled = problem.with_spared(effects, &values, modelled)?;
        let shown = Fit::new(&problem.experiment, &problem.layout, &modelled).in_motion(problem, effects, &values)?;
        let left = match count {
            0 => 1.0,
            _ => left(search, stage, effects, &search.whitened_residual(effects, &values)?).0,
        };
        let held = match finished.evidence.of(effects) {
            Some(held) => Some(held.clone()),
            None if finished.evidence.no_time(search, effects) => None,
            None => held_out(problem, &prepared.noise, effects, fit, &finished.evidence.folds),
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
    finished: &Finished,
    judgement: &Judgement,
    probabilities: Option<&Probabilities>,
) -> Result<Vec<CandidateResult>, CompareError> {
    let Finished { search, stage, .. } = finished;
    let baseline = finished.evidence.of(&[]);
    let mut all = Vec::new();
    for (k, signature) in stage.sensitivities.signatures.iter().enumerate() {
        let set = vec![signature.id.clone()];
        let fit = search.fits.get(&set);
        let held = finished.evidence.of(&set).zip(baseline);
        let gain = if fit.is_some() { search.gain(&set) } else { stage.gains.singles[k].0 };
        let left = match fit {
            // After a stop nothing is simulated any more.
            Some(fit) if !search.watch.stopped() || search.is_modelled(&set) => {
                left(search, stage, &set, &search.whitened_residual(&set, &fit.values())?).0
            }
            _ => (1.0 - gain / stage.structure(&stage.residual, &[]).0.max(gain).max(1.0)).clamp(0.0, 1.0),
        };
        let of_effect =
            |fit: &Calibration| parameters(search.problem.base.len(), fit).split_off(search.problem.base.len());
        all.push(CandidateResult {
            probability: probabilities.map_or(f64::NAN, |known| known.of(&signature.id)),
            tied: judgement.tied.contains(&signature.id),
            heldout_gain: held.map(|(own, base)| own.density.iter().sum::<f64>() - base.density.iter().sum::<f64>()),
            better: finished.evidence.better(&set, &[]),
            p_value: p_value(&stage.draws, |draw| draw.single, gain),
            gain,
            left,
            refitted: fit.is_some(),
            visible_share: visible_share(finished, k),
            parameters: fit.map(of_effect).unwrap_or_default(),
            effect: signature.id.clone(),
        });
    }
    Ok(all)
}

/// The part of a signature that the calibrated parameters cannot absorb.
fn visible_share(finished: &Finished, k: usize) -> f64 {
    let Finished { search, stage, .. } = finished;
    let view = stage.gains.singles[k].1;
    let Some(view) = stage.sensitivities.signatures[k].views.get(view) else { return 0.0 };
    let outside = &stage.projected.views[k][stage.gains.singles[k].1];
    let whole: f64 = view.columns.iter().map(|c| norm(&search.context.whitening.apply(&c.values)).powi(2)).sum();
    let kept: f64 = outside.iter().map(|column| norm(column).powi(2)).sum();
    if whole > 0.0 { (kept / whole).sqrt().min(1.0) } else { 0.0 }
}

fn pairs(finished: &Finished) -> Vec<PairResult> {
    let Finished { search, stage, .. } = finished;
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
