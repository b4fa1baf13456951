//! The performance index (3.1)-(3.5).

use super::{HEADINGS, Stand, step_length};
use crate::map::ElevationMap;
use crate::robot::Robot;
use bekker_modeldescription::{Unit, parameters};
use std::f64::consts::FRAC_PI_4;

/// Footprints of headings that differ by half a turn are the same.
const ORIENTATIONS: usize = HEADINGS / 2;

/// Rounding of node places against the footprint's sides, in spacings.
const ON_THE_EDGE: f64 = 1e-9;

parameters! {
    /// Weights of the performance index (3.5).
    pub struct PerformanceIndex {
        /// Weight k_1 of the roughness.
        roughness: [Unit::ONE] = 5.0, 0.0..=1e6, Fixed, "Iagnemma 2001, 3.3";
        /// Weight k_2 of turning.
        turning: [Unit::ONE] = 0.1, 0.0..=1e6, Fixed, "Iagnemma 2001, 3.3";
        /// Weight k_3 of length.
        length: [Unit::ONE] = 0.1, 1e-9..=1e6, Fixed, "Iagnemma 2001, 3.3";
        /// Exponent alpha of (3.2) and (3.3).
        exponent: [Unit::ONE] = 3.0, 0.1..=20.0, Fixed, "Iagnemma 2001, 3.3";
    }
}

/// The index of every node of a map and heading.
#[derive(Clone, Debug)]
pub struct CostField {
    columns: usize,
    rows: usize,
    /// k_1 r' of (3.2) by orientation, node; infinite where the footprint reaches unknown ground.
    roughness: Vec<f32>,
    /// k_2 t of (3.3) by node.
    turning: Vec<f32>,
    /// k_3 l of a straight step (3.4).
    step: f64,
}

impl CostField {
    /// Computes it for a robot: the footprint is the convex hull of the wheels on flat ground.
    #[must_use]
    pub fn new(map: &ElevationMap, robot: &Robot, index: &PerformanceIndex) -> Self {
        let mut roughness = Vec::new();
        for nodes in footprints(map, robot) {
            // (3.1)-(3.2)
            roughness.extend(deviations(map, &nodes, 1).map(|d| index.scaled(index.roughness, d, robot)));
        }
        // (3.3): the circle through the farthest wheel.
        let reach = reach(robot);
        let nodes = nodes_where(reach, map.cell(), |[x, y]| x.hypot(y) <= reach + ON_THE_EDGE * map.cell());
        let turning = deviations(map, &nodes, 1).map(|d| index.scaled(index.turning, d, robot)).collect();
        Self { columns: map.columns(), rows: map.rows(), roughness, turning, step: index.straight(map, robot) }
    }

    /// Cost of a straight step at every `stride`-th node, the mean over the headings; infinite where the footprint reaches unknown ground.
    #[must_use]
    pub fn means(map: &ElevationMap, robot: &Robot, index: &PerformanceIndex, stride: usize) -> Vec<f64> {
        let footprints = footprints(map, robot);
        let share = 1.0 / footprints.len() as f64;
        let mut means = vec![index.straight(map, robot); map.columns().div_ceil(stride) * map.rows().div_ceil(stride)];
        for nodes in &footprints {
            let costs = deviations(map, nodes, stride).map(|d| f64::from(index.scaled(index.roughness, d, robot)));
            means.iter_mut().zip(costs).for_each(|(mean, cost)| *mean += share * cost);
        }
        means
    }

    /// Cost of a step that leaves `from` in `heading` and arrives at `to`: k_1 r' at the new node (counted by the step's length,
    /// so that a diagonal is worth its 1.4 nodes), k_2 t at the old one where the heading changes, and k_3 l.
    #[must_use]
    pub fn step(&self, from: Stand, to: Stand) -> f64 {
        let turn = if from.heading == to.heading { 0.0 } else { f64::from(self.turning[self.node(from)]) };
        let length = step_length(to.heading);
        turn + length * (self.roughness_at(to) + self.step)
    }

    /// Index of a path of straight ways (m), taken at the nodes and headings nearest to its points, a step apart; `heading` (rad) is that
    /// before the first, any where missing. Of a path over nodes it is the sum of [`step`](Self::step).
    #[must_use]
    pub fn along(&self, map: &ElevationMap, points: &[[f64; 2]], heading: Option<f64>) -> f64 {
        let eighth = |angle: f64| (angle / FRAC_PI_4).round().rem_euclid(HEADINGS as f64) as usize;
        let stand =
            |place: [f64; 2], heading: usize| map.nearest(place).map(|(column, row)| Stand { column, row, heading });
        let (mut total, mut heading) = (0.0, heading.map(eighth));
        for pair in points.windows(2) {
            let [dx, dy] = [0, 1].map(|axis| (pair[1][axis] - pair[0][axis]) / map.cell());
            let length = dx.hypot(dy);
            if length < ON_THE_EDGE {
                continue;
            }
            let ahead = eighth(dy.atan2(dx));
            let turns = heading.replace(ahead).is_some_and(|before| before != ahead);
            let turn = stand(pair[0], ahead).filter(|_| turns).map_or(0.0, |at| f64::from(self.turning[self.node(at)]));
            // A diagonal step is one piece.
            let count = (length / std::f64::consts::SQRT_2 - ON_THE_EDGE).ceil().max(1.0);
            let at = |k: usize| [0, 1].map(|axis| pair[0][axis] + (pair[1][axis] - pair[0][axis]) * k as f64 / count);
            let pieces = (1..=count as usize).map(|k| {
                let roughness = stand(at(k), ahead).map_or(f64::INFINITY, |stand| self.roughness_at(stand));
                length / count * (roughness + self.step)
            });
            total += turn + pieces.sum::<f64>();
        }
        total
    }

