//! What is left open of the start of each window, and how the modelled values depend on it.
//!
//! A start is a nuisance: nobody asks for it, and it must not be taken for a parameter of the soil. To first order it is
//! projected out: [`Projector`] takes out of whitened values whatever the starts of the windows could bring about, and leaves
//! the rest as it is. Squares of what is left are those of a fit in which every start is free
//! (variable projection: Golub and Pereyra 1973; Kaufman 1975). All that a diagnosis does with whitened values, fits, bootstrap and
//! left-out runs alike, is done with what is left.
//!
//! Columns of a window are zero outside of its rows but for what whitening adds: the row after the window (an AR(1) process)
//! and a multiple of the part that a whole run has in common. So the work grows with the rows, not with rows times windows.

use super::Windows;
use crate::diagnosis::layout::{Block, Layout};
use crate::diagnosis::linear_algebra::Factor;
use crate::diagnosis::noise::{LocalWhite, NoiseModel};
use nalgebra::DMatrix;
use std::ops::Range;

/// A column smaller than this many standard deviations a unit (m, m/s) in all its rows together changes nothing that was measured.
const NOTHING: f64 = 1e-6;

/// How the modelled values of one window depend on one number of its start.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FreeStart {
    pub run: usize,
    /// Window of the run, and which number of its start.
    pub window: usize,
    pub number: usize,
    pub rows: Range<usize>,
    /// For each signal of the run, in the layout's order, the derivatives over `rows`.
    pub slopes: Vec<Vec<f64>>,
}

/// The starts as far as they are known without the model: a place carries over to every place of its window.
pub(crate) fn carried_over(layout: &Layout, windows: &Windows) -> Vec<FreeStart> {
    let mut starts = Vec::new();
    for (run, cuts) in windows.iter().enumerate() {
        for (window, cut) in cuts.iter().enumerate().filter(|(_, cut)| cut.start.is_some()) {
            let slope = |block: &Block| if block.is_place() { 1.0 } else { 0.0 };
            let slopes = layout.of_run(run).map(|block| vec![slope(block); cut.rows.len()]).collect();
            starts.push(FreeStart { run, window, number: 0, rows: cut.rows.clone(), slopes });
        }
    }
    starts
}

/// Whitened values of one signal of one run: where they stand, and how they are made white.
pub(crate) struct StrandOf<'a> {
    pub run: usize,
    /// Place of the signal among those of its run.
    pub signal: usize,
    /// Where its values begin among all whitened ones.
    pub at: usize,
    pub rows: &'a [usize],
    pub noise: &'a NoiseModel,
}

/// A whitened column on one strand: `values` from `from` on among all whitened values, less `along` times the strand's common part.
#[derive(Clone, Debug)]
struct Part {
    strand: usize,
    from: usize,
    values: Vec<f64>,
    along: f64,
}

/// Part that all rows of a strand have in common, and where the strand begins.
#[derive(Clone, Debug)]
struct Common {
    at: usize,
    values: Vec<f64>,
}

/// Takes the starts of one run's windows out of whitened values.
#[derive(Clone, Debug)]
pub(crate) struct Projector {
    columns: Vec<Vec<Part>>,
    /// Run, window and number of each column.
    names: Vec<(usize, usize, usize)>,
    commons: Vec<Common>,
    factor: Factor,
}

