//! What may act beside the named effects and is not told from another form of their laws.
//!
//! A second effect is named only if it gains more than noise even where the strengths of the first ones may vary smoothly with the
//! conditions (`stage`), brings at least a hundredth of what all gain, and is one of few that do as well. Where it fails one of these
//! although it gains more than noise, a user should know of it. An example is a rover with an unknown payload and a worn bearing:
//! viscous friction accounts for what the payload leaves, and so does a payload whose effect grows with the speed.

use super::bootstrap::p_value;
use super::search::{Search, sorted};
use super::stage::Stage;
use super::starts::Start;
use super::verdict::{Judgement, rivals};
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::thresholds::{NAMED, WORTH_A_REFIT};
use std::collections::BTreeMap;

/// For a set of effects what each further one promises to gain beside it, and where its fit starts.
pub(super) type Promised = BTreeMap<Vec<String>, Vec<(f64, Start)>>;

/// Most further effects that are fitted.
const MOST: usize = 6;

impl Search<'_> {
    /// Keeps what further effects promise beside those of a stage, whose strengths stay the same under all conditions.
    pub(super) fn keep_promises(&mut self, stage: &Stage) {
        let promises = stage.plain.iter().enumerate().map(|(k, gain)| (*gain, self.start(stage, k))).collect();
        self.promised.insert(sorted(&stage.effects), promises);
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
        let mut promises = self.promised.get(&sorted(&named)).cloned().unwrap_or_default();
        promises.sort_by(|a, b| b.0.total_cmp(&a.0));
        promises.truncate(MOST);
        let most = promises.first().map_or(0.0, |(gain, _)| *gain);
        let more_than_noise = |gain: f64| p_value(&stage.draws, |draw| draw.single, gain) < NAMED;
        if !more_than_noise(most) {
            return Ok(None);
        }
        promises.retain(|(gain, _)| *gain >= WORTH_A_REFIT * most);
        let sets: Vec<Vec<String>> = promises.iter().map(|(_, (set, _))| set.clone()).collect();
        self.fit(promises.into_iter().map(|(_, start)| start).collect());
        let fitted = sets.into_iter().filter(|set| self.fits.get(set).is_some());
        let Some(best) = fitted.max_by(|a, b| self.net_gain(a).total_cmp(&self.net_gain(b))) else { return Ok(None) };
        let gain = self.gain(&best) - self.gain(&named);
        let Some(new) = best.last().filter(|_| more_than_noise(gain)).cloned() else { return Ok(None) };
        let all: Vec<String> = stage.sensitivities.signatures.iter().map(|signature| signature.id.clone()).collect();
        let as_good = rivals(self, stage, &best, &all)?;
        let others = as_good.into_iter().filter(|(own, _)| *own == new).map(|(_, other)| other);
        judgement.beside = std::iter::once(new.clone()).chain(others).collect();
        Ok(Some(format!(
            "what {} leaves is more than noise: {} could take it (chi-square falls by {gain:.0}), or another form of what is named",
            named.join(" with "),
            judgement.beside.join(" or "),
        )))
    }
}
