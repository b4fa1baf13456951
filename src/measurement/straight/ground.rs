//! The ground under a stretch, from heights that were recorded or read off a map along the way.

use super::super::table::Table;
use std::ops::Range;

/// Distance between two points of the ground, m: heights within it are averaged.
const SPACING: f64 = 0.25;

/// Points at an end of the ground whose slope goes on beyond it.
const AT_END: usize = 4;

/// How far it goes on, m, and besides as a share of its length: wheels stand before and behind the middle of a rover, and a model that
/// slips less than the vehicle gets farther.
const BEYOND: f64 = 5.0;
const BEYOND_OF_LENGTH: f64 = 0.5;

/// Columns `x` and `z` of the ground, which is level where only one point of it is known; `None` where none is.
pub(super) fn under(x: &[f64], height: &[f64], rows: Range<usize>) -> Option<Table> {
    let present: Vec<(f64, f64)> =
        rows.map(|row| (x[row], height[row])).filter(|(x, z)| x.is_finite() && z.is_finite()).collect();
    let low = present.iter().map(|(x, _)| *x).fold(f64::INFINITY, f64::min);
    let bin = |x: f64| ((x - low) / SPACING) as usize;
    let mut bins: Vec<(f64, f64, f64)> = Vec::new();
    for (x, z) in present {
        let at = bin(x);
        bins.resize(bins.len().max(at + 1), (0.0, 0.0, 0.0));
        let (sum_x, sum_z, count) = bins[at];
        bins[at] = (sum_x + x, sum_z + z, count + 1.0);
    }
    let points: Vec<(f64, f64)> =
        bins.into_iter().filter(|(.., count)| *count > 0.0).map(|(x, z, count)| (x / count, z / count)).collect();
    let count = AT_END.min(points.len());
    if count == 0 {
        return None;
    }
    let first = slope(points[0], points[count - 1]);
    let last = slope(points[points.len() - count], points[points.len() - 1]);
    let (start, end) = (points[0], points[points.len() - 1]);
    let beyond = BEYOND + BEYOND_OF_LENGTH * (end.0 - start.0);
    let before = (start.0 - beyond, start.1 - beyond * first);
    let behind = (end.0 + beyond, end.1 + beyond * last);
    let mut table = Table::new(["x", "z"]).ok()?;
    for (x, z) in std::iter::once(before).chain(points).chain([behind]) {
        table.push(&[x, z]).ok()?;
    }
    Some(table)
}

fn slope(a: (f64, f64), b: (f64, f64)) -> f64 {
    if b.0 > a.0 { (b.1 - a.1) / (b.0 - a.0) } else { 0.0 }
}
