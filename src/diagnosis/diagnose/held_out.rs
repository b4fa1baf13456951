//! Prediction of what was left out of the fit: whole conditions or whole runs.
//!
//! A wheel on a carriage is refitted without each fold. A traverse, where refits are dear, takes one Gauss-Newton step
//! from the full fit to the optimum without the fold, within the bounds; where the full fit is far from the measurements,
//! so that such a step means little, it is refitted for a few steps. The left-out runs are then simulated with those
//! values, so that the prediction itself is not linearised. A rover that gets stuck in them predicts that it stays there.

use super::fits::{Noise, Task, run};
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::least_squares::{LeastSquares, Pace};
use crate::diagnosis::problem::Problem;
use crate::diagnosis::weighted::Weighted;
use crate::measurement::{Experiment, Kind};
use nalgebra::DMatrix;
use std::collections::{BTreeMap, BTreeSet};

/// Most folds.
const FOLDS: usize = 6;

/// Fewest groups of runs that make folds by themselves; with fewer, folds are levels of slip or stretches of rows.
const LEAST_GROUPS: usize = 3;

/// Rows (run, row) that are left out together.
pub(crate) type Fold = Vec<(usize, usize)>;

/// How well left-out data were predicted.
#[derive(Clone, Debug)]
pub(crate) struct HeldOut {
    /// Log predictive density of each left-out run (of each fold) up to a constant of the data, nats: runs are
    /// independent under the noise model.
    pub density: Vec<f64>,
    /// RMS of measured minus predicted by signal.
    pub rmse: BTreeMap<String, f64>,
}

/// Folds of whole conditions: groups of repeats; conditions of equal label; with too few of them, classes of slip.
pub(crate) fn folds(experiment: &Experiment) -> Vec<Fold> {
    let mut units = units(experiment);
    if units.len() < LEAST_GROUPS {
        units = classes(experiment);
    }
    let count = units.len().min(FOLDS);
    let mut folds = vec![Fold::new(); count];
    for (k, unit) in units.into_iter().enumerate() {
        folds[k % count].extend(unit);
    }
    folds.iter_mut().for_each(|fold| fold.sort_unstable());
    folds
}

/// Rows that repeat each other, whole groups of runs together.
fn units(experiment: &Experiment) -> Vec<Fold> {
    let mut units: Vec<(String, Fold)> = Vec::new();
    for (k, run) in experiment.runs.iter().enumerate() {
        for row in 0..run.data.rows() {
            let key = match (run.conditions.get(row), &run.group) {
                (Some(Some(label)), _) => format!("condition {label}"),
                (_, Some(group)) => format!("group {group}"),
                _ => format!("run {k}"),
            };
            match units.iter_mut().find(|(known, _)| *known == key) {
                Some((_, unit)) => unit.push((k, row)),
                None => units.push((key, vec![(k, row)])),
            }
        }
    }
    units.into_iter().map(|(_, unit)| unit).collect()
}

/// Classes of about equal count along slip (or the row, in a traverse), rows of equal slip together.
fn classes(experiment: &Experiment) -> Vec<Fold> {
    let mut samples: Vec<(f64, (usize, usize))> = Vec::new();
    for (k, run) in experiment.runs.iter().enumerate() {
        for row in 0..run.data.rows() {
            samples.push((run.data.value("slip", row).unwrap_or(row as f64), (k, row)));
        }
    }
    samples.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let levels: Vec<_> = samples.chunk_by(|a, b| a.0 == b.0).collect();
    let count = levels.len().min(FOLDS);
    let mut folds = vec![Fold::new(); count];
    for (k, level) in levels.iter().enumerate() {
        folds[k * count / levels.len()].extend(level.iter().map(|(_, at)| *at));
    }
    folds
}

