//! How large a gain noise alone gives the best of all candidates: a parametric bootstrap under the noise model.
//!
//! Each draw makes noise for every row, re-estimates the noise model from the repeats of that very draw, whitens by it,
//! and fits base and candidates around the given fit by their sensitivities. So the p-value accounts for the number
//! of candidates, the uncertainty of the noise model, and the side of the neutral value on which an effect may lie.
//!
//! Where rows are many (`by_products`), the noise of a draw is whitened by its own model and the columns by the given one: a gain does
//! not depend on the scale of its column, so that what is neglected is of second order in the error of the noise model, which
//! thousands of rows keep to a few per cent.

use super::gains::{Gains, Products, Projected};
use super::signature::Signature;
use crate::diagnosis::layout::Layout;
use crate::diagnosis::linear_algebra::{Directions, dot};
use crate::diagnosis::noise::{NoiseModel, Repeats, Whitening, estimate_near};
use nalgebra::DVector;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::borrow::Cow;
use std::collections::BTreeMap;

const SEED: u64 = 1979;

/// What is the same for all draws.
pub(crate) struct Null<'a> {
    pub layout: &'a Layout,
    pub noise: &'a BTreeMap<String, NoiseModel>,
    /// Repeats from which the noise model came; `None` where it did not come from repeats.
    pub repeats: Option<&'a Repeats>,
    /// Raw columns that the fit absorbs (layout order), and the priors' rows of each.
    pub base: &'a [(Vec<f64>, Vec<f64>)],
    pub signatures: &'a [Signature],
    /// For every whitened value the set of repeats that it belongs to; values that nothing repeats are sets of one.
    pub sets: &'a [usize],
    /// Directions along the conditions, in whitened values of the given noise, outside the base.
    pub flexible: &'a Directions,
    /// Whether to draw pairs as well.
    pub pairs: bool,
}

/// Statistics of one draw, or of the data.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Statistics {
    /// Chi-square after the base.
    pub chi_square: f64,
    /// Its part that repeats have in common: noise divided by the root of their number, and all of the model's error.
    pub common: f64,
    /// Its part along the flexible columns.
    pub structure: f64,
    /// Largest gain of a single candidate.
    pub single: f64,
    /// Largest gain of a pair.
    pub pair: f64,
}

