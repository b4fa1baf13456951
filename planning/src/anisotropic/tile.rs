//! A square of nodes, solved from the values around it.
//!
//! The cost to come of a node x is the least, over the eight triangles of x with a neighbour A along an axis and the next one D along a
//! diagonal, of the way from a point y = A + t (D - A) plus the linear interpolation of the costs there:
//! u(x) = min over t of F(t) + (1 - t) u(A) + t u(D) (Sethian and Vladimirsky 2003). F(t) is a straight line through half the difference
//! of the ways there and back at t = 0 and 1, plus the root of the parabola through the squares of what is left at 0, 1/2 and 1. That is
//! exact for costs that are the same in all directions, an ellipse, or either with a slope or current added (a Randers metric), and
//! the least value is a closed form. Where the parabola does not bend that way, the least of the three ways themselves is taken.
//!
//! Triangles are taken by the side on which they lie, so that a line of nodes depends on the line before it alone: each line is
//! one loop without branches. Lines are taken from each of the four sides in turn until no value falls.

use super::table::{DIRECTIONS, DirectionTable};
#[cfg(target_arch = "x86_64")]
use bekker_scalar::{Arch, Avx2};

/// Nodes along a side.
pub(super) const SIDE: usize = 64;

/// With a node on either side.
pub(super) const WIDE: usize = SIDE + 2;

/// A cost must fall by this share for nodes that depend on it to be looked at again: rounding.
pub(super) const FALLS: f64 = 1e-9;

/// Costs beyond the grid.
pub(super) static BEYOND: [f32; DIRECTIONS] = [f32::INFINITY; DIRECTIONS];

/// Values of a tile, row by row.
pub(super) type Tile = [[f64; SIDE]; SIDE];

/// Values of a tile and the nodes around it.
pub(super) type Surrounded = [[f64; WIDE]; WIDE];

/// Values around a tile: of the row below and above, and of the column to the left and right.
pub(super) type Frame = [[f64; WIDE]; 4];

/// Where the k-th place of a side of a frame lies, as (column, row).
fn in_frame(side: usize, k: usize) -> [usize; 2] {
    [[k, 0], [k, WIDE - 1], [0, k], [WIDE - 1, k]][side]
}

/// The values around a tile.
pub(super) fn frame(values: &Surrounded) -> Frame {
    std::array::from_fn(|side| {
        std::array::from_fn(|k| {
            let [column, row] = in_frame(side, k);
            values[row][column]
        })
    })
}

/// Costs of a metre of a tile and around it in one direction, line by line.
type Metres = [[f32; WIDE]; WIDE];

/// The side from which ways lead to a node.
struct From {
    /// Directions of travel: from the diagonal neighbour of lower index, between, along the axis, between, from the other diagonal.
    ways: [usize; 5],
    /// Whether lines are columns.
    turned: bool,
    /// Whether the line before has the lower index.
    lower: bool,
}

const SIDES: [From; 4] = [
    From { ways: [2, 3, 4, 5, 6], turned: false, lower: true },
    From { ways: [2, 1, 0, 15, 14], turned: true, lower: true },
    From { ways: [14, 13, 12, 11, 10], turned: false, lower: false },
    From { ways: [6, 7, 8, 9, 10], turned: true, lower: false },
];

/// Costs of the five ways to the nodes of a line, and half of what the first, third and fifth cost more than the way back.
type Ways = [[f32; SIDE]; 8];

/// A triangle's ways: along the axis, between and along the diagonal, and half of what the first and last cost more than the way back.
pub(super) type Triangle = ([f32; 3], [f32; 2]);

/// Memory of a thread.
pub(super) struct Scratch {
    /// Costs of a metre for each side and way, line by line.
    metres: Vec<Metres>,
    /// Costs of ways for each side, line by line.
    ways: Vec<[Ways; SIDE]>,
    upright: Box<Surrounded>,
    turned: Box<Surrounded>,
}

impl Scratch {
    pub fn new() -> Self {
        Self {
            metres: vec![[[f32::INFINITY; WIDE]; WIDE]; 20],
            ways: vec![[[[0.0; SIDE]; 8]; SIDE]; 4],
            upright: Box::new([[f64::INFINITY; WIDE]; WIDE]),
            turned: Box::new([[f64::INFINITY; WIDE]; WIDE]),
        }
    }
}

