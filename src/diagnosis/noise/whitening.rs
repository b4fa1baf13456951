//! The linear map that makes the noise of an experiment white.

use super::NoiseModel;
use crate::diagnosis::layout::Layout;
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
}

impl Whitening {
    /// `keep(run, row)` says which rows count; those at the start of a run that no fit counts are left out in any case. `None`
    /// where a signal has no noise model.
    pub fn new(
        layout: &Layout,
        noise: &BTreeMap<String, NoiseModel>,
        keep: &dyn Fn(usize, usize) -> bool,
    ) -> Option<Self> {
        let strand = |block: &crate::diagnosis::layout::Block| {
            let measured = &layout.measured[block.range.clone()];
            let rows = layout.starts[block.run]..measured.len();
            let rows = rows.filter(|row| !measured[*row].is_nan() && keep(block.run, *row)).collect();
            Some(Strand { start: block.range.start, rows, noise: *noise.get(&block.signal)? })
        };
        let strands = layout.blocks.iter().map(strand).collect::<Option<Vec<_>>>()?;
        let len = strands.iter().map(|strand| strand.rows.len()).sum();
        Some(Self { strands, len })
    }

    /// Place in the layout of every whitened value, in order.
    pub fn places(&self) -> impl Iterator<Item = usize> {
        self.strands.iter().flat_map(|strand| strand.rows.iter().map(|row| strand.start + row))
    }

    /// Number of whitened values.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whitened values of a vector in the layout's order.
    pub fn apply(&self, values: &[f64]) -> Vec<f64> {
        let mut out = Vec::with_capacity(self.len);
        for strand in &self.strands {
            let from = out.len();
            out.extend(strand.rows.iter().map(|row| values[strand.start + row]));
            strand.noise.whiten(&strand.rows, &mut out[from..]);
        }
        out
    }
}