impl Projector {
    /// Of the starts of one run over its strands; `None` where these tell nothing of them.
    pub fn new<'s>(starts: impl Iterator<Item = &'s FreeStart>, strands: &[StrandOf]) -> Option<Self> {
        let commons: Vec<Common> = strands
            .iter()
            .map(|strand| Common { at: strand.at, values: strand.noise.common_part(strand.rows) })
            .collect();
        let (mut columns, mut names) = (Vec::new(), Vec::new());
        for start in starts {
            let column: Vec<Part> = strands
                .iter()
                .enumerate()
                .filter_map(|(k, strand)| part(start, k, strand, &commons[k].values))
                .collect();
            let squares: f64 = column.iter().flat_map(|part| &part.values).map(|x| x * x).sum();
            if squares > NOTHING * NOTHING && squares.is_finite() {
                columns.push(column);
                names.push((start.run, start.window, start.number));
            }
        }
        let factor = Factor::of(&products(&columns, &commons));
        let kept = |k: &usize| factor.kept.contains(k);
        let names = (0..names.len()).filter(kept).map(|k| names[k]).collect();
        let columns: Vec<Vec<Part>> =
            columns.into_iter().enumerate().filter(|(k, _)| kept(k)).map(|(_, c)| c).collect();
        let factor = factor.numbered_anew();
        (!columns.is_empty()).then_some(Self { columns, names, commons, factor })
    }

    /// Number of directions that are taken out.
    pub fn rank(&self) -> usize {
        self.columns.len()
    }

    /// Takes the starts out of whitened values.
    pub fn remove_from(&self, white: &mut [f64]) {
        let along = self.along(white);
        let change = self.factor.solve(&|k| along[k]);
        let mut common = vec![0.0; self.commons.len()];
        for (column, size) in self.columns.iter().zip(change.iter()) {
            for part in column {
                let place = &mut white[part.from..part.from + part.values.len()];
                place.iter_mut().zip(&part.values).for_each(|(x, v)| *x -= size * v);
                common[part.strand] += size * part.along;
            }
        }
        for (common, size) in self.commons.iter().zip(common).filter(|(_, size)| *size != 0.0) {
            let place = &mut white[common.at..common.at + common.values.len()];
            place.iter_mut().zip(&common.values).for_each(|(x, c)| *x += size * c);
        }
    }

    /// Changes of the starts, by run, window and number, that bring whitened residuals (modelled minus measured, nothing
    /// taken out yet) nearest to zero.
    pub fn best_starts(&self, white: &[f64]) -> Vec<((usize, usize, usize), f64)> {
        let along = self.along(white);
        let change = self.factor.solve(&|k| along[k]);
        self.names.iter().copied().zip(change.iter().map(|x| -x)).collect()
    }

    fn along(&self, white: &[f64]) -> Vec<f64> {
        let common: Vec<f64> = self.commons.iter().map(|common| dot(&common.values, &white[common.at..])).collect();
        let of = |column: &Vec<Part>| {
            column.iter().map(|part| dot(&part.values, &white[part.from..]) - part.along * common[part.strand]).sum()
        };
        self.columns.iter().map(of).collect()
    }
}

/// One start on one strand.
fn part(start: &FreeStart, k: usize, strand: &StrandOf, common: &[f64]) -> Option<Part> {
    if start.run != strand.run {
        return None;
    }
    let slopes = start.slopes.get(strand.signal)?;
    let first = strand.rows.partition_point(|row| *row < start.rows.start);
    let end = strand.rows.partition_point(|row| *row < start.rows.end);
    let raw: Vec<f64> = strand.rows[first..end].iter().map(|row| slopes[row - start.rows.start]).collect();
    if raw.iter().all(|x| *x == 0.0) {
        return None;
    }
    let LocalWhite { values, along } = strand.noise.whiten_part(strand.rows, first, &raw, common);
    Some(Part { strand: k, from: strand.at + first, values, along })
}

fn products(columns: &[Vec<Part>], commons: &[Common]) -> DMatrix<f64> {
    let own: Vec<f64> = commons.iter().map(|common| dot(&common.values, &common.values)).collect();
    // What the common part has of each column's local values, by strand.
    let shared: Vec<Vec<(usize, f64, f64)>> = columns
        .iter()
        .map(|column| {
            let of = |part: &Part| {
                let common = &commons[part.strand];
                (part.strand, part.along, dot(&part.values, &common.values[part.from - common.at..]))
            };
            column.iter().map(of).collect()
        })
        .collect();
    DMatrix::from_fn(columns.len(), columns.len(), |i, j| {
        let mut sum = 0.0;
        for (a, (strand, along, local)) in columns[i].iter().zip(&shared[i]) {
            let Some(at) = shared[j].iter().position(|(other, ..)| other == strand) else { continue };
            let (b, (_, other_along, other_local)) = (&columns[j][at], &shared[j][at]);
            sum += overlap(a, b) - along * other_local - other_along * local + along * other_along * own[*strand];
        }
        sum
    })
}

/// Product of local values where both are.
fn overlap(a: &Part, b: &Part) -> f64 {
    let from = a.from.max(b.from);
    let end = (a.from + a.values.len()).min(b.from + b.values.len());
    if from >= end { 0.0 } else { dot(&a.values[from - a.from..end - a.from], &b.values[from - b.from..]) }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
