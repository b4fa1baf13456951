//! The ground between the nodes of a map: bilinear, or once continuously differentiable.

use super::ElevationMap;

/// How heights between nodes follow from those at the nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// Bilinear in a cell: continuous, with creases along the grid's lines.
    Bilinear,
    /// Bicubic Hermite with limited slopes: continuous first derivatives, and along every grid line no overshoot over the
    /// nodes (the slope at a node is the harmonic mean of those beside it, 0 at an extreme).
    #[default]
    Smooth,
}

/// Height and slopes at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Height, m.
    pub height: f64,
    /// Slope dz/dx.
    pub slope_x: f64,
    /// Slope dz/dy.
    pub slope_y: f64,
}

/// A map as a surface.
#[derive(Clone, Debug)]
pub struct Surface {
    map: ElevationMap,
    /// Slopes at the nodes times the spacing, (x, y); empty where bilinear.
    slopes: Vec<[f64; 2]>,
}

impl Surface {
    /// The surface over `map`.
    #[must_use]
    pub fn new(map: ElevationMap, interpolation: Interpolation) -> Self {
        let slopes = match interpolation {
            Interpolation::Bilinear => Vec::new(),
            Interpolation::Smooth => node_slopes(&map),
        };
        Self { map, slopes }
    }

    /// The map.
    #[must_use]
    pub fn map(&self) -> &ElevationMap {
        &self.map
    }

    /// How the surface runs between the nodes.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation {
        if self.slopes.is_empty() { Interpolation::Bilinear } else { Interpolation::Smooth }
    }

    /// Height and slopes at a place; `None` beyond the map and where a corner of the cell is a hole.
    #[must_use]
    pub fn at(&self, place: [f64; 2]) -> Option<Patch> {
        let (column, row, u, v) = self.cell_of(place)?;
        let patch =
            if self.slopes.is_empty() { self.bilinear(column, row, u, v) } else { self.hermite(column, row, u, v) };
        patch.height.is_finite().then_some(patch)
    }

    /// Height at a place, m.
    #[must_use]
    pub fn height(&self, place: [f64; 2]) -> Option<f64> {
        self.at(place).map(|patch| patch.height)
    }

    /// The cell of a place and the place in it, each from 0 to 1.
    fn cell_of(&self, place: [f64; 2]) -> Option<(usize, usize, f64, f64)> {
        let [u, v] = self.map.in_cells(place);
        let (last_u, last_v) = ((self.map.columns - 1) as f64, (self.map.rows - 1) as f64);
        if !(u >= 0.0 && v >= 0.0 && u <= last_u && v <= last_v) {
            return None;
        }
        let (column, row) = ((u as usize).min(self.map.columns - 2), (v as usize).min(self.map.rows - 2));
        Some((column, row, u - column as f64, v - row as f64))
    }

    fn bilinear(&self, column: usize, row: usize, u: f64, v: f64) -> Patch {
        let z = |dc: usize, dr: usize| self.map.heights[(row + dr) * self.map.columns + column + dc];
        let (south, north) = (z(1, 0) - z(0, 0), z(1, 1) - z(0, 1));
        let (west, east) = (z(0, 1) - z(0, 0), z(1, 1) - z(1, 0));
        let height = z(0, 0) + south * u + west * v + (north - south) * u * v;
        let cell = self.map.cell;
        Patch { height, slope_x: (south + (north - south) * v) / cell, slope_y: (west + (east - west) * u) / cell }
    }

    /// Bicubic Hermite patch with no twist at the nodes: cubic along x on the southern and northern side, blended along y.
    fn hermite(&self, column: usize, row: usize, u: f64, v: f64) -> Patch {
        let (hu, du) = basis(u);
        let (hv, dv) = basis(v);
        let (mut height, mut by_u, mut by_v) = (0.0, 0.0, 0.0);
        for (dr, dc) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let node = (row + dr) * self.map.columns + column + dc;
            let (z, [zx, zy]) = (self.map.heights[node], self.slopes[node]);
            let along_x = z * hu[dc] + zx * hu[2 + dc];
            height += along_x * hv[dr] + zy * hu[dc] * hv[2 + dr];
            by_u += (z * du[dc] + zx * du[2 + dc]) * hv[dr] + zy * du[dc] * hv[2 + dr];
            by_v += along_x * dv[dr] + zy * hu[dc] * dv[2 + dr];
        }
        Patch { height, slope_x: by_u / self.map.cell, slope_y: by_v / self.map.cell }
    }
}

/// Hermite's basis at t (values at 0 and 1, slopes at 0 and 1) and its derivatives.
fn basis(t: f64) -> ([f64; 4], [f64; 4]) {
    let (t2, t3) = (t * t, t * t * t);
    let one = 3.0 * t2 - 2.0 * t3;
    let d_one = 6.0 * (t - t2);
    ([1.0 - one, one, t - 2.0 * t2 + t3, t3 - t2], [-d_one, d_one, 1.0 - 4.0 * t + 3.0 * t2, 3.0 * t2 - 2.0 * t])
}

/// Limited slopes at all nodes, times the spacing. Beside a hole the slope is that of the side that is known.
fn node_slopes(map: &ElevationMap) -> Vec<[f64; 2]> {
    let z = |column: Option<usize>, row: Option<usize>| match (column, row) {
        (Some(column), Some(row)) => map.height(column, row),
        _ => f64::NAN,
    };
    let nodes = (0..map.rows).flat_map(|row| (0..map.columns).map(move |column| (column, row)));
    let slopes = nodes.map(|(column, row)| {
        let here = map.height(column, row);
        let x = limited(here - z(column.checked_sub(1), Some(row)), z(Some(column + 1), Some(row)) - here);
        let y = limited(here - z(Some(column), row.checked_sub(1)), z(Some(column), Some(row + 1)) - here);
        [x, y]
    });
    slopes.collect()
}

/// Harmonic mean of two slopes of one sign, else 0; the other one where one is unknown.
fn limited(before: f64, after: f64) -> f64 {
    match (before.is_nan(), after.is_nan()) {
        (true, true) => 0.0,
        (true, false) => after,
        (false, true) => before,
        (false, false) if before * after > 0.0 => 2.0 * before * after / (before + after),
        (false, false) => 0.0,
    }
}
