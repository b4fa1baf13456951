//! The cheapest path from an arrival field, and the cost of a path.

use super::field::{AROUND_START, Entry, RING, way_cost};
use super::{ArrivalField, DirectionalCost};
use std::collections::BinaryHeap;

/// Shares of an edge of the ring at which a way through it is tried, before the best is refined by a parabola.
const SHARES: [f64; 3] = [0.0, 0.5, 1.0];

/// Points of a path that are tried to be replaced by one straight way, at most.
const LONGEST_SPAN: usize = 64;

/// Rounds of straightening; each ends where nothing gets cheaper.
const ROUNDS: usize = 6;

/// Straightening and moving, one after the other, so many times.
const SMOOTHED: usize = 3;

/// Sizes of steps by which points are moved, from a spacing on.
const MOVES: usize = 5;

/// What a traced path may cost more than its field says before ways over nodes are tried.
const MORE: f64 = 0.003;

/// A straight way must be cheaper by this share to replace points: rounding.
const CHEAPER: f64 = 1e-9;

/// A path at any angle.
#[derive(Clone, Debug, PartialEq)]
pub struct AnyAnglePath {
    /// Points from start to goal, m.
    pub points: Vec<[f64; 2]>,
    /// Its cost.
    pub cost: f64,
    /// Its length, m.
    pub length: f64,
}

/// The cheapest path from the field's start to `goal` (m). It is traced back from the goal over the ways by which the field was made: to
/// the place on the ring of nodes around where the cost to come plus that of the way is least. What the grid has put in corners is then
/// straightened, and every point moved to where the path is cheapest. Between places that cannot be passed a trace can end, or cost more
/// than the field says; then the cheapest way over nodes is taken where it is better. `None` where the goal is out of reach.
#[must_use]
pub fn path_from(field: &ArrivalField, cost: &impl DirectionalCost, goal: [f64; 2]) -> Option<AnyAnglePath> {
    let expected = field.at(goal);
    let traced = traced(field, cost, goal).map(|points| smoothed(points, cost, field.cell));
    match traced.filter(|path| path.cost.is_finite()) {
        Some(path) if path.cost <= expected * (1.0 + MORE) => Some(path),
        path => {
            let other = over_nodes(field, cost, goal).map(|points| smoothed(points, cost, field.cell));
            let both = path.into_iter().chain(other).filter(|path| path.cost.is_finite());
            both.min_by(|a, b| a.cost.total_cmp(&b.cost))
        }
    }
}

/// A path from its points, straightened and moved.
fn smoothed(mut points: Vec<[f64; 2]>, cost: &impl DirectionalCost, cell: f64) -> AnyAnglePath {
    points.reverse();
    let piece = 0.5 * cell;
    for _ in 0..SMOOTHED {
        straighten(&mut points, cost, piece);
        relax(&mut points, cost, piece);
    }
    let length = points.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).sum();
    AnyAnglePath { cost: path_cost(cost, &points, piece), points, length }
}

/// Moves every point but the ends to where the two ways at it are cheapest, by steps that halve.
fn relax(points: &mut [[f64; 2]], cost: &impl DirectionalCost, piece: f64) {
    let mut step = 2.0 * piece;
    for _ in 0..MOVES {
        for k in 1..points.len().saturating_sub(1) {
            let mut least = path_cost(cost, &points[k - 1..=k + 1], piece);
            for (dx, dy) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
                let moved = [points[k][0] + step * dx, points[k][1] + step * dy];
                let there = path_cost(cost, &[points[k - 1], moved, points[k + 1]], piece);
                if there < least * (1.0 - CHEAPER) {
                    (least, points[k]) = (there, moved);
                }
            }
        }
        step *= 0.5;
    }
}

/// The cheapest way over nodes of the ring's steps (Dijkstra 1959), from the goal back to the start.
fn over_nodes(field: &ArrivalField, cost: &impl DirectionalCost, goal: [f64; 2]) -> Option<Vec<[f64; 2]>> {
    let near = |at: [f64; 2]| {
        let place = [0, 1].map(|axis| (at[axis] - field.origin[axis]) / field.cell);
        let [columns, rows] = [(place[0], field.columns), (place[1], field.rows)]
            .map(|(at, count)| (at.floor().max(0.0) as usize)..=(at.ceil() as usize).min(count - 1));
        rows.flat_map(move |row| columns.clone().map(move |column| (column, row)))
    };
    let mut least = vec![f64::INFINITY; field.cost.len()];
    let mut from = vec![usize::MAX; field.cost.len()];
    let mut queue = BinaryHeap::new();
    for (column, row) in near(field.start) {
        let node = row * field.columns + column;
        least[node] = way_cost(cost, field.start, field.place(column, row), field.cell);
        queue.push(Entry { cost: least[node], node: node as u32 });
    }
    while let Some(Entry { cost: here, node }) = queue.pop() {
        let node = node as usize;
        if here > least[node] || here.is_infinite() {
            continue;
        }
        let (column, row) = (node % field.columns, node / field.columns);
        for (dc, dr) in RING {
            let (Some(c), Some(r)) = (column.checked_add_signed(dc), row.checked_add_signed(dr)) else { continue };
            if c >= field.columns || r >= field.rows {
                continue;
            }
            let next = r * field.columns + c;
            let total = here + way_cost(cost, field.place(column, row), field.place(c, r), field.cell);
            if total < least[next] {
                (least[next], from[next]) = (total, node);
                queue.push(Entry { cost: total, node: next as u32 });
            }
        }
    }
    let total = |&(column, row): &(usize, usize)| {
        least[row * field.columns + column] + way_cost(cost, field.place(column, row), goal, field.cell)
    };
    let last = near(goal).min_by(|a, b| total(a).total_cmp(&total(b))).filter(|node| total(node).is_finite())?;
    let mut points = vec![goal];
    let mut node = last.1 * field.columns + last.0;
    while node != usize::MAX {
        points.push(field.place(node % field.columns, node / field.columns));
        node = from[node];
    }
    points.push(field.start);
    Some(points)
}

