//! From the chosen effects to the verdict: effects that the set could do without are dropped, and the smaller set is judged
//! by the same rules.

use super::bootstrap::p_value;
use super::doubts::{Doubt, doubts};
use super::evidence::Evidence;
use super::prepare::Prepared;
use super::search::Search;
use super::stage::Stage;
use super::verdict::{self, Case, Judgement};
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::thresholds::{BETTER, NAMED, WORTH_A_SWAP};

/// A verdict and the set that it is about, in the order in which its effects were chosen.
pub(crate) struct Judged {
    pub judgement: Judgement,
    pub chosen: Vec<String>,
}

/// Judges a chosen set.
///
/// # Errors
/// [`PredictionError`] where the model has no answer at a fit.
pub(crate) fn judge(
    search: &mut Search,
    stage: &Stage,
    prepared: &Prepared,
    evidence: &mut Evidence,
    mut chosen: Vec<String>,
) -> Result<Judged, PredictionError> {
    let mut dropped = Vec::new();
    loop {
        if chosen.is_empty() || search.fits.get(&chosen).is_none() {
            let judgement = verdict::without_effects(stage, stage.blind_share());
            return Ok(Judged { judgement, chosen: Vec::new() });
        }
        let doubts = doubts(search, stage, &chosen)?;
        let superfluous = doubts.iter().find_map(|doubt| Some((doubt, doubt.superfluous()?.to_owned())));
        match superfluous.filter(|_| chosen.len() > 1 && !search.watch.stopped()) {
            Some((doubt, id)) => {
                dropped.push(format!("{id} is not named beside the rest: {}", doubt.words()));
                chosen.retain(|other| *other != id);
            }
            None => {
                let mut judgement = judged(search, stage, prepared, evidence, &chosen, &doubts)?;
                dropped.append(&mut judgement.cautions);
                judgement.cautions = dropped;
                return Ok(Judged { judgement, chosen });
            }
        }
    }
}

/// The verdict on a set of which no effect is to be dropped.
fn judged(
    search: &mut Search,
    stage: &Stage,
    prepared: &Prepared,
    evidence: &mut Evidence,
    chosen: &[String],
    doubts: &[Doubt],
) -> Result<Judgement, PredictionError> {
    search.rivals(stage, chosen, WORTH_A_SWAP);
    let Some(fit) = search.fits.get(chosen) else {
        return Ok(verdict::without_effects(stage, 0.0));
    };
    let residual = search.whitened_residual(chosen, &fit.values())?;
    let all = candidates(stage);
    let as_good = verdict::rivals(search, chosen, &all);
    let imitates = |own: &String| {
        as_good.iter().any(|(other, _)| other == own) || verdict::is_imitation(search, stage, chosen, own)
    };
    let rivals = rivals(search, stage, prepared, evidence, chosen, as_good.clone());
    let better = evidence.better(chosen, &[]);
    let case = Case {
        effects: chosen,
        left: verdict::left(search, stage, chosen, &residual),
        more_than_noise_alone: beats_noise(search, stage, chosen),
        imitating: chosen.iter().filter(|own| imitates(own)).cloned().collect(),
        predicted: better.is_some(),
        confirmed: better.is_some_and(|better| better > BETTER),
        without_priors: without_priors(search, stage, chosen),
        rivals,
        doubts,
    };
    Ok(verdict::with_effects(&case))
}

/// Whether a set gains more than the best of all candidates does by noise alone.
fn beats_noise(search: &Search, stage: &Stage, chosen: &[String]) -> bool {
    let pick = |draw: &super::bootstrap::Statistics| if chosen.len() > 1 { draw.pair } else { draw.single };
    p_value(&stage.draws, pick, search.gain(chosen)) < NAMED
}

/// Whether the naming holds with the priors all but removed; `None` without priors.
fn without_priors(search: &Search, stage: &Stage, chosen: &[String]) -> Option<bool> {
    if search.watch.stopped() || search.problem.base.iter().all(|free| free.prior.is_none()) {
        return None;
    }
    let (base, with) = (search.without_priors(&[]), search.without_priors(chosen));
    let gain = base.zip(with).map_or(0.0, |(base, with)| base.chi_square - with.chi_square);
    Some(p_value(&stage.draws, |draw| if chosen.len() > 1 { draw.pair } else { draw.single }, gain) < NAMED)
}

fn candidates(stage: &Stage) -> Vec<String> {
    stage.sensitivities.signatures.iter().map(|signature| signature.id.clone()).collect()
}

/// Effects that could stand in the place of one of the set: those that fit about as well (`as_good`) where left-out data do
/// not speak against them, and those that left-out data make more probable.
fn rivals(
    search: &Search,
    stage: &Stage,
    prepared: &Prepared,
    evidence: &mut Evidence,
    chosen: &[String],
    as_good: Vec<(String, String)>,
) -> Vec<(String, String)> {
    let all = candidates(stage);
    let mut rivals = as_good;
    let mut sets: Vec<Vec<String>> = rivals.iter().map(|(own, other)| verdict::swapped(chosen, own, other)).collect();
    sets.push(chosen.to_vec());
    evidence.add(search, sets);
    let told_apart = |(own, other): &(String, String)| {
        evidence.better(chosen, &verdict::swapped(chosen, own, other)).is_some_and(|better| better > BETTER)
    };
    rivals.retain(|pair| !told_apart(pair));
    let (_, inclusion) = evidence.probabilities(search, stage, prepared);
    let Some(inclusion) = inclusion else { return rivals };
    let probability = |id: &String| inclusion.get(id).copied().unwrap_or(0.0);
    let least = chosen.iter().min_by(|a, b| probability(a).total_cmp(&probability(b)));
    for other in all.iter().filter(|id| !chosen.contains(id)) {
        let known = rivals.iter().any(|(_, rival)| rival == other);
        if let Some(own) = least.filter(|own| !known && probability(other) > probability(own)) {
            rivals.push((own.clone(), other.clone()));
        }
    }
    rivals
}
