//! One stage of the search: a fit, its sensitivities, and what noise alone would give there.

use super::bootstrap::{Null, Statistics, p_value};
use super::control::Control;
use super::fits::Noise;
use super::gains::{Gains, Projected, SingleGain};
use super::prepare::Prepared;
use super::signature::{Sensitivities, sensitivities};
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::linear_algebra::{Basis, Directions, Reach, Span, dot, norm};
use crate::diagnosis::noise::{Repeats, Whitening};
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::DETECTABLE;
use crate::parallel::map_in_order;
use std::collections::BTreeMap;

/// Bootstrap draws that are made together.
const AT_A_TIME: usize = 8;

/// A fit of the baseline with some effects, seen from where it stands.
pub(crate) struct Stage {
    /// Effects in the fit.
    pub effects: Vec<String>,
    pub fit: Calibration,
    pub modelled: Vec<f64>,
    /// Whitened residual, priors' rows last.
    pub residual: Vec<f64>,
    pub sensitivities: Sensitivities,
    /// Gains of the data by sensitivities, parameters on their bounds being free to come back; and the columns outside
    /// the base.
    pub gains: Gains,
    /// Gains of single effects where the strengths of those in the fit are the same under all conditions; none at the baseline.
    pub gains_at_constant_strength: Vec<SingleGain>,
    pub projected: Projected,
    /// Directions along the conditions outside the base.
    pub flexible: Directions,
    /// Values at different set-points: repeats count once.
    pub set_points: usize,
    /// Statistics of the data.
    pub observed: Statistics,
    /// Statistics of noise alone.
    pub draws: Vec<Statistics>,
}

/// What is the same for every stage of a search.
pub(crate) struct StageContext<'a> {
    pub problem: &'a Problem<'a>,
    pub noise: &'a Noise,
    pub whitening: &'a Whitening,
    /// Repeats behind the noise model, where it came from them.
    pub repeats: Option<&'a Repeats>,
    /// Raw flexible columns.
    pub flexible: &'a [Vec<f64>],
    /// Smooth functions by which the strength of an effect in the fit may vary.
    pub modulations: &'a [Vec<Vec<f64>>],
    /// Bootstrap draws that are asked for.
    pub draws: usize,
}

impl<'a> StageContext<'a> {
    /// Of a problem whose noise and baseline are known.
    pub fn new(problem: &'a Problem<'a>, prepared: &'a Prepared, whitening: &'a Whitening, draws: usize) -> Self {
        Self {
            problem,
            noise: &prepared.noise,
            whitening,
            repeats: prepared.repeats.as_ref(),
            flexible: &prepared.flexible,
            modulations: &prepared.modulations,
            draws,
        }
    }
}

impl Stage {
    /// Looks from a fit. With effects in it, their strength may vary smoothly with the conditions before anything else
    /// is tried: the right effect in another form is not a second effect.
    ///
    /// # Errors
    /// [`PredictionError`] where the model has no answer at the fit.
    pub fn new(
        context: &StageContext,
        effects: &[String],
        fit: Calibration,
        control: &Control,
    ) -> Result<Self, PredictionError> {
        let problem = context.problem;
        let values = fit.values();
        let sensitivities = sensitivities(problem, effects, &values)?;
        let modelled = sensitivities.modelled.clone();
        let free = problem.free(effects);
        let priors = problem.prior_rows(&free);
        let difference: Vec<f64> = modelled.iter().zip(&problem.layout.measured).map(|(m, y)| m - y).collect();
        let whitened = context.whitening.apply(&difference);
        let mut residual = whitened.clone();
        residual.extend(priors.residual(&values));
        let mut base = Vec::new();
        for (k, column) in sensitivities.base.iter().enumerate() {
            // What sits on a bound cannot follow the noise to either side.
            if !fit.parameters[k].at_bound {
                base.push((column.clone(), priors.column(&free, &values, k).collect()));
            }
        }
        let none = vec![0.0; priors.len()];
        let unmodulated = base.len();
        for column in &sensitivities.base[problem.base.len()..] {
            for modulation in context.modulations {
                base.push((modulated(problem, column, modulation), none.clone()));
            }
        }
        let whiten = |column: &Vec<f64>| {
            let mut all = context.whitening.apply(column);
            all.extend_from_slice(&none);
            all
        };
        let absorbed = Projected::new(context.whitening, &base, &[]).base;
        let outside: Vec<Vec<f64>> = context.flexible.iter().map(|column| absorbed.outside(&whiten(column))).collect();
        let by_products = problem.strategy().budget().by_products;
        let flexible = match by_products {
            true => Directions::Span(Span::of(residual.len(), &outside)),
            false => Directions::Basis(Basis::of(&outside)),
        };
        let sets = sets_of_repeats(problem, context.whitening);
        let set_points = sets.iter().max().map_or(0, |last| last + 1);
        let null = Null {
            layout: &problem.layout,
            noise: &context.noise.models,
            repeats: context.repeats,
            base: &base,
            signatures: &sensitivities.signatures,
            sets: &sets,
            flexible: &flexible,
            pairs: effects.is_empty(),
        };
        let (observed, _, projected) = null.statistics(context.whitening, &whitened);
        // With an effect added a parameter may come back from its bound, and one may return to its prior.
        let freed = |projected: &Projected| -> Vec<(Vec<f64>, Reach)> {
            let held = (0..sensitivities.base.len()).filter(|k| fit.parameters[*k].at_bound);
            held.map(|k| {
                let mut column = context.whitening.apply(&sensitivities.base[k]);
                column.extend(priors.column(&free, &values, k));
                (projected.base.outside(&column), free[k].reach(values[k]))
            })
            .collect()
        };
        let gains_of = |projected: &Projected| {
            projected.gains(&projected.base.outside(&residual), &freed(projected), effects.is_empty())
        };
        let gains = gains_of(&projected);
        let gains_at_constant_strength = match (effects.is_empty(), base.len() == unmodulated) {
            (true, _) => Vec::new(),
            (false, true) => gains.singles.clone(),
            (false, false) => {
                let base = &base[..unmodulated];
                gains_of(&Projected::new(context.whitening, base, &sensitivities.signatures)).singles
            }
        };
        let numbers: Vec<u64> = (0..context.draws as u64).collect();
        let products = by_products.then(|| null.products(context.whitening));
        let batches: Vec<&[u64]> = numbers.chunks(AT_A_TIME).collect();
        let draw = |batch: &&[u64]| (!(control.stop)()).then(|| null.draws(batch, products.as_ref()));
        let draws = map_in_order(&batches, draw).into_iter().flatten().flatten().collect();
        Ok(Self {
            effects: effects.to_vec(),
            fit,
            modelled,
            residual,
            sensitivities,
            gains,
            gains_at_constant_strength,
            projected,
            flexible,
            set_points,
            observed,
            draws,
        })
    }