    /// Multiplies roughness and length of the nodes that are marked.
    #[must_use]
    pub fn raised(mut self, marked: &[bool], factor: f64) -> Self {
        let more = (factor - 1.0) * self.step;
        for (roughness, _) in self.roughness.iter_mut().zip(marked.iter().cycle()).filter(|(_, marked)| **marked) {
            *roughness = (f64::from(*roughness) * factor + more) as f32;
        }
        self
    }

    /// Least cost of the way over this many columns and rows: only length.
    pub(super) fn least(&self, columns: usize, rows: usize) -> f64 {
        let (long, short) = (columns.max(rows) as f64, columns.min(rows) as f64);
        self.step * (long + (std::f64::consts::SQRT_2 - 1.0) * short)
    }

    /// k_1 r' of a stand; infinite over unknown ground.
    #[must_use]
    pub fn roughness_at(&self, stand: Stand) -> f64 {
        let orientation = stand.heading % ORIENTATIONS;
        f64::from(self.roughness[orientation * self.columns * self.rows + self.node(stand)])
    }

    pub(super) fn node(&self, stand: Stand) -> usize {
        stand.row * self.columns + stand.column
    }

    pub(super) fn size(&self) -> (usize, usize) {
        (self.columns, self.rows)
    }

    /// Bytes that the field holds.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&self.roughness[..]) + size_of_val(&self.turning[..])
    }
}

impl PerformanceIndex {
    /// A weighted power of a deviation (m) over the wheel's diameter, (3.2) and (3.3). Unknown ground stays out of reach whatever the weight.
    fn scaled(&self, weight: f64, deviation: f64, robot: &Robot) -> f32 {
        if deviation.is_finite() {
            (weight * (deviation / (2.0 * robot.wheel_radius)).powf(self.exponent)) as f32
        } else {
            f32::INFINITY
        }
    }

    /// k_3 l of a straight step (3.4).
    fn straight(&self, map: &ElevationMap, robot: &Robot) -> f64 {
        self.length * map.cell() / (2.0 * robot.wheel_radius)
    }
}

/// Distance of the farthest wheel from the robot's middle, m.
fn reach(robot: &Robot) -> f64 {
    robot.wheels.iter().map(|wheel| wheel.centre[0].hypot(wheel.centre[1])).fold(0.0, f64::max)
}

/// Nodes under the footprint by orientation, as steps of columns and rows.
fn footprints(map: &ElevationMap, robot: &Robot) -> [Vec<(isize, isize)>; ORIENTATIONS] {
    let hull = hull(robot.wheels.iter().map(|wheel| [wheel.centre[0], wheel.centre[1]]).collect());
    std::array::from_fn(|orientation| {
        let (sin, cos) = (orientation as f64 * FRAC_PI_4).sin_cos();
        let turned: Vec<[f64; 2]> = hull.iter().map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]).collect();
        nodes_where(reach(robot), map.cell(), |place| inside(&turned, place, map.cell()))
    })
}

/// Nodes within `reach` of a node that lie where `wanted` says, as steps of columns and rows.
fn nodes_where(reach: f64, cell: f64, wanted: impl Fn([f64; 2]) -> bool) -> Vec<(isize, isize)> {
    let far = (reach / cell).ceil() as isize;
    let all = (-far..=far).flat_map(|row| (-far..=far).map(move |column| (column, row)));
    all.filter(|(column, row)| wanted([*column as f64 * cell, *row as f64 * cell])).collect()
}

/// Standard deviation of the heights of `nodes` around every `stride`-th node; infinite where one is unknown.
fn deviations<'a>(map: &'a ElevationMap, nodes: &'a [(isize, isize)], stride: usize) -> impl Iterator<Item = f64> + 'a {
    let rows = (0..map.rows()).step_by(stride);
    let all = rows.flat_map(move |row| (0..map.columns()).step_by(stride).map(move |column| (column, row)));
    all.map(move |(column, row)| {
        let here = map.height(column, row);
        let (mut sum, mut squares) = (0.0, 0.0);
        for (dc, dr) in nodes {
            let z = match (column.checked_add_signed(*dc), row.checked_add_signed(*dr)) {
                (Some(column), Some(row)) => map.height(column, row) - here,
                _ => f64::NAN,
            };
            sum += z;
            squares += z * z;
        }
        let count = nodes.len() as f64;
        let variance = squares / count - (sum / count).powi(2);
        if variance.is_nan() { f64::INFINITY } else { variance.max(0.0).sqrt() }
    })
}

/// Convex hull, counter-clockwise.
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while chain.len() >= 2 && turn(chain[chain.len() - 2], chain[chain.len() - 1], point) <= 0.0 {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut points.iter().copied());
    hull.extend(half(&mut points.iter().rev().copied()));
    hull
}

/// Twice the area of a triangle, positive where it turns left.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn inside(hull: &[[f64; 2]], place: [f64; 2], cell: f64) -> bool {
    (0..hull.len()).all(|k| turn(hull[k], hull[(k + 1) % hull.len()], place) >= -ON_THE_EDGE * cell * cell)
}
