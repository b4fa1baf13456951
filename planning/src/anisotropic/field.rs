//! Cost to come from a start to every node of a grid, over a table of costs by direction.
//!
//! Tiles are solved in rounds: those whose incoming cost is the least among their neighbours, side by side on all threads. Two
//! neighbours are never solved in one round, so that the outcome does not depend on the number of threads. A tile is solved again
//! where a neighbour has fallen such that one of its border's nodes would fall; in the end none would, which is the fixed point
//! also where costs depend so strongly on direction that no order of the nodes is causal.

use super::table::{DIRECTIONS, DirectionTable, Grid, RING};
use super::tile::{BEYOND, FALLS, Frame, SIDE, Scratch, Surrounded, Tile, WIDE, frame, least, priced, smaller, solve};
use super::{DirectionalCost, path_cost};
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// Around the start, nodes within this many spacings get their cost along the straight way: the field has a tip there, which
/// linear interpolation rounds off.
pub(super) const AROUND_START: f64 = 4.0;

/// Cost to come.
#[derive(Clone, Debug, PartialEq)]
pub struct ArrivalField {
    /// The grid.
    pub grid: Grid,
    /// Where it starts, m.
    pub start: [f64; 2],
    /// Cost to come of every node, row by row from the south; infinite where the rover cannot get.
    pub cost: Vec<f64>,
}

/// Why there is no field.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// The start is off the grid.
    #[error("the start ({x}, {y}) is off the grid")]
    Start {
        /// Easting, m.
        x: f64,
        /// Northing, m.
        y: f64,
    },
    /// The rover cannot leave the start.
    #[error("no way leads from the start ({x}, {y}): every direction costs infinitely much")]
    Blocked {
        /// Easting, m.
        x: f64,
        /// Northing, m.
        y: f64,
    },
    /// A cost is negative or no number.
    #[error("a metre at ({x:.2}, {y:.2}) costs {cost}; expected 0 or more")]
    Cost {
        /// Easting, m.
        x: f64,
        /// Northing, m.
        y: f64,
        /// The cost.
        cost: f64,
    },
    /// Too few or too many nodes.
    #[error("a grid of {columns} x {rows} nodes; expected at least 2 x 2 and at most {max}", max = crate::map::MAX_NODES)]
    Size {
        /// Nodes along x.
        columns: usize,
        /// Nodes along y.
        rows: usize,
    },
    /// The number of costs is another than that of the nodes.
    #[error("costs of {got} nodes were given for {columns} x {rows} nodes")]
    Count {
        /// Nodes with costs.
        got: usize,
        /// Nodes along x.
        columns: usize,
        /// Nodes along y.
        rows: usize,
    },
    /// Spacing or corner are no numbers.
    #[error("the grid's spacing is {cell} m and its corner at {origin:?}; expected a positive number and finite ones")]
    Spacing {
        /// Spacing, m.
        cell: f64,
        /// Place of node (0, 0), m.
        origin: [f64; 2],
    },
}

impl ArrivalField {
    /// Cost to come at a place between nodes, bilinear; infinite off the grid and beside a node out of reach.
    #[must_use]
    pub fn at(&self, place: [f64; 2]) -> f64 {
        let Some(around) = self.grid.around(place) else { return f64::INFINITY };
        around.map(|(weight, node)| weight * self.cost[node]).sum()
    }
}

/// Cost to come from `start` (m) to all nodes of a cost over a grid; see [`arrival_over`].
///
/// # Errors
/// [`FieldError`] where the start is off the grid or blocked, or a cost is negative.
pub fn arrival(cost: &(impl DirectionalCost + Sync), grid: Grid, start: [f64; 2]) -> Result<ArrivalField, FieldError> {
    arrival_over(&DirectionTable::of(cost, grid)?, start)
}

/// Cost to come from `start` (m) to all nodes of a table, on all threads of the pool that it is called in; the same to the last bit
/// whatever their number.
///
/// Ways are priced in single precision and summed in double precision. Where a way between nodes costs less than 1e-9 or more than 1e9,
/// only the table's own directions are travelled.
///
/// # Errors
/// [`FieldError`] where the start is off the grid or blocked.
pub fn arrival_over(table: &DirectionTable, start: [f64; 2]) -> Result<ArrivalField, FieldError> {
    let mut tiles = Tiles::new(table);
    for (node, cost) in around_start(table, start)? {
        tiles.start(node, cost);
    }
    while tiles.round() {}
    Ok(ArrivalField { grid: *table.grid(), start, cost: tiles.rows() })
}