/// Solves tile (column, row) of a table; `values` of it and around it come in and go out. `before` is what was around it when it was solved
/// the last time: then only what follows from values that have fallen since is looked at. Compiled for AVX2 as well, which x86-64
/// processors may have, with the same operations and bits.
pub(super) fn solve(
    scratch: &mut Scratch,
    table: &DirectionTable,
    tile: [usize; 2],
    values: &mut Box<Surrounded>,
    before: Option<&Frame>,
) {
    #[cfg(target_arch = "x86_64")]
    if Avx2::there() {
        return Avx2::wide(
            #[inline(always)]
            || solve_here(scratch, table, tile, values, before),
        );
    }
    solve_here(scratch, table, tile, values, before);
}

#[inline(always)]
fn solve_here(
    scratch: &mut Scratch,
    table: &DirectionTable,
    tile: [usize; 2],
    values: &mut Box<Surrounded>,
    before: Option<&Frame>,
) {
    spread(&mut scratch.metres, table, tile);
    for (k, (side, ways)) in SIDES.iter().zip(&mut scratch.ways).enumerate() {
        let metres = |k: usize| &scratch.metres[5 * k..5 * k + 5];
        price(side, metres(k), metres((k + 2) % 4), table.grid().cell, ways);
    }
    std::mem::swap(&mut scratch.upright, values);
    relax(scratch, before);
    std::mem::swap(&mut scratch.upright, values);
}

/// Lays the table's costs out by side, way and line.
#[inline(always)]
fn spread(metres: &mut [Metres], table: &DirectionTable, tile: [usize; 2]) {
    /// Rows that are read together, so that lines of columns are written in the first cache.
    const TOGETHER: usize = 11;
    let grid = table.grid();
    // Node -1 of the grid wraps to one that is beyond it too.
    let node = |column: usize, row: usize| {
        let (column, row) = ((tile[0] * SIDE + column).wrapping_sub(1), (tile[1] * SIDE + row).wrapping_sub(1));
        let inside = column < grid.columns && row < grid.rows;
        if inside { &table.costs()[row * grid.columns + column] } else { &BEYOND }
    };
    let Ok(planes) = <&mut [Metres; 20]>::try_from(metres) else { return };
    for first in (0..WIDE).step_by(TOGETHER) {
        for column in 0..WIDE {
            for row in first..first + TOGETHER {
                let costs = node(column, row);
                for (k, side) in SIDES.iter().enumerate() {
                    let [line, place] = if side.turned { [column, row] } else { [row, column] };
                    for (j, way) in side.ways.into_iter().enumerate() {
                        planes[5 * k + j][line][place] = costs[way];
                    }
                }
            }
        }
    }
}

/// Costs of the ways from one side by the trapezoid rule. The ways back are those of the opposite side, in opposite order.
#[inline(always)]
fn price(side: &From, metres: &[Metres], back: &[Metres], cell: f64, ways: &mut [Ways; SIDE]) {
    let [straight, between, diagonal] = halves(cell);
    for (line, ways) in ways.iter_mut().enumerate() {
        let before = if side.lower { line } else { line + 2 };
        let [first, after_first, axis, before_last, last, odd @ ..] = ways;
        for (j, length, way) in [(0, diagonal, first), (2, straight, axis), (4, diagonal, last)] {
            let ends = |metres: &Metres, p: usize| length * (metres[line + 1][p + 1] + metres[before][p + j / 2]);
            for p in 0..SIDE {
                way[p] = ends(&metres[j], p);
                odd[j / 2][p] = half_more(way[p], ends(&back[4 - j], p));
            }
        }
        for (j, way) in [(1, after_first), (3, before_last)] {
            let (here, there) = (&metres[j][line + 1], &metres[j][before]);
            for p in 0..SIDE {
                way[p] = between * (here[p + 1] + 0.5 * (there[p + j / 2] + there[p + j / 2 + 1]));
            }
        }
    }
}

/// Half of what a way costs more than the way back; 0 where one of them cannot be passed.
#[inline(always)]
fn half_more(way: f32, back: f32) -> f32 {
    let more = 0.5 * (way - back);
    if more.abs() < f32::INFINITY { more } else { 0.0 }
}

