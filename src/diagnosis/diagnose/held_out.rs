//! Prediction of what was left out of the fit: whole conditions or whole runs.
//!
//! How the fit to everything becomes one without a fold is said by the [kind](crate::diagnosis::kinds) of the experiment: by a
//! refit, by one Gauss-Newton step within the bounds where refits are dear, or by a refit of few steps. The left-out runs are then
//! simulated with those values, so that the prediction itself is not linearised; where the simulation differs from what the step had
//! promised there, or has no result, the step went too far and a refit takes its place. A rover that gets stuck in them predicts
//! that it stays there, and a row of a carriage without an answer counts as missed, see [`unanswered`](crate::diagnosis::unanswered).
//! What the kept conditions do not determine widens the prediction: else a fit that extrapolates into a left-out end of the
//! slips is judged by chance.

use super::fits::{Noise, Task, run};
use super::folds::Fold;
use super::probability::log_density;
use crate::diagnosis::bounded_quadratic::within;
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::gauss_newton::PROXIMAL;
use crate::diagnosis::kinds::LeftOut;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::{LINEAR, UNFELT};
use crate::diagnosis::weighted::Weighted;
use nalgebra::{DMatrix, DVector};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// Squared range of a uniform distribution over its variance.
const UNIFORM: f64 = 12.0;

/// How well left-out data were predicted.
#[derive(Clone, Debug)]
pub(crate) struct HeldOut {
    /// Log predictive density of each left-out run (of each fold) up to a constant of the data, nats: runs are
    /// independent under the noise model.
    pub density: Vec<f64>,
    /// RMS of measured minus predicted by signal.
    pub rmse: BTreeMap<String, f64>,
}

/// Predicts each fold from the others, for the baseline with `effects` whose fit to everything is `fit`.
pub(crate) fn held_out(
    problem: &Problem,
    noise: &Noise,
    effects: &[String],
    fit: &Calibration,
    folds: &[Fold],
) -> Option<HeldOut> {
    let refit = |fold: &Fold, scouting: Option<usize>| {
        let task = problem.task(effects, vec![fit.values()]);
        Some(run(problem, noise, &Task { left_out: fold.clone(), scouting, ..task })?.values())
    };
    let fitted: Vec<Kept> = match problem.strategy().left_out(problem, fit) {
        LeftOut::Step => stepped(problem, noise, effects, &fit.values(), folds)?,
        LeftOut::Refit => {
            let opened = |fold| opened(problem, noise, effects, refit(fold, None)?, fold);
            folds.iter().map(opened).collect::<Option<_>>()?
        }
        LeftOut::ShortRefit => {
            folds.iter().map(|fold| Some(Kept::known(refit(fold, Some(0))?))).collect::<Option<_>>()?
        }
    };
    let (mut density, mut squares) = (Vec::new(), BTreeMap::<String, (f64, usize)>::new());
    for (fold, kept) in folds.iter().zip(fitted) {
        let refitted = || opened(problem, noise, effects, refit(fold, None)?, fold);
        let (kept, modelled) = simulated((problem, noise, effects), kept, refitted, fold)?;
        let inside: BTreeSet<_> = fold.iter().copied().collect();
        let difference: Vec<f64> =
            problem.layout.measured.iter().zip(&modelled).map(|(measured, modelled)| measured - modelled).collect();
        for run in inside.iter().map(|(run, _)| *run).collect::<BTreeSet<_>>() {
            let whitening = noise.whitening(problem, &|other, row| other == run && inside.contains(&(other, row)))?;
            let residual = DVector::from_vec(whitening.apply(&difference));
            let open: Vec<f64> = kept.columns.iter().flat_map(|column| whitening.apply(column)).collect();
            let open = DMatrix::from_vec(residual.len(), kept.columns.len(), open);
            density.push(log_density(&residual, &open, &kept.precision)?);
        }
        for block in &problem.layout.blocks {
            let (sum, count) = squares.entry(block.signal.clone()).or_default();
            for (_, row) in fold.iter().filter(|(run, _)| *run == block.run) {
                let e = difference[block.range.start + row];
                if !e.is_nan() {
                    *sum += e * e;
                    *count += 1;
                }
            }
        }
    }
    let rmse = squares.into_iter().map(|(signal, (sum, count))| (signal, (sum / count.max(1) as f64).sqrt()));
    Some(HeldOut { density, rmse: rmse.collect() })
}

