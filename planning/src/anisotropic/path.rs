//! The cheapest path from an arrival field, and the cost of a path.

use super::field::AROUND_START;
use super::table::RING;
use super::{ArrivalField, DirectionalCost};
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap};

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

/// Weight of the cost to come in the search over nodes. The ways of its sixteen steps cost more than the field says, beside walls by some
/// percent, and with a weight of one the search would look at all nodes in between.
const GUIDED: f64 = 1.1;

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
    let traced = traced(field, cost, goal).map(|points| smoothed(points, cost, field.grid.cell));
    match traced.filter(|path| path.cost.is_finite()) {
        Some(path) if path.cost <= expected * (1.0 + MORE) => Some(path),
        path => {
            let other = over_nodes(field, cost, goal).map(|points| smoothed(points, cost, field.grid.cell));
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

/// Cost of a straight way of a few spacings, looked at each half of one so that it crosses no wall.
fn way_cost(cost: &impl DirectionalCost, from: [f64; 2], to: [f64; 2], cell: f64) -> f64 {
    path_cost(cost, &[from, to], 0.5 * cell)
}

/// A node in the queue, the one with the least total first.
#[derive(PartialEq)]
struct Entry {
    total: f64,
    to_goal: f64,
    node: usize,
}

impl Eq for Entry {}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        other.total.total_cmp(&self.total).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// A cheap way over nodes of the ring's steps, from the goal back to the start: A* that is guided by the cost to come.
fn over_nodes(field: &ArrivalField, cost: &impl DirectionalCost, goal: [f64; 2]) -> Option<Vec<[f64; 2]>> {
    let grid = &field.grid;
    let place = |node: usize| grid.place(node % grid.columns, node / grid.columns);
    let first: Vec<usize> = grid.around(field.start)?.map(|(_, node)| node).collect();
    // Cost from a node to the goal, and the node that comes next; none before the goal.
    let mut known: HashMap<usize, (f64, Option<usize>)> = HashMap::new();
    let mut queue = BinaryHeap::new();
    let mut offer = |queue: &mut BinaryHeap<Entry>, node: usize, to_goal: f64, next: Option<usize>| {
        let total = to_goal + GUIDED * field.cost[node];
        if total.is_finite() && known.get(&node).is_none_or(|(known, _)| to_goal < *known) {
            known.insert(node, (to_goal, next));
            queue.push(Entry { total, to_goal, node });
        }
    };
    for (_, node) in grid.around(goal)? {
        offer(&mut queue, node, way_cost(cost, place(node), goal, grid.cell), None);
    }
    let mut best: Option<(f64, usize)> = None;
    while let Some(Entry { total, to_goal, node }) = queue.pop() {
        if best.is_some_and(|(least, _)| total >= least) {
            break;
        }
        if first.contains(&node) {
            let whole = to_goal + way_cost(cost, field.start, place(node), grid.cell);
            if whole.is_finite() && best.is_none_or(|(least, _)| whole < least) {
                best = Some((whole, node));
            }
        }
        let (column, row) = (node % grid.columns, node / grid.columns);
        for [dc, dr] in RING {
            let (c, r) = (column.wrapping_add_signed(dc as isize), row.wrapping_add_signed(dr as isize));
            if c < grid.columns && r < grid.rows {
                let way = way_cost(cost, grid.place(c, r), place(node), grid.cell);
                offer(&mut queue, r * grid.columns + c, to_goal + way, Some(node));
            }
        }
    }
    let mut node = best.map(|(_, node)| node);
    let mut points = vec![field.start];
    while let Some(at) = node {
        points.push(place(at));
        node = known.get(&at).and_then(|(_, next)| *next);
    }
    (points.len() > 1).then(|| points.into_iter().chain([goal]).rev().collect())
}

/// Points from the goal back to the start.
fn traced(field: &ArrivalField, cost: &impl DirectionalCost, goal: [f64; 2]) -> Option<Vec<[f64; 2]>> {
    let start = field.start;
    let mut points = vec![goal];
    // From the goal itself any way may come; after it the cost to come must fall with each.
    let mut here = goal;
    let mut through = best_way(field, cost, here, f64::INFINITY, false);
    let mut come = f64::INFINITY;
    loop {
        let near = (here[0] - start[0]).hypot(here[1] - start[1]) <= AROUND_START * field.grid.cell;
        let straight = if near { path_cost(cost, &[start, here], 0.5 * field.grid.cell) } else { f64::INFINITY };
        let way = |way: Way| (way, best_way(field, cost, way.from, way.come, false));
        // A point between two nodes may have no way on where both of them do.
        let leads_on = |(_, next): &(Way, Option<Way>)| near || next.is_some();
        let nodes = || best_way(field, cost, here, come, true).map(way);
        match through.map(way).filter(leads_on).or_else(|| nodes().filter(leads_on)) {
            Some((way, next)) if straight.is_infinite() || way.total < straight => {
                (here, come, through) = (way.from, way.come, next);
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
    let grid = &field.grid;
    let [u, v] = grid.in_cells(here)?;
    let (column, row) = (u.round() as usize, v.round() as usize);
    let node = |k: usize| {
        let [dc, dr] = RING[k % RING.len()];
        let (column, row) = (column.wrapping_add_signed(dc as isize), row.wrapping_add_signed(dr as isize));
        let inside = column < grid.columns && row < grid.rows;
        inside.then(|| (grid.place(column, row), field.cost[row * grid.columns + column]))
    };
    let mut best: Option<Way> = None;
    let mut way = |from: [f64; 2], come: f64| {
        let total = if come < most { come + way_cost(cost, from, here, grid.cell) } else { f64::INFINITY };
        if total.is_finite() && best.is_none_or(|best| total < best.total) {
            best = Some(Way { from, come, total });
        }
        total
    };
    let ring: [Option<([f64; 2], f64)>; RING.len()] = std::array::from_fn(node);
    let over = ring.map(|node| node.map_or(f64::INFINITY, |(place, come)| way(place, come)));
    for k in 0..RING.len() {
        let next = (k + 1) % RING.len();
        let (Some((one, at_one)), Some((other, at_other))) = (ring[k], ring[next]) else { continue };
        if nodes || !at_one.is_finite() || !at_other.is_finite() {
            continue;
        }
        let mut between = |t: f64| {
            let from = [0, 1].map(|axis| (1.0 - t) * one[axis] + t * other[axis]);
            way(from, (1.0 - t) * at_one + t * at_other)
        };
        let (first, half, last) = (over[k], between(0.5), over[next]);
        let bend = first - 2.0 * half + last;
        let t = 0.5 + 0.25 * (first - last) / bend;
        if bend > 0.0 && t > 0.0 && t < 1.0 {
            between(t);
        }
    }
    best
}

/// Replaces points by straight ways where that is cheaper, over spans that double and overlap by half.
fn straighten(points: &mut Vec<[f64; 2]>, cost: &impl DirectionalCost, piece: f64) {
    for _ in 0..ROUNDS {
        let before = points.len();
        let mut costs: Vec<f64> = points.windows(2).map(|pair| path_cost(cost, pair, piece)).collect();
        let mut span = 2;
        while span <= LONGEST_SPAN {
            (*points, costs) = straightened(points, &costs, cost, piece, span);
            span *= 2;
        }
        if points.len() == before {
            return;
        }
    }
}

/// The points that are left, and the costs of the ways between them.
fn straightened(
    points: &[[f64; 2]],
    costs: &[f64],
    cost: &impl DirectionalCost,
    piece: f64,
    span: usize,
) -> (Vec<[f64; 2]>, Vec<f64>) {
    let (mut kept, mut kept_costs) = (vec![points[0]], Vec::new());
    let mut k = 0;
    while k < costs.len() {
        let end = (k + span).min(costs.len());
        let old: f64 = costs[k..end].iter().sum();
        let whole = [points[k], points[end]];
        let next = if end > k + 1 && costs_less(cost, whole, piece, old * (1.0 - CHEAPER)) {
            kept.push(points[end]);
            kept_costs.push(path_cost(cost, &whole, piece));
            end
        } else {
            let half = (k + span / 2).min(end);
            kept.extend(&points[k + 1..=half]);
            kept_costs.extend(&costs[k..half]);
            half
        };
        k = next;
    }
    (kept, kept_costs)
}

/// Cost of a polyline, by the midpoint rule in steps of at most `step` (m).
#[must_use]
pub fn path_cost(cost: &impl DirectionalCost, points: &[[f64; 2]], step: f64) -> f64 {
    points.windows(2).map(|pair| pieces(cost, [pair[0], pair[1]], step).sum::<f64>()).sum()
}

/// Costs of the pieces of a straight way.
fn pieces(cost: &impl DirectionalCost, [from, to]: [[f64; 2]; 2], step: f64) -> impl Iterator<Item = f64> {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let length = dx.hypot(dy);
    let count = if length == 0.0 { 0.0 } else { (length / step).ceil().max(1.0) };
    (0..count as usize).map(move |k| {
        let share = (k as f64 + 0.5) / count;
        let place = [from[0] + share * dx, from[1] + share * dy];
        cost.per_metre(place, [dx / length, dy / length]) * length / count
    })
}

/// Whether a straight way costs less than `limit`; looked at up to where it is passed.
fn costs_less(cost: &impl DirectionalCost, way: [[f64; 2]; 2], step: f64, limit: f64) -> bool {
    let mut sum = 0.0;
    pieces(cost, way, step).all(|piece| {
        sum += piece;
        sum < limit
    })
}
