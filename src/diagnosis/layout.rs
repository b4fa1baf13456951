//! All measured values of an experiment as one vector.

use crate::measurement::Experiment;
use std::ops::Range;

/// One signal of one run within the vector: one entry a row, missing or not.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub run: usize,
    pub signal: String,
    pub range: Range<usize>,
}

/// Where each measured value stands, and the values; NaN marks a missing one.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub blocks: Vec<Block>,
    pub measured: Vec<f64>,
}

impl Layout {
    pub fn new(experiment: &Experiment) -> Self {
        let mut layout = Self { blocks: Vec::new(), measured: Vec::new() };
        for (run, data) in experiment.runs.iter().enumerate() {
            for signal in &data.measured {
                let start = layout.measured.len();
                layout.measured.extend_from_slice(data.data.column(signal).unwrap_or_default());
                layout.blocks.push(Block { run, signal: signal.clone(), range: start..layout.measured.len() });
            }
        }
        layout
    }

    /// Length of the vector.
    pub fn len(&self) -> usize {
        self.measured.len()
    }

    /// The blocks of one run.
    pub fn of_run(&self, run: usize) -> impl Iterator<Item = &Block> {
        self.blocks.iter().filter(move |block| block.run == run)
    }

    /// Number of values that are there.
    pub fn present(&self) -> usize {
        self.measured.iter().filter(|v| !v.is_nan()).count()
    }
}
