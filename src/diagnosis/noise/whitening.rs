//! The linear map that makes the noise of an experiment white, and takes out what the starts of windows could bring about.

use super::NoiseModel;
use crate::diagnosis::layout::{Block, Layout};
use crate::diagnosis::windows::free::{Projector, StrandOf};
use std::collections::BTreeMap;

/// One signal of one run: the rows that count, and its noise.
#[derive(Clone, Debug)]
struct Strand {
    /// Where the block starts in the layout.
    start: usize,
    /// Rows of the block that are measured and kept.
    rows: Vec<usize>,
    noise: NoiseModel,
    /// Sizes of the noise of these rows, and what the common part of the run counts in each; empty where all have the same.
    scale: Vec<f64>,
    weights: Vec<f64>,
}

/// Takes values in the order of a [`Layout`] to whitened values of those that are measured and kept.
#[derive(Clone, Debug)]
pub(crate) struct Whitening {
    strands: Vec<Strand>,
    len: usize,
    /// One a run with windows whose starts are free.
    starts: Vec<Projector>,
}

impl Whitening {
    /// `keep(run, row)` says which rows count; those at the start of a run that no fit counts are left out in any case. `None`
    /// where a signal has no noise model.
    pub fn new(
        layout: &Layout,
        noise: &BTreeMap<String, NoiseModel>,
        keep: &dyn Fn(usize, usize) -> bool,
    ) -> Option<Self> {
        let strand = |block: &Block| {
            let counts = |row: &usize| layout.is_fitted(block, *row) && keep(block.run, *row);
            let rows: Vec<usize> = (0..block.range.len()).filter(counts).collect();
            let start = block.range.start;
            let of_rows = || rows.iter().filter_map(|row| layout.scale.get(start + row));
            let (scale, weights) = of_rows().map(|scale| (scale.row, scale.weight)).unzip();
            Some(Strand { start, rows, noise: *noise.get(&block.signal)?, scale, weights })
        };
        let strands = layout.blocks.iter().map(strand).collect::<Option<Vec<_>>>()?;
        let len = strands.iter().map(|strand| strand.rows.len()).sum();
        let starts = projectors(layout, &strands);
        Some(Self { strands, len, starts })
    }

    /// Number of directions that the starts of windows take.
    pub fn taken(&self) -> usize {
        self.starts.iter().map(Projector::rank).sum()
    }

    /// Changes of the windows' starts, by run, window and number, that bring a residual (modelled minus measured, in the
    /// layout's order) nearest to zero.
    pub fn best_starts(&self, residual: &[f64]) -> Vec<((usize, usize, usize), f64)> {
        let white = self.white(residual);
        self.starts.iter().flat_map(|starts| starts.best_starts(&white)).collect()
    }

    /// Place in the layout of every whitened value, in order.
    pub fn places(&self) -> impl Iterator<Item = usize> {
        self.strands.iter().flat_map(|strand| strand.rows.iter().map(|row| strand.start + row))
    }

    /// Number of whitened values.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whitened values of a vector in the layout's order, without what the starts of windows could bring about.
    pub fn apply(&self, values: &[f64]) -> Vec<f64> {
        let mut out = self.white(values);
        self.starts.iter().for_each(|starts| starts.remove_from(&mut out));
        out
    }

    fn white(&self, values: &[f64]) -> Vec<f64> {
        let mut out = Vec::with_capacity(self.len);
        for strand in &self.strands {
            let from = out.len();
            out.extend(strand.rows.iter().map(|row| values[strand.start + row]));
            out[from..].iter_mut().zip(&strand.scale).for_each(|(value, scale)| *value /= scale);
            strand.noise.whiten(&strand.rows, &strand.weights, &mut out[from..]);
        }
        out
    }
}

