//! Costs of a metre in sixteen directions at every node of a grid.

use super::{DirectionalCost, FieldError};
use crate::map::{ElevationMap, MAX_NODES};
use rayon::prelude::*;

/// Directions at a node.
pub const DIRECTIONS: usize = 16;

/// Steps of these directions, counter-clockwise from east. Even ones lead to the eight nodes around, odd ones pass through the middle
/// between two of them.
pub(super) const RING: [[i32; 2]; DIRECTIONS] = [
    [1, 0],
    [2, 1],
    [1, 1],
    [1, 2],
    [0, 1],
    [-1, 2],
    [-1, 1],
    [-2, 1],
    [-1, 0],
    [-2, -1],
    [-1, -1],
    [-1, -2],
    [0, -1],
    [1, -2],
    [1, -1],
    [2, -1],
];

/// A square grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Nodes along x.
    pub columns: usize,
    /// Nodes along y.
    pub rows: usize,
    /// Spacing, m.
    pub cell: f64,
    /// Place of node (0, 0), the south-western one, m.
    pub origin: [f64; 2],
}

/// The grid of a map's nodes.
impl From<&ElevationMap> for Grid {
    fn from(map: &ElevationMap) -> Self {
        Self { columns: map.columns(), rows: map.rows(), cell: map.cell(), origin: map.origin() }
    }
}

impl Grid {
    /// Place of a node, m.
    #[must_use]
    pub fn place(&self, column: usize, row: usize) -> [f64; 2] {
        [self.origin[0] + column as f64 * self.cell, self.origin[1] + row as f64 * self.cell]
    }

    /// A place in units of the spacing from node (0, 0); `None` off the grid.
    #[must_use]
    pub fn in_cells(&self, place: [f64; 2]) -> Option<[f64; 2]> {
        let [u, v] = [0, 1].map(|axis| (place[axis] - self.origin[axis]) / self.cell);
        let inside = u >= 0.0 && v >= 0.0 && u <= (self.columns - 1) as f64 && v <= (self.rows - 1) as f64;
        inside.then_some([u, v])
    }

    /// The nodes around a place with their weights in bilinear interpolation; those of weight 0 are left out. `None` off the grid.
    pub(super) fn around(&self, place: [f64; 2]) -> Option<impl Iterator<Item = (f64, usize)> + use<>> {
        let [u, v] = self.in_cells(place)?;
        let (column, row) = ((u as usize).min(self.columns - 2), (v as usize).min(self.rows - 2));
        let (u, v) = (u - column as f64, v - row as f64);
        let first = row * self.columns + column;
        let corners = [
            ((1.0 - u) * (1.0 - v), first),
            (u * (1.0 - v), first + 1),
            ((1.0 - u) * v, first + self.columns),
            (u * v, first + self.columns + 1),
        ];
        Some(corners.into_iter().filter(|(weight, _)| *weight > 0.0))
    }

    fn check(&self) -> Result<(), FieldError> {
        let (columns, rows) = (self.columns, self.rows);
        let nodes = columns.checked_mul(rows).filter(|nodes| columns >= 2 && rows >= 2 && *nodes <= MAX_NODES);
        if nodes.is_none() {
            return Err(FieldError::Size { columns, rows });
        }
        let spaced = self.cell > 0.0 && self.cell.is_finite() && self.origin.iter().all(|x| x.is_finite());
        if spaced { Ok(()) } else { Err(FieldError::Spacing { cell: self.cell, origin: self.origin }) }
    }
}

/// Costs of a metre in [`DIRECTIONS`] directions of travel at every node of a grid, infinite where the rover cannot go.
///
/// A way between neighbouring nodes costs its length times the mean of the costs in its direction at both ends (the trapezoid rule), and
/// cannot be passed where one of these is infinite: a wall is never crossed if it is at least a spacing thick, or its nodes touch along
/// edges and diagonals.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionTable {
    grid: Grid,
    costs: Vec<[f32; DIRECTIONS]>,
}

impl DirectionTable {
    /// Unit vectors of the directions of travel, east and north, in the order of the table: towards the nodes (1, 0), (2, 1), (1, 1),
    /// (1, 2), (0, 1) and so on counter-clockwise.
    #[must_use]
    pub fn directions() -> [[f64; 2]; DIRECTIONS] {
        RING.map(|[x, y]| [x, y].map(|step| f64::from(step) / f64::from(x * x + y * y).sqrt()))
    }

    /// A table of given costs, node by node from the south-west, row by row.
    ///
    /// # Errors
    /// [`FieldError`] for a wrong grid or count, and where a cost is negative or no number.
    pub fn new(grid: Grid, costs: Vec<[f32; DIRECTIONS]>) -> Result<Self, FieldError> {
        grid.check()?;
        if costs.len() != grid.columns * grid.rows {
            return Err(FieldError::Count { got: costs.len(), columns: grid.columns, rows: grid.rows });
        }
        let wrong = |cost: f32| cost.is_nan() || cost < 0.0;
        // Of all that are wrong the first is named, whatever the number of threads.
        let first = costs.par_iter().position_first(|node| node.iter().copied().any(wrong));
        if let Some(node) = first {
            let [x, y] = grid.place(node % grid.columns, node / grid.columns);
            let cost = costs[node].into_iter().find(|cost| wrong(*cost)).unwrap_or(f32::NAN);
            return Err(FieldError::Cost { x, y, cost: f64::from(cost) });
        }
        Ok(Self { grid, costs })
    }