    /// Part of a whitened residual along the conditions, less what noise puts there on average after the columns `fitted`
    /// (outside the base) took their share; and the probability of as much by noise alone.
    pub fn structure(&self, residual: &[f64], fitted: &[&Vec<f64>]) -> (f64, f64) {
        let own = Basis::of(fitted.iter().copied());
        let taken: f64 = own.iter().map(|q| self.flexible.squares_within(q)).sum();
        let kept = 1.0 - taken / (self.flexible.rank() as f64).max(1.0);
        let along = self.flexible.squares_within(residual);
        let mean = self.draws.iter().map(|draw| draw.structure).sum::<f64>() / self.draws.len().max(1) as f64;
        (along - kept * mean, p_value(&self.draws, |draw| kept * draw.structure, along))
    }

    /// Share of the visible effects that could be there at the full range of their parameters without being found.
    pub fn blind_share(&self) -> f64 {
        let all = self.sensitivities.signatures.len();
        let blind = (0..all).filter(|k| self.largest_size(*k) < DETECTABLE).count();
        if all == 0 { 1.0 } else { blind as f64 / all as f64 }
    }

    /// Whitened size of what effect number `k` changes beyond the calibration over the range of its parameters.
    pub fn largest_size(&self, k: usize) -> f64 {
        self.projected.views[k].iter().flatten().map(|column| norm(column)).fold(0.0, f64::max)
    }

    /// Index of an effect among the signatures.
    pub fn index(&self, id: &str) -> Option<usize> {
        self.sensitivities.signatures.iter().position(|signature| signature.id == id)
    }

    /// Columns of an effect outside the base, by the view that fits the data best.
    pub fn columns(&self, id: &str) -> Vec<&Vec<f64>> {
        let Some(k) = self.index(id) else { return Vec::new() };
        self.projected.views[k].get(self.gains.singles[k].1).map_or_else(Vec::new, |columns| columns.iter().collect())
    }

    /// Cosine between what two effects change outside the base, along their best directions.
    pub fn cosine(&self, a: &str, b: &str) -> f64 {
        largest_cosine(&self.columns(a), &self.columns(b))
    }
}

/// For every whitened value the number of the set of repeats that it belongs to, one signal apart from the other.
fn sets_of_repeats(problem: &Problem, whitening: &Whitening) -> Vec<usize> {
    let layout = &problem.layout;
    let mut set_of: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for (k, set) in problem.experiment.replicates().iter().enumerate() {
        set_of.extend(set.iter().map(|sample| ((sample.run, sample.row), k)));
    }
    let mut names = vec![String::new(); layout.len()];
    for block in &layout.blocks {
        for (row, at) in block.range.clone().enumerate() {
            names[at] = match set_of.get(&(block.run, row)) {
                Some(set) => format!("{} {set}", block.signal),
                None => format!("{at}"),
            };
        }
    }
    let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
    whitening
        .places()
        .map(|at| {
            let next = numbers.len();
            *numbers.entry(&names[at]).or_insert(next)
        })
        .collect()
}

/// Largest cosine between directions of two spans.
pub(crate) fn largest_cosine(a: &[&Vec<f64>], b: &[&Vec<f64>]) -> f64 {
    let (a, b) = (Basis::of(a.iter().copied()), Basis::of(b.iter().copied()));
    let (rows, columns) = (a.rank(), b.rank());
    if rows == 0 || columns == 0 {
        return 0.0;
    }
    let (a, b): (Vec<_>, Vec<_>) = (a.iter().collect(), b.iter().collect());
    let products = nalgebra::DMatrix::from_fn(rows, columns, |i, k| dot(a[i], b[k]));
    products.singular_values().max().min(1.0)
}

/// A raw column times a function of the conditions.
fn modulated(problem: &Problem, column: &[f64], modulation: &[Vec<f64>]) -> Vec<f64> {
    let mut out = column.to_vec();
    for block in &problem.layout.blocks {
        for (row, at) in block.range.clone().enumerate() {
            out[at] *= modulation[block.run][row];
        }
    }
    out
}
