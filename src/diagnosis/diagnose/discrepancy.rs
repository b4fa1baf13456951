//! A flexible discrepancy: smooth functions of every recorded condition, for each signal, that stand for "something".
//!
//! It says how much of a misfit could be explained at all, and it competes as "something else" against the effects. Which
//! conditions there are is said by the [kind](crate::diagnosis::kinds) of the experiment.

use crate::diagnosis::layout::{Block, Layout};
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::{HATS, SAME_LEVEL};
use crate::measurement::{Experiment, Run};

/// A function of a row: its values by run and row.
pub(crate) type Shape = Vec<Vec<f64>>;

/// A condition: one value a row of a run.
pub(crate) struct Condition {
    /// By run.
    values: Vec<Vec<f64>>,
    low: f64,
    high: f64,
}

impl Condition {
    /// `None` where the condition is not recorded everywhere or does not vary. A row that is left out is missing here too: a load
    /// that no soil carries would set the range for all others.
    pub fn new(
        experiment: &Experiment,
        layout: &Layout,
        value: &dyn Fn(usize, &Run) -> Option<Vec<f64>>,
    ) -> Option<Self> {
        let mut values: Vec<Vec<f64>> =
            experiment.runs.iter().enumerate().map(|(k, run)| value(k, run)).collect::<Option<_>>()?;
        layout.left_out().iter().for_each(|(run, row)| values[*run][*row] = f64::NAN);
        let finite = || values.iter().flatten().filter(|v| !v.is_nan());
        let low = finite().copied().fold(f64::INFINITY, f64::min);
        let high = finite().copied().fold(f64::NEG_INFINITY, f64::max);
        (high > low).then_some(Self { values, low, high })
    }

    /// Value between -1 and 1; 0 where missing.
    pub fn scaled(&self, run: usize, row: usize) -> f64 {
        let value = self.values[run][row];
        if value.is_nan() { 0.0 } else { 2.0 * (value - self.low) / (self.high - self.low) - 1.0 }
    }

    /// Knots of the hats: the levels where there are few, else quantiles.
    fn knots(&self) -> Vec<f64> {
        let mut all: Vec<f64> = self.values.iter().flatten().copied().filter(|v| !v.is_nan()).collect();
        all.sort_by(f64::total_cmp);
        let gap = SAME_LEVEL * (self.high - self.low);
        let levels: Vec<f64> = all.chunk_by(|a, b| b - a <= gap).map(|level| level[level.len() / 2]).collect();
        if (2..=HATS).contains(&levels.len()) {
            return levels;
        }
        let mut knots: Vec<f64> = (0..HATS).map(|k| all[k * (all.len() - 1) / (HATS - 1)]).collect();
        knots.dedup_by(|b, a| *b - *a <= gap);
        knots
    }

    /// Hat function number `k` over the knots.
    fn hat(&self, knots: &[f64], k: usize, run: usize, row: usize) -> f64 {
        let value = self.values[run][row];
        if value.is_nan() {
            return 0.0;
        }
        let value = value.clamp(knots[0], knots[knots.len() - 1]);
        let side = |other: usize| ((value - knots[other]) / (knots[k] - knots[other])).clamp(0.0, 1.0);
        match (value <= knots[k], k > 0, k + 1 < knots.len()) {
            (true, true, _) => side(k - 1),
            (false, _, true) => side(k + 1),
            _ => 1.0,
        }
    }
}

/// Columns of the discrepancy in the layout's order, each nonzero in one signal only. `modelled` is what the baseline gives.
pub(crate) fn columns(problem: &Problem, modelled: &[f64]) -> Vec<Vec<f64>> {
    let (experiment, layout) = (&*problem.experiment, &problem.layout);
    let shapes = problem.strategy().discrepancy(experiment, layout, modelled);
    let mut columns = Vec::new();
    for signal in experiment.signals() {
        for shape in &shapes {
            let mut column = vec![0.0; layout.len()];
            for Block { run, range, .. } in layout.blocks.iter().filter(|block| block.signal == signal) {
                for row in 0..range.len() {
                    column[range.start + row] = shape[*run][row];
                }
            }
            columns.push(column);
        }
    }
    columns
}

/// A shape from its value in each run and row.
pub(crate) fn product(experiment: &Experiment, f: &dyn Fn(usize, usize) -> f64) -> Shape {
    experiment.runs.iter().enumerate().map(|(k, run)| (0..run.data.rows()).map(|row| f(k, row)).collect()).collect()
}

/// Adds the first powers of a condition, up to `most`, to `shapes`.
pub(crate) fn powers(experiment: &Experiment, condition: &Condition, most: i32, shapes: &mut Vec<Shape>) {
    for power in 1..=most {
        shapes.push(product(experiment, &|run, row| condition.scaled(run, row).powi(power)));
    }
}

/// Adds the hat functions of a condition to `shapes`.
pub(crate) fn hats(experiment: &Experiment, condition: &Condition, shapes: &mut Vec<Shape>) {
    let knots = condition.knots();
    if knots.len() > 1 {
        for k in 0..knots.len() {
            shapes.push(product(experiment, &|run, row| condition.hat(&knots, k, run, row)));
        }
    }
}

/// A recorded column.
pub(crate) fn recorded(experiment: &Experiment, layout: &Layout, name: &str) -> Option<Condition> {
    Condition::new(experiment, layout, &|_, run| run.data.column(name).map(<[f64]>::to_vec))
}

/// Adds a drift over the list of runs to `shapes`.
pub(crate) fn run_order(experiment: &Experiment, layout: &Layout, shapes: &mut Vec<Shape>) {
    if let Some(order) = Condition::new(experiment, layout, &|k, run| Some(vec![k as f64; run.data.rows()])) {
        powers(experiment, &order, 2, shapes);
    }
}
