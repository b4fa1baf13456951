//! Mean residuals over two conditions.

use super::{Samples, all_rounded, axis, layout_with, rounded};
use crate::report::units::short;
use plotly::common::{ColorBar, ColorScale, ColorScaleElement};
use plotly::layout::AxisType;
use plotly::{HeatMap, Plot};
use std::collections::BTreeMap;

/// Cells along a condition without levels of its own.
const CELLS: usize = 8;
/// A condition has levels of its own where that many samples lie at each on average.
const FEWEST: usize = 2;
/// Cells along a condition at most.
const MOST_CELLS: usize = 14;

/// Mean residual in standard deviations of one sample (or in units of `scale`) over two conditions of the same samples.
/// `None` where either does not vary.
pub(in crate::report) fn map(x: &Samples, y: &Samples, scale: f64, unit: &str) -> Option<Plot> {
    if x.values.len() != y.values.len() || x.levels.len() < 2 || y.levels.len() < 2 {
        return None;
    }
    let (across, up) = (edges(x), edges(y));
    let mut cells: BTreeMap<(usize, usize), (f64, usize)> = BTreeMap::new();
    for ((at_x, residual), (at_y, _)) in x.values.iter().zip(&y.values) {
        let cell = cells.entry((place(&up, *at_y), place(&across, *at_x))).or_default();
        *cell = (cell.0 + residual, cell.1 + 1);
    }
    let mean = |row: usize, column: usize| {
        cells.get(&(row, column)).map_or(f64::NAN, |(sum, count)| rounded(sum / *count as f64 / scale))
    };
    let z: Vec<Vec<f64>> =
        (0..up.len()).map(|row| (0..across.len()).map(|column| mean(row, column)).collect()).collect();
    let largest = z.iter().flatten().filter(|v| !v.is_nan()).map(|v| v.abs()).fold(2.0, f64::max);
    // The page puts its own background in the middle.
    let colours = [(0.0, "#3b82f6"), (0.5, "#8b949e"), (1.0, "#e8871e")];
    let colours = colours.map(|(at, colour)| ColorScaleElement(at, colour.to_owned()));
    let heat = HeatMap::new(names(x, &across), names(y, &up), z)
        .zmin(-largest)
        .zmax(largest)
        .color_scale(ColorScale::Vector(colours.to_vec()))
        .color_bar(ColorBar::new().title(unit).thickness(12))
        .name("mean residual");
    let mut plot = Plot::new();
    plot.add_trace(heat);
    let category =
        |samples: &Samples| axis(&samples.condition.shown().axis(&samples.condition.name())).type_(AxisType::Category);
    plot.set_layout(layout_with(category(x), category(y), false));
    Some(plot)
}

/// Ranges of the cells, in rising order: the condition's own levels where it has few.
fn edges(samples: &Samples) -> Vec<(f64, f64)> {
    let apart = samples.levels.windows(2).all(|pair| pair[0].high < pair[1].low);
    let repeated = samples.values.len() >= FEWEST * samples.levels.len();
    if apart && repeated && samples.levels.len() <= MOST_CELLS {
        return samples.levels.iter().map(|level| (level.low, level.high)).collect();
    }
    let (first, last) = (samples.levels[0].low, samples.levels[samples.levels.len() - 1].high);
    // Few samples would leave most cells empty.
    let cells = ((samples.values.len() as f64).sqrt() as usize).clamp(2, CELLS);
    let width = (last - first) / cells as f64;
    (0..cells).map(|k| (first + width * k as f64, first + width * (k + 1) as f64)).collect()
}

fn place(edges: &[(f64, f64)], value: f64) -> usize {
    edges.iter().rposition(|(low, _)| *low <= value).unwrap_or(0)
}

fn names(samples: &Samples, edges: &[(f64, f64)]) -> Vec<String> {
    let factor = samples.condition.shown().factor;
    let middles = all_rounded(edges.iter().map(|(low, high)| 0.5 * (low + high) * factor));
    middles.into_iter().map(short).collect()
}