/// Nodes near the start with the costs of straight ways to them.
pub(super) fn around_start(table: &DirectionTable, start: [f64; 2]) -> Result<Vec<([usize; 2], f64)>, FieldError> {
    let grid = table.grid();
    let [u, v] = grid.in_cells(start).ok_or(FieldError::Start { x: start[0], y: start[1] })?;
    let ends = |at: f64, count: usize| {
        ((at - AROUND_START).ceil().max(0.0) as usize)..=((at + AROUND_START).floor() as usize).min(count - 1)
    };
    let mut nodes = Vec::new();
    for row in ends(v, grid.rows) {
        for column in ends(u, grid.columns) {
            let near = (column as f64 - u).hypot(row as f64 - v) <= AROUND_START;
            let total = path_cost(table, &[start, grid.place(column, row)], 0.5 * grid.cell);
            if near && total.is_finite() {
                nodes.push(([column, row], total));
            }
        }
    }
    let leaves = nodes.iter().any(|&([column, row], _)| grid.place(column, row) != start);
    if leaves { Ok(nodes) } else { Err(FieldError::Blocked { x: start[0], y: start[1] }) }
}

/// A neighbour among the nodes of a tile and around it; beyond them it is no index of theirs.
fn step(at: [usize; 2], k: usize) -> [usize; 2] {
    [0, 1].map(|axis| at[axis].wrapping_add_signed(RING[k][axis] as isize))
}

/// Whether a node is of the tile itself.
fn within(at: [usize; 2]) -> bool {
    at.iter().all(|at| (1..=SIDE).contains(at))
}

/// The tiles of a field.
struct Tiles<'a> {
    table: &'a DirectionTable,
    columns: usize,
    rows: usize,
    /// None before a value is known.
    tiles: Vec<Option<Box<Tile>>>,
    /// What was around a tile when it was solved.
    frames: Vec<Option<Box<Frame>>>,
    /// The least cost that comes in, of tiles to be solved; infinite for others.
    due: Vec<f64>,
    /// Memory of threads between rounds: to make it anew for each takes longer than to solve a tile.
    scratches: Mutex<Vec<Scratch>>,
}

/// A solved tile.
struct Solved {
    place: [usize; 2],
    values: Box<Surrounded>,
    /// For the nine tiles around it, the least cost to which a node of their border would fall.
    falls: [f64; 9],
}

impl<'a> Tiles<'a> {
    fn new(table: &'a DirectionTable) -> Self {
        let (columns, rows) = (table.grid().columns.div_ceil(SIDE), table.grid().rows.div_ceil(SIDE));
        let count = columns * rows;
        Self {
            table,
            columns,
            rows,
            tiles: vec![None; count],
            frames: vec![None; count],
            due: vec![f64::INFINITY; count],
            scratches: Mutex::new(Vec::new()),
        }
    }

    fn start(&mut self, [column, row]: [usize; 2], cost: f64) {
        let index = row / SIDE * self.columns + column / SIDE;
        let tile = self.tiles[index].get_or_insert_with(|| Box::new([[f64::INFINITY; SIDE]; SIDE]));
        tile[row % SIDE][column % SIDE] = cost;
        self.due[index] = self.due[index].min(cost);
    }