/// The values that the kept runs give, and what the model gives for the fold with them. Values of a linear step that went too far are replaced by
/// those of a refit: the simulation gives something else than the step had promised, or nothing.
fn simulated(
    (problem, noise, effects): (&Problem, &Noise, &[String]),
    kept: Kept,
    refitted: impl FnOnce() -> Option<Kept>,
    fold: &Fold,
) -> Option<(Kept, Vec<f64>)> {
    let modelled = predict(problem, effects, &kept.values, fold);
    if modelled.is_none() && kept.promised.is_none() {
        // These are a refit's values already.
        return None;
    }
    if let Some(modelled) = modelled
        && is_linear(problem, noise, &kept, &modelled, fold)?
    {
        return Some((kept, modelled));
    }
    let kept = refitted()?;
    let modelled = predict(problem, effects, &kept.values, fold)?;
    Some((kept, modelled))
}

/// Modelled values where a fold lies; elsewhere anything.
fn predict(problem: &Problem, effects: &[String], values: &[f64], fold: &Fold) -> Option<Vec<f64>> {
    let free = problem.free(effects);
    let runs: BTreeSet<usize> = fold.iter().map(|(run, _)| *run).collect();
    if problem.strategy().budget().predicts_whole || runs.len() == problem.experiment.runs.len() {
        return problem.predict(&free, |predict| predict.values_onward(values)).ok()?.ok();
    }
    let runs: Vec<usize> = runs.into_iter().collect();
    let part = problem.only(&runs);
    let own = part.predict(&free, |predict| predict.values_onward(values)).ok()?.ok()?;
    let mut all = vec![f64::NAN; problem.layout.len()];
    for (k, run) in runs.iter().enumerate() {
        for (from, to) in part.layout.of_run(k).zip(problem.layout.of_run(*run)) {
            all[to.range.clone()].copy_from_slice(&own[from.range.clone()]);
        }
    }
    Some(all)
}

/// Whether the left-out rows are what a linear step had promised, beside what the prediction misses of them beyond noise.
fn is_linear(problem: &Problem, noise: &Noise, kept: &Kept, modelled: &[f64], fold: &Fold) -> Option<bool> {
    let Some(promised) = &kept.promised else { return Some(true) };
    let inside: BTreeSet<_> = fold.iter().copied().collect();
    let whitening = noise.whitening(problem, &|run, row| inside.contains(&(run, row)))?;
    let from_modelled = |other: &[f64]| {
        let difference: Vec<f64> = other.iter().zip(modelled).map(|(other, modelled)| other - modelled).collect();
        let whitened = whitening.apply(&difference);
        (whitened.iter().map(|r| r * r).sum::<f64>(), whitened.len() as f64)
    };
    let (misfit, rows) = from_modelled(&problem.layout.measured);
    Some(from_modelled(promised).0 <= UNFELT + LINEAR * (misfit - rows).max(0.0))
}

/// What the runs outside a fold say.
struct Kept {
    values: Vec<f64>,
    /// Precision of the search coordinates around them.
    precision: DMatrix<f64>,
    /// Derivatives of all rows in these coordinates; none where a far rover's values are taken as known.
    columns: Rc<Vec<Vec<f64>>>,
    /// What a linear step promises of all rows; `None` after a refit.
    promised: Option<Vec<f64>>,
}

impl Kept {
    /// Values around which nothing counts as open.
    fn known(values: Vec<f64>) -> Self {
        Self { values, precision: DMatrix::zeros(0, 0), columns: Rc::default(), promised: None }
    }
}

/// Values that were refitted without a fold, and what the kept rows leave open around them.
fn opened(problem: &Problem, noise: &Noise, effects: &[String], values: Vec<f64>, fold: &Fold) -> Option<Kept> {
    let free = problem.free(effects);
    let inside: BTreeSet<_> = fold.iter().copied().collect();
    let whitening = noise.whitening(problem, &|run, row| !inside.contains(&(run, row)))?;
    let (_, slopes) = problem.predict(&free, |predict| predict.slopes_onward(&values)).ok()?.ok()?;
    let kept = |predict: &dyn crate::diagnosis::prediction::Predict| {
        let (layout, free, robust) = (&problem.layout, free.as_slice(), f64::INFINITY);
        let priors = &problem.prior_rows(free);
        let whitening = &whitening;
        Weighted { predict, layout, free, whitening, priors, robust, whole: false }.columns(&slopes, &values)
    };
    let precision = precision(&free, &problem.predict(&free, kept).ok()?);
    Some(Kept { columns: Rc::new(scaled(&free, &slopes, &values)), precision, values, promised: None })
}

