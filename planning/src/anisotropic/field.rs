//! Cost to come from a start to every node, on a square grid.
//!
//! At a node x the cost is the least, over the directions between neighbouring pairs of the sixteen nodes around it, of the way
//! from a point y between a pair plus the linear interpolation of the pair's costs: u(x) = min |x - y| c + u(y) (Sethian and
//! Vladimirsky 2003, semi-Lagrangian). Nodes are taken in the order of their cost. Where the cost depends strongly on direction
//! that order is not causal for so near a ring; a node whose cost falls later is then taken again, so that the result is the fixed
//! point in any case.

use super::DirectionalCost;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Steps to the ring of nodes that a way to a node may come from, counter-clockwise from east. Nodes such as (2, 0) are left out:
/// (1, 0) lies on the way to them.
pub(super) const RING: [(isize, isize); 16] = [
    (1, 0),
    (2, 1),
    (1, 1),
    (1, 2),
    (0, 1),
    (-1, 2),
    (-1, 1),
    (-2, 1),
    (-1, 0),
    (-2, -1),
    (-1, -1),
    (-1, -2),
    (0, -1),
    (1, -2),
    (1, -1),
    (2, -1),
];

/// Around the start, nodes within this many spacings get their cost along the straight way: the field has a tip there, which
/// linear interpolation rounds off.
pub(super) const AROUND_START: f64 = 4.0;

/// A cost must fall by this share to be worth taking a node again: rounding.
const FALLS: f64 = 1e-12;

/// Cost to come.
#[derive(Clone, Debug, PartialEq)]
pub struct ArrivalField {
    /// Nodes along x.
    pub columns: usize,
    /// Nodes along y.
    pub rows: usize,
    /// Spacing, m.
    pub cell: f64,
    /// Place of node (0, 0), m.
    pub origin: [f64; 2],
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
}

/// A node in the queue, the cheapest first.
#[derive(PartialEq)]
pub(super) struct Entry {
    pub cost: f64,
    pub node: u32,
}

impl Eq for Entry {}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl ArrivalField {
    /// Place of a node, m.
    #[must_use]
    pub fn place(&self, column: usize, row: usize) -> [f64; 2] {
        [self.origin[0] + column as f64 * self.cell, self.origin[1] + row as f64 * self.cell]
    }

    /// Cost to come at a place between nodes, bilinear; infinite off the grid and beside a node out of reach.
    #[must_use]
    pub fn at(&self, place: [f64; 2]) -> f64 {
        let [u, v] = [(place[0] - self.origin[0]) / self.cell, (place[1] - self.origin[1]) / self.cell];
        if !(u >= 0.0 && v >= 0.0 && u <= (self.columns - 1) as f64 && v <= (self.rows - 1) as f64) {
            return f64::INFINITY;
        }
        let (column, row) = ((u as usize).min(self.columns - 2), (v as usize).min(self.rows - 2));
        let (u, v) = (u - column as f64, v - row as f64);
        let cost = |dc: usize, dr: usize| self.cost[(row + dr) * self.columns + column + dc];
        let corners = [
            ((1.0 - u) * (1.0 - v), cost(0, 0)),
            (u * (1.0 - v), cost(1, 0)),
            ((1.0 - u) * v, cost(0, 1)),
            (u * v, cost(1, 1)),
        ];
        corners.iter().filter(|(weight, _)| *weight > 0.0).map(|(weight, cost)| weight * cost).sum()
    }
}

/// Cost to come from `start` (m) to all nodes of a grid of `columns` by `rows` nodes, `cell` apart, the first at `origin` (m).
///
/// # Errors
/// [`FieldError`] where the start is off the grid or a cost is negative.
pub fn arrival(
    cost: &impl DirectionalCost,
    [columns, rows]: [usize; 2],
    cell: f64,
    origin: [f64; 2],
    start: [f64; 2],
) -> Result<ArrivalField, FieldError> {
    let mut field = ArrivalField { columns, rows, cell, origin, start, cost: vec![f64::INFINITY; columns * rows] };
    let mut queue = BinaryHeap::new();
    around_start(&mut field, cost, &mut queue)?;
    if queue.is_empty() {
        return Err(FieldError::Start { x: start[0], y: start[1] });
    }
    while let Some(Entry { cost: here, node }) = queue.pop() {
        let node = node as usize;
        if here > field.cost[node] {
            continue;
        }
        let (column, row) = (node % columns, node / columns);
        for (k, (dc, dr)) in RING.iter().enumerate() {
            let (Some(c), Some(r)) = (column.checked_add_signed(*dc), row.checked_add_signed(*dr)) else { continue };
            if c >= columns || r >= rows || field.cost[r * columns + c] <= here {
                continue;
            }
            // Seen from that node, this one is at the opposite place of its ring.
            let best = from_pair(&field, cost, c, r, (k + 8) % 16)?;
            let there = &mut field.cost[r * columns + c];
            if best < *there * (1.0 - FALLS) || (there.is_infinite() && best.is_finite()) {
                *there = best;
                queue.push(Entry { cost: best, node: (r * columns + c) as u32 });
            }
        }
    }
    Ok(field)
}

