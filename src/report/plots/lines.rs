//! Lines over an abscissa.

use super::figure::{COLOURS, Figure, Mark, Scale, Trace};
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

/// A figure of one line a series: of long series every k-th point, k the smallest that leaves few enough.
pub(in crate::report) fn lines(of: &LinePlot) -> Figure {
    let trace = |(k, series): (usize, &Series)| {
        let stride = series.x.len().div_ceil(MOST_POINTS).max(1);
        let thinned = |values: &[f64]| values.iter().copied().step_by(stride).collect();
        let colour = COLOURS[k % COLOURS.len()];
        Trace::new(&series.name, Mark::Line, colour, thinned(&series.x), thinned(&series.y))
    };
    let traces = of.series.iter().enumerate().map(trace).collect();
    Figure::new(Scale::numbers(&of.x_label), Scale::numbers(&of.y_label), traces)
}