/// Derivatives in the search coordinates.
fn scaled(free: &[crate::diagnosis::free::Free], slopes: &[Vec<f64>], values: &[f64]) -> Vec<Vec<f64>> {
    let scaled = |(k, slope): (usize, &Vec<f64>)| slope.iter().map(|s| s * free[k].slope(values[k])).collect();
    slopes.iter().enumerate().map(scaled).collect()
}

/// One Gauss-Newton step to each fold's own optimum.
fn stepped(problem: &Problem, noise: &Noise, effects: &[String], values: &[f64], folds: &[Fold]) -> Option<Vec<Kept>> {
    let free = problem.free(effects);
    let (modelled, slopes) = problem.predict(&free, |predict| predict.slopes(values)).ok()?.ok()?;
    let all = Rc::new(scaled(&free, &slopes, values));
    let fit = |predict: &dyn crate::diagnosis::prediction::Predict| {
        let (layout, free, robust) = (&problem.layout, free.as_slice(), noise.robust.unwrap_or(f64::INFINITY));
        let priors = &problem.prior_rows(free);
        let over = |left_out: &BTreeSet<(usize, usize)>| {
            let whitening = &noise.whitening(problem, &|run, row| !left_out.contains(&(run, row)))?;
            let weighted = Weighted { predict, layout, free, whitening, priors, robust, whole: false };
            let (mut residual, mut columns) = (weighted.whitened(&modelled, values), weighted.columns(&slopes, values));
            let precision = precision(free, &columns);
            weighted.make_robust(&mut residual, &mut columns);
            Some((Normal::of(&residual, &columns), precision, weighted.coordinates(values)))
        };
        let (whole, _, u) = over(&BTreeSet::new())?;
        let bounds: Vec<(f64, f64)> = free.iter().map(crate::diagnosis::free::Free::bounds).collect();
        let kept = |fold: &Fold| {
            let (part, precision, _) = over(&fold.iter().copied().collect())?;
            let to = without(&whole, &part, &bounds, &u);
            let mut promised = modelled.clone();
            for ((column, to), from) in all.iter().zip(&to).zip(&u) {
                promised.iter_mut().zip(column).for_each(|(value, slope)| *value += slope * (to - from));
            }
            let values = free.iter().zip(&to).map(|(free, u)| free.value(*u)).collect();
            Some(Kept { values, precision, columns: Rc::clone(&all), promised: Some(promised) })
        };
        folds.iter().map(kept).collect::<Option<Vec<_>>>()
    };
    problem.predict(&free, fit).ok()?
}

/// The normal equations of a linear least-squares problem with the Jacobian J and the residuals r.
struct Normal {
    /// J^T J.
    gram: DMatrix<f64>,
    /// J^T r, half of the slope of chi-square.
    along: DVector<f64>,
}

impl Normal {
    fn of(residual: &[f64], columns: &[Vec<f64>]) -> Self {
        let jacobian = DMatrix::from_fn(residual.len(), columns.len(), |i, k| columns[k][i]);
        Self { gram: jacobian.tr_mul(&jacobian), along: jacobian.tr_mul(&DVector::from_column_slice(residual)) }
    }
}

/// The coordinates of the optimum of a part of the rows, from those of the whole, `u`, by one Gauss-Newton step within the bounds.
///
/// A search may end at `u` although the linear problem of all rows has a slope left there: the model is less smooth than that. This slope
/// is subtracted from the part's, so that the step follows from the rows that are left out alone. A slope that presses a coordinate
/// against its bound is kept, since it holds the coordinate there.
fn without(whole: &Normal, part: &Normal, bounds: &[(f64, f64)], u: &[f64]) -> Vec<f64> {
    let (mut gram, mut along) = (part.gram.clone(), part.along.clone());
    let mut ends = Vec::new();
    for (k, (lower, upper)) in bounds.iter().enumerate() {
        let (down, up) = ((lower - u[k]).min(0.0), (upper - u[k]).max(0.0));
        let held = if whole.along[k] > 0.0 { down == 0.0 } else { up == 0.0 };
        if !held {
            along[k] -= whole.along[k];
        }
        gram[(k, k)] += PROXIMAL / (upper - lower).powi(2);
        ends.push((down, up));
    }
    let change = within(&gram, along.as_slice(), &ends);
    u.iter().zip(change).map(|(u, change)| u + change).collect()
}

