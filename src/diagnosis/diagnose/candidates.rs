//! The candidates of a search: single effects, pairs, and rivals of a chosen set.

use super::bootstrap::p_value;
use super::far::costs;
use super::fits::Task;
use super::search::Search;
use super::stage::Stage;
use super::starts::Start;
use super::views::Rounding;
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::free::Free;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::problem::{Problem, plain_effect};
use crate::diagnosis::thresholds::{COMMON, WORTH_A_REFIT, WORTH_ANOTHER};

/// Fits of single effects where none promises more than noise does.
const FEW: usize = 3;

impl Search<'_> {
    /// Fits the candidates on top of the baseline's stage. Where that is far from the measurements, a better baseline is looked
    /// for first, and the best effects are fitted once more from other places. Returns the stage of the baseline that was taken.
    ///
    /// # Errors
    /// [`PredictionError`].
    pub fn candidates(&mut self, stage: Stage) -> Result<Stage, PredictionError> {
        let mut stage = self.led_baseline(stage)?;
        self.singles(&stage);
        if self.lower_valleys(1) {
            stage = self.stage(&[])?.unwrap_or(stage);
            self.singles_again(&stage);
        }
        if stage.fit.is_far() {
            self.afresh(&stage);
        }
        Ok(stage)
    }

    /// Refits single effects on top of a stage: all or, where fits are dear, those with the largest gain predicted
    /// by their sensitivities. Where the stage is far from the measurements sensitivities predict poorly: there all effects are
    /// fitted for a few steps, and the predicted gain is what that gained.
    pub fn singles(&mut self, stage: &Stage) {
        let all = 0..stage.gains.singles.len();
        let Some(most) = self.problem.strategy().budget().singles else {
            return self.fit(all.map(|k| self.start(stage, k)).collect());
        };
        if stage.fit.is_far() && !all.clone().any(|k| self.looks.contains_key(&self.with(stage, k))) {
            self.scout(stage);
        }
        let mut promises: Vec<(f64, Start)> = all.filter_map(|k| self.promise(stage, k)).collect();
        promises.sort_by(|a, b| b.0.total_cmp(&a.0));
        promises.truncate(most);
        // A fit may gain less than predicted: the others are then compared with what was gained, and must predict more than
        // noise alone does with the probability `COMMON`.
        let mut gained = 0.0_f64;
        let common = |promise: f64| p_value(&stage.draws, |draw| draw.single, promise) > COMMON;
        // Where noise alone promises as much a few fits show that the promises are kept.
        if !stage.fit.is_far() && promises.first().is_some_and(|(most, _)| common(*most)) {
            promises.truncate(FEW);
            for (_, start) in &mut promises {
                self.not_above(stage, start);
            }
        }
        for round in 0.. {
            let Some((most, _)) = promises.first() else { return };
            if round > 0 && !stage.fit.is_far() && common(*most) {
                return;
            }
            let bar = WORTH_A_REFIT * gained.max(*most);
            let worth: Vec<Start> =
                promises.extract_if(.., |(promise, _)| *promise >= bar).map(|(_, set)| set).collect();
            if worth.is_empty() {
                return;
            }
            let sets: Vec<Vec<String>> = worth.iter().map(|(effects, _)| effects.clone()).collect();
            self.fit(worth);
            let gains = sets.iter().filter_map(|set| Some(stage.fit.chi_square - self.fits.get(set)?.chi_square));
            gained = gains.fold(gained, f64::max);
        }
    }

    /// Where the starts of a single effect leave more than the stage does without it, the fit begins next to nothing of the effect: from a
    /// poor start the way back to the stage is long, and there is little to find.
    fn not_above(&self, stage: &Stage, start: &mut Start) {
        let task = self.problem.task(&start.0, start.1.clone());
        let Some((left, _)) = costs(self.problem, self.noise, &task) else { return };
        if !left.iter().any(|left| *left < stage.fit.chi_square)
            && let Some(faint) = self.faint(stage, start)
        {
            start.1 = vec![faint];
        }
    }

    /// The first start of a single effect on the stage's soil, those of its parameters next to their neutral values without which nothing
    /// measured changes. The others, such as the place of a patch, stay.
    fn faint(&self, stage: &Stage, (effects, starts): &Start) -> Option<Vec<f64>> {
        let (id, first) = (effects.last()?, starts.first()?);
        let (k, candidate) = (stage.index(id)?, self.problem.candidate(id)?);
        let own = self.problem.part(effects, first, id);
        let soil = &stage.fit.values()[..self.problem.base.len()];
        let joined = |own: &[f64]| self.joined(stage, k, soil, own);
        let strengths = strengths(self.problem, effects, &candidate.free, own, &joined, &stage.modelled)?;
        let faint = own.iter().zip(&candidate.free).zip(strengths);
        let faint = faint.map(|((own, free), strength)| if strength { free.nearly_neutral() } else { *own });
        Some(joined(&faint.collect::<Vec<_>>()))
    }

    /// Single effects on top of a baseline that has changed: those that are fitted once more from there, too.
    fn singles_again(&mut self, stage: &Stage) {
        self.looks.clear();
        let fitted = (0..stage.gains.singles.len()).filter(|k| self.fits.get(&self.with(stage, *k)).is_some());
        let again: Vec<Start> = fitted.map(|k| self.start(stage, k)).collect();
        let again: Vec<_> = again.into_iter().map(|(effects, starts)| self.problem.task(&effects, starts)).collect();
        self.settle_all(&again);
        self.singles(stage);
    }

    /// What candidate number `k` promises to gain on top of a stage, and where its fit starts: by the sensitivities, unless
    /// these say little or a first look came further.
    fn promise(&self, stage: &Stage, k: usize) -> Option<(f64, Start)> {
        let linear = stage.gains.singles[k].0;
        let effects = self.with(stage, k);
        match self.looks.get(&effects).map(|look| (stage.fit.chi_square - look.chi_square, look)) {
            Some((gain, look)) if stage.fit.is_far() || gain > linear => {
                Some((gain, (effects, vec![look.values.clone()])))
            }
            None if stage.fit.is_far() => None,
            _ => Some((linear, self.start(stage, k))),
        }
    }

    /// A stage's effects with candidate number `k` added.
    pub(super) fn with(&self, stage: &Stage, k: usize) -> Vec<String> {
        stage.effects.iter().chain([&stage.sensitivities.signatures[k].id]).cloned().collect()
    }

    /// Refits the pairs that look best by their sensitivities.
    pub fn pairs(&mut self, stage: &Stage) {
        let most = self.problem.strategy().budget().pairs;
        let mut order = stage.gains.pairs.clone();
        order.sort_by(|a, b| b.2.total_cmp(&a.2));
        let mut sets = Vec::new();
        for (i, j, _) in order.into_iter().take(most) {
            let [a, b] = [i, j].map(|k| stage.sensitivities.signatures[k].id.clone());
            let (Some(first), Some(second)) = (self.single(stage, &a, i), self.single(stage, &b, j)) else { continue };
            let parts = [(a.as_str(), self.part(&first, &a)), (b.as_str(), self.part(&second, &b))];
            // From the baseline as it is with either of them alone.
            let starts = [&first, &second].map(|base| self.problem.assemble(base, &parts)).to_vec();
            sets.push((vec![a, b], starts));
        }
        self.fit(sets);
    }

    /// Refits the sets that arise from `effects` by putting in the place of one of them another candidate whose signature
    /// has at least the cosine `worth` with it, or that is the same effect acting elsewhere. `stage` is the baseline's.
    pub fn rivals(&mut self, stage: &Stage, effects: &[String], worth: f64) {
        let Some(values) = self.fits.get(effects).map(Calibration::values) else { return };
        let mut sets: Vec<Start> = Vec::new();
        for own in effects {
            for (k, signature) in stage.sensitivities.signatures.iter().enumerate() {
                let elsewhere = plain_effect(own) == plain_effect(&signature.id);
                if effects.contains(&signature.id) || !elsewhere && stage.cosine(own, &signature.id) < worth {
                    continue;
                }
                let Some(other) = self.single(stage, &signature.id, k) else { continue };
                let kept = effects.iter().filter(|id| *id != own);
                let mut parts: Vec<(&str, &[f64])> =
                    kept.map(|id| (id.as_str(), self.problem.part(effects, &values, id))).collect();
                parts.push((&signature.id, self.part(&other, &signature.id)));
                let start = self.problem.assemble(&values, &parts);
                let swapped =
                    effects.iter().map(|id| if id == own { signature.id.clone() } else { id.clone() }).collect();
                sets.push((swapped, vec![start]));
            }
        }
        let (known, new): (Vec<Start>, Vec<Start>) =
            sets.into_iter().partition(|(set, _)| self.fits.get(set).is_some());
        let made: Vec<Vec<String>> = new.iter().map(|(set, _)| set.clone()).collect();
        self.fit(new);
        self.again_beside(effects, &known, &made);
    }

    /// Fits a set and those of its rivals that leave nearly as little once more from the given soil, with as much of the effects as was found and
    /// with next to nothing of them; rivals that were `known` before, from the soil of the set too. So they have had about as many
    /// searches as the set has, and a name rests less on where searches ended. `made` are rivals that began at that soil.
    fn again_beside(&mut self, effects: &[String], known: &[Start], made: &[Vec<String>]) {
        if !self.problem.strategy().budget().refits_from_larger {
            return;
        }
        let least = WORTH_ANOTHER * self.gain(effects);
        let near = |set: &[String]| self.gain(set) >= least;
        let mut tasks: Vec<Task> = Vec::new();
        for (set, starts) in known.iter().filter(|(set, _)| near(set)) {
            let Some(mut task) = self.search_at_given_soil(set) else { continue };
            task.starts.extend(starts.iter().cloned());
            tasks.push(task);
        }
        let rivals = known.iter().map(|(set, _)| set).chain(made).any(|set| near(set));
        let made = made.iter().map(Vec::as_slice).filter(|set| near(set));
        // Without a rival the set has nothing to be compared with.
        tasks.extend(made.chain(rivals.then_some(effects)).filter_map(|set| self.search_at_given_soil(set)));
        self.settle_all(&tasks);
    }
}

