//! All measured values of an experiment as one vector.

use super::kinds::strategy;
use super::noise::Scale;
use super::windows::free::FreeStart;
use crate::measurement::Experiment;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

/// One signal of one run within the vector: one entry a row, missing or not.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub run: usize,
    pub signal: String,
    pub range: Range<usize>,
}

impl Block {
    /// Whether it is the place of the body along x: by that name alone or behind that of one of several experiments.
    pub fn is_place(&self) -> bool {
        self.signal == "x" || self.signal.ends_with(".x")
    }
}

/// Where each measured value stands, and the values; NaN marks a missing one.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub blocks: Vec<Block>,
    /// The values that count: those of rows that are left out are missing here.
    pub measured: Vec<f64>,
    /// All values as they were measured.
    pub recorded: Vec<f64>,
    /// Size of the noise of each value; empty where all have the same.
    pub scale: Vec<Scale>,
    /// For each run, how many of its first rows no fit counts.
    pub starts: Vec<usize>,
    /// Rows (run, row) that are left out since the model has no answer there, in rising order.
    left_out: Vec<(usize, usize)>,
    /// Rows (run, row) behind a gap, where the motion has not settled yet: no fit counts them either.
    unsettled: BTreeSet<(usize, usize)>,
    /// Rows (run, row) that take no part in any fit, so that they can judge the final model.
    spared: BTreeSet<(usize, usize)>,
    /// What is open of the starts of windows, by run.
    pub free_starts: Vec<Arc<FreeStart>>,
}

impl Layout {
    pub fn new(experiment: &Experiment) -> Self {
        let starts = strategy(experiment).uncounted_rows(experiment);
        let mut layout = Self {
            blocks: Vec::new(),
            measured: Vec::new(),
            recorded: Vec::new(),
            scale: Vec::new(),
            starts,
            left_out: Vec::new(),
            unsettled: BTreeSet::new(),
            spared: BTreeSet::new(),
            free_starts: Vec::new(),
        };
        for (run, data) in experiment.runs.iter().enumerate() {
            for signal in &data.measured {
                let start = layout.measured.len();
                layout.measured.extend_from_slice(data.data.column(signal).unwrap_or_default());
                layout.blocks.push(Block { run, signal: signal.clone(), range: start..layout.measured.len() });
            }
        }
        layout.recorded.clone_from(&layout.measured);
        layout
    }

    /// Places for values that nobody measured: the signals of each run of `experiment`, no value of which counts.
    pub fn unmeasured(experiment: &Experiment) -> Self {
        let mut layout = Self::new(experiment);
        let mut end = 0;
        for block in &mut layout.blocks {
            let start = end;
            end += experiment.runs[block.run].data.rows();
            block.range = start..end;
        }
        layout.measured = vec![f64::NAN; end];
        layout.recorded.clone_from(&layout.measured);
        layout
    }

    /// The layout of some of the runs, which `experiment` holds in this order.
    pub fn of_runs(&self, experiment: &Experiment, runs: &[usize]) -> Self {
        let mut part = Self::new(experiment);
        let place = |(run, row): &(usize, usize)| Some((runs.iter().position(|kept| kept == run)?, *row));
        part.leave_out(&self.left_out.iter().filter_map(place).collect::<Vec<_>>());
        part.unsettled = self.unsettled.iter().filter_map(place).collect();
        part.spare(self.spared.iter().filter_map(place));
        if !self.scale.is_empty() {
            let own = runs.iter().flat_map(|run| self.of_run(*run));
            part.scale = own.flat_map(|block| self.scale[block.range.clone()].iter().copied()).collect();
        }
        for (k, run) in runs.iter().enumerate() {
            let own = self.free_starts.iter().filter(|start| start.run == *run);
            part.free_starts.extend(own.map(|start| Arc::new(FreeStart { run: k, ..(**start).clone() })));
        }
        part
    }

    /// Values in units of the noise of each, up to a factor that they have in common.
    pub fn by_scale(&self, mut values: Vec<f64>) -> Vec<f64> {
        values.iter_mut().zip(&self.scale).for_each(|(value, scale)| *value /= scale.row);
        values
    }

    /// Marks rows (run, row) whose motion has not settled yet.
    pub fn unsettle(&mut self, rows: impl IntoIterator<Item = (usize, usize)>) {
        self.unsettled.extend(rows);
    }

    /// Whether no fit counts a row since the motion has not settled there: at the start of a run, or behind a gap.
    pub fn is_unsettled(&self, run: usize, row: usize) -> bool {
        row < self.starts[run] || self.unsettled.contains(&(run, row))
    }

