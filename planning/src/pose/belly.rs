//! Distance of the body from the ground.

use super::{PoseError, Violation};
use crate::map::Surface;
use crate::robot::{Belly, Frames, Robot};
use nalgebra::{Matrix2, Vector2, Vector3};

/// Smallest vertical distance of the belly from the ground (m), and the violation where it is negative. It is looked at over every
/// node of the map, where the ground has its peaks, and in between in steps of at most half a spacing.
pub fn clearance(robot: &Robot, surface: &Surface, frames: &Frames) -> Result<(f64, Option<Violation>), PoseError> {
    let Some(belly) = robot.belly else { return Ok((f64::INFINITY, None)) };
    let mut lowest = (f64::INFINITY, Vector3::zeros());
    for at in between(&belly, surface, frames).chain(over_nodes(&belly, surface, frames)) {
        let Some(ground) = surface.height([at.x, at.y]) else {
            return Err(PoseError::Unknown { part: "belly".to_owned(), x: at.x, y: at.y });
        };
        if at.z - ground < lowest.0 {
            lowest = (at.z - ground, at);
        }
    }
    let (clearance, at) = lowest;
    Ok((clearance, (clearance < 0.0).then_some(Violation::Belly { x: at.x, y: at.y, depth: -clearance })))
}

/// Points of the belly on a regular grid of its own.
fn between(belly: &Belly, surface: &Surface, frames: &Frames) -> impl Iterator<Item = Vector3<f64>> {
    let step = 0.5 * surface.map().cell();
    let (length, width) = (belly.front - belly.rear, 2.0 * belly.half_width);
    let [along, across] = [length, width].map(|side| (side / step).ceil().max(1.0) as usize);
    let steps = (0..=along).flat_map(move |i| (0..=across).map(move |j| (i, j)));
    steps.map(move |(i, j)| {
        let x = belly.rear + length * i as f64 / along as f64;
        frames.point(None, [x, width * (j as f64 / across as f64 - 0.5), belly.z])
    })
}

/// Points of the belly over nodes of the map.
fn over_nodes(belly: &Belly, surface: &Surface, frames: &Frames) -> impl Iterator<Item = Vector3<f64>> {
    let corner = |x: f64, y: f64| frames.point(None, [x, y, belly.z]);
    let origin = corner(0.0, 0.0);
    let (u, v) = (corner(1.0, 0.0) - origin, corner(0.0, 1.0) - origin);
    let plan = Matrix2::new(u.x, v.x, u.y, v.y).try_inverse();
    let map = surface.map();
    let sides = [(belly.rear, -1.0), (belly.rear, 1.0), (belly.front, -1.0), (belly.front, 1.0)];
    let corners = sides.map(|(x, side)| {
        let at = corner(x, side * belly.half_width);
        map.in_cells([at.x, at.y])
    });
    let ends = |k: usize, count: usize| {
        let (low, high) = corners.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), c| (l.min(c[k]), h.max(c[k])));
        (low.ceil().max(0.0) as usize)..(high.floor() as usize + 1).min(count)
    };
    let (columns, rows) = (ends(0, map.columns()), ends(1, map.rows()));
    let nodes = rows.flat_map(move |row| columns.clone().map(move |column| (column, row)));
    nodes.filter_map(move |(column, row)| {
        let [x, y] = map.place(column, row);
        let inside = plan? * Vector2::new(x - origin.x, y - origin.y);
        let within = (belly.rear..=belly.front).contains(&inside.x) && inside.y.abs() <= belly.half_width;
        within.then(|| corner(inside.x, inside.y))
    })
}