/// Predicts each fold from the others, for the baseline with `effects` whose fit to everything is `fit`.
pub(crate) fn held_out(
    problem: &Problem,
    noise: &Noise,
    effects: &[String],
    fit: &Calibration,
    folds: &[Fold],
) -> Option<HeldOut> {
    let values = fit.values();
    let fitted: Vec<Vec<f64>> = match problem.experiment.kind {
        Kind::Traverse if !fit.is_far() => stepped(problem, noise, effects, &values, folds)?,
        kind => folds
            .iter()
            .map(|fold| {
                let scouting = (kind == Kind::Traverse).then_some(0);
                let task = problem.task(effects, vec![values.clone()]);
                Some(run(problem, noise, &Task { left_out: fold.clone(), scouting, ..task })?.values())
            })
            .collect::<Option<_>>()?,
    };
    let (mut density, mut squares) = (Vec::new(), BTreeMap::<String, (f64, usize)>::new());
    for (fold, values) in folds.iter().zip(&fitted) {
        let modelled = predict(problem, effects, values, fold)?;
        let inside: BTreeSet<_> = fold.iter().copied().collect();
        let difference: Vec<f64> =
            problem.layout.measured.iter().zip(&modelled).map(|(measured, modelled)| measured - modelled).collect();
        for run in inside.iter().map(|(run, _)| *run).collect::<BTreeSet<_>>() {
            let whitening = noise.whitening(problem, &|other, row| other == run && inside.contains(&(other, row)))?;
            density.push(-0.5 * whitening.apply(&difference).iter().map(|r| r * r).sum::<f64>());
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

/// Modelled values where a fold lies; elsewhere anything.
fn predict(problem: &Problem, effects: &[String], values: &[f64], fold: &Fold) -> Option<Vec<f64>> {
    let free = problem.free(effects);
    let runs: BTreeSet<usize> = fold.iter().map(|(run, _)| *run).collect();
    if problem.experiment.kind == Kind::SingleWheel || runs.len() == problem.experiment.runs.len() {
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

/// One Gauss-Newton step to each fold's own optimum.
fn stepped(
    problem: &Problem,
    noise: &Noise,
    effects: &[String],
    values: &[f64],
    folds: &[Fold],
) -> Option<Vec<Vec<f64>>> {
    let free = problem.free(effects);
    let whole = noise.whitening(problem, &|_, _| true)?;
    let (modelled, slopes) = problem.predict(&free, |predict| predict.slopes(values)).ok()?.ok()?;
    let fit = |predict: &dyn crate::diagnosis::prediction::Predict| {
        let (layout, free, robust) = (&problem.layout, free.as_slice(), f64::INFINITY);
        let u = Weighted { predict, layout, free, whitening: &whole, robust, whole: true }.coordinates(values);
        folds
            .iter()
            .map(|fold| {
                let inside: BTreeSet<_> = fold.iter().copied().collect();
                let whitening = noise.whitening(problem, &|run, row| !inside.contains(&(run, row)))?;
                let weighted = Weighted { predict, layout, free, whitening: &whitening, robust, whole: false };
                let residual = weighted.whitened(&modelled, values);
                let columns = weighted.columns(&slopes, values);
                Some(weighted.values(&linear_optimum(free, &u, &residual, &columns)?))
            })
            .collect::<Option<Vec<_>>>()
    };
    problem.predict(&free, fit).ok()?
}

/// Minimum of |r + J (u' - u)|^2 over u' within the bounds.
fn linear_optimum(
    free: &[crate::diagnosis::free::Free],
    u: &[f64],
    residual: &[f64],
    columns: &[Vec<f64>],
) -> Option<Vec<f64>> {
    let n = columns.len();
    // The triangular factor holds all that the problem needs, in n + 1 rows.
    let matrix = DMatrix::from_fn(residual.len(), n + 1, |i, k| if k < n { columns[k][i] } else { residual[i] });
    let triangle = matrix.qr().r();
    let rows = triangle.nrows();
    let (lower, upper) = free.iter().map(crate::diagnosis::free::Free::bounds).unzip();
    let at = |v: &[f64]| -> Vec<f64> {
        (0..rows).map(|i| triangle[(i, n)] + (0..n).map(|k| triangle[(i, k)] * (v[k] - u[k])).sum::<f64>()).collect()
    };
    let linear = |v: &[f64]| {
        let residual = at(v);
        DMatrix::from_fn(rows, n + 1, |i, k| if k == 0 { residual[i] } else { triangle[(i, k - 1)] })
    };
    let problem = LeastSquares { lower, upper, rows, tolerance: 1e-10, residual: &at, linear: &linear };
    Some(problem.minimise(&[u.to_vec()], Pace::PATIENT).pop()?.x)
}