    /// The table of a cost.
    ///
    /// # Errors
    /// [`FieldError`] for a wrong grid, and where a cost is negative or no number.
    pub fn of(cost: &(impl DirectionalCost + Sync), grid: Grid) -> Result<Self, FieldError> {
        let directions = Self::directions();
        Self::filled(grid, |column, row| {
            let place = grid.place(column, row);
            directions.map(|direction| cost.per_metre(place, direction) as f32)
        })
    }

    /// The table of the costs of each node (column, row), on all threads.
    ///
    /// # Errors
    /// [`FieldError`] for a wrong grid, and where a cost is negative or no number.
    pub fn filled(grid: Grid, costs_of: impl Fn(usize, usize) -> [f32; DIRECTIONS] + Sync) -> Result<Self, FieldError> {
        grid.check()?;
        let mut costs = vec![[0.0_f32; DIRECTIONS]; grid.columns * grid.rows];
        costs.par_chunks_mut(grid.columns).enumerate().for_each(|(row, line)| {
            for (column, node) in line.iter_mut().enumerate() {
                *node = costs_of(column, row);
            }
        });
        Self::new(grid, costs)
    }

    /// Closes the node nearest to a place (m) for directions within `angle` (rad) of a heading (rad from east to north).
    pub fn close(&mut self, place: [f64; 2], heading: f64, angle: f64) {
        let Some([u, v]) = self.grid.in_cells(place) else { return };
        let node = v.round() as usize * self.grid.columns + u.round() as usize;
        for (cost, [x, y]) in self.costs[node].iter_mut().zip(Self::directions()) {
            if x * heading.cos() + y * heading.sin() > angle.cos() {
                *cost = f32::INFINITY;
            }
        }
    }

    /// Multiplies the costs of the nodes that are marked.
    pub fn raise(&mut self, marked: &[bool], factor: f32) {
        let nodes = self.costs.iter_mut().zip(marked).filter(|(_, marked)| **marked);
        nodes.flat_map(|(costs, _)| costs).for_each(|cost| *cost *= factor);
    }

    /// The grid.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Costs of a metre, node by node.
    #[must_use]
    pub fn costs(&self) -> &[[f32; DIRECTIONS]] {
        &self.costs
    }
}

/// Bilinear between the nodes; between the directions by the curve of the field's triangles. Infinite beside a node where it is.
impl DirectionalCost for DirectionTable {
    fn per_metre(&self, place: [f64; 2], direction: [f64; 2]) -> f64 {
        let Some(around) = self.grid.around(place) else { return f64::INFINITY };
        let sector = Sector::of(direction);
        let mut costs = [0.0; 5];
        for (weight, node) in around {
            for (cost, k) in costs.iter_mut().zip(sector.ways) {
                *cost += weight * f64::from(self.costs[node][k]);
            }
        }
        sector.per_metre(costs)
    }
}

/// The eighth of a turn in which a direction lies.
struct Sector {
    /// The axis, the direction between and the diagonal, and the ways back along the axis and the diagonal.
    ways: [usize; 5],
    /// Place from the axis (0) to the diagonal (1).
    t: f64,
}

impl Sector {
    fn of([x, y]: [f64; 2]) -> Self {
        let axis = match (x.abs() >= y.abs(), x >= 0.0, y >= 0.0) {
            (true, true, _) => 0,
            (false, _, true) => 4,
            (true, false, _) => 8,
            (false, _, false) => 12,
        };
        let [ax, ay] = RING[axis].map(f64::from);
        let (along, left) = (ax * x + ay * y, ax * y - ay * x);
        let step = |count: usize| if left >= 0.0 { axis + count } else { axis + DIRECTIONS - count };
        let back = DIRECTIONS / 2;
        let ways = [axis, step(1), step(2), axis + back, step(2) + back].map(|way| way % DIRECTIONS);
        Self { ways, t: left.abs() / along }
    }

    /// From the costs of a metre in the five directions.
    fn per_metre(&self, costs: [f64; 5]) -> f64 {
        let t = self.t;
        let [along, between, across] = [1.0, 1.25_f64.sqrt(), 2.0_f64.sqrt()];
        let ways = [along * costs[0], between * costs[1], across * costs[2]];
        let odd = [ways[0] - along * costs[3], ways[2] - across * costs[4]];
        let odd = odd.map(|more| if more.is_finite() { 0.5 * more } else { 0.0 });
        let even = [ways[0] - odd[0], ways[1] - 0.5 * (odd[0] + odd[1]), ways[2] - odd[1]].map(|way| way * way);
        let square =
            even[0] * (1.0 - t) * (1.0 - 2.0 * t) + even[1] * 4.0 * t * (1.0 - t) - even[2] * t * (1.0 - 2.0 * t);
        let cost = if square.is_finite() && square >= 0.0 {
            (square.sqrt() + (1.0 - t) * odd[0] + t * odd[1]).max(0.0)
        } else {
            // Straight lines to both sides of the middle, which a way that cannot be passed blocks up to there.
            let part = if t < 0.5 { (ways[0], ways[1], 2.0 * t) } else { (ways[1], ways[2], 2.0 * t - 1.0) };
            let parts = [(1.0 - part.2, part.0), (part.2, part.1)].into_iter().filter(|(share, _)| *share > 0.0);
            parts.map(|(share, way)| share * way).sum()
        };
        cost / 1.0_f64.hypot(t)
    }
}
