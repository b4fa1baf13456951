//! The cheapest path from an arrival field, and the cost of a path.

use super::{ArrivalField, DirectionalCost};
use std::f64::consts::TAU;

/// Directions that are tried at a point of the path, before the best is refined.
const DIRECTIONS: usize = 64;

/// Halvings of the angle between directions.
const REFINED: usize = 6;

/// Length of a step, in spacings: longer than a cell, so that the interpolation's facets do not steer it.
const STEP: f64 = 1.5;

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

/// The cheapest path from the field's start to `goal` (m), traced back from the goal: each step is taken from where the cost to come
/// plus that of the step is least. `None` where the goal is out of reach, or where the trace stops coming nearer to the start, as it can
/// between places that cannot be passed, a cell or two apart.
#[must_use]
pub fn path_from(field: &ArrivalField, cost: &impl DirectionalCost, goal: [f64; 2]) -> Option<AnyAnglePath> {
    if !field.at(goal).is_finite() {
        return None;
    }
    let step = STEP * field.cell;
    let mut points = vec![goal];
    let mut here = goal;
    let far = |at: [f64; 2]| (at[0] - field.start[0]).hypot(at[1] - field.start[1]);
    // A path that does not run in circles passes no cell twice.
    for _ in 0..field.columns * field.rows {
        if far(here) <= 2.0 * step {
            break;
        }
        let value = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let from = [here[0] - step * cos, here[1] - step * sin];
            // In pieces as short as those that the path is judged by, so that no step cuts a corner of a wall.
            field.at(from) + path_cost(cost, &[from, here], 0.5 * field.cell)
        };
        let tried = (0..DIRECTIONS).map(|k| k as f64 * TAU / DIRECTIONS as f64);
        let (mut least, mut angle) = tried.map(|a| (value(a), a)).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let mut turn = TAU / DIRECTIONS as f64;
        for _ in 0..REFINED {
            turn *= 0.5;
            for other in [angle - turn, angle + turn] {
                let there = value(other);
                if there < least {
                    (least, angle) = (there, other);
                }
            }
        }
        if !least.is_finite() {
            return None;
        }
        let next = [here[0] - step * angle.cos(), here[1] - step * angle.sin()];
        // A trace that does not come nearer to the start would run in circles.
        if field.at(next) >= field.at(here) {
            return None;
        }
        here = next;
        points.push(here);
    }
    points.push(field.start);
    points.reverse();
    let length = points.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).sum();
    let cost = path_cost(cost, &points, 0.5 * field.cell);
    Some(AnyAnglePath { points, cost, length })
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
