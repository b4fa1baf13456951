//! The field by the plainest scheme that solves it, beside that of tiles.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use super::field::around_start;
use super::table::{DIRECTIONS, RING};
use super::tile::SIDE;
use super::{DirectionTable, FieldError, Grid, arrival_over};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::VecDeque;

/// Ways of the tiles are in single precision, 6e-8 of a way, and falls below 1e-9 of a cost are not passed on, over some hundred nodes.
const ROUNDING: f64 = 1e-6;

/// Nodes are taken from a queue, and all around one that has fallen are put back, until none falls: in double precision, each triangle's
/// least cost by a search over t.
fn plain(table: &DirectionTable, start: [f64; 2]) -> Vec<f64> {
    let grid = table.grid();
    let mut cost = vec![f64::INFINITY; grid.columns * grid.rows];
    let mut queue = VecDeque::new();
    let index = |[column, row]: [usize; 2]| row * grid.columns + column;
    let neighbours = |[column, row]: [usize; 2]| {
        (0..DIRECTIONS).step_by(2).filter_map(move |k| {
            let at = (column.checked_add_signed(RING[k][0] as isize)?, row.checked_add_signed(RING[k][1] as isize)?);
            (at.0 < grid.columns && at.1 < grid.rows).then_some((k, [at.0, at.1]))
        })
    };
    for (node, value) in around_start(table, start).unwrap() {
        cost[index(node)] = value;
        queue.extend(neighbours(node).map(|(_, node)| node));
    }
    while let Some(here) = queue.pop_front() {
        let around: Vec<(usize, [usize; 2])> = neighbours(here).collect();
        let mut best = f64::INFINITY;
        let metre = |node: [usize; 2], k: usize| f64::from(table.costs()[index(node)][(k + 8) % DIRECTIONS]);
        for &(k, one) in &around {
            let length = grid.cell * f64::from(RING[k][0].pow(2) + RING[k][1].pow(2)).sqrt();
            let way = |k: usize, to: [usize; 2]| 0.5 * length * (metre(here, k) + metre(to, k));
            best = best.min(cost[index(one)] + way(k, one));
            for &(other_k, other) in
                around.iter().filter(|(other, _)| k % 4 == 0 && (other + 2) % 16 == k || (k + 2) % 16 == *other)
            {
                let (axis, diagonal) =
                    if k % 4 == 0 { ((k, one), (other_k, other)) } else { ((other_k, other), (k, one)) };
                let middle = if (axis.0 + 2) % 16 == diagonal.0 { axis.0 + 1 } else { (axis.0 + 15) % 16 };
                let two = |node: [usize; 2], k: usize, square: f64| {
                    0.5 * grid.cell * square.sqrt() * (metre(here, k) + metre(node, k))
                };
                let f0 = two(axis.1, axis.0, 1.0);
                let f2 = two(diagonal.1, diagonal.0, 2.0);
                let far = 0.5 * (metre(axis.1, middle) + metre(diagonal.1, middle));
                let f1 = 0.5 * grid.cell * 1.25_f64.sqrt() * (metre(here, middle) + far);
                let odd = [(axis, 1.0, f0), (diagonal, 2.0, f2)].map(|((k, node), square, way)| {
                    let more = 0.5 * (way - two(node, (k + 8) % DIRECTIONS, square));
                    if more.is_finite() { more } else { 0.0 }
                });
                best = best.min(searched([f0, f1, f2], odd, cost[index(axis.1)], cost[index(diagonal.1)]));
            }
        }
        if best < cost[index(here)] * (1.0 - 1e-13) {
            cost[index(here)] = best;
            queue.extend(around.into_iter().map(|(_, node)| node));
        }
    }
    cost
}

/// Least F(t) + (1 - t) u0 + t u1 by golden section where F is convex, else of the three ways.
fn searched([f0, f1, f2]: [f64; 3], [odd0, odd1]: [f64; 2], u0: f64, u1: f64) -> f64 {
    let mut best = (f0 + u0).min(f2 + u1).min(f1 + 0.5 * (u0 + u1));
    let [q0, q1, q2] = [f0 - odd0, f1 - 0.5 * (odd0 + odd1), f2 - odd1].map(|even| even * even);
    let (alpha, beta) = (2.0 * (q0 - 2.0 * q1 + q2), 4.0 * q1 - 3.0 * q0 - q2);
    if !(alpha > 0.0 && alpha * q0 > 0.25 * beta * beta && (u0 + u1).is_finite()) {
        return best;
    }
    let value = |t: f64| (alpha * t * t + beta * t + q0).sqrt() + (1.0 - t) * (u0 + odd0) + t * (u1 + odd1);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
        if value(a) < value(b) { high = b } else { low = a }
    }
    best = best.min(value(0.5 * (low + high)).max(u0.min(u1)));
    best
}

/// Costs that change from node to node and with the direction, by a factor of up to twenty, and walls.
fn random(seed: u64, grid: Grid) -> DirectionTable {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let node = |_| {
        let (level, strength, turn) =
            (random.random_range(0.5..2.0), random.random_range(0.0..0.8), random.random_range(0.0..6.3));
        let stretch = random.random_range(1.0..4.0_f64);
        let wall = random.random_range(0.0..1.0) < 0.2;
        // One node in fifty is passed in some directions only.
        let partly = random.random_range(0.0..1.0) < 0.02;
        DirectionTable::directions().map(|[x, y]| {
            let (along, across) = (x * f64::cos(turn) + y * f64::sin(turn), y * f64::cos(turn) - x * f64::sin(turn));
            let cost = level * (along.hypot(stretch * across) + strength * along);
            if wall || (partly && along < 0.3) { f32::INFINITY } else { cost as f32 }
        })
    };
    DirectionTable::new(grid, (0..grid.columns * grid.rows).map(node).collect()).unwrap()
}

