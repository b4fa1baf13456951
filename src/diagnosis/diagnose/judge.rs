//! From the chosen effects to the verdict: effects that the set could do without are dropped, and the smaller set is judged
//! by the same rules.

use super::bootstrap::p_value;
use super::doubts::{Doubt, doubts};
use super::evidence::{Evidence, Probabilities};
use super::prepare::Prepared;
use super::search::Search;
use super::stage::Stage;
use super::verdict::{self, Case, Judgement};
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::thresholds::{BETTER, MAY_STAY, MOST_TIED, NAMED, UNLIKELY, WORTH_A_SWAP};

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
                let judgement = judged(search, stage, prepared, evidence, &chosen, &doubts)?;
                let clearer = clearer(search, stage, prepared, evidence, &judgement, &chosen)?;
                let mut found = clearer.unwrap_or(Judged { judgement, chosen });
                found.judgement.cautions.splice(0..0, dropped);
                return Ok(found);
            }
        }
    }
}

/// The verdict on a set without its last effect, where that names effects and leaves little or nothing but noise, and the whole leaves so many possible that it
/// tells nothing. What may act beside them is said by `beside`.
fn clearer(
    search: &mut Search,
    stage: &Stage,
    prepared: &Prepared,
    evidence: &mut Evidence,
    whole: &Judgement,
    chosen: &[String],
) -> Result<Option<Judged>, PredictionError> {
    if chosen.len() < 2 || whole.tied.len() <= MOST_TIED || search.watch.stopped() {
        return Ok(None);
    }
    let first = &chosen[..chosen.len() - 1];
    let Some(values) = search.fits.get(first).map(Calibration::values) else { return Ok(None) };
    let residual = search.whitened_residual(first, &values)?;
    let (left, more_than_noise) = verdict::left(search, stage, first, &residual);
    if more_than_noise && left > MAY_STAY {
        return Ok(None);
    }
    let part = judge(search, stage, prepared, evidence, first.to_vec())?;
    Ok(part.judgement.names().then_some(part))
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
    let as_good = verdict::rivals(search, stage, chosen, &all)?;
    let imitates = |own: &String| {
        as_good.iter().any(|(other, _)| other == own) || verdict::is_imitation(search, stage, chosen, own)
    };
    let mut rivals = rivals(search, stage, evidence, chosen, as_good.clone())?;
    let probabilities = evidence.probabilities(search, stage, prepared);
    let improbable = probabilities.and_then(|probabilities| {
        add_probable(&probabilities, stage, chosen, &mut rivals);
        improbable(&probabilities, chosen, !rivals.is_empty())
    });
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
        improbable,
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
    if search.watch.stopped()
        || search.problem.base.iter().all(|free| free.prior.or(free.shared).is_none() || free.is_of_a_sensor())
    {
        return None;
    }
    let (base, with) = (search.without_priors(&[]), search.without_priors(chosen));
    let gain = base.zip(with).map_or(0.0, |(base, with)| base.chi_square - with.chi_square);
    Some(p_value(&stage.draws, |draw| if chosen.len() > 1 { draw.pair } else { draw.single }, gain) < NAMED)
}

fn candidates(stage: &Stage) -> Vec<String> {
    stage.sensitivities.signatures.iter().map(|signature| signature.id.clone()).collect()
}

/// Effects that could stand in the place of one of the set: of those that fit about as well (`as_good`) the ones that left-out
/// data do not speak against, and look-alikes where left-out data do not count against these.
fn rivals(
    search: &Search,
    stage: &Stage,
    evidence: &mut Evidence,
    chosen: &[String],
    as_good: Vec<(String, String)>,
) -> Result<Vec<(String, String)>, PredictionError> {
    let mut sets: Vec<Vec<String>> = as_good.iter().map(|(own, other)| verdict::swapped(chosen, own, other)).collect();
    sets.push(chosen.to_vec());
    evidence.add(search, sets);
    let told_apart = |(own, other): &(String, String)| {
        evidence.against(chosen, &verdict::swapped(chosen, own, other)).is_some_and(|ours| ours > BETTER)
    };
    let mut rivals = Vec::new();
    for pair in as_good {
        let alikes_tie = search.problem.strategy().alikes(search.problem, &pair.0).is_some();
        if !told_apart(&pair) || (alikes_tie && verdict::are_alike(search, stage, chosen, &pair.0, &pair.1)?) {
            rivals.push(pair);
        }
    }
    Ok(rivals)
}

/// Adds those candidates to the rivals that keep more than the probability [`UNLIKELY`] without an effect of the set.
fn add_probable(probabilities: &Probabilities, stage: &Stage, chosen: &[String], rivals: &mut Vec<(String, String)>) {
    for other in candidates(stage).into_iter().filter(|id| !chosen.contains(id)) {
        let without = |own: &&String| probabilities.without(&other, own);
        let Some(own) = chosen.iter().max_by(|a, b| without(a).total_cmp(&without(b))) else { continue };
        if without(&own) > UNLIKELY && !rivals.iter().any(|(_, rival)| *rival == other) {
            rivals.push((own.clone(), other));
        }
    }
}

/// Reasons against naming a set of which an effect keeps less than the probability [`BETTER`] although no single rival
/// is probable, or beside which the baseline alone or "something else" is.
fn improbable(probabilities: &Probabilities, chosen: &[String], has_rivals: bool) -> Option<String> {
    let least = chosen.iter().min_by(|a, b| probabilities.of(a).total_cmp(&probabilities.of(b)))?;
    let (kept, share) = (probabilities.of(least), probabilities.share());
    let elsewhere = share.enough.max(share.other) > UNLIKELY;
    ((kept < BETTER && !has_rivals) || elsewhere).then(|| {
        format!(
            "{least} keeps {:.0} % of the probability, and a name needs {:.0} %; \"something else\", which may be another form of it, \
             keeps {:.0} %, the baseline alone {:.0} %",
            100.0 * kept, 100.0 * BETTER, 100.0 * share.other, 100.0 * share.enough,
        )
    })
}
