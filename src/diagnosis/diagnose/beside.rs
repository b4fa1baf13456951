//! What may act beside the named effects and is not told from another form of their laws.
//!
//! A second effect is named only if it gains more than noise even where the strengths of the first ones may vary smoothly with the
//! conditions (`stage`), brings at least a hundredth of what all gain, and is one of few that do as well. Where it fails one of these
//! although it gains more than noise, a user should know of it. An example is a rover with an unknown payload and a worn bearing:
//! viscous friction accounts for what the payload leaves, and so does a payload whose effect grows with the speed.

use super::bootstrap::p_value;
use super::gains::SingleGain;
use super::search::{Search, sorted};
use super::stage::Stage;
use super::starts::Start;
use super::untried::Untried;
use super::verdict::{Judgement, rivals, swapped};
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::thresholds::{NAMED, WORTH_A_REFIT};
use std::collections::BTreeMap;

/// What each further effect promises to gain beside a set, and where its fit starts, by the set; and chi-square of the set then.
pub(super) type Promised = BTreeMap<Vec<String>, (f64, Vec<(f64, Start)>)>;

/// Most further effects that are fitted.
const MOST: usize = 6;

impl Search<'_> {
    /// Keeps what further effects promise beside those of a stage, whose strengths stay the same under all conditions.
    pub(super) fn keep_promises(&mut self, stage: &Stage) {
        let of = |(k, gain): (usize, &SingleGain)| (gain.0, self.start_by(stage, k, gain));
        let promises = stage.gains_at_constant_strength.iter().enumerate().map(of).collect();
        self.promised.insert(sorted(&stage.effects), (stage.fit.chi_square, promises));
    }

    /// What further effects promise beside a fitted set, the most first; none after a stop and where there is no time to find it.
    fn promises(&mut self, set: &[String]) -> Result<Vec<(f64, Start)>, PredictionError> {
        let Some(now) = self.fits.get(set).map(|fit| fit.chi_square) else { return Ok(Vec::new()) };
        // The set may have been fitted once more since.
        if self.promised.get(&sorted(set)).is_none_or(|(then, _)| *then != now) {
            let Some(stage) = self.stage(set)? else { return Ok(Vec::new()) };
            self.keep_promises(&stage);
        }
        let mut promises = self.promised.get(&sorted(set)).map_or(Vec::new(), |(_, promises)| promises.clone());
        promises.sort_by(|a, b| b.0.total_cmp(&a.0));
        Ok(promises)
    }

    /// Looks for what may act beside the effects that a judgement names, and says it. `stage` is the baseline's.
    ///
    /// # Errors
    /// [`PredictionError`] where the model has no answer at a fit.
    pub(super) fn beside(
        &mut self,
        stage: &Stage,
        judgement: &mut Judgement,
    ) -> Result<Option<String>, PredictionError> {
        let named = judgement.effects.clone();
        if !judgement.names() || self.watch.stopped() {
            return Ok(None);
        }
        let mut promises = self.promises(&named)?;
        let most = promises.first().map_or(0.0, |(gain, _)| *gain);
        let more_than_noise = |gain: f64| p_value(&stage.draws, |draw| draw.single, gain) < NAMED;
        if !more_than_noise(most) {
            return Ok(None);
        }
        promises.truncate(MOST);
        promises.retain(|(gain, _)| *gain >= WORTH_A_REFIT * most);
        if !self.watch.has_time(promises.len() as f64) {
            self.watch.leave([Untried::Further(named)]);
            return Ok(None);
        }
        let sets: Vec<Vec<String>> = promises.iter().map(|(_, (set, _))| set.clone()).collect();
        self.fit(promises.into_iter().map(|(_, start)| start).collect());
        let fitted = sets.into_iter().filter(|set| self.fits.get(set).is_some());
        let Some(best) = fitted.max_by(|a, b| self.net_gain(a).total_cmp(&self.net_gain(b))) else { return Ok(None) };
        let gain = self.gain(&best) - self.gain(&named);
        let Some(new) = best.last().filter(|_| more_than_noise(gain)).cloned() else { return Ok(None) };
        let all: Vec<String> = stage.sensitivities.signatures.iter().map(|signature| signature.id.clone()).collect();
        let as_good = rivals(self, stage, &best, &all)?.into_iter().filter(|(own, _)| *own == new);
        let mut others: Vec<String> = as_good.map(|(_, other)| other).collect();
        others.sort_by(|a, b| {
            let gain = |id: &String| self.net_gain(&swapped(&best, &new, id));
            gain(b).total_cmp(&gain(a))
        });
        judgement.beside = std::iter::once(new).chain(others).collect();
        Ok(Some(format!(
            "{} leaves more than noise: adding {} lowers chi-square by {gain:.0}, and another law of what is named could explain it as well",
            named.join(" with "),
            judgement.beside.join(" or "),
        )))
    }
}
