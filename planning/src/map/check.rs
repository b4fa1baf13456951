//! What is doubtful in a map: holes, spikes, heights in another unit.

use super::{ElevationMap, MapError};

/// A node that stands out of its surroundings by more than this many spacings is a spike: a slope of 63 degrees on all sides.
const SPIKE_SLOPE: f64 = 2.0;

/// Ground is seldom steeper than 45 degrees over half of its area: such a map has heights in another unit than its spacing.
const USUAL_SLOPE: f64 = 1.0;

/// No place on Earth, Moon or Mars is higher or lower, m.
const HIGHEST: f64 = 25_000.0;

/// A single node far above or below all its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spike {
    /// Column, from 0 at the west.
    pub column: usize,
    /// Row, from 0 at the south.
    pub row: usize,
    /// Height above (or, negative, below) the median of the neighbours, m.
    pub height: f64,
}

/// Something in a map that a user should look at before a plan is made on it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Doubt {
    /// Nodes without a height.
    #[error(
        "{count} of {nodes} nodes are holes, the first at column {column}, row {row}; nothing is planned over them \
         (fill them with `filled`, or measure there)"
    )]
    Holes {
        /// Holes.
        count: usize,
        /// Nodes of the map.
        nodes: usize,
        /// Column of the first.
        column: usize,
        /// Row of the first.
        row: usize,
    },
    /// Single nodes that stand out.
    #[error(
        "{count} single nodes stand out of all their neighbours, the largest at column {column}, row {row} by {height:.2} m; \
         errors of measurement look so (smooth them with `without_spikes`)"
    )]
    Spikes {
        /// Spikes.
        count: usize,
        /// Column of the largest.
        column: usize,
        /// Row of the largest.
        row: usize,
        /// Its height over the median of its neighbours, m.
        height: f64,
    },
    /// Most of the ground is too steep.
    #[error(
        "half of the ground is steeper than {slope:.1} (rise over run); heights and spacing ({cell} m) look like different units"
    )]
    Units {
        /// Median slope.
        slope: f64,
        /// Spacing, m.
        cell: f64,
    },
    /// Heights beyond any mountain.
    #[error("a height of {height} m; expected metres, and a mark of missing data as NaN")]
    Height {
        /// The height, m.
        height: f64,
    },
}

impl ElevationMap {
    /// What is doubtful in the map.
    #[must_use]
    pub fn doubts(&self) -> Vec<Doubt> {
        let mut doubts = Vec::new();
        if let Some(first) = self.heights.iter().position(|z| z.is_nan()) {
            let count = self.heights.iter().filter(|z| z.is_nan()).count();
            let (column, row) = (first % self.columns, first / self.columns);
            doubts.push(Doubt::Holes { count, nodes: self.heights.len(), column, row });
        }
        let spikes = self.spikes(SPIKE_SLOPE * self.cell);
        if let Some(largest) = spikes.iter().max_by(|a, b| a.height.abs().total_cmp(&b.height.abs())) {
            let Spike { column, row, height } = *largest;
            doubts.push(Doubt::Spikes { count: spikes.len(), column, row, height });
        }
        let slope = self.median_slope();
        if slope > USUAL_SLOPE {
            doubts.push(Doubt::Units { slope, cell: self.cell });
        }
        if let Some(&height) = self.heights.iter().find(|z| z.abs() > HIGHEST) {
            doubts.push(Doubt::Height { height });
        }
        doubts
    }

    /// Nodes that are higher, or lower, than each of their up to eight neighbours by more than `threshold` (m).
    #[must_use]
    pub fn spikes(&self, threshold: f64) -> Vec<Spike> {
        let nodes = (0..self.rows).flat_map(|row| (0..self.columns).map(move |column| (column, row)));
        let spike = |(column, row)| {
            let here = self.height(column, row);
            let around = self.neighbours(column, row);
            let (low, high) =
                around.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), z| (l.min(*z), h.max(*z)));
            let out = here - high > threshold || low - here > threshold;
            (out && !around.is_empty()).then(|| Spike { column, row, height: here - median(around) })
        };
        nodes.filter_map(spike).collect()
    }

    /// The map with spikes of more than `threshold` (m) put to the median of their neighbours, and how many they were.
    /// A second pass finds spikes that stood beside others; passes are made until none is left, at most ten.
    ///
    /// # Errors
    /// None for a map that exists; the type is that of [`ElevationMap::new`].
    pub fn without_spikes(&self, threshold: f64) -> Result<(Self, usize), MapError> {
        let (mut map, mut count) = (self.clone(), 0);
        for _ in 0..10 {
            let spikes = map.spikes(threshold);
            if spikes.is_empty() {
                break;
            }
            count += spikes.len();
            let mut heights = map.heights.clone();
            for spike in spikes {
                heights[spike.row * map.columns + spike.column] -= spike.height;
            }
            map = map.with_heights(heights)?;
        }
        Ok((map, count))
    }

    /// The map with every hole filled by the mean of its known neighbours, from the rims inward, and how many nodes were
    /// filled. What is filled is a guess: it is as smooth as a hole's rim.
    ///
    /// # Errors
    /// None for a map that exists; the type is that of [`ElevationMap::new`].
    pub fn filled(&self) -> Result<(Self, usize), MapError> {
        let (mut map, mut count) = (self.clone(), 0);
        loop {
            let holes = (0..map.heights.len()).filter(|&node| map.heights[node].is_nan());
            let found = holes.filter_map(|node| {
                let around = map.neighbours(node % map.columns, node / map.columns);
                (!around.is_empty()).then(|| (node, around.iter().sum::<f64>() / around.len() as f64))
            });
            let found: Vec<(usize, f64)> = found.collect();
            if found.is_empty() {
                return Ok((map, count));
            }
            count += found.len();
            let mut heights = map.heights.clone();
            found.into_iter().for_each(|(node, z)| heights[node] = z);
            map = map.with_heights(heights)?;
        }
    }

    /// Known heights of the up to eight neighbours.
    pub(crate) fn neighbours(&self, column: usize, row: usize) -> Vec<f64> {
        let rows = row.saturating_sub(1)..=(row + 1).min(self.rows - 1);
        let columns = column.saturating_sub(1)..=(column + 1).min(self.columns - 1);
        let around = rows.flat_map(|r| columns.clone().map(move |c| (c, r))).filter(|at| *at != (column, row));
        around.map(|(c, r)| self.height(c, r)).filter(|z| z.is_finite()).collect()
    }

    /// Median slope between neighbouring nodes along x and y; 0 without two known neighbours.
    fn median_slope(&self) -> f64 {
        let mut slopes = Vec::new();
        for row in 0..self.rows {
            for column in 0..self.columns {
                let here = self.height(column, row);
                let rises = [self.height(column + 1, row) - here, self.height(column, row + 1) - here];
                slopes.extend(rises.iter().filter(|rise| rise.is_finite()).map(|rise| rise.abs() / self.cell));
            }
        }
        if slopes.is_empty() { 0.0 } else { median(slopes) }
    }
}

/// Median of a list that is not empty (the upper one of two).
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