/// Half the lengths of a way along an axis, between and along a diagonal.
fn halves(cell: f64) -> [f32; 3] {
    [1.0_f64, 1.25, 2.0].map(|square| (0.5 * cell * square.sqrt()) as f32)
}

/// One triangle: ways along the axis, between and along the diagonal in these directions, from the costs at the node, its neighbour along
/// the axis and that along the diagonal.
pub(super) fn priced(cell: f64, ways: [usize; 3], [here, axis, diagonal]: [&[f32; DIRECTIONS]; 3]) -> Triangle {
    let half = halves(cell);
    let back = ways.map(|way| (way + DIRECTIONS / 2) % DIRECTIONS);
    let along = |way: usize| half[0] * (here[way] + axis[way]);
    let between = half[1] * (here[ways[1]] + 0.5 * (axis[ways[1]] + diagonal[ways[1]]));
    let across = |way: usize| half[2] * (here[way] + diagonal[way]);
    let (first, last) = (along(ways[0]), across(ways[2]));
    ([first, between, last], [half_more(first, along(back[0])), half_more(last, across(back[2]))])
}

/// Which lines have fallen when, so that none is looked at twice for the same values.
struct Clock {
    now: u32,
    /// When a row or column has fallen.
    fallen: [[u32; WIDE]; 2],
    /// When a line was looked at from each side.
    looked: [[u32; WIDE]; 4],
}

impl Clock {
    /// All lines with a value have fallen; where the tile was solved `before` with these values around it, those with one around it that is
    /// less now.
    fn new(values: &Surrounded, before: Option<&Frame>) -> Self {
        let mut fallen = [[0; WIDE]; 2];
        if let Some(before) = before {
            for (side, old) in before.iter().enumerate() {
                for (k, old) in old.iter().enumerate() {
                    let [column, row] = in_frame(side, k);
                    if values[row][column] < *old {
                        (fallen[0][row], fallen[1][column]) = (1, 1);
                    }
                }
            }
        } else {
            for (row, line) in values.iter().enumerate() {
                for (column, value) in line.iter().enumerate() {
                    if value.is_finite() {
                        (fallen[0][row], fallen[1][column]) = (1, 1);
                    }
                }
            }
        }
        Self { now: 1, fallen, looked: [[0; WIDE]; 4] }
    }
}

/// Takes lines from each side in turn until none has fallen in four.
#[inline(always)]
fn relax(scratch: &mut Scratch, before: Option<&Frame>) {
    let mut clock = Clock::new(&scratch.upright, before);
    let (mut quiet, mut is_turned) = (0, false);
    for k in (0..4).cycle() {
        if quiet == 4 {
            break;
        }
        let side = &SIDES[k];
        match (is_turned, side.turned) {
            (false, true) => turn(&scratch.upright, &mut scratch.turned),
            (true, false) => turn(&scratch.turned, &mut scratch.upright),
            _ => {}
        }
        is_turned = side.turned;
        let values = if is_turned { &mut scratch.turned } else { &mut scratch.upright };
        quiet = if sweep(k, &scratch.ways[k], values, &mut clock) { 0 } else { quiet + 1 };
    }
    if is_turned {
        turn(&scratch.turned, &mut scratch.upright);
    }
}

/// Takes all lines from one side; whether any has fallen.
#[inline(always)]
fn sweep(side: usize, ways: &[Ways; SIDE], values: &mut Surrounded, clock: &mut Clock) -> bool {
    let From { turned, lower, .. } = SIDES[side];
    let (along, across) = (usize::from(turned), usize::from(!turned));
    clock.now += 1;
    let mut gains = [0.0; SIDE];
    for step in 1..=SIDE {
        let (line, before) = if lower { (step, step - 1) } else { (WIDE - 1 - step, WIDE - step) };
        if clock.fallen[along][before] <= clock.looked[side][line] {
            continue;
        }
        clock.looked[side][line] = clock.now;
        let from = values[before];
        if may_fall(&from, &values[line]) && fall(&ways[line - 1], &from, &mut values[line], &mut gains) {
            clock.fallen[along][line] = clock.now;
        }
    }
    for (fallen, gain) in clock.fallen[across][1..].iter_mut().zip(gains) {
        if gain > 0.0 {
            *fallen = clock.now;
        }
    }
    gains.iter().any(|gain| *gain > 0.0)
}