/// Straight ways from the start to the nodes near it.
fn around_start(
    field: &mut ArrivalField,
    cost: &impl DirectionalCost,
    queue: &mut BinaryHeap<Entry>,
) -> Result<(), FieldError> {
    let start = field.start;
    let [u, v] = [(start[0] - field.origin[0]) / field.cell, (start[1] - field.origin[1]) / field.cell];
    let on_grid = u >= 0.0 && v >= 0.0 && u <= (field.columns - 1) as f64 && v <= (field.rows - 1) as f64;
    if !on_grid {
        return Ok(());
    }
    let ends = |at: f64, count: usize| {
        ((at - AROUND_START).ceil().max(0.0) as usize)..=((at + AROUND_START).floor() as usize).min(count - 1)
    };
    for row in ends(v, field.rows) {
        for column in ends(u, field.columns) {
            if (column as f64 - u).hypot(row as f64 - v) > AROUND_START {
                continue;
            }
            let total = super::path_cost(cost, &[start, field.place(column, row)], 0.5 * field.cell);
            if total.is_nan() || total < 0.0 {
                return Err(FieldError::Cost { x: start[0], y: start[1], cost: total });
            }
            if total.is_finite() {
                let node = row * field.columns + column;
                field.cost[node] = total;
                queue.push(Entry { cost: total, node: node as u32 });
            }
        }
    }
    Ok(())
}

/// Cost of a straight way of a few spacings. By the middle of its pieces: of second order where the cost changes with place.
pub(super) fn way_cost(cost: &impl DirectionalCost, from: [f64; 2], to: [f64; 2], cell: f64) -> f64 {
    let piece = if cost.open() { f64::INFINITY } else { 0.5 * cell };
    super::path_cost(cost, &[from, to], piece)
}

/// Least cost at a node by ways through its ring's place `k` and either neighbour of it on the ring.
fn from_pair(
    field: &ArrivalField,
    cost: &impl DirectionalCost,
    column: usize,
    row: usize,
    k: usize,
) -> Result<f64, FieldError> {
    let place = field.place(column, row);
    let of = |k: usize| {
        let (dc, dr) = RING[k % 16];
        let at = (column.checked_add_signed(dc)?, row.checked_add_signed(dr)?);
        let inside = at.0 < field.columns && at.1 < field.rows;
        inside.then(|| ([dc as f64 * field.cell, dr as f64 * field.cell], field.cost[at.1 * field.columns + at.0]))
    };
    let Some((to_one, one)) = of(k) else { return Ok(f64::INFINITY) };
    let mut best = f64::INFINITY;
    let mut bad = None;
    let mut way = |to: [f64; 2], come: f64| {
        let way = way_cost(cost, [place[0] + to[0], place[1] + to[1]], place, field.cell);
        if way.is_nan() || way < 0.0 {
            bad = Some(FieldError::Cost { x: place[0], y: place[1], cost: way });
        }
        come + way
    };
    let at_one = way(to_one, one);
    best = best.min(at_one);
    for neighbour in [k + 1, k + 15] {
        let Some((to_other, other)) = of(neighbour) else { continue };
        if !other.is_finite() {
            continue;
        }
        let mut between = |t: f64| {
            let to = [0, 1].map(|axis| (1.0 - t) * to_one[axis] + t * to_other[axis]);
            way(to, (1.0 - t) * one + t * other)
        };
        let (half, end) = (between(0.5), between(1.0));
        best = best.min(half);
        // The least value of a parabola through the three.
        let bend = at_one - 2.0 * half + end;
        let t = 0.5 + 0.25 * (at_one - end) / bend;
        if bend > 0.0 && t > 0.0 && t < 1.0 {
            best = best.min(between(t));
        }
    }
    bad.map_or(Ok(best), Err)
}
