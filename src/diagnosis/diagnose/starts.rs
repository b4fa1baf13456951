//! Where the fits of a search start.

use super::gains::SingleGain;
use super::search::Search;
use super::stage::Stage;
use super::views::View;

/// Share of its range at which each law of an effect is tried by itself: about where usual values are.
const ALONE: f64 = 0.3;

/// A set of effects and the values from which its fit starts.
pub(super) type Start = (Vec<String>, Vec<Vec<f64>>);

impl Search<'_> {
    /// A stage's effects with candidate number `k` added, and where to start.
    pub(super) fn start(&self, stage: &Stage, k: usize) -> Start {
        self.start_by(stage, k, &stage.gains.singles[k])
    }

    /// The same by a gain of the candidate that was found otherwise.
    pub(super) fn start_by(&self, stage: &Stage, k: usize, (_, view, coefficients): &SingleGain) -> Start {
        let signature = &stage.sensitivities.signatures[k];
        let effects = self.with(stage, k);
        let Some(candidate) = self.problem.candidate(&signature.id) else { return (effects, Vec::new()) };
        let soil = &stage.fit.values()[..self.problem.base.len()];
        let promised = signature.views.get(*view).map(|view| view.start(&candidate.free, coefficients));
        let mut starts: Vec<Vec<f64>> = promised.iter().map(|own| self.joined(stage, k, soil, own)).collect();
        let further = self.problem.strategy().further_starts(!starts.is_empty());
        starts.extend(self.shares(stage, k, soil, further));
        if !further.is_empty() {
            starts.extend(self.laws(stage, k, soil));
        }
        (effects, starts)
    }

    /// Starts at a soil with one law of candidate number `k` each, where several of its parameters change something by themselves: together
    /// they may lead a search to where none of them acts as it does alone (slip-sinkage after Ding, Lyasko and Reece).
    fn laws(&self, stage: &Stage, k: usize, soil: &[f64]) -> Vec<Vec<f64>> {
        let signature = &stage.sensitivities.signatures[k];
        let Some(candidate) = self.problem.candidate(&signature.id) else { return Vec::new() };
        let laws = signature.views.iter().find_map(View::members).filter(|laws| laws.len() > 1).unwrap_or_default();
        let at = |law: &usize| {
            let mut own: Vec<f64> = candidate.free.iter().map(|free| free.start).collect();
            own[*law] += ALONE * candidate.free[*law].span();
            self.joined(stage, k, soil, &own)
        };
        laws.iter().map(at).collect()
    }

    /// Starts at a soil with candidate number `k` at these shares of its ranges.
    pub(super) fn shares(&self, stage: &Stage, k: usize, soil: &[f64], shares: &[f64]) -> Vec<Vec<f64>> {
        let Some(candidate) = self.problem.candidate(&stage.sensitivities.signatures[k].id) else { return Vec::new() };
        let at = |share: &f64| candidate.free.iter().map(|free| free.start + share * free.span()).collect::<Vec<f64>>();
        shares.iter().map(|share| self.joined(stage, k, soil, &at(share))).collect()
    }

    /// Values of all free parameters: a soil, the stage's effects as they are, and candidate number `k` at `own`.
    pub(super) fn joined(&self, stage: &Stage, k: usize, soil: &[f64], own: &[f64]) -> Vec<f64> {
        let values = stage.fit.values();
        let kept = stage.effects.iter().map(|id| (id.as_str(), self.problem.part(&stage.effects, &values, id)));
        let parts: Vec<(&str, &[f64])> = kept.chain([(stage.sensitivities.signatures[k].id.as_str(), own)]).collect();
        self.problem.assemble(soil, &parts)
    }

    /// Values of the effect in a fit of the baseline and this effect alone.
    pub(super) fn part<'v>(&self, values: &'v [f64], id: &str) -> &'v [f64] {
        self.problem.part(&[id.to_owned()], values, id)
    }

    /// Values of the baseline and one effect: fitted, or where the sensitivities would start.
    pub(super) fn single(&self, stage: &Stage, id: &str, k: usize) -> Option<Vec<f64>> {
        match self.fits.get(&[id.to_owned()]) {
            Some(fit) => Some(fit.values()),
            None => self.start(stage, k).1.into_iter().next(),
        }
    }
}
