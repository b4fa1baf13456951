//! The ground along a path, which is made dearer to find another route.

use crate::map::ElevationMap;
use crate::robot::Robot;

/// Factor of costs within the corridor.
pub const DEARER: f64 = 3.0;
/// Share of a path that must lie outside of the corridor for another route.
pub const DIFFERENT: f64 = 0.3;
/// Half-width of the corridor as a share of the path's length; at least the rover's reach from its middle.
const WIDTH: f64 = 0.12;
/// Around start and goal, within this many half-widths, every path must pass.
const ENDS: f64 = 1.5;

/// Nodes near a path.
pub struct Corridor {
    marked: Vec<bool>,
    width: f64,
}

impl Corridor {
    /// The corridor of a path of two or more points (m).
    pub fn new(map: &ElevationMap, robot: &Robot, points: &[[f64; 2]]) -> Self {
        let reach = robot.wheels.iter().map(|wheel| wheel.centre[0].hypot(wheel.centre[1])).fold(0.0, f64::max);
        let far = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let length: f64 = points.windows(2).map(|pair| far(pair[0], pair[1])).sum();
        let width = reach.max(WIDTH * length);
        let mut marked = vec![false; map.columns() * map.rows()];
        let mut last: Option<[f64; 2]> = None;
        for &point in points {
            // Discs a quarter of the half-width apart cover the corridor but for notches of a percent.
            if last.is_none_or(|last| far(last, point) > 0.25 * width) {
                mark(&mut marked, map, point, width, true);
                last = Some(point);
            }
        }
        for end in [points.first(), points.last()].into_iter().flatten() {
            mark(&mut marked, map, *end, ENDS * width, false);
        }
        Self { marked, width }
    }

    /// Which nodes lie within it.
    pub fn marked(&self) -> &[bool] {
        &self.marked
    }

    /// Its half-width, m.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Share of the points of a path between its ends that lie outside.
    pub fn outside(&self, map: &ElevationMap, points: &[[f64; 2]]) -> f64 {
        let (Some(start), Some(goal)) = (points.first(), points.last()) else { return 0.0 };
        let near = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) <= ENDS * self.width;
        let between: Vec<&[f64; 2]> = points.iter().filter(|at| !near(at, start) && !near(at, goal)).collect();
        let inside =
            |at: &&&[f64; 2]| map.nearest(***at).is_some_and(|(column, row)| self.marked[row * map.columns() + column]);
        1.0 - between.iter().filter(inside).count() as f64 / between.len().max(1) as f64
    }
}

/// Marks the nodes within `radius` (m) of a place.
fn mark(marked: &mut [bool], map: &ElevationMap, place: [f64; 2], radius: f64, value: bool) {
    let [u, v] = [0, 1].map(|axis| (place[axis] - map.origin()[axis]) / map.cell());
    let far = radius / map.cell();
    let nodes =
        |at: f64, count: usize| ((at - far).ceil().max(0.0) as usize)..((at + far).floor() as usize + 1).min(count);
    for row in nodes(v, map.rows()) {
        for column in nodes(u, map.columns()) {
            if (column as f64 - u).hypot(row as f64 - v) <= far {
                marked[row * map.columns() + column] = value;
            }
        }
    }
}
