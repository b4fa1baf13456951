//! Probabilities over the baseline, the candidates and "something else": pseudo-BMA with a Bayesian bootstrap over what
//! was left out (Yao, Vehtari, Simpson and Gelman 2018).

use super::fits::Noise;
use super::folds::Fold;
use crate::diagnosis::linear_algebra::products;
use crate::diagnosis::noise::Whitening;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::REWEIGHTINGS;
use crate::parallel::map_in_order;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Exp1};
use std::collections::BTreeSet;

const SEED: u64 = 1998;

/// Weights of models from their log predictive densities by fold and their prior probabilities.
pub(crate) fn weights(densities: &[&[f64]], priors: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; densities.len()];
    for_each_reweighting(densities, &mut |totals| {
        let totals: Vec<f64> = totals.iter().zip(priors).map(|(total, prior)| total + prior.ln()).collect();
        let most = totals.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let shares: Vec<f64> = totals.iter().map(|total| (total - most).exp()).collect();
        let all: f64 = shares.iter().sum();
        sums.iter_mut().zip(shares).for_each(|(sum, share)| *sum += share / all);
    });
    sums.iter().map(|sum| sum / REWEIGHTINGS as f64).collect()
}

/// Probability that `ours` predicts left-out data better than `theirs`.
pub(crate) fn better(ours: &[f64], theirs: &[f64]) -> f64 {
    let mut wins = 0;
    for_each_reweighting(&[ours, theirs], &mut |totals| wins += usize::from(totals[0] > totals[1]));
    wins as f64 / REWEIGHTINGS as f64
}

/// Probability of `ours` where only `theirs` competes and both are as probable beforehand. Unlike [`better`] it weighs by how
/// much one predicts better: two that predict the same within a fraction of a nat are as probable, even where one of them
/// is that little better on every fold.
pub(crate) fn against(ours: &[f64], theirs: &[f64]) -> f64 {
    weights(&[ours, theirs], &[0.5, 0.5])[0]
}

/// Calls `f` with the sums of each model's densities under Dirichlet weights of the folds.
fn for_each_reweighting(densities: &[&[f64]], f: &mut dyn FnMut(&[f64])) {
    let folds = densities.first().map_or(0, |all| all.len());
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut totals = vec![0.0; densities.len()];
    for _ in 0..REWEIGHTINGS {
        let raw: Vec<f64> = (0..folds).map(|_| Exp1.sample(&mut rng)).collect();
        let sum: f64 = raw.iter().sum();
        for (total, densities) in totals.iter_mut().zip(densities) {
            *total = raw.iter().zip(*densities).map(|(w, d)| w * d).sum::<f64>() * folds as f64 / sum;
        }
        f(&totals);
    }
}

/// Log predictive density of a whitened residual, up to a constant of the data, where the coefficients of these whitened
/// columns are known to a precision only: the normal density of covariance 1 + A K^-1 A'. `None` where K is not positive.
pub(crate) fn log_density(residual: &DVector<f64>, columns: &DMatrix<f64>, precision: &DMatrix<f64>) -> Option<f64> {
    let (kept, all) = (precision.clone().cholesky()?, (precision + columns.tr_mul(columns)).cholesky()?);
    let along = columns.tr_mul(residual);
    let determinant = |factor: &Cholesky<f64, Dyn>| 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
    let wider = determinant(&all) - determinant(&kept);
    Some(-0.5 * (residual.norm_squared() - along.dot(&all.solve(&along)) + wider))
}

/// Prior standard deviations tried for the coefficients of the flexible columns, in standard deviations of the noise over
/// the whole experiment.
const STRENGTHS: [f64; 7] = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0];

