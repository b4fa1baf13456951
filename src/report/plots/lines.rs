//! Lines over an abscissa.

use super::{COLOURS, all_rounded, axis, layout_with};
use plotly::common::{Line, Mode};
use plotly::{Plot, Scatter};
use serde::Serialize;

/// Longer series are thinned to this many points: more than a screen shows.
const MOST_POINTS: usize = 1500;

/// One line of a plot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// Abscissae, in the unit of the plot's label.
    pub x: Vec<f64>,
    /// Ordinates, in the unit of the plot's label; NaN leaves a gap.
    pub y: Vec<f64>,
}

/// A plot of lines.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinePlot {
    /// Name for files and anchors: `figure_2_23a`.
    pub id: String,
    /// Title.
    pub title: String,
    /// Label of the abscissa with its unit: "time, s".
    pub x_label: String,
    /// Label of the ordinate with its unit.
    pub y_label: String,
    /// The lines.
    pub series: Vec<Series>,
}

/// A plot of one line a series.
pub(in crate::report) fn lines(of: &LinePlot) -> Plot {
    let mut plot = Plot::new();
    for (k, series) in of.series.iter().enumerate() {
        let (x, y) = thinned(series);
        let line = Line::new().color(COLOURS[k % COLOURS.len()]).width(2.0);
        plot.add_trace(Scatter::new(x, y).mode(Mode::Lines).name(&series.name).line(line));
    }
    plot.set_layout(layout_with(axis(&of.x_label), axis(&of.y_label), of.series.len() > 1));
    plot
}

/// Every k-th point, k the smallest that leaves few enough; a value that is not finite is a gap.
fn thinned(series: &Series) -> (Vec<f64>, Vec<Option<f64>>) {
    let stride = series.x.len().div_ceil(MOST_POINTS).max(1);
    let x = all_rounded(series.x.iter().copied().step_by(stride));
    let y = series.y.iter().step_by(stride).map(|y| y.is_finite().then(|| super::rounded(*y))).collect();
    (x, y)
}