    /// The tiles around one and itself, numbered from 0 in the south-west to 8, with their indices.
    fn around(&self, [column, row]: [usize; 2]) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        (0..9).filter_map(move |k| {
            let (column, row) = ((column + k % 3).checked_sub(1)?, (row + k / 3).checked_sub(1)?);
            (column < columns && row < rows).then_some((k, row * columns + column))
        })
    }

    /// Solves the tiles that come before all of their neighbours; false when none is due.
    fn round(&mut self) -> bool {
        let places = (0..self.due.len()).filter(|index| self.due[*index].is_finite());
        let places = places.map(|index| [index % self.columns, index / self.columns]);
        let order = |index: usize| (self.due[index], index);
        let first = |place: &[usize; 2]| {
            let own = order(place[1] * self.columns + place[0]);
            self.around(*place).all(|(_, index)| order(index) >= own)
        };
        let chosen: Vec<[usize; 2]> = places.filter(first).collect();
        let solved: Vec<Solved> =
            chosen.par_iter().map(|place| self.with_scratch(|scratch| self.solve(scratch, *place))).collect();
        for solved in &solved {
            self.take(solved);
        }
        !solved.is_empty()
    }

    /// Something done with the memory of a thread, which is left for the next.
    fn with_scratch<T>(&self, work: impl FnOnce(&mut Scratch) -> T) -> T {
        let kept = || self.scratches.lock().unwrap_or_else(PoisonError::into_inner);
        let mut scratch = kept().pop().unwrap_or_else(Scratch::new);
        let done = work(&mut scratch);
        kept().push(scratch);
        done
    }

    /// Puts a solved tile in its place, and its neighbours on the list.
    fn take(&mut self, solved: &Solved) {
        for (k, index) in self.around(solved.place) {
            if k == 4 {
                let tile = self.tiles[index].get_or_insert_with(|| Box::new([[f64::INFINITY; SIDE]; SIDE]));
                for (to, from) in tile.iter_mut().zip(&solved.values[1..]) {
                    to.copy_from_slice(&from[1..=SIDE]);
                }
                self.due[index] = f64::INFINITY;
                self.frames[index] = Some(Box::new(frame(&solved.values)));
            } else {
                self.due[index] = self.due[index].min(solved.falls[k]);
            }
        }
    }

    fn solve(&self, scratch: &mut Scratch, place: [usize; 2]) -> Solved {
        let mut values = Box::new([[f64::INFINITY; WIDE]; WIDE]);
        /// Where the lines of a tile below, of the same and above begin among those around a tile, in it, and how many there are.
        const PARTS: [(usize, usize, usize); 3] = [(0, SIDE - 1, 1), (1, 0, SIDE), (WIDE - 1, 0, 1)];
        for (k, index) in self.around(place) {
            let Some(tile) = &self.tiles[index] else { continue };
            let ((to_row, row, rows), (to_column, column, columns)) = (PARTS[k / 3], PARTS[k % 3]);
            for (to, from) in values[to_row..].iter_mut().zip(&tile[row..row + rows]) {
                to[to_column..to_column + columns].copy_from_slice(&from[column..column + columns]);
            }
        }
        let before = self.frames[place[1] * self.columns + place[0]].as_deref();
        solve(scratch, self.table, place, &mut values, before);
        let falls = self.falls(place, &values);
        Solved { place, values, falls }
    }

    /// To what the borders of the tiles around would fall from a solved tile.
    fn falls(&self, place: [usize; 2], values: &Surrounded) -> [f64; 9] {
        let own = self.tiles[place[1] * self.columns + place[0]].as_deref();
        let old = |[column, row]: [usize; 2]| own.map_or(f64::INFINITY, |tile| tile[row - 1][column - 1]);
        let mut falls = [f64::INFINITY; 9];
        let part = |at: usize| usize::from(at > 0) + usize::from(at > SIDE);
        let ends = (0..WIDE).flat_map(|at| [[at, 0], [at, WIDE - 1]]);
        let ring = ends.chain((1..=SIDE).flat_map(|at| [[0, at], [WIDE - 1, at]]));
        for at in ring {
            let here = values[at[1]][at[0]];
            let fell = |k: usize| {
                let [column, row] = step(at, k);
                within([column, row])
                    && values[row][column] < here
                    && values[row][column] < old([column, row]) * (1.0 - FALLS)
            };
            if !(0..DIRECTIONS).step_by(2).any(fell) {
                continue;
            }
            let least = self.least_from(place, at, values);
            let to = &mut falls[3 * part(at[1]) + part(at[0])];
            if least < here * (1.0 - FALLS) && least < *to {
                *to = least;
            }
        }
        falls
    }

    /// The least cost of a node around a tile over the triangles that the tile has a corner of.
    fn least_from(&self, place: [usize; 2], at: [usize; 2], values: &Surrounded) -> f64 {
        let grid = self.table.grid();
        let node = |[column, row]: [usize; 2]| {
            let column = (place[0] * SIDE + column).checked_sub(1).filter(|column| *column < grid.columns)?;
            let row = (place[1] * SIDE + row).checked_sub(1).filter(|row| *row < grid.rows)?;
            Some(&self.table.costs()[row * grid.columns + column])
        };
        let Some(here) = node(at) else { return f64::INFINITY };
        let neighbour = |k: usize| {
            let at = step(at, k);
            let costs = if at[0] < WIDE && at[1] < WIDE { node(at) } else { None };
            costs.map_or((&BEYOND, f64::INFINITY, false), |costs| (costs, values[at[1]][at[0]], within(at)))
        };
        let mut best = f64::INFINITY;
        for axis in (0..DIRECTIONS).step_by(4) {
            for middle in [axis + 1, axis + DIRECTIONS - 1] {
                let diagonal = (2 * middle - axis) % DIRECTIONS;
                let ((one, at_one, mine), (other, at_other, also)) = (neighbour(axis), neighbour(diagonal));
                if mine || also {
                    // From the neighbour to the node: the other way.
                    let ways = [axis, middle, diagonal].map(|step| (step + DIRECTIONS / 2) % DIRECTIONS);
                    best = smaller(least(priced(grid.cell, ways, [here, one, other]), at_one, at_other), best);
                }
            }
        }
        best
    }

    /// Values of all nodes, row by row.
    fn rows(self) -> Vec<f64> {
        let grid = self.table.grid();
        let mut cost = vec![f64::INFINITY; grid.columns * grid.rows];
        cost.par_chunks_mut(grid.columns).enumerate().for_each(|(row, line)| {
            let tiles = &self.tiles[row / SIDE * self.columns..];
            for (to, tile) in line.chunks_mut(SIDE).zip(tiles) {
                if let Some(tile) = tile {
                    to.copy_from_slice(&tile[row % SIDE][..to.len()]);
                }
            }
        });
        cost
    }
}
