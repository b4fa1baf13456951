//! Rows in which the result of a simulation depends on the last digits of its parameters.
//!
//! Where a wheel stops on firm ground within a few inner steps, a change of a parameter by a millionth of its range can change what follows
//! as much as a change by a tenth. A derivative there tells nothing of where to search, but would outweigh those of all other
//! rows, and the misfit jumps from trial to trial. So such rows have no derivatives in a search, and where the calibrated baseline has
//! some, they are left out as rows without an answer.

use super::compare::CompareError;
use super::free::Free;
use super::layout::Layout;
use super::prediction::PredictionError;
use super::problem::Problem;
use super::thresholds::{ABSURD, MAY_BE_UNANSWERED};
use super::unanswered::Unanswered;
use std::collections::BTreeSet;

/// Share of their ranges by which the parameters are changed to see what depends on their last digits.
const SHARE: f64 = 1e-6;

/// Takes the derivatives out of the rows in which they are absurd. `slopes`: for each free parameter the change of every value of the layout by
/// a change of the parameter.
pub(crate) fn silence(layout: &Layout, free: &[Free], values: &[f64], slopes: &mut [Vec<f64>]) {
    let ranges: Vec<f64> = free.iter().zip(values).map(|(free, value)| range(free, *value)).collect();
    let sizes = layout.sizes();
    for block in &layout.blocks {
        let most = ABSURD * sizes[&*block.signal];
        for at in block.range.clone() {
            if slopes.iter().zip(&ranges).any(|(slope, range)| (slope[at] * range).abs() > most) {
                slopes.iter_mut().for_each(|slope| slope[at] = 0.0);
            }
        }
    }
}

/// Range of a parameter as its derivative sees it: the width of the bounds of its search coordinate, in the parameter's unit.
fn range(free: &Free, value: f64) -> f64 {
    let (lower, upper) = free.bounds();
    (upper - lower) * free.slope(value)
}

/// The rows that count in which the baseline depends on a millionth of its parameters' ranges; it gives `here` at `values`. None where runs
/// are not cut into windows, whose length bounds what may add up, and none where more rows are so than may be left out beside a verdict.
///
/// # Errors
/// [`CompareError`] where the model has no answer.
pub(crate) fn undetermined(problem: &Problem, values: &[f64], here: &[f64]) -> Result<Vec<Unanswered>, CompareError> {
    if !problem.is_cut() {
        return Ok(Vec::new());
    }
    let layout = &problem.layout;
    let moved = |(k, (free, value)): (usize, (&Free, &f64))| {
        let (lower, upper) = free.bounds();
        let step = if k % 2 == 0 { SHARE } else { -SHARE } * (upper - lower);
        let at = free.coordinate(*value);
        let next = if (lower..=upper).contains(&(at + step)) { at + step } else { at - step };
        free.value(next)
    };
    let near: Vec<f64> = problem.base.iter().zip(values).enumerate().map(moved).collect();
    let there = problem.predict(&problem.base, |predict| predict.answers(&near))??.values;
    let rows = jumps(layout, here, &there);
    if rows.len() as f64 > MAY_BE_UNANSWERED * layout.rows().1 as f64 {
        return Ok(Vec::new());
    }
    let unanswered = |(run, row): (usize, usize)| {
        let error = PredictionError::Undetermined { run: problem.experiment.runs[run].name.clone() };
        Unanswered { run, rows: row..row + 1, error }
    };
    Ok(rows.into_iter().map(unanswered).collect())
}

/// Rows that count in which the modelled values differ by more than a change of [`SHARE`] can bring about.
fn jumps(layout: &Layout, here: &[f64], there: &[f64]) -> BTreeSet<(usize, usize)> {
    let mut rows = BTreeSet::new();
    let sizes = layout.sizes();
    for block in &layout.blocks {
        let most = ABSURD * SHARE * sizes[&*block.signal];
        let differs = |row: &usize| {
            let at = block.range.start + row;
            (here[at] - there[at]).abs() > most && layout.is_fitted(block, *row)
        };
        rows.extend((0..block.range.len()).filter(differs).map(|row| (block.run, row)));
    }
    rows
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
mod tests {
    use super::*;
    use crate::diagnosis::kinds::synthetic::experiment;
    use crate::model::{ControlKind, Model};

    fn model() -> Model {
        let mut model = Model::preset("two_wheeled").unwrap();
        model.control.kind = ControlKind::Speed;
        model
    }

    #[test]
    fn property_a_usual_drive_has_no_such_rows() {
        let experiment = experiment("speed_command", false);
        let mut problem = Problem::new(&model(), &experiment, &[]).unwrap();
        problem.coarsen();
        problem.cut();
        assert!(problem.is_cut());
        let values: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
        let here = problem.predict(&problem.base, |predict| predict.values(&values)).unwrap().unwrap();
        assert!(undetermined(&problem, &values, &here).unwrap().is_empty());
    }

    #[test]
    fn analytic_a_row_that_jumps_is_found_and_has_no_derivatives() {
        let experiment = experiment("speed_command", false);
        let problem = Problem::new(&model(), &experiment, &[]).unwrap();
        let layout = &problem.layout;
        let block = layout.blocks.last().unwrap();
        let row = block.range.len() - 3;
        let at = block.range.start + row;
        let size = layout.sizes()[&*block.signal];
        let here = layout.measured.clone();
        for (share, expected) in [(0.9, None), (1.1, Some((block.run, row)))] {
            let mut there = here.clone();
            there[at] += share * ABSURD * SHARE * size;
            assert_eq!(jumps(layout, &here, &there).into_iter().next(), expected, "{share} of the limit");

            // A derivative as large as that change, in one of the parameters.
            let free = &problem.base;
            let values: Vec<f64> = free.iter().map(|free| free.start).collect();
            let usual = |(free, value): (&Free, &f64)| vec![1e-6 * size / range(free, *value); layout.len()];
            let mut slopes: Vec<Vec<f64>> = free.iter().zip(&values).map(usual).collect();
            slopes[1][at] = share * ABSURD * size / range(&free[1], values[1]);
            let before = slopes.clone();
            silence(layout, free, &values, &mut slopes);
            for (k, slope) in slopes.iter().enumerate() {
                for (i, slope) in slope.iter().enumerate() {
                    let silenced = i == at && expected.is_some();
                    assert_eq!(*slope, if silenced { 0.0 } else { before[k][i] }, "parameter {k}, value {i}");
                }
            }
        }
    }
}
