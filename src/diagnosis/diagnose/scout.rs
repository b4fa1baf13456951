//! A first look at every effect where a traverse's baseline is far from the measurements, and a way to a better baseline.
//!
//! Sensitivities around such a baseline say little, and fits from it often fail: the calibration has bent the soil to stand
//! in for what it lacks, and with an effect added to that soil the simulated rover gets stuck, where the cost is flat.

use super::far::weakened;
use super::fits::{Outcome, Task};
use super::search::Search;
use super::stage::Stage;
use super::starts::Start;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::thresholds::{MOST_AFRESH, WORTH_AFRESH};

/// Shares of an effect's ranges from which its fit to led rovers starts.
const LED_FROM: [f64; 1] = [0.1];

/// Searches from seeded draws in a first look without a lead.
const SEARCHES: usize = 1;

impl Search<'_> {
    /// Fits every effect on top of a stage for a few steps, from the stage's values and from seeded draws; what was found best
    /// is kept among the looks.
    pub(super) fn scout(&mut self, stage: &Stage) {
        let unknown = |k: &usize| self.fits.get(&self.with(stage, *k)).is_none();
        let all: Vec<usize> = (0..stage.gains.singles.len()).filter(unknown).collect();
        // Draws find a way past soils in which a replay gets stuck; in windows a rover begins anew every few seconds.
        let searches = if self.problem.is_cut() { 0 } else { SEARCHES };
        let tasks: Vec<Task> = all.iter().map(|k| self.look(self.start(stage, *k), searches)).collect();
        self.keep(&tasks);
    }

    /// Makes first looks and keeps the best of each set of effects.
    fn keep(&mut self, tasks: &[Task]) {
        for (task, at) in tasks.iter().zip(self.outcomes(tasks)) {
            let Some(at) = at else { continue };
            if self.looks.get(&task.effects).is_none_or(|known| at.chi_square < known.chi_square) {
                self.looks.insert(task.effects.clone(), at);
            }
        }
    }

    /// The baseline's stage at a better place, where it is far from the measurements and there is one: rovers that are led
    /// at the measured velocity do not get stuck, so that baseline and effects are fitted to them first. From where these
    /// fits ended they go on without the lead.
    ///
    /// # Errors
    /// [`PredictionError`].
    pub(super) fn led_baseline(&mut self, stage: Stage) -> Result<Stage, PredictionError> {
        if !self.problem.strategy().can_be_led(self.problem, &stage.fit) {
            return Ok(stage);
        }
        let led = Task { guided: true, ..self.problem.task(&[], Vec::new()) };
        let Some(led) = self.outcomes(&[led]).pop().flatten() else { return Ok(stage) };
        let all: Vec<usize> = (0..stage.gains.singles.len()).collect();
        let led_from = |k: &usize| {
            let starts = self.shares(&stage, *k, &led.values, &LED_FROM);
            Task { guided: true, ..self.look((self.with(&stage, *k), starts), 0) }
        };
        let tasks: Vec<Task> = all.iter().map(led_from).collect();
        let ends = self.outcomes(&tasks);
        let on = |(task, at): (&Task, Option<Outcome>)| Some(self.look((task.effects.clone(), vec![at?.values]), 0));
        let tasks: Vec<Task> = tasks.iter().zip(ends).filter_map(on).collect();
        self.keep(&tasks);
        self.fit_again(&[], led.values);
        let better = self.fits.get(&[]).is_some_and(|fit| fit.chi_square < stage.fit.chi_square);
        if better { Ok(self.stage(&[])?.unwrap_or(stage)) } else { Ok(stage) }
    }

    /// Fits the best effects of a far baseline once more as if they had been in the model from the outset, from the given
    /// values and from draws: the soil from which they were fitted is bent to stand in for them.
    pub(super) fn afresh(&mut self, stage: &Stage) {
        let tasks: Vec<Task> =
            self.best_additions(stage).iter().map(|set| self.problem.task(set, Vec::new())).collect();
        self.settle_all(&tasks);
    }

    /// Fits the best effects once more from the given soil, with as much of the effect as was found and with next to nothing of it.
    /// The soil of a baseline that stands in for an effect may lie in another valley of chi-square than the soil beside the effect, and
    /// what the fit could not reach from there looks like a further effect. Returns whether a fit has found a lower valley.
    pub(super) fn again_at_given_soil(&mut self, stage: &Stage) -> bool {
        if !self.problem.strategy().budget().refits_from_larger {
            return false;
        }
        let sets = self.best_additions(stage);
        let tasks: Vec<Task> = sets.iter().filter_map(|set| self.search_at_given_soil(set)).collect();
        let left = |task: &Task| self.fits.get(&task.effects).map_or(f64::INFINITY, |fit| fit.chi_square);
        let before: Vec<f64> = tasks.iter().map(left).collect();
        self.settle_all(&tasks);
        let is_lower =
            |(task, before): (&Task, &f64)| self.fits.get(&task.effects).is_some_and(|fit| fit.chi_square < *before);
        let lower = tasks.iter().zip(&before).any(is_lower);
        if lower {
            self.lower_valleys(1);
        }
        lower
    }

    /// A search of a fitted set from the given soil, with as much of its effects as was found and with next to nothing of them.
    pub(super) fn search_at_given_soil(&self, set: &[String]) -> Option<Task> {
        let given: Vec<f64> = self.problem.base.iter().map(|free| free.start).collect();
        let values = self.fits.get(set)?.values();
        let mut task = self.problem.task(set, vec![[&given, &values[given.len()..]].concat()]);
        task.starts.extend(weakened(self.problem, &task).starts);
        Some(task)
    }

    /// The fitted sets of a stage with one effect more that gain most, with at least a share of the largest gain.
    fn best_additions(&self, stage: &Stage) -> Vec<Vec<String>> {
        let mut sets: Vec<(f64, Vec<String>)> = (0..stage.gains.singles.len())
            .map(|k| self.with(stage, k))
            .filter_map(|set| Some((stage.fit.chi_square - self.fits.get(&set)?.chi_square, set)))
            .collect();
        sets.sort_by(|a, b| b.0.total_cmp(&a.0));
        let least = sets.first().map_or(0.0, |(most, _)| WORTH_AFRESH * most);
        sets.into_iter().take(MOST_AFRESH).filter(|(gain, _)| *gain >= least).map(|(_, set)| set).collect()
    }

    fn look(&self, (effects, starts): Start, searches: usize) -> Task {
        Task { scouting: Some(searches), ..self.problem.task(&effects, starts) }
    }
}
