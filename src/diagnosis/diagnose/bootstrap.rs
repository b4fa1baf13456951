//! How large a gain noise alone gives the best of all candidates: a parametric bootstrap under the noise model.
//!
//! Each draw makes noise for every row, re-estimates the noise model from the repeats of that very draw, whitens by it,
//! and fits base and candidates around the given fit by their sensitivities. So the p-value accounts for the number
//! of candidates, the uncertainty of the noise model, and the side of the neutral value on which an effect may lie.
//!
//! Where rows are many (`by_products`), the noise of a draw is whitened by its own model and the columns by the given one: a gain does
//! not depend on the scale of its column, so that what is neglected is of second order in the error of the noise model, which
//! thousands of rows keep to a few per cent.

use super::signature::{Column, Signature};
use crate::diagnosis::layout::Layout;
use crate::diagnosis::linear_algebra::{Basis, Directions, Factor, Reach, best_fall, dot, products};
use crate::diagnosis::noise::{NoiseModel, Repeats, Whitening, estimate_near};
use nalgebra::{DMatrix, DVector};
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

/// Gains of candidates by their sensitivities.
#[derive(Clone, Debug)]
pub(crate) struct Gains {
    /// For each signature: the largest fall of chi-square, the view that gives it, its coefficients.
    pub singles: Vec<(f64, usize, Vec<f64>)>,
    /// For pairs (i < j) of signatures: the largest fall.
    pub pairs: Vec<(usize, usize, f64)>,
}

/// Whitened columns outside the base.
pub(crate) struct Projected {
    pub base: Basis,
    /// By signature and view: columns outside the base.
    pub views: Vec<Vec<Vec<Vec<f64>>>>,
    reach: Vec<Vec<Vec<Reach>>>,
}

impl Projected {
    pub fn new(whitening: &Whitening, base: &[(Vec<f64>, Vec<f64>)], signatures: &[Signature]) -> Self {
        let extra = base.first().map_or(0, |(_, priors)| priors.len());
        let whiten = |column: &Vec<f64>, priors: &[f64]| {
            let mut all = whitening.apply(column);
            all.extend_from_slice(priors);
            all
        };
        let columns: Vec<Vec<f64>> = base.iter().map(|(column, priors)| whiten(column, priors)).collect();
        let basis = Basis::of(&columns);
        let none = vec![0.0; extra];
        let outside = |column: &Column| basis.outside(&whiten(&column.values, &none));
        let views = signatures
            .iter()
            .map(|s| s.views.iter().map(|view| view.columns.iter().map(outside).collect()).collect())
            .collect();
        let reach = |column: &Column| column.reach;
        let reach = signatures
            .iter()
            .map(|s| s.views.iter().map(|view| view.columns.iter().map(reach).collect()).collect())
            .collect();
        Self { base: basis, views, reach }
    }

    /// Gains for a whitened residual (modelled minus measured) that is outside the base, where besides the candidates the
    /// columns `freed` (outside the base too) may follow within their reach; what they gain alone does not count.
    pub fn gains(&self, residual: &[f64], freed: &[(Vec<f64>, Reach)], pairs: bool) -> Gains {
        let n = self.views.len();
        let alone = fall(&[], &[], freed, residual).0;
        let mut singles = Vec::with_capacity(n);
        for (views, reach) in self.views.iter().zip(&self.reach) {
            let mut best = (0.0, 0, vec![0.0; views.first().map_or(0, Vec::len)]);
            for (v, (columns, reach)) in views.iter().zip(reach).enumerate() {
                let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
                let (fall, d) = fall(&columns, reach, freed, residual);
                if fall - alone > best.0 {
                    best = (fall - alone, v, d);
                }
            }
            singles.push(best);
        }
        let mut both = Vec::new();
        if pairs {
            for i in 0..n {
                for j in i + 1..n {
                    both.push((i, j, self.pair(i, j, &singles, freed, residual) - alone));
                }
            }
        }
        Gains { singles, pairs: both }
    }

    /// The largest fall of two signatures together, each by the view that is its best alone.
    fn pair(
        &self,
        i: usize,
        j: usize,
        singles: &[(f64, usize, Vec<f64>)],
        freed: &[(Vec<f64>, Reach)],
        residual: &[f64],
    ) -> f64 {
        let (vi, vj) = (singles[i].1, singles[j].1);
        let (Some(a), Some(b)) = (self.views[i].get(vi), self.views[j].get(vj)) else { return 0.0 };
        let columns: Vec<&[f64]> = a.iter().chain(b).map(Vec::as_slice).collect();
        let reach: Vec<Reach> = self.reach[i][vi].iter().chain(&self.reach[j][vj]).copied().collect();
        fall(&columns, &reach, freed, residual).0
    }
}

