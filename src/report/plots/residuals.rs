//! Residuals against a condition.

use super::{COLOURS, GREY, Samples, all_rounded, axis, band, layout_with};
use crate::diagnosis::Level;
use crate::report::units::{of_column, spoken};
use plotly::common::{DashType, Line, Marker, MarkerSymbol, Mode};
use plotly::{Plot, Scatter};

/// A plot has at most this many samples; means are computed from all of them.
const MOST_SAMPLES: usize = 1500;

/// More runs than this are not ticked one by one.
const MOST_TICKS: f64 = 12.0;

/// Residuals of a signal against a condition, their mean by level, and the band of two standard deviations of the noise
/// of one sample. `before` are the means of the model without what was added.
pub(in crate::report) fn residuals(samples: &Samples, floor: Option<f64>, before: Option<&Samples>) -> Plot {
    let (shown, at) = (of_column(&samples.signal), samples.condition.shown());
    let every = samples.values.len().div_ceil(MOST_SAMPLES).max(1);
    let (x, y): (Vec<f64>, Vec<f64>) =
        samples.values.iter().step_by(every).map(|(x, y)| (x * at.factor, y * shown.factor)).unzip();
    let mut plot = Plot::new();
    plot.add_trace(
        Scatter::new(all_rounded(x), all_rounded(y))
            .mode(Mode::Markers)
            .name("samples")
            .marker(Marker::new().color(COLOURS[0]).size(5).opacity(0.45)),
    );
    let means = |levels: &[Level]| -> (Vec<f64>, Vec<f64>) {
        let middle = levels.iter().map(|l| 0.5 * (l.low + l.high) * at.factor);
        (all_rounded(middle), all_rounded(levels.iter().map(|l| l.mean * shown.factor)))
    };
    if let Some(before) = before {
        let (x, y) = means(&before.levels);
        plot.add_trace(
            Scatter::new(x, y)
                .mode(Mode::Lines)
                .name("mean before")
                .line(Line::new().color(GREY).width(2.0).dash(DashType::Dash)),
        );
    }
    let (x, y) = means(&samples.levels);
    plot.add_trace(
        Scatter::new(x, y)
            .mode(Mode::LinesMarkers)
            .name("mean")
            .line(Line::new().color(COLOURS[1]).width(2.0))
            .marker(Marker::new().color(COLOURS[1]).size(7).symbol(MarkerSymbol::Diamond)),
    );
    let mut x_axis = axis(&at.axis(&samples.condition.name()));
    if samples.condition.counts() && samples.levels.iter().all(|level| level.high <= MOST_TICKS) {
        x_axis = x_axis.dtick(1.0);
    }
    let mut layout = layout_with(x_axis, axis(&shown.axis(&format!("{} residual", spoken(&samples.signal)))), false);
    if let Some(floor) = floor {
        layout = layout.shapes(vec![band(2.0 * floor * shown.factor)]);
    }
    plot.set_layout(layout);
    plot
}