/// Log predictive densities, by fold, of the baseline plus a flexible discrepancy: ridge regression of the residual on the
/// columns along the conditions, its strength by the evidence of the rows that are kept. The base follows linearly. What the
/// rows that are kept leave open widens the prediction, as with the effects. `None` after a stop, too.
pub(crate) fn something_else(
    problem: &Problem,
    noise: &Noise,
    difference: &[f64],
    base: &[Vec<f64>],
    flexible: &[Vec<f64>],
    folds: &[Fold],
) -> Option<Vec<f64>> {
    let whole = noise.whitening(problem, &|_, _| true)?;
    let sizes: Vec<f64> = flexible.iter().map(|column| size(&whole.apply(column))).collect();
    let base_sizes: Vec<f64> = base.iter().map(|column| size(&whole.apply(column))).collect();
    let scaled = |whitening: &Whitening| -> DMatrix<f64> {
        let all = base.iter().zip(&base_sizes).chain(flexible.iter().zip(&sizes));
        let columns: Vec<DVector<f64>> = all
            .map(|(column, size)| DVector::from_vec(whitening.apply(column)) / size.max(f64::MIN_POSITIVE))
            .collect();
        DMatrix::from_columns(&columns)
    };
    let by_products = problem.strategy().budget().by_products;
    let of_fold = |fold: &Fold| -> Option<Vec<f64>> {
        let mut densities = Vec::new();
        if problem.halt.asked() {
            return None;
        }
        let inside: BTreeSet<_> = fold.iter().copied().collect();
        let kept = noise.whitening(problem, &|run, row| !inside.contains(&(run, row)))?;
        let (x, y) = (scaled(&kept), DVector::from_vec(kept.apply(difference)));
        let gram = if by_products { products(&x) } else { x.tr_mul(&x) };
        let (coefficients, precision) = ridge(&gram, &x.tr_mul(&y), base.len())?;
        for run in inside.iter().map(|(run, _)| *run).collect::<BTreeSet<_>>() {
            let left = noise.whitening(problem, &|other, row| other == run && inside.contains(&(other, row)))?;
            let columns = scaled(&left);
            let rest = DVector::from_vec(left.apply(difference)) - &columns * &coefficients;
            densities.push(log_density(&rest, &columns, &precision)?);
        }
        Some(densities)
    };
    Some(map_in_order(folds, of_fold).into_iter().collect::<Option<Vec<_>>>()?.concat())
}

fn size(column: &[f64]) -> f64 {
    column.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Coefficients of the strength with the largest evidence, and their precision, from the products of the columns among themselves and
/// with what they fit; the first `free` columns have a wide prior.
fn ridge(gram: &DMatrix<f64>, along: &DVector<f64>, free: usize) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let n = along.len();
    let mut best: Option<(f64, DVector<f64>, DMatrix<f64>)> = None;
    for strength in STRENGTHS {
        let wide = STRENGTHS[STRENGTHS.len() - 1];
        let variance = |k: usize| if k < free { wide * wide } else { strength * strength };
        let mut precision = gram.clone();
        (0..n).for_each(|k| precision[(k, k)] += variance(k).recip());
        let Some(cholesky) = precision.clone().cholesky() else { continue };
        let coefficients = cholesky.solve(along);
        let determinant: f64 = cholesky.l_dirty().diagonal().iter().map(|d| 2.0 * d.ln()).sum();
        let prior: f64 = (0..n).map(|k| variance(k).ln()).sum();
        let evidence = 0.5 * (along.dot(&coefficients) - determinant - prior);
        if best.as_ref().is_none_or(|(known, ..)| evidence > *known) {
            best = Some((evidence, coefficients, precision));
        }
    }
    best.map(|(_, coefficients, precision)| (coefficients, precision))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of sums of a dozen terms.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn analytic_density_of_what_is_left_open_is_that_of_the_whole_covariance() {
        let columns = DMatrix::from_fn(5, 2, |i, k| ((3 * i + 7 * k) as f64).sin());
        let residual = DVector::from_fn(5, |i, _| (i as f64 + 0.5).cos());
        let precision = DMatrix::from_row_slice(2, 2, &[2.0, 0.3, 0.3, 0.7]);
        let open = precision.clone().try_inverse().expect("positive");
        let covariance = DMatrix::identity(5, 5) + &columns * open * columns.transpose();
        let squares = residual.dot(&(covariance.clone().try_inverse().expect("positive") * &residual));
        let expected = -0.5 * (squares + covariance.determinant().ln());
        let found = log_density(&residual, &columns, &precision).expect("positive");
        assert!((found - expected).abs() < ROUNDING, "{found} instead of {expected}");
    }

    #[test]
    fn analytic_a_little_better_on_every_fold_is_not_told_apart() {
        let theirs = [-10.0, -20.0, -30.0, -40.0];
        let ours = theirs.map(|density| density + 0.01);
        assert!((better(&ours, &theirs) - 1.0).abs() < ROUNDING);
        // Every reweighting adds up to 0.04 nats.
        let expected = 1.0 / (1.0 + (-0.04_f64).exp());
        let found = against(&ours, &theirs);
        assert!((found - expected).abs() < ROUNDING, "{found} instead of {expected}");
    }

    #[test]
    fn analytic_nothing_left_open_is_plain_noise() {
        let residual = DVector::from_vec(vec![0.3, -1.1, 0.7]);
        let found = log_density(&residual, &DMatrix::zeros(3, 0), &DMatrix::zeros(0, 0)).expect("positive");
        assert!((found + 0.5 * residual.norm_squared()).abs() < ROUNDING, "{found}");
    }
}
