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
            let measured = &layout.measured[block.range.clone()];
            let counts = |row: &usize| !measured[*row].is_nan() && !layout.is_unsettled(block.run, *row);
            let rows = (0..measured.len()).filter(|row| counts(row) && keep(block.run, *row)).collect();
            Some(Strand { start: block.range.start, rows, noise: *noise.get(&block.signal)? })
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
            strand.noise.whiten(&strand.rows, &mut out[from..]);
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
