//! What left-out data say: predictions of fitted sets, and the probabilities that follow from them.

use super::folds::{Fold, folds};
use super::held_out::{HeldOut, held_out};
use super::prepare::Prepared;
use super::probability::{against, better, something_else, weights};
use super::result::Share;
use super::search::Search;
use super::stage::Stage;
use super::untried::{Untried, named};
use crate::diagnosis::thresholds::{COMPETING_PAIRS, COMPETING_SINGLES, PRIOR_ENOUGH, PRIOR_OTHER};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

/// What predicting the left-out conditions with one set costs, in single fits: six short refits on a carriage; less on a
/// traverse.
const PREDICTION: f64 = 1.0;

/// Predictions of what was left out, by fitted set.
pub(crate) struct Evidence {
    pub folds: Vec<Fold>,
    /// With the bits of chi-square of the fit: a set that was fitted once more since predicts anew.
    held: BTreeMap<Vec<String>, (u64, HeldOut)>,
    /// What "something else" predicts, once it was asked for; none where that could not be computed.
    other: OnceLock<Option<Vec<f64>>>,
}

impl Evidence {
    /// Of the baseline, the best singles and pairs, and the prefixes of a chosen set.
    pub fn new(search: &Search, chosen: &[String]) -> Self {
        let mut evidence =
            Self { folds: folds(&search.problem.experiment), held: BTreeMap::new(), other: OnceLock::new() };
        let best = |count: usize, most: usize| {
            let mut sets: Vec<&Vec<String>> = search.fits.of(count).map(|(set, _)| set).collect();
            sets.sort_by(|a, b| search.net_gain(b).total_cmp(&search.net_gain(a)));
            sets.into_iter().take(most).cloned().collect::<Vec<_>>()
        };
        let mut sets = vec![Vec::new()];
        sets.extend((2..=chosen.len()).rev().map(|count| chosen[..count].to_vec()));
        sets.extend(best(1, COMPETING_SINGLES));
        sets.extend(best(2, COMPETING_PAIRS));
        evidence.add(search, sets);
        evidence
    }

    /// Predicts with further sets, as far as they are fitted, unless the same fit was predicted with before.
    pub fn add(&mut self, search: &Search, mut sets: Vec<Vec<String>>) {
        sets.iter_mut().for_each(|set| set.sort());
        let mut known = BTreeSet::new();
        let bits = |set: &[String]| search.fits.get(set).map(|fit| fit.chi_square.to_bits());
        let is_held = |set: &[String]| self.held.get(set).is_some_and(|(of, _)| bits(set) == Some(*of));
        sets.retain(|set| known.insert(set.clone()) && !is_held(set));
        // In the order of their importance, in case there is no time for all.
        let folds = &self.folds;
        let predict = |set: &Vec<String>| held_out(search.problem, search.noise, set, search.fits.get(set)?, folds);
        let untried = |set: &Vec<String>| Untried::LeftOut(set.clone());
        let held = search.watch.pieces(&sets, PREDICTION, |set| named(set), untried, predict);
        self.held.extend(sets.into_iter().zip(held).filter_map(|(set, held)| {
            let of = bits(&set)?;
            Some((set, (of, held?)))
        }));
    }

    /// Whether there was no time to predict with a set.
    pub fn no_time(&self, search: &Search, effects: &[String]) -> bool {
        let mut set = effects.to_vec();
        set.sort();
        search.watch.untried().contains(&Untried::LeftOut(set))
    }

    /// What a set predicts of the left-out data.
    pub fn of(&self, effects: &[String]) -> Option<&HeldOut> {
        let mut set = effects.to_vec();
        set.sort();
        self.held.get(&set).map(|(_, held)| held)
    }

    /// Probability that one set predicts better than another; `None` where one of them was not predicted with.
    pub fn better(&self, ours: &[String], theirs: &[String]) -> Option<f64> {
        Some(better(&self.of(ours)?.density, &self.of(theirs)?.density))
    }

    /// Probability of one set where only another competes; `None` where one of them was not predicted with.
    pub fn against(&self, ours: &[String], theirs: &[String]) -> Option<f64> {
        Some(against(&self.of(ours)?.density, &self.of(theirs)?.density))
    }

    /// Probabilities of all that competes; `None` where a set of effects was not tried or predicted.
    pub fn probabilities(&self, search: &Search, stage: &Stage, prepared: &Prepared) -> Option<Probabilities> {
        let partial = |piece: &Untried| piece.unknown().is_some() || matches!(piece, Untried::LeftOut(_));
        if search.watch.stopped() || search.watch.untried().iter().any(partial) {
            return None;
        }
        let measured = &search.problem.layout.measured;
        let difference: Vec<f64> = measured.iter().zip(&stage.modelled).map(|(y, m)| y - m).collect();
        let base = &stage.sensitivities.base;
        let other = self.other.get_or_init(|| {
            something_else(search.problem, &prepared.noise, &difference, base, &prepared.flexible, &self.folds)
        });
        // A stop meanwhile.
        if other.is_none() && search.watch.stopped() {
            return None;
        }
        let mut densities: Vec<&[f64]> = self.held.values().map(|(_, held)| held.density.as_slice()).collect();
        densities.extend(other.as_deref());
        // A candidate at its neutral value is the baseline, so many useless candidates must not outvote "enough".
        let each = (1.0 - PRIOR_ENOUGH - PRIOR_OTHER) / self.held.len().saturating_sub(1).max(1) as f64;
        let mut priors: Vec<f64> =
            self.held.keys().map(|set| if set.is_empty() { PRIOR_ENOUGH } else { each }).collect();
        priors.extend(other.as_ref().map(|_| PRIOR_OTHER));
        let mut weights = weights(&densities, &priors);
        let other = if other.is_some() { weights.pop().unwrap_or(0.0) } else { 0.0 };
        let sets = self.held.keys().cloned().zip(weights).collect();
        Some(Probabilities { sets, other })
    }
}

/// Probabilities of the sets of effects that compete, and of "something else".
pub(crate) struct Probabilities {
    /// By set; the empty one is "the baseline is enough".
    sets: BTreeMap<Vec<String>, f64>,
    other: f64,
}

impl Probabilities {
    /// Probabilities of "enough" and "something else".
    pub fn share(&self) -> Share {
        Share { enough: self.sets.get(&Vec::new()).copied().unwrap_or(0.0), other: self.other }
    }

    /// Probability that an effect is part of the explanation.
    pub fn of(&self, id: &str) -> f64 {
        self.sum(|set| set.iter().any(|own| own == id))
    }

    /// Probability that an effect is part of the explanation and another one is not.
    pub fn without(&self, id: &str, absent: &str) -> f64 {
        self.sum(|set| set.iter().any(|own| own == id) && !set.iter().any(|own| own == absent))
    }

    fn sum(&self, counts: impl Fn(&[String]) -> bool) -> f64 {
        // From +0, since the sum of nothing is -0 and would be written so.
        self.sets.iter().filter(|(set, _)| counts(set)).fold(0.0, |sum, (_, weight)| sum + weight)
    }
}