    /// Whether the value of a block in a row is one that fits count.
    pub fn is_fitted(&self, block: &Block, row: usize) -> bool {
        !self.measured[block.range.start + row].is_nan() && !self.is_unsettled(block.run, row)
    }

    /// Leaves rows (run, row) out of everything that follows.
    pub fn leave_out(&mut self, rows: &[(usize, usize)]) {
        self.left_out.extend_from_slice(rows);
        self.left_out.sort_unstable();
        self.left_out.dedup();
        rows.iter().for_each(|row| self.blank(*row));
    }

    /// Keeps rows (run, row) out of all fits.
    pub fn spare(&mut self, rows: impl IntoIterator<Item = (usize, usize)>) {
        for row in rows {
            self.spared.insert(row);
            self.blank(row);
        }
    }

    /// Lets the spared rows be simulated; they still do not count.
    pub fn show_spared(&mut self) {
        self.spared.clear();
    }

    /// Whether a row takes no part in any fit, so that it can judge the final model.
    pub fn is_spared(&self, run: usize, row: usize) -> bool {
        self.spared.contains(&(run, row))
    }

    fn blank(&mut self, (run, row): (usize, usize)) {
        for block in self.blocks.iter().filter(|block| block.run == run) {
            self.measured[block.range.start + row] = f64::NAN;
        }
    }

    /// Rows (run, row) that are left out, in rising order.
    pub fn left_out(&self) -> &[(usize, usize)] {
        &self.left_out
    }

    /// Whether rows of a run are left out or spared and none of it counts.
    pub fn is_left_out(&self, run: usize) -> bool {
        let counts = |at: std::ops::Range<usize>| self.measured[at].iter().any(|value| !value.is_nan());
        self.left_out.iter().chain(&self.spared).any(|(other, _)| *other == run)
            && !self.of_run(run).any(|block| counts(block.range.clone()))
    }

    /// Whether a row has measured values that count.
    pub fn counts(&self, run: usize, row: usize) -> bool {
        self.of_run(run).any(|block| !self.measured[block.range.start + row].is_nan())
    }

    /// Number of rows that were measured and are not spared, and how many of them count.
    pub fn rows(&self) -> (usize, usize) {
        let mut all = (0, 0);
        for run in 0..self.starts.len() {
            for row in 0..self.of_run(run).next().map_or(0, |block| block.range.len()) {
                let recorded = |block: &Block| !self.recorded[block.range.start + row].is_nan();
                let measured = !self.is_spared(run, row) && self.of_run(run).any(recorded);
                all.0 += usize::from(measured);
                all.1 += usize::from(measured && self.counts(run, row));
            }
        }
        all
    }

    /// Length of the vector.
    pub fn len(&self) -> usize {
        self.measured.len()
    }

    /// The blocks of one run.
    pub fn of_run(&self, run: usize) -> impl Iterator<Item = &Block> {
        self.blocks.iter().filter(move |block| block.run == run)
    }

    /// Standard deviation of a signal over the whole experiment; some scale where it never changes.
    pub fn scatter(&self, signal: &str) -> f64 {
        let blocks = self.blocks.iter().filter(|block| block.signal == signal);
        let values: Vec<f64> =
            blocks.flat_map(|block| self.measured[block.range.clone()].to_vec()).filter(|v| !v.is_nan()).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64;
        [variance.sqrt(), mean.abs(), 1.0].into_iter().find(|scale| *scale > 0.0).unwrap_or(1.0)
    }

    /// Root of the mean square of each signal over the whole experiment, of all values that were measured; infinite where none differs from 0.
    pub fn sizes(&self) -> BTreeMap<&str, f64> {
        let mut sums: BTreeMap<&str, (f64, f64)> = BTreeMap::new();
        for block in &self.blocks {
            let (sum, count) = sums.entry(&block.signal).or_default();
            for value in self.recorded[block.range.clone()].iter().filter(|value| !value.is_nan()) {
                *sum += value * value;
                *count += 1.0;
            }
        }
        let size = |(sum, count): (f64, f64)| if sum > 0.0 { (sum / count).sqrt() } else { f64::INFINITY };
        sums.into_iter().map(|(signal, sums)| (signal, size(sums))).collect()
    }

    /// Number of values that count.
    pub fn present(&self) -> usize {
        self.measured.iter().filter(|v| !v.is_nan()).count()
    }
}