impl Null<'_> {
    /// Statistics of these draws, each of which has its own seed: the same whatever the order of the draws.
    /// With the products `known` of the columns these are not whitened again.
    pub fn draws(&self, numbers: &[u64], known: Option<&Products>) -> Vec<Statistics> {
        let (mut all, rests): (Vec<Statistics>, Vec<Vec<f64>>) =
            numbers.iter().filter_map(|k| self.draw(*k, known)).unzip();
        let structures = self.flexible.squares_within_each(&rests);
        all.iter_mut().zip(structures).for_each(|(statistics, structure)| statistics.structure = structure);
        all
    }

    /// One draw, its structure still open, and what is left outside the base.
    fn draw(&self, k: u64, known: Option<&Products>) -> Option<(Statistics, Vec<f64>)> {
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        rng.set_stream(k);
        let mut noise = vec![f64::NAN; self.layout.len()];
        for block in &self.layout.blocks {
            let Some(model) = self.noise.get(&block.signal) else { continue };
            let scale = self.layout.scale.get(block.range.clone()).unwrap_or_default();
            model.draw(&mut rng, scale, &mut noise[block.range.clone()]);
        }
        for (value, measured) in noise.iter_mut().zip(&self.layout.measured) {
            if measured.is_nan() {
                *value = f64::NAN;
            }
        }
        let whitening = match (self.repeats, known) {
            (None, Some(products)) => Cow::Borrowed(products.whitening),
            (repeats, _) => Cow::Owned(Whitening::new(self.layout, &self.noise_of(repeats, &noise), &|_, _| true)?),
        };
        let white = whitening.apply(&noise);
        Some(match known {
            Some(products) => self.by_products(products, white),
            None => {
                let (statistics, _, _, rest) = self.judged(&whitening, &white);
                (statistics, rest)
            }
        })
    }

    /// The noise models as the repeats of a draw tell them; the given ones without repeats.
    fn noise_of(&self, repeats: Option<&Repeats>, noise: &[f64]) -> BTreeMap<String, NoiseModel> {
        let Some(repeats) = repeats else { return self.noise.clone() };
        let again = |(signal, model): (&String, &NoiseModel)| {
            let again = estimate_near(repeats, self.layout, signal, noise, model).unwrap_or(*model);
            (signal.clone(), again)
        };
        self.noise.iter().map(again).collect()
    }

    /// Products of the columns under the given noise.
    pub fn products<'w>(&self, whitening: &'w Whitening) -> Products<'w> {
        Products::new(whitening, self.base, self.signatures)
    }

    /// The same as [`statistics`](Self::statistics), to rounding, without a column outside the base: hundreds of draws ask for
    /// products alone.
    fn by_products(&self, products: &Products, mut residual: Vec<f64>) -> (Statistics, Vec<f64>) {
        let extra = self.base.first().map_or(0, |(_, priors)| priors.len());
        residual.extend(std::iter::repeat_n(0.0, extra));
        let residual = DVector::from_vec(residual);
        let (rest, along) = products.outside(residual);
        let (single, pair) = products.gains(&along, self.pairs);
        let rest = rest.as_slice();
        let (chi_square, common) = (dot(rest, rest), common(rest, self.sets));
        (Statistics { chi_square, common, structure: 0.0, single, pair }, rest.to_vec())
    }

    /// Statistics for a whitened residual without the priors' rows, and the projected columns.
    pub fn statistics(&self, whitening: &Whitening, residual: &[f64]) -> (Statistics, Gains, Projected) {
        let (mut statistics, gains, projected, rest) = self.judged(whitening, residual);
        statistics.structure = self.flexible.squares_within(&rest);
        (statistics, gains, projected)
    }

    /// The same, its structure still open, and what is left outside the base.
    fn judged(&self, whitening: &Whitening, residual: &[f64]) -> (Statistics, Gains, Projected, Vec<f64>) {
        let projected = Projected::new(whitening, self.base, self.signatures);
        let extra = self.base.first().map_or(0, |(_, priors)| priors.len());
        let mut residual = residual.to_vec();
        residual.extend(std::iter::repeat_n(0.0, extra));
        projected.base.remove_from(&mut residual);
        let gains = projected.gains(&residual, &[], self.pairs);
        let statistics = Statistics {
            chi_square: dot(&residual, &residual),
            common: common(&residual, self.sets),
            structure: 0.0,
            single: gains.singles.iter().map(|(fall, ..)| *fall).fold(0.0, f64::max),
            pair: gains.pairs.iter().map(|(.., fall)| *fall).fold(0.0, f64::max),
        };
        (statistics, gains, projected, residual)
    }
}

/// Squares of a whitened residual along the means of its sets.
fn common(residual: &[f64], sets: &[usize]) -> f64 {
    let count = sets.iter().max().map_or(0, |last| last + 1);
    let mut sums = vec![(0.0, 0.0); count];
    for (value, set) in residual.iter().zip(sets) {
        sums[*set].0 += value;
        sums[*set].1 += 1.0;
    }
    sums.iter().filter(|(_, size)| *size > 0.0).map(|(sum, size)| sum * sum / size).sum()
}

/// Share of draws with at least `observed`, counting the observation itself: never below 1/(draws + 1).
pub(crate) fn p_value(draws: &[Statistics], pick: impl Fn(&Statistics) -> f64, observed: f64) -> f64 {
    let beyond = draws.iter().filter(|draw| pick(draw) >= observed).count();
    (beyond + 1) as f64 / (draws.len() + 1) as f64
}