/// Which parameters of an effect are its strength: with one of them at its neutral value, the others staying at `own`, the model gives what it
/// gives without the effect, `modelled`. The softening of a soft patch is one, its place is not. `joined` gives the values of all
/// free parameters from those of the effect. `None` where the model has no answer.
fn strengths(
    problem: &Problem,
    effects: &[String],
    free: &[Free],
    own: &[f64],
    joined: &dyn Fn(&[f64]) -> Vec<f64>,
    modelled: &[f64],
) -> Option<Vec<bool>> {
    let rounding = Rounding::of(&problem.layout, modelled);
    let all = problem.free(effects);
    let is_strength = |j: usize| {
        let mut without = own.to_vec();
        without[j] = free[j].start;
        let values = problem.predict(&all, |predict| predict.values(&joined(&without))).ok()?.ok()?;
        let change: Vec<f64> = values.iter().zip(modelled).map(|(a, b)| a - b).collect();
        Some(rounding.hides(&change))
    };
    (0..free.len()).map(is_strength).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
mod tests {
    use super::*;
    use crate::diagnosis::kinds::synthetic::experiment;
    use crate::model::{ControlKind, Model};

    #[test]
    fn property_what_an_effect_needs_to_act_is_its_strength() {
        let experiment = experiment("speed_command", false);
        let mut model = Model::preset("two_wheeled").unwrap();
        model.control.kind = ControlKind::Speed;
        let mut problem = Problem::new(&model, &experiment, &[]).unwrap();
        problem.coarsen();
        problem.cut();
        let base: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
        let modelled = problem.predict(&problem.base, |predict| predict.values(&base)).unwrap().unwrap();
        for (id, values) in [
            ("soft_patch", [("softening", 0.5, true), ("centre", 1.3, false), ("half_width", 0.6, false)].as_slice()),
            ("rim_adhesion", &[("loss", 0.6, true), ("rounding", 0.3, false)]),
        ] {
            let candidate = problem.candidate(id).unwrap();
            let of =
                |free: &Free| values.iter().find(|(name, ..)| free.variable.name == format!("{id}.{name}")).unwrap();
            let own: Vec<f64> = candidate.free.iter().map(|free| of(free).1).collect();
            let expected: Vec<bool> = candidate.free.iter().map(|free| of(free).2).collect();
            let joined = |own: &[f64]| base.iter().chain(own).copied().collect();
            let found = strengths(&problem, &[id.to_owned()], &candidate.free, &own, &joined, &modelled).unwrap();
            assert_eq!(found, expected, "{id}");
        }
    }
}