/// Whether any value of a line is above one that it can come from.
#[inline(always)]
fn may_fall(from: &[f64; WIDE], here: &[f64; WIDE]) -> bool {
    let above = |p: usize| u32::from(smaller(smaller(from[p], from[p + 2]), from[p + 1]) < here[p + 1]);
    (0..SIDE).map(above).sum::<u32>() > 0
}

/// Puts every value of a line to the least over its two triangles on one side; whether any has fallen. `gains` keeps the largest fall
/// of each beyond rounding.
#[inline(always)]
fn fall(ways: &Ways, from: &[f64; WIDE], here: &mut [f64; WIDE], gains: &mut [f64; SIDE]) -> bool {
    let [first, after_first, axis, before_last, last, odd_first, odd_axis, odd_last] = ways;
    let mut fallen = 0;
    for p in 0..SIDE {
        let (low, middle, high) = (from[p], from[p + 1], from[p + 2]);
        let one = least(([axis[p], after_first[p], first[p]], [odd_axis[p], odd_first[p]]), middle, low);
        let other = least(([axis[p], before_last[p], last[p]], [odd_axis[p], odd_last[p]]), middle, high);
        let best = smaller(one, other);
        let old = here[p + 1];
        here[p + 1] = smaller(best, old);
        let gain = old * (1.0 - FALLS) - best;
        gains[p] = if gain > gains[p] { gain } else { gains[p] };
        fallen += u32::from(gain > 0.0);
    }
    fallen > 0
}

/// The smaller one; `b` where `a` is no number.
#[inline(always)]
pub(super) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Least cost over a triangle from the costs to come at its axis and diagonal neighbours.
#[inline(always)]
pub(super) fn least(([axis, middle, diagonal], odd): Triangle, at_axis: f64, at_diagonal: f64) -> f64 {
    // F(t) + (1 - t) u(A) + t u(D) = u(A) + odd(0) + d t + E(t), E(t)^2 = alpha t^2 + beta t + E(0)^2.
    let d = (at_diagonal - at_axis) as f32 + (odd[1] - odd[0]);
    let (e0, e1, e2) = (axis - odd[0], middle - 0.5 * (odd[0] + odd[1]), diagonal - odd[1]);
    let (q0, q1, q2) = (e0 * e0, e1 * e1, e2 * e2);
    let (alpha, beta) = (2.0 * (q0 - 2.0 * q1 + q2), 4.0 * q1 - 3.0 * q0 - q2);
    let discriminant = alpha * q0 - 0.25 * beta * beta;
    // The derivative d + E'(t) is negative at 0 and positive at 1.
    let inside =
        (alpha > 0.0) & (discriminant > 0.0) & (beta + 2.0 * d * e0 < 0.0) & (2.0 * alpha + beta + 2.0 * d * e2 > 0.0);
    let way = odd[0] + (discriminant.sqrt() * (alpha - d * d).sqrt() - 0.5 * beta * d) / alpha;
    let way = if inside { way } else { f32::INFINITY };
    let nodes = smaller(at_axis + f64::from(axis), at_diagonal + f64::from(diagonal));
    let straight = smaller(0.5 * (at_axis + at_diagonal) + f64::from(middle), nodes);
    // A curve between three ways that cost nearly nothing can fall below nothing.
    let through = at_axis + f64::from(way);
    let lowest = smaller(at_axis, at_diagonal);
    let through = if through < lowest { lowest } else { through };
    // A neighbour that cannot be come from makes no number of it.
    smaller(through, straight)
}

/// Rows to columns.
#[inline(always)]
fn turn(from: &Surrounded, to: &mut Surrounded) {
    /// A divisor of the width, so that few cache lines are written at a time.
    const TOGETHER: usize = 6;
    for first in (0..WIDE).step_by(TOGETHER) {
        for (row, line) in from.iter().enumerate() {
            for column in first..first + TOGETHER {
                to[column][row] = line[column];
            }
        }
    }
}
