//! The search: all singles and all pairs, then one more effect at a time.

use super::bootstrap::p_value;
use super::control::Control;
use super::fits::{Noise, Task, run};
use super::stage::{Ground, Stage};
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::problem::Problem;
use crate::measurement::Kind;
use std::collections::BTreeMap;

/// Most pairs that are refitted, for a carriage and for a traverse; the others are screened by their sensitivities.
const PAIRS_STEADY: usize = 24;
const PAIRS_TRAVERSE: usize = 4;

/// Most singles that are refitted on a traverse, and the share of the best screened gain from which on.
const SINGLES_TRAVERSE: usize = 8;
const WORTH_A_REFIT: f64 = 0.3;

/// Further starts as shares of a parameter's range, in case the neutral value is a poor place to look from: a flexible
/// wheel's misfit first rises with its compliance, since the calibration leans the other way.
const STARTS: [f64; 3] = [0.1, 0.3, 0.6];

/// Chi-square by which a further parameter must pay for itself (Akaike).
pub(crate) const PRICE: f64 = 2.0;

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

fn sorted(effects: &[String]) -> Vec<String> {
    let mut effects = effects.to_vec();
    effects.sort();
    effects
}

/// Everything that a search needs and collects.
pub(crate) struct Search<'a> {
    pub problem: &'a Problem<'a>,
    pub noise: &'a Noise,
    pub ground: Ground<'a>,
    pub control: &'a Control<'a>,
    pub fits: Fits,
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
    pub fn fit(&mut self, sets: Vec<(Vec<String>, Vec<Vec<f64>>)>) {
        let sets: Vec<_> = sets.into_iter().filter(|(effects, _)| self.fits.get(effects).is_none()).collect();
        let tasks: Vec<Task> = sets.into_iter().map(|(effects, starts)| self.problem.task(&effects, starts)).collect();
        let local = |task: &Task| super::fits::outcome(self.problem, self.noise, task);
        let outcomes = self.control.spread.fits(&tasks, self.noise, &local);
        for (task, outcome) in tasks.iter().zip(outcomes) {
            let Some(outcome) = outcome else { continue };
            // A fit made elsewhere comes back as its values; standard errors and bounds are found again here.
            let again = self.problem.task(&task.effects, vec![outcome.values]);
            if let Some(fit) = super::fits::settle(self.problem, self.noise, &again) {
                self.fits.insert(&task.effects, fit);
            }
        }
    }

    /// Refits single effects on top of a stage: all on a carriage, those worth it on a traverse.
    pub fn singles(&mut self, stage: &Stage) {
        let best = stage.gains.singles.iter().map(|(gain, ..)| *gain).fold(0.0, f64::max);
        let mut order: Vec<usize> = (0..stage.gains.singles.len()).collect();
        order.sort_by(|a, b| stage.gains.singles[*b].0.total_cmp(&stage.gains.singles[*a].0));
        let traverse = self.problem.experiment.kind == Kind::Traverse;
        let chosen: Vec<usize> = order
            .into_iter()
            .enumerate()
            .filter(|(rank, k)| {
                !traverse || (*rank < SINGLES_TRAVERSE && stage.gains.singles[*k].0 >= WORTH_A_REFIT * best)
            })
            .map(|(_, k)| k)
            .collect();
        let sets = chosen.into_iter().map(|k| self.start(stage, k)).collect();
        self.fit(sets);
    }

    /// A stage's effects with candidate number `k` added, and where to start.
    fn start(&self, stage: &Stage, k: usize) -> (Vec<String>, Vec<Vec<f64>>) {
        let signature = &stage.sensitivities.signatures[k];
        let mut effects = stage.effects.clone();
        effects.push(signature.id.clone());
        let Some(candidate) = self.problem.candidate(&signature.id) else { return (effects, Vec::new()) };
        let (_, view, coefficients) = &stage.gains.singles[k];
        let mut own = Vec::new();
        if let Some(view) = signature.views.get(*view) {
            own.push(view.start(&candidate.free, coefficients));
        }
        let shares: &[f64] = match self.problem.experiment.kind {
            Kind::SingleWheel => &STARTS,
            Kind::Traverse if own.is_empty() => &STARTS[..1],
            Kind::Traverse => &[],
        };
        own.extend(
            shares.iter().map(|share| candidate.free.iter().map(|free| free.start + share * span(free)).collect()),
        );
        let before = stage.fit.values();
        let parts = |own| {
            let mut parts: Vec<(&str, &[f64])> =
                stage.effects.iter().map(|id| (id.as_str(), self.problem.part(&stage.effects, &before, id))).collect();
            parts.push((&signature.id, own));
            parts
        };
        let starts = own.iter().map(|own| self.problem.assemble(&before, &parts(own))).collect();
        (effects, starts)
    }

    /// Refits the pairs that look best by their sensitivities.
    pub fn pairs(&mut self, stage: &Stage) {
        let most = if self.problem.experiment.kind == Kind::Traverse { PAIRS_TRAVERSE } else { PAIRS_STEADY };
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

    /// Values of the effect in a fit of the baseline and this effect alone.
    fn part<'v>(&self, values: &'v [f64], id: &str) -> &'v [f64] {
        self.problem.part(&[id.to_owned()], values, id)
    }

    /// Values of the baseline and one effect: fitted, or where the sensitivities would start.
    fn single(&self, stage: &Stage, id: &str, k: usize) -> Option<Vec<f64>> {
        match self.fits.get(&[id.to_owned()]) {
            Some(fit) => Some(fit.values()),
            None => self.start(stage, k).1.into_iter().next(),
        }
    }

    /// Refits the sets that arise from `effects` by putting in the place of one of them another candidate whose signature
    /// has at least the cosine `worth` with it. `stage` is the baseline's.
    pub fn rivals(&mut self, stage: &Stage, effects: &[String], worth: f64) {
        let Some(values) = self.fits.get(effects).map(Calibration::values) else { return };
        let mut sets = Vec::new();
        for own in effects {
            for (k, signature) in stage.sensitivities.signatures.iter().enumerate() {
                if effects.contains(&signature.id) || stage.cosine(own, &signature.id) < worth {
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
        self.fit(sets);
    }

    /// A stage at a fitted set, or at the baseline.
    ///
    /// # Errors
    /// [`PredictionError`].
    pub fn stage(&self, effects: &[String]) -> Result<Option<Stage>, PredictionError> {
        let Some(fit) = self.fits.get(effects) else { return Ok(None) };
        Stage::new(&self.ground, effects, fit.clone(), self.control).map(Some)
    }

    /// Whether the best further effect gains more than noise alone: its p-value, corrected for the number of candidates.
    pub fn p_of_best(stage: &Stage) -> f64 {
        p_value(&stage.draws, |draw| draw.single, stage.observed.single)
    }

    /// Fits with the priors all but removed.
    pub fn without_priors(&self, effects: &[String]) -> Option<Calibration> {
        let start = self.fits.get(effects)?.values();
        let task = Task { prior_factor: 1e3, ..self.problem.task(effects, vec![start]) };
        run(self.problem, self.noise, &task)
    }
}

fn span(free: &crate::diagnosis::free::Free) -> f64 {
    let (up, down) = (free.variable.max - free.start, free.start - free.variable.min);
    if up >= down { up } else { -down }
}
