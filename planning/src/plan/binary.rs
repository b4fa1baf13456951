//! The conventional planner of section 3.3: the shortest path that avoids obstacles, cells with a step to a neighbour.

use super::index::{CostField, PerformanceIndex};
use super::search::{Task, search};
use super::{HEADINGS, Stand};
use crate::map::ElevationMap;
use crate::robot::Robot;
use std::collections::HashMap;

/// A path of the binary planner.
#[derive(Clone, Debug, PartialEq)]
pub struct BinaryPath {
    /// Stands from start to goal.
    pub stands: Vec<Stand>,
    /// Length, m.
    pub length: f64,
}

/// Which nodes are obstacles: those whose largest step to one of the eight neighbours exceeds `height` (m). Holes are obstacles.
#[must_use]
pub fn obstacles(map: &ElevationMap, height: f64) -> Vec<bool> {
    let nodes = (0..map.rows()).flat_map(|row| (0..map.columns()).map(move |column| (column, row)));
    let obstacle = |(column, row)| {
        let here = map.height(column, row);
        here.is_nan() || map.neighbours(column, row).iter().any(|z| (z - here).abs() > height)
    };
    nodes.map(obstacle).collect()
}

/// Obstacles for each area of the robot's footprint (length between the outermost wheels times track).
#[must_use]
pub fn obstacle_density(map: &ElevationMap, robot: &Robot, height: f64) -> f64 {
    let count = obstacles(map, height).iter().filter(|obstacle| **obstacle).count();
    let side = |k: usize| {
        let places = robot.wheels.iter().map(|wheel| wheel.centre[k]);
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    let area = map.heights().len() as f64 * map.cell() * map.cell();
    count as f64 * side(0) * side(1) / area
}

/// The shortest path from node to node over no obstacle; `None` where there is none. The rover's size is not looked at, as in the
/// thesis; its footprint must stay on the map.
#[must_use]
pub fn binary_path(
    map: &ElevationMap,
    robot: &Robot,
    height: f64,
    start: (usize, usize),
    goal: (usize, usize),
) -> Option<BinaryPath> {
    let index = PerformanceIndex { roughness: 0.0, turning: 0.0, ..PerformanceIndex::default() };
    let field = CostField::new(map, robot, &index);
    let blocked = obstacles(map, height);
    let at = |node: (usize, usize)| blocked[node.1 * map.columns() + node.0];
    if at(start) || at(goal) {
        return None;
    }
    let stands = blocked.iter().enumerate().filter(|(_, blocked)| **blocked).flat_map(|(node, _)| {
        let (column, row) = (node % map.columns(), node / map.columns());
        (0..HEADINGS).map(move |heading| (Stand { column, row, heading }, f64::INFINITY))
    });
    let raised: HashMap<Stand, f64> = stands.collect();
    let start = Stand { column: start.0, row: start.1, heading: 0 };
    let found = search(&Task { field: &field, start, any_heading: true, goal, raised: &raised }, |_| true);
    let step = |pair: &[Stand]| {
        let (dc, dr) = (pair[0].column.abs_diff(pair[1].column), pair[0].row.abs_diff(pair[1].row));
        (dc as f64).hypot(dr as f64) * map.cell()
    };
    let length = found.path.windows(2).map(step).sum();
    found.reached.then_some(BinaryPath { stands: found.path, length })
}
