//! The search: what it has fitted, and how it fits further sets of effects.

use super::beside::Promised;
use super::bootstrap::p_value;
use super::control::Control;
use super::fits::{NO_PRIORS, Noise, Outcome, Task, run};
use super::stage::{Stage, StageContext};
use super::starts::Start;
use super::untried::{Untried, named};
use super::watch::Watch;
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::free::Free;
use crate::diagnosis::halt::Halt;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::PRICE;
use crate::diagnosis::weighted::Weighted;
use crate::soil_class::SoilClass;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Share by which another fit of the same set must have less chi-square to take its place: less is the rounding of a search,
/// and the baseline stays the one that `compare` gives.
pub(super) const SAME_FIT: f64 = 1e-6;

/// What the sensitivities and the bootstrap of a stage cost, in single fits.
const STAGE: f64 = 1.0;

/// Fitted effect sets, by their effects in the library's order.
#[derive(Default)]
pub(crate) struct Fits {
    known: BTreeMap<Vec<String>, Calibration>,
}

impl Fits {
    pub fn get(&self, effects: &[String]) -> Option<&Calibration> {
        self.known.get(&sorted(effects))
    }

    pub fn insert(&mut self, effects: &[String], fit: Calibration) {
        self.known.insert(sorted(effects), fit);
    }

    /// Fitted sets of `count` effects.
    pub fn of(&self, count: usize) -> impl Iterator<Item = (&Vec<String>, &Calibration)> {
        self.known.iter().filter(move |(effects, _)| effects.len() == count)
    }
}

pub(super) fn sorted(effects: &[String]) -> Vec<String> {
    let mut effects = effects.to_vec();
    effects.sort();
    effects
}

/// Modelled values by effects and the bits of the fit's chi-square.
pub(super) type Modelled = BTreeMap<(Vec<String>, u64), Vec<f64>>;

/// Everything that a search needs and collects.
pub(crate) struct Search<'a> {
    pub problem: &'a Problem<'a>,
    pub noise: &'a Noise,
    pub context: StageContext<'a>,
    pub control: &'a Control<'a>,
    pub watch: &'a Watch<'a>,
    pub fits: Fits,
    /// Where first looks ended, by their effects.
    pub looks: BTreeMap<Vec<String>, Outcome>,
    /// From which larger set, and its chi-square then, a set was last fitted once more.
    pub settled: BTreeMap<[Vec<String>; 2], f64>,
    /// Modelled values that were asked for, by effects and chi-square of the fit.
    pub modelled: Mutex<Modelled>,
    /// What further effects promise beside a set, by its effects.
    pub promised: Promised,
}

impl<'a> Search<'a> {
    /// A search of which only the baseline is fitted.
    pub fn new(
        context: StageContext<'a>,
        baseline: Calibration,
        control: &'a Control<'a>,
        watch: &'a Watch<'a>,
    ) -> Self {
        let mut fits = Fits::default();
        fits.insert(&[], baseline);
        Self {
            problem: context.problem,
            noise: context.noise,
            context,
            control,
            watch,
            fits,
            looks: BTreeMap::new(),
            settled: BTreeMap::new(),
            modelled: Mutex::default(),
            promised: Promised::default(),
        }
    }
}