/// Grids over several tiles, of which the last are not full.
const GRIDS: [[usize; 2]; 3] = [[2 * SIDE + 7, SIDE + 30], [SIDE, SIDE], [40, 3 * SIDE + 1]];

#[test]
fn agreement_tiles_and_a_plain_queue_find_one_field() {
    for (seed, [columns, rows]) in GRIDS.into_iter().enumerate() {
        let grid = Grid { columns, rows, cell: 0.5, origin: [3.0, -2.0] };
        let table = random(seed as u64, grid);
        let free =
            (0..columns * rows).find(|node| table.costs()[*node][0].is_finite() && node / columns > rows / 2).unwrap();
        let start = grid.place(free % columns, free / columns);
        let (tiles, plain) = (arrival_over(&table, start).unwrap().cost, plain(&table, start));
        let reached = plain.iter().filter(|cost| cost.is_finite()).count();
        assert!(reached > columns * rows / 2 && reached < columns * rows, "{reached} of {}", columns * rows);
        for (node, (tile, plain)) in tiles.iter().zip(&plain).enumerate() {
            let same = tile == plain || (tile - plain).abs() <= ROUNDING * plain;
            assert!(same, "seed {seed}, node {node}: {tile} {plain}");
        }
    }
}

#[test]
fn property_a_field_is_the_same_on_any_number_of_threads() {
    let grid = Grid { columns: 3 * SIDE + 5, rows: 3 * SIDE - 9, cell: 1.0, origin: [0.0; 2] };
    let table = random(9, grid);
    let free = table.costs().iter().position(|costs| costs[0].is_finite()).unwrap();
    let start = grid.place(free % grid.columns, free / grid.columns);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| arrival_over(&table, start)).unwrap().cost
    };
    let bits = |cost: Vec<f64>| cost.into_iter().map(f64::to_bits).collect::<Vec<_>>();
    let one = bits(on(1));
    assert!(on(1).iter().filter(|cost| cost.is_finite()).count() > one.len() / 2);
    assert!([2, 3, 8].into_iter().all(|threads| bits(on(threads)) == one));
}

#[test]
fn property_walls_are_not_crossed_at_nodes_or_in_blocked_directions() {
    let grid = Grid { columns: 20, rows: 20, cell: 1.0, origin: [0.0; 2] };
    let open = [1.0; DIRECTIONS];
    let filled = |costs: &dyn Fn(usize, usize) -> [f32; DIRECTIONS]| {
        let costs = (0..400).map(|node| costs(node % 20, node / 20)).collect();
        arrival_over(&DirectionTable::new(grid, costs).unwrap(), [10.0, 3.0]).unwrap()
    };
    // A wall one node thick, also where its nodes touch at corners only along a diagonal of two nodes.
    let wall = filled(&|_, row| if row == 9 { [f32::INFINITY; DIRECTIONS] } else { open });
    let stairs = filled(&|column, row| {
        if column + row == 20 || column + row == 21 { [f32::INFINITY; DIRECTIONS] } else { open }
    });
    assert!(wall.cost[10 * 20..].iter().all(|cost| cost.is_infinite()) && wall.cost[8 * 20].is_finite());
    assert!(stairs.cost[399].is_infinite() && stairs.cost[0].is_finite());
    // A river that is crossed to the north but not back.
    let north = DirectionTable::directions().map(|[_, y]| if y > 0.0 { 1.0 } else { f32::INFINITY });
    let there = filled(&|_, row| if row == 9 { north } else { open });
    let back = arrival_over(
        &DirectionTable::new(grid, (0..400).map(|node| if node / 20 == 9 { north } else { open }).collect()).unwrap(),
        [10.0, 15.0],
    );
    assert!(there.cost[15 * 20 + 10] < 12.2 && back.unwrap().cost[3 * 20 + 10].is_infinite());
}

#[test]
fn property_wrong_tables_and_blocked_starts_are_told() {
    let grid = Grid { columns: 8, rows: 8, cell: 1.0, origin: [0.0; 2] };
    let mut costs = vec![[1.0; DIRECTIONS]; 64];
    assert!(matches!(DirectionTable::new(grid, costs[1..].to_vec()), Err(FieldError::Count { got: 63, .. })));
    let flat = Grid { rows: 1, ..grid };
    assert!(matches!(DirectionTable::new(flat, vec![[1.0; DIRECTIONS]; 8]), Err(FieldError::Size { .. })));
    let unspaced = Grid { cell: 0.0, ..grid };
    assert!(matches!(DirectionTable::new(unspaced, costs.clone()), Err(FieldError::Spacing { .. })));
    costs[19][5] = f32::NAN;
    let told = DirectionTable::new(grid, costs.clone()).unwrap_err();
    assert_eq!(told.to_string(), "a metre at (3.00, 2.00) costs NaN; expected 0 or more");
    costs[19] = [f32::INFINITY; DIRECTIONS];
    let table = DirectionTable::new(grid, costs).unwrap();
    assert_eq!(arrival_over(&table, [3.0, 2.0]), Err(FieldError::Blocked { x: 3.0, y: 2.0 }));
}