/// Of each run with free starts. Strands of a run stand in the order of its signals.
fn projectors(layout: &Layout, strands: &[Strand]) -> Vec<Projector> {
    let mut projectors = Vec::new();
    let mut runs: Vec<usize> = layout.free_starts.iter().map(|start| start.run).collect();
    runs.dedup();
    for run in runs {
        let (mut at, mut signal, mut own) = (0, 0, Vec::new());
        for (block, strand) in layout.blocks.iter().zip(strands) {
            if block.run == run {
                own.push(StrandOf { run, signal, at, rows: &strand.rows, noise: &strand.noise });
                signal += 1;
            }
            at += strand.rows.len();
        }
        let starts = layout.free_starts.iter().filter(|start| start.run == run).map(AsRef::as_ref);
        projectors.extend(Projector::new(starts, &own));
    }
    projectors
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

    use super::*;
    use crate::diagnosis::noise::NoiseModel;
    use crate::diagnosis::windows::free::FreeStart;
    use crate::measurement::{Experiment, Kind, Run, Table};
    use nalgebra::{DMatrix, DVector};
    use std::sync::Arc;

    /// Rounding of a few hundred products, of squares of some thousand.
    const ROUNDING: f64 = 1e-9;
    const ROWS: usize = 40;

    /// Two runs of two signals, in which some cells are missing.
    fn experiment() -> Experiment {
        let run = |k: usize| {
            let mut data = Table::new(["time", "x", "pitch"]).unwrap();
            for row in 0..ROWS {
                let missing = row % 11 == 3 + k;
                let x = Some((row as f64 * 0.7).sin()).filter(|_| !missing);
                data.push_with_gaps(&[Some(row as f64 * 0.1), x, Some((row as f64).cos())]).unwrap();
            }
            Run {
                name: format!("{k}"),
                file: "".into(),
                group: None,
                parameters: BTreeMap::new(),
                terrain: None,
                x0: None,
                data,
                conditions: Vec::new(),
                inputs: Vec::new(),
                measured: vec!["x".to_owned(), "pitch".to_owned()],
            }
        };
        Experiment {
            name: String::new(),
            kind: Kind::Traverse,
            folder: "".into(),
            parameters: BTreeMap::new(),
            priors: BTreeMap::new(),
            soil_class: None,
            shared: BTreeMap::new(),
            sensors: BTreeMap::new(),
            model: None,
            noise: BTreeMap::new(),
            effects: Vec::new(),
            runs: vec![run(0), run(1)],
            doubts: Vec::new(),
            parts: Vec::new(),
        }
    }

    /// Windows of ten rows; the last start of each run repeats what the one before it says, and one says nothing.
    fn starts() -> Vec<FreeStart> {
        let mut all = Vec::new();
        for run in 0..2 {
            for window in 0..4 {
                let slope =
                    |row: usize, signal: usize| ((run + 3 * window + 5 * signal) as f64 + row as f64 * 0.3).sin();
                let slopes = (0..2).map(|signal| (0..10).map(|row| slope(row, signal)).collect()).collect();
                all.push(FreeStart { run, window, number: 0, rows: 10 * window..10 * window + 10, slopes });
            }
            let twin = all.last().unwrap().clone();
            all.push(FreeStart { number: 1, ..twin.clone() });
            all.push(FreeStart { number: 2, slopes: vec![vec![0.0; 10]; 2], ..twin });
        }
        all
    }

    #[test]
    fn agreement_what_starts_could_bring_about_is_taken_out_as_if_each_were_fitted() {
        let experiment = experiment();
        let mut layout = Layout::new(&experiment);
        let noise = NoiseModel { deviation: 0.3, run_share: 0.36, correlation: 0.5 };
        let models: BTreeMap<String, NoiseModel> =
            [("x".to_owned(), noise), ("pitch".to_owned(), NoiseModel { deviation: 0.02, ..noise })].into();
        let plain = Whitening::new(&layout, &models, &|_, _| true).unwrap();
        let starts = starts();
        layout.free_starts = starts.iter().cloned().map(Arc::new).collect();
        let freed = Whitening::new(&layout, &models, &|_, _| true).unwrap();
        assert_eq!(freed.taken(), 8, "a repeated direction counts once, one of nothing not at all");
        let values: Vec<f64> = (0..layout.len()).map(|k| (k as f64 * 1.7).sin()).collect();
        let left = DVector::from_vec(freed.apply(&values));
        // The same by a fit of every start.
        let column = |start: &FreeStart| {
            let mut raw = vec![0.0; layout.len()];
            for (block, slopes) in layout.of_run(start.run).zip(&start.slopes) {
                raw[block.range.clone()][start.rows.clone()].copy_from_slice(slopes);
            }
            DVector::from_vec(plain.apply(&raw))
        };
        let columns = DMatrix::from_columns(&starts.iter().map(column).collect::<Vec<_>>());
        let white = DVector::from_vec(plain.apply(&values));
        let fitted = columns.clone().svd(true, true).solve(&white, ROUNDING).unwrap();
        let explicit = &white - &columns * &fitted;
        assert!((&left - &explicit).amax() < ROUNDING * white.amax(), "{}", (&left - &explicit).amax());
        // The starts that fit best leave the same.
        let best = freed.best_starts(&values);
        let moved = best.iter().fold(white, |rest, (name, change)| {
            let start = starts.iter().find(|s| (s.run, s.window, s.number) == *name).unwrap();
            rest + column(start) * *change
        });
        assert!((moved - explicit).amax() < ROUNDING * left.amax());
    }
}