/// Whitened columns of the base and of all signatures, and their products.
pub(crate) struct Products<'w> {
    whitening: &'w Whitening,
    columns: DMatrix<f64>,
    base: Factor,
    /// Number of columns of the base, the first ones.
    of_base: usize,
    /// Products of the signatures' columns outside the base, row by row, and how many there are.
    outside: DMatrix<f64>,
    /// L^-1 of the products of the base with each column.
    shared: Vec<Vec<f64>>,
    /// By signature and view: its columns among those of the signatures, and their reaches.
    views: Vec<Vec<(std::ops::Range<usize>, Vec<Reach>)>>,
}

impl<'w> Products<'w> {
    fn new(whitening: &'w Whitening, base: &[(Vec<f64>, Vec<f64>)], signatures: &[Signature]) -> Self {
        let extra = base.first().map_or(0, |(_, priors)| priors.len());
        let (mut all, mut count) = (Vec::new(), 0);
        for (column, priors) in base {
            all.extend(whitening.apply(column));
            all.extend_from_slice(priors);
            count += 1;
        }
        let mut views = Vec::new();
        for signature in signatures {
            let mut own = Vec::new();
            for view in &signature.views {
                let first = count - base.len();
                for column in &view.columns {
                    all.extend(whitening.apply(&column.values));
                    all.extend(std::iter::repeat_n(0.0, extra));
                    count += 1;
                }
                own.push((first..count - base.len(), view.columns.iter().map(|column| column.reach).collect()));
            }
            views.push(own);
        }
        let columns = DMatrix::from_vec(all.len() / count.max(1), count, all);
        let gram = products(&columns);
        let of_base = base.len();
        let factor = Factor::of(&gram.view((0, 0), (of_base, of_base)).into_owned());
        let shared: Vec<Vec<f64>> = (of_base..count).map(|k| factor.forward(&|j| gram[(j, k)])).collect();
        let outside = DMatrix::from_fn(count - of_base, count - of_base, |i, j| {
            gram[(of_base + i, of_base + j)] - dot(&shared[i], &shared[j])
        });
        Self { whitening, columns, base: factor, of_base, outside, shared, views }
    }

    /// A residual outside the base, and the products of the signatures' columns (outside the base) with it.
    fn outside(&self, mut residual: DVector<f64>) -> (DVector<f64>, Vec<f64>) {
        let along = self.columns.tr_mul(&residual);
        let own = self.base.forward(&|k| along[k]);
        let outside = self.shared.iter().enumerate().map(|(k, shared)| along[self.of_base + k] - dot(shared, &own));
        let outside = outside.collect();
        for (k, size) in self.base.kept.iter().zip(self.base.solve(&|k| along[k])) {
            residual.axpy(-size, &self.columns.column(*k), 1.0);
        }
        (residual, outside)
    }

    /// The largest gains of a single signature and of a pair.
    fn gains(&self, along: &[f64], pairs: bool) -> (f64, f64) {
        let fall = |parts: &[&(std::ops::Range<usize>, Vec<Reach>)]| {
            let members: Vec<usize> = parts.iter().flat_map(|(range, _)| range.clone()).collect();
            let reach: Vec<Reach> = parts.iter().flat_map(|(_, reach)| reach.iter().copied()).collect();
            let products = |i: &usize| members.iter().map(move |j| self.outside[(*i, *j)]).collect::<Vec<_>>();
            let gram: Vec<f64> = members.iter().flat_map(products).collect();
            let along: Vec<f64> = members.iter().map(|k| -along[*k]).collect();
            best_fall(&gram, &along, &reach).0
        };
        let (mut single, mut pair, mut best) = (0.0_f64, 0.0_f64, Vec::with_capacity(self.views.len()));
        for views in &self.views {
            let mut own = (0.0, 0);
            for (v, view) in views.iter().enumerate() {
                let fall = fall(&[view]);
                if fall > own.0 {
                    own = (fall, v);
                }
            }
            single = single.max(own.0);
            best.push(views.get(own.1));
        }
        for i in 0..if pairs { best.len() } else { 0 } {
            for j in i + 1..best.len() {
                if let (Some(a), Some(b)) = (best[i], best[j]) {
                    pair = pair.max(fall(&[a, b]));
                }
            }
        }
        (single, pair)
    }
}

/// Fall of |r + X d|^2 with the `columns` and the `freed` ones, and the coefficients of the former.
fn fall(columns: &[&[f64]], reach: &[Reach], freed: &[(Vec<f64>, Reach)], residual: &[f64]) -> (f64, Vec<f64>) {
    let all: Vec<&[f64]> = columns.iter().copied().chain(freed.iter().map(|(column, _)| column.as_slice())).collect();
    let reach: Vec<Reach> = reach.iter().copied().chain(freed.iter().map(|(_, reach)| *reach)).collect();
    let n = all.len();
    let mut gram = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let g = dot(all[i], all[j]);
            (gram[i * n + j], gram[j * n + i]) = (g, g);
        }
    }
    let along: Vec<f64> = all.iter().map(|column| -dot(column, residual)).collect();
    let (fall, mut d) = best_fall(&gram, &along, &reach);
    d.truncate(columns.len());
    (fall, d)
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
            model.draw(&mut rng, &mut noise[block.range.clone()]);
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
