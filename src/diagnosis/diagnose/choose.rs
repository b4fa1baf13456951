//! Which effects are chosen: the best single one, what it takes beside it, and what of that is worth naming.

use super::bootstrap::p_value;
use super::engine::DiagnoseOptions;
use super::search::Search;
use super::stage::Stage;
use super::verdict;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::thresholds::{MAY_STAY, NAMED, REACH, TOO_MUCH};

/// The effects that gain more than noise alone, in the order of their gains.
pub(super) fn choose(
    search: &mut Search,
    stage: &Stage,
    options: &DiagnoseOptions,
) -> Result<Vec<String>, PredictionError> {
    let best = best_of(search, 1);
    let p_single = best.as_ref().map_or(1.0, |set| p_value(&stage.draws, |draw| draw.single, search.gain(set)));
    let p_pair = p_value(&stage.draws, |draw| draw.pair, stage.observed.pair);
    let mut chosen = best.clone().filter(|_| p_single < NAMED && options.max_effects > 0).unwrap_or_default();
    if options.max_effects < 2 || (chosen.is_empty() && p_pair >= NAMED) || (search.control.stop)() {
        return Ok(chosen);
    }
    let mut grown = if chosen.is_empty() { None } else { further(search, &chosen)? };
    // Before a second effect is taken: whether the first one, fitted from elsewhere, leaves nothing for it.
    if grown.is_some() && search.again_at_given_soil(stage) {
        chosen = best_of(search, 1).unwrap_or(chosen);
        grown = further(search, &chosen)?;
    }
    if grown.is_some() || chosen.is_empty() {
        search.pairs(stage);
        search.lower_valleys(1);
        if let Some(pair) = best_pair(search, &chosen, grown)? {
            chosen = pair;
        }
    }
    while chosen.len() >= 2 && chosen.len() < options.max_effects && !(search.control.stop)() {
        let Some(set) = further(search, &chosen)? else { break };
        chosen = set;
    }
    let chosen = needed(search, stage, chosen);
    worth_naming(search, stage, chosen)
}

/// The chosen effects without those that had only helped the search along: each set with one effect less is fitted again
/// from where the whole came. `stage` is the baseline's.
fn needed(search: &mut Search, stage: &Stage, mut chosen: Vec<String>) -> Vec<String> {
    while chosen.len() > 1 && search.problem.strategy().budget().refits_from_larger {
        let without = |id: &String| chosen.iter().filter(|other| *other != id).cloned().collect::<Vec<_>>();
        let parts: Vec<Vec<String>> = chosen.iter().map(without).collect();
        parts.iter().for_each(|part| search.settle_below(&chosen, part));
        let best = parts.into_iter().max_by(|a, b| search.gain(a).total_cmp(&search.gain(b)));
        let step = |part: &Vec<String>| search.gain(&chosen) - search.gain(part);
        match best.filter(|part| p_value(&stage.draws, |draw| draw.single, step(part)) >= NAMED) {
            Some(part) => chosen = part,
            None => break,
        }
    }
    chosen
}

/// As many of the chosen effects as are worth naming: where the later ones leave over half of the little that the first left,
/// that is mostly another form of the first, of which the later ones took a bit. Where much is left, they are the known part
/// of something else.
fn worth_naming(search: &Search, stage: &Stage, mut chosen: Vec<String>) -> Result<Vec<String>, PredictionError> {
    if chosen.len() < 2 {
        return Ok(chosen);
    }
    let mut left = Vec::new();
    for count in 1..=chosen.len() {
        let Some(fit) = search.fits.get(&chosen[..count]) else { return Ok(chosen) };
        let residual = search.whitened_residual(&chosen[..count], &fit.values())?;
        left.push(verdict::left(search, stage, &chosen[..count], &residual));
    }
    if let Some((last, true)) = left.last().copied().filter(|(last, _)| *last <= MAY_STAY) {
        let too_little = |(share, _): &(f64, bool)| last > TOO_MUCH * share;
        let enough = left.iter().position(too_little).map_or(chosen.len(), |k| k + 1);
        chosen.truncate(enough);
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
    search.keep_promises(&stage);
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
    if search.net_gain(&best) <= known + REACH {
        return Ok(grown);
    }
    for id in &best {
        let alone = std::slice::from_ref(id);
        let Some(stage) = search.stage(alone)? else { return Ok(grown) };
        search.keep_promises(&stage);
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