/// Points from the goal back to the start.
fn traced(field: &ArrivalField, cost: &impl DirectionalCost, goal: [f64; 2]) -> Option<Vec<[f64; 2]>> {
    let start = field.start;
    let mut points = vec![goal];
    // From the goal itself any way may come; after it the cost to come must fall with each.
    let mut come = f64::INFINITY;
    let mut here = goal;
    loop {
        let near = (here[0] - start[0]).hypot(here[1] - start[1]) <= AROUND_START * field.cell;
        let straight = if near { path_cost(cost, &[start, here], 0.5 * field.cell) } else { f64::INFINITY };
        // A point between two nodes may have no way on where both of them do.
        let ways = [false, true].into_iter().filter_map(|nodes| best_way(field, cost, here, come, nodes));
        let way = ways.into_iter().find(|way| near || best_way(field, cost, way.from, way.come, false).is_some());
        match way {
            Some(way) if straight.is_infinite() || way.total < straight => {
                (here, come) = (way.from, way.come);
                points.push(here);
            }
            _ if straight.is_finite() => {
                points.push(start);
                return Some(points);
            }
            _ => return None,
        }
    }
}

/// A way to a place from a point of the ring around it.
#[derive(Clone, Copy)]
struct Way {
    from: [f64; 2],
    /// Cost to come at that point.
    come: f64,
    /// With the cost of the way.
    total: f64,
}

/// The cheapest way to a place from the ring around the node next to it, from points whose cost to come is below `most`; with `nodes`
/// from nodes only.
fn best_way(field: &ArrivalField, cost: &impl DirectionalCost, here: [f64; 2], most: f64, nodes: bool) -> Option<Way> {
    let [u, v] = [0, 1].map(|axis| (here[axis] - field.origin[axis]) / field.cell);
    if !(u >= 0.0 && v >= 0.0 && u <= (field.columns - 1) as f64 && v <= (field.rows - 1) as f64) {
        return None;
    }
    let base = [u.round() as isize, v.round() as isize];
    let node = |k: usize| {
        let (dc, dr) = RING[k % RING.len()];
        let (column, row) = (usize::try_from(base[0] + dc).ok()?, usize::try_from(base[1] + dr).ok()?);
        let inside = column < field.columns && row < field.rows;
        inside.then(|| (field.place(column, row), field.cost[row * field.columns + column]))
    };
    let mut best: Option<Way> = None;
    let mut way = |from: [f64; 2], come: f64| {
        let total = if come < most { come + way_cost(cost, from, here, field.cell) } else { f64::INFINITY };
        if total.is_finite() && best.is_none_or(|best| total < best.total) {
            best = Some(Way { from, come, total });
        }
        total
    };
    for k in 0..RING.len() {
        let Some((one, at_one)) = node(k) else { continue };
        let edge = |(_, at_other): &([f64; 2], f64)| !nodes && at_other.is_finite() && at_one.is_finite();
        let Some((other, at_other)) = node(k + 1).filter(edge) else {
            way(one, at_one);
            continue;
        };
        let mut between = |t: f64| {
            let from = [0, 1].map(|axis| (1.0 - t) * one[axis] + t * other[axis]);
            way(from, (1.0 - t) * at_one + t * at_other)
        };
        let [first, half, last] = SHARES.map(&mut between);
        let bend = first - 2.0 * half + last;
        let t = 0.5 + 0.25 * (first - last) / bend;
        if bend > 0.0 && t > 0.0 && t < 1.0 {
            between(t);
        }
    }
    best
}

/// Replaces points by straight ways where that is cheaper, over spans that double.
fn straighten(points: &mut Vec<[f64; 2]>, cost: &impl DirectionalCost, piece: f64) {
    for _ in 0..ROUNDS {
        let before = points.len();
        let mut span = 2;
        while span <= LONGEST_SPAN {
            let mut k = 0;
            while k + 2 < points.len() {
                let end = (k + span).min(points.len() - 1);
                let old = path_cost(cost, &points[k..=end], piece);
                if path_cost(cost, &[points[k], points[end]], piece) < old * (1.0 - CHEAPER) {
                    points.drain(k + 1..end);
                }
                k += 1;
            }
            span *= 2;
        }
        if points.len() == before {
            return;
        }
    }
}

/// Cost of a polyline, by the midpoint rule in steps of at most `step` (m).
#[must_use]
pub fn path_cost(cost: &impl DirectionalCost, points: &[[f64; 2]], step: f64) -> f64 {
    let part = |pair: &[[f64; 2]]| {
        let (dx, dy) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        let length = dx.hypot(dy);
        if length == 0.0 {
            return 0.0;
        }
        let count = (length / step).ceil().max(1.0);
        let piece = |k: usize| {
            let share = (k as f64 + 0.5) / count;
            cost.per_metre([pair[0][0] + share * dx, pair[0][1] + share * dy], [dx / length, dy / length])
        };
        (0..count as usize).map(piece).sum::<f64>() * length / count
    };
    points.windows(2).map(part).sum()
}
