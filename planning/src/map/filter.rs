//! Uncertainty of a range sensor over the map, (3.13)-(3.15), and the filter (3.18).

use super::{ElevationMap, MapError};
use bekker_modeldescription::{Unit, parameters};

/// The filter's window reaches this many standard deviations to each side: what is left out weighs 4.6 % in all before the
/// weights are normalised. The thesis takes "approximately twice sigma_z".
const WINDOW: f64 = 2.0;

parameters! {
    /// Error of the sensor that measured the map, as it grows with range.
    pub struct RangeError {
        /// Random part: standard deviation over range squared, sigma_r of (3.13).
        random: [Unit::PER_METRE] = 0.0, 0.0..=1.0, Fixed, "calibration of the sensor; 0 is a perfect one";
        /// Systematic part: error over range, K_s of (3.14), in rad.
        systematic: [Unit::RADIAN] = 0.0, 0.0..=1.0, Fixed, "calibration of the sensor; 0 is a perfect one";
    }
}

impl RangeError {
    /// Standard deviation of a point's place at a range Z (m): sigma_z = Z (sigma_r Z + K_s), m. (3.15)
    #[must_use]
    pub fn deviation(&self, range: f64) -> f64 {
        range * (self.random * range + self.systematic)
    }
}

/// The map as seen from `sensor` (m): every height is the mean of those around it, weighted by a Gaussian whose standard
/// deviation is the sensor's error at that range (3.18). The weights are normalised, which (3.18) as printed is not: without
/// that the filter would change the heights of level ground. Holes have no weight, and stay holes.
///
/// # Errors
/// None for a map that exists; the type is that of [`ElevationMap::new`].
pub fn blurred(map: &ElevationMap, sensor: [f64; 2], error: &RangeError) -> Result<ElevationMap, MapError> {
    let nodes = (0..map.rows()).flat_map(|row| (0..map.columns()).map(move |column| (column, row)));
    let heights = nodes.map(|(column, row)| {
        let [x, y] = map.place(column, row);
        mean_around(map, column, row, error.deviation((x - sensor[0]).hypot(y - sensor[1])))
    });
    map.with_heights(heights.collect())
}

/// Gaussian mean of the heights around a node.
fn mean_around(map: &ElevationMap, column: usize, row: usize, deviation: f64) -> f64 {
    let here = map.height(column, row);
    let reach = (WINDOW * deviation / map.cell()).floor() as usize;
    if reach == 0 || here.is_nan() {
        return here;
    }
    let share = |cells: usize| (-0.5 * (cells as f64 * map.cell() / deviation).powi(2)).exp();
    let (mut sum, mut weights) = (0.0, 0.0);
    for r in row.saturating_sub(reach)..=(row + reach).min(map.rows() - 1) {
        for c in column.saturating_sub(reach)..=(column + reach).min(map.columns() - 1) {
            let z = map.height(c, r);
            if z.is_finite() {
                let weight = share(r.abs_diff(row)) * share(c.abs_diff(column));
                sum += weight * (z - here);
                weights += weight;
            }
        }
    }
    here + sum / weights
}
