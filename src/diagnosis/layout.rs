//! All measured values of an experiment as one vector.

use crate::measurement::{Experiment, Kind, Run};
use std::ops::Range;

/// Time at the start of a traverse that no fit counts, s, and the largest share of a run's rows that this may be. A simulated
/// rover starts at rest; how contacts break loose there, and how deep a standing wheel sinks, are assumptions of the model,
/// and a real one may have been moving.
const BREAKING_LOOSE: f64 = 0.5;
const AT_MOST: f64 = 0.1;

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
    /// For each run, how many of its first rows no fit counts.
    pub starts: Vec<usize>,
}

impl Layout {
    pub fn new(experiment: &Experiment) -> Self {
        let starts = experiment.runs.iter().map(|run| breaking_loose(experiment.kind, run)).collect();
        let mut layout = Self { blocks: Vec::new(), measured: Vec::new(), starts };
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

/// How many rows at the start of a run are not counted.
fn breaking_loose(kind: Kind, run: &Run) -> usize {
    match (kind, run.data.column("time")) {
        (Kind::Traverse, Some(time)) => {
            let early = time.iter().take_while(|t| **t - time[0] < BREAKING_LOOSE).count();
            early.min((AT_MOST * time.len() as f64) as usize)
        }
        _ => 0,
    }
}