impl Search<'_> {
    /// Fall of chi-square of a fitted set against the baseline, less the price of its parameters.
    pub fn net_gain(&self, effects: &[String]) -> f64 {
        let (Some(base), Some(fit)) = (self.fits.get(&[]), self.fits.get(effects)) else { return 0.0 };
        base.chi_square - fit.chi_square - PRICE * (fit.parameters.len() - base.parameters.len()) as f64
    }

    /// Fall of chi-square of a fitted set against the baseline.
    pub fn gain(&self, effects: &[String]) -> f64 {
        let (Some(base), Some(fit)) = (self.fits.get(&[]), self.fits.get(effects)) else { return 0.0 };
        base.chi_square - fit.chi_square
    }

    /// Fits sets that are not fitted yet, each from its starts.
    pub fn fit(&mut self, sets: Vec<Start>) {
        let sets: Vec<_> = sets.into_iter().filter(|(effects, _)| self.fits.get(effects).is_none()).collect();
        let tasks: Vec<Task> = sets.into_iter().map(|(effects, starts)| self.problem.task(&effects, starts)).collect();
        self.settle_all(&tasks);
        let again: Vec<Task> = tasks.iter().filter_map(|task| self.restart_at_part(&task.effects)).collect();
        self.settle_all(&again);
    }

    /// Makes fits and keeps the best of each set.
    pub(super) fn settle_all(&mut self, tasks: &[Task]) {
        for (task, outcome) in tasks.iter().zip(self.outcomes(tasks)) {
            let Some(outcome) = outcome else { continue };
            // A fit made elsewhere comes back as its values; standard errors and bounds are found again here.
            let again = self.problem.task(&task.effects, vec![outcome.values]);
            let Some(fit) = super::fits::settle(self.problem, self.noise, &again) else { continue };
            let improves = |known: &Calibration| fit.chi_square < known.chi_square * (1.0 - SAME_FIT);
            if self.fits.get(&task.effects).is_none_or(improves) {
                self.fits.insert(&task.effects, fit);
            }
        }
    }

    /// A search of a set from the best set with one effect less, that effect all but neutral, where a fit of the whole set
    /// leaves more than that, or there is none: its search has failed. The baseline may have bent its soil so far that with
    /// more of the effect it carries no wheel.
    fn restart_at_part(&self, effects: &[String]) -> Option<Task> {
        let whole = self.fits.get(effects).map_or(f64::INFINITY, |fit| fit.chi_square);
        let without = |k: usize| effects.iter().enumerate().filter(move |(j, _)| *j != k).map(|(_, id)| id.clone());
        let parts = (0..effects.len()).filter_map(|k| {
            let part: Vec<String> = without(k).collect();
            let fit = self.fits.get(&part)?;
            Some((fit.chi_square, part, fit.values(), &effects[k]))
        });
        let (least, part, values, new) = parts.min_by(|a, b| a.0.total_cmp(&b.0))?;
        if whole <= least {
            return None;
        }
        let neutral: Vec<f64> = self.problem.candidate(new)?.free.iter().map(Free::nearly_neutral).collect();
        let kept = part.iter().map(|id| (id.as_str(), self.problem.part(&part, &values, id)));
        let all: Vec<(&str, &[f64])> = kept.chain([(new.as_str(), neutral.as_slice())]).collect();
        Some(self.problem.task(effects, vec![self.problem.assemble(&values, &all)]))
    }

    /// Fits a set once more from where a larger one came, less the rest of that, and keeps the better fit: a further effect
    /// may have helped the search only.
    pub fn settle_below(&mut self, larger: &[String], set: &[String]) {
        let Some(fit) = self.fits.get(larger) else { return };
        let (values, chi_square) = (fit.values(), fit.chi_square);
        if !self.problem.strategy().budget().refits_from_larger
            || self.settled.insert([sorted(larger), sorted(set)], chi_square) == Some(chi_square)
        {
            return;
        }
        let parts: Vec<(&str, &[f64])> =
            set.iter().map(|id| (id.as_str(), self.problem.part(larger, &values, id))).collect();
        self.fit_again(set, self.problem.assemble(&values, &parts));
    }

    /// Fits a part of a fitted set where that is missing, from where the whole came.
    pub fn fit_part(&mut self, whole: &[String], part: &[String]) {
        let (None, Some(fit)) = (self.fits.get(part), self.fits.get(whole)) else { return };
        let values = fit.values();
        let kept: Vec<(&str, &[f64])> =
            part.iter().map(|id| (id.as_str(), self.problem.part(whole, &values, id))).collect();
        let start = self.problem.assemble(&values, &kept);
        self.fit(vec![(part.to_vec(), vec![start])]);
    }

    /// Rise of chi-square of a fitted set where its soil is held within what a class of soil allows; `None` where there is no
    /// such fit.
    pub fn cost_within(&self, effects: &[String], fit: &Calibration, class: &SoilClass) -> Option<f64> {
        let mut problem = self.problem.clone();
        for free in &mut problem.base {
            if let Some(range) = class.allows(&free.variable.name) {
                free.variable.min = free.variable.min.max(*range.start());
                free.variable.max = free.variable.max.min(*range.end());
            }
        }
        if problem.base.iter().any(|free| free.variable.min >= free.variable.max) {
            return None;
        }
        let within = run(&problem, self.noise, &problem.task(effects, vec![fit.values()]))?;
        Some(within.chi_square - fit.chi_square)
    }

    /// Whitened derivatives by search coordinate at the values of a set, priors' rows last.
    ///
    /// # Errors
    /// [`PredictionError`] where the model has no answer there.
    pub fn whitened_columns(&self, effects: &[String], values: &[f64]) -> Result<Vec<Vec<f64>>, PredictionError> {
        let free = self.problem.free(effects);
        self.problem.predict(&free, |predict| {
            let (layout, whitening) = (&self.problem.layout, self.context.whitening);
            let priors = &self.problem.prior_rows(&free);
            let (free, robust) = (&free, f64::INFINITY);
            let weighted = Weighted { predict, layout, free, whitening, priors, robust, whole: true };
            Ok(weighted.columns(&predict.slopes(values)?.1, values))
        })?
    }

    /// Whitened residual of a fitted set, priors' rows last.
    ///
    /// # Errors
    /// [`PredictionError`] where the model has no answer at the fit.
    pub fn whitened_residual(&self, effects: &[String], values: &[f64]) -> Result<Vec<f64>, PredictionError> {
        let free = self.problem.free(effects);
        let modelled = self.modelled(effects)?.unwrap_or_else(|| vec![f64::NAN; self.problem.layout.len()]);
        self.problem.predict(&free, |predict| {
            let (layout, whitening) = (&self.problem.layout, self.context.whitening);
            let priors = &self.problem.prior_rows(&free);
            let (free, robust) = (&free, f64::INFINITY);
            let weighted = Weighted { predict, layout, free, whitening, priors, robust, whole: true };
            weighted.whitened(&modelled, values)
        })
    }

    /// Fits a set from another start and keeps the better fit.
    pub fn fit_again(&mut self, set: &[String], start: Vec<f64>) {
        self.settle_all(&[self.problem.task(set, vec![start])]);
    }

    pub(super) fn outcomes(&self, tasks: &[Task]) -> Vec<Option<Outcome>> {
        let known = |set: &[String]| self.fits.get(set).is_some();
        let fit = |task: &Task| super::fits::outcome(self.problem, self.noise, task);
        self.watch.fits(tasks, self.noise, &known, &fit)
    }

    /// What a fitted set gives, in the layout's order; computed to its end after a stop too. `None` where it is not fitted.
    ///
    /// # Errors
    /// [`PredictionError`] where the model has no answer at the fit.
    pub fn modelled(&self, effects: &[String]) -> Result<Option<Vec<f64>>, PredictionError> {
        let Some(fit) = self.fits.get(effects) else { return Ok(None) };
        let key = (sorted(effects), fit.chi_square.to_bits());
        let known = || self.modelled.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(values) = known().get(&key) {
            return Ok(Some(values.clone()));
        }
        let mut problem = self.problem.clone();
        problem.halt = Halt::default();
        let values = problem.predict(&problem.free(effects), |predict| predict.values(&fit.values()))??;
        known().insert(key, values.clone());
        Ok(Some(values))
    }

    /// Whether [`Self::modelled`] needs no simulation.
    pub fn is_modelled(&self, effects: &[String]) -> bool {
        let Some(fit) = self.fits.get(effects) else { return false };
        let known = self.modelled.lock().unwrap_or_else(PoisonError::into_inner);
        known.contains_key(&(sorted(effects), fit.chi_square.to_bits()))
    }

    /// A stage at a fitted set, or at the baseline. `None` where the set is not fitted, or there is no time to go on from it.
    ///
    /// # Errors
    /// [`PredictionError`].
    pub fn stage(&self, effects: &[String]) -> Result<Option<Stage>, PredictionError> {
        let Some(fit) = self.fits.get(effects) else { return Ok(None) };
        // The baseline's is needed for any answer; its draws alone may be fewer, which is said.
        let further = !effects.is_empty();
        if further {
            self.watch.trying(&format!("what {} leaves", named(effects)));
        }
        let made = if further && (self.watch.stopped() || !self.watch.has_time(STAGE)) {
            None
        } else {
            match Stage::new(&self.context, effects, fit.clone(), self.control) {
                Err(PredictionError::Interrupted) => None,
                made => Some(made?),
            }
        };
        let whole = made.filter(|_| !further || !self.watch.stopped());
        if whole.is_none() && further {
            self.watch.leave([Untried::Further(effects.to_vec())]);
        }
        Ok(whole)
    }

    /// Whether the best further effect gains more than noise alone: its p-value, corrected for the number of candidates.
    pub fn p_of_best(stage: &Stage) -> f64 {
        p_value(&stage.draws, |draw| draw.single, stage.observed.single)
    }

    /// Fits with the priors all but removed.
    pub fn without_priors(&self, effects: &[String]) -> Option<Calibration> {
        let start = self.fits.get(effects)?.values();
        let task = Task { prior_factor: NO_PRIORS, ..self.problem.task(effects, vec![start]) };
        run(self.problem, self.noise, &task)
    }
}
