//! Rows near each other in time.

use std::ops::Range;

/// Rows within `within` (s) of a row.
pub(crate) fn around(time: &[f64], row: usize, within: f64) -> Range<usize> {
    let first = time.partition_point(|t| *t < time[row] - within);
    let end = time.partition_point(|t| *t <= time[row] + within);
    first..end
}

/// The mean of the values around each row; NaN where there are none.
pub(super) fn means(time: &[f64], values: &[f64], within: f64) -> Vec<f64> {
    let mean = |row: usize| {
        let present = around(time, row, within).map(|k| values[k]).filter(|value| !value.is_nan());
        let (sum, count) = present.fold((0.0, 0_usize), |(sum, count), value| (sum + value, count + 1));
        if count > 0 { sum / count as f64 } else { f64::NAN }
    };
    (0..time.len()).map(mean).collect()
}

/// The slope over time of the straight line through the values around each row; NaN where there are fewer than two.
pub(super) fn slopes(time: &[f64], values: &[f64], within: f64) -> Vec<f64> {
    (0..time.len()).map(|row| line(time, values, row, within).1).collect()
}

/// The straight line through the values around each row, at that row; NaN where there are none.
pub(super) fn lines(time: &[f64], values: &[f64], within: f64) -> Vec<f64> {
    let at = |row: usize| {
        let (mean, slope, late) = line(time, values, row, within);
        if slope.is_nan() { mean } else { mean + slope * late }
    };
    (0..time.len()).map(at).collect()
}

/// Mean and slope of the values around a row, and by how much the row comes after the mean of their times.
fn line(time: &[f64], values: &[f64], row: usize, within: f64) -> (f64, f64, f64) {
    let present: Vec<usize> = around(time, row, within).filter(|k| !values[*k].is_nan()).collect();
    let count = present.len() as f64;
    let mean = |of: &[f64]| present.iter().map(|k| of[*k]).sum::<f64>() / count;
    let (t, v) = (mean(time), mean(values));
    let products = present.iter().map(|k| ((time[*k] - t) * (values[*k] - v), (time[*k] - t).powi(2)));
    let (along, square) = products.fold((0.0, 0.0), |(a, b), (p, q)| (a + p, b + q));
    // Zero over zero is NaN.
    (v, along / square, time[row] - t)
}

/// Values with those that are missing on the line in time between their neighbours, and the nearest at the ends; NaN where there are none.
pub(super) fn filled(time: &[f64], values: &[f64]) -> Vec<f64> {
    let present: Vec<usize> = (0..values.len()).filter(|k| !values[*k].is_nan()).collect();
    let at = |row: usize| {
        let after = present.partition_point(|k| *k < row);
        match (after.checked_sub(1).map(|k| present[k]), present.get(after).copied()) {
            (_, Some(k)) if k == row => values[k],
            (Some(a), Some(b)) => values[a] + (values[b] - values[a]) * (time[row] - time[a]) / (time[b] - time[a]),
            (Some(k), None) | (None, Some(k)) => values[k],
            (None, None) => f64::NAN,
        }
    };
    (0..values.len()).map(at).collect()
}
