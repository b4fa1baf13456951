//! What candidates gain by their sensitivities, one by one and in pairs: from columns outside the base, and from products of columns alone.

use super::signature::Signature;
use super::views::Column;
use crate::diagnosis::linear_algebra::{Basis, Factor, Reach, best_fall, dot, products};
use crate::diagnosis::noise::Whitening;
use nalgebra::{DMatrix, DVector};

/// Of one signature the largest fall of chi-square, the view that gives it, and its coefficients.
pub(crate) type SingleGain = (f64, usize, Vec<f64>);

/// Gains of candidates by their sensitivities.
#[derive(Clone, Debug)]
pub(crate) struct Gains {
    /// For each signature.
    pub singles: Vec<SingleGain>,
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
    fn pair(&self, i: usize, j: usize, singles: &[SingleGain], freed: &[(Vec<f64>, Reach)], residual: &[f64]) -> f64 {
        let (vi, vj) = (singles[i].1, singles[j].1);
        let (Some(a), Some(b)) = (self.views[i].get(vi), self.views[j].get(vj)) else { return 0.0 };
        let columns: Vec<&[f64]> = a.iter().chain(b).map(Vec::as_slice).collect();
        let reach: Vec<Reach> = self.reach[i][vi].iter().chain(&self.reach[j][vj]).copied().collect();
        fall(&columns, &reach, freed, residual).0
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

/// Whitened columns of the base and of all signatures, and their products.
pub(crate) struct Products<'w> {
    pub whitening: &'w Whitening,
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
    pub fn new(whitening: &'w Whitening, base: &[(Vec<f64>, Vec<f64>)], signatures: &[Signature]) -> Self {
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
    pub fn outside(&self, mut residual: DVector<f64>) -> (DVector<f64>, Vec<f64>) {
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
    pub fn gains(&self, along: &[f64], pairs: bool) -> (f64, f64) {
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