/// Precision of search coordinates from whitened columns; a coordinate that these do not determine may lie anywhere between
/// its bounds.
fn precision(free: &[crate::diagnosis::free::Free], columns: &[Vec<f64>]) -> DMatrix<f64> {
    let matrix = DMatrix::from_fn(columns.first().map_or(0, Vec::len), columns.len(), |i, k| columns[k][i]);
    let mut precision = matrix.tr_mul(&matrix);
    for (k, free) in free.iter().enumerate() {
        let (lower, upper) = free.bounds();
        precision[(k, k)] += UNIFORM / (upper - lower).powi(2);
    }
    precision
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
mod tests {
    use super::*;
    use crate::diagnosis::diagnose::DiagnoseOptions;
    use crate::diagnosis::kinds::synthetic::experiment;
    use crate::model::Model;

    /// The charge [`PROXIMAL`] of a move, over these bounds 2.5e-9 beside curvatures of 1 and more, shifts the optimum by less.
    const CHARGED: f64 = 1e-6;
    const WIDE: (f64, f64) = (-1e4, 1e4);

    /// The problem of a line u0 + u1 x through points.
    fn line(points: &[(f64, f64)], u: &[f64]) -> Normal {
        let residual: Vec<f64> = points.iter().map(|(x, y)| u[0] + u[1] * x - y).collect();
        Normal::of(&residual, &[vec![1.0; points.len()], points.iter().map(|(x, _)| *x).collect()])
    }

    const POINTS: [(f64, f64); 5] = [(0.0, 1.0), (1.0, 2.5), (2.0, 3.0), (3.0, 8.0), (4.0, 7.0)];

    /// The least-squares line by its own formula.
    fn best(points: &[(f64, f64)]) -> [f64; 2] {
        let n = points.len() as f64;
        let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
        let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
        let slope = mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2));
        [y - slope * x, slope]
    }

    #[test]
    fn analytic_the_step_leads_from_the_best_line_of_all_points_to_that_of_some() {
        let u = best(&POINTS);
        let to = without(&line(&POINTS, &u), &line(&POINTS[..3], &u), &[WIDE; 2], &u);
        let expected = best(&POINTS[..3]);
        assert!(to.iter().zip(expected).all(|(a, b)| (a - b).abs() < CHARGED), "{to:?} and {expected:?}");
    }

    /// Where a search has ended although a slope is left, nothing left out leads nowhere.
    #[test]
    fn property_the_step_is_nothing_where_nothing_is_left_out() {
        let u = [0.3, 0.4];
        let all = line(&POINTS, &u);
        assert_eq!(without(&all, &line(&POINTS, &u), &[WIDE; 2], &u), u);
    }

    /// A coordinate that the whole holds on a bound stays there until the part pulls it away.
    #[test]
    fn property_a_bound_holds_as_long_as_the_part_presses_on_it() {
        let low = (best(&POINTS)[1] + 1.0, 1e4);
        let at = |points: &[(f64, f64)]| {
            // The best line of all points with this slope goes through their mean.
            let [x, y] = [2.0, 4.3];
            let u = [y - low.0 * x, low.0];
            without(&line(&POINTS, &u), &line(points, &u), &[WIDE, low], &u)
        };
        assert_eq!(at(&POINTS[..3])[1], low.0, "the slope of the first points is lower still");
        assert!(at(&POINTS[2..4])[1] > low.0, "between two of them it is steeper");
    }

    #[test]
    fn property_a_step_to_where_the_model_has_no_answer_is_replaced_by_a_refit() {
        let (experiment, model) = (experiment("torque_command", false), Model::preset("two_wheeled").unwrap());
        let problem = DiagnoseOptions::default().problem(&model, &experiment).unwrap();
        let given: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
        // A model whose soil is no number does not start.
        let nowhere = vec![f64::NAN; given.len()];
        let (noise, fold) = (Noise::new(BTreeMap::new()), vec![(0, 0)]);
        assert!(predict(&problem, &[], &given, &fold).is_some() && predict(&problem, &[], &nowhere, &fold).is_none());
        let stepped = || Kept { promised: Some(Vec::new()), ..Kept::known(nowhere.clone()) };
        let found = |kept: Kept, refitted: Option<Kept>| {
            simulated((&problem, &noise, &[]), kept, || refitted, &fold).map(|(kept, _)| kept.values)
        };
        assert_eq!(found(stepped(), Some(Kept::known(given.clone()))), Some(given.clone()));
        assert_eq!(found(stepped(), None), None, "no refit either");
        assert_eq!(found(Kept::known(nowhere), Some(Kept::known(given))), None, "a refit is not made twice");
    }
}
