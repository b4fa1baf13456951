//! The profile likelihood of one parameter.

use super::{COLOURS, GREY, all_rounded, layout, rounded};
use crate::diagnosis::FinalParameter;
use crate::report::units::Shown;
use plotly::common::{DashType, Line, Marker, Mode};
use plotly::layout::{Shape, ShapeLayer, ShapeLine, ShapeType};
use plotly::{Plot, Scatter};

/// 95 % point of chi-square with one degree of freedom.
const RISE: f64 = 3.841;

/// Rise of chi-square over the value of a parameter, with its 95 % interval.
pub(in crate::report) fn profile(parameter: &FinalParameter, shown: Shown) -> Plot {
    let (x, y): (Vec<f64>, Vec<f64>) =
        parameter.profile.iter().map(|(value, rise)| (value * shown.factor, *rise)).unzip();
    let ends = (x.first().copied().unwrap_or(0.0), x.last().copied().unwrap_or(0.0));
    let mut plot = Plot::new();
    plot.add_trace(
        Scatter::new(all_rounded(x), all_rounded(y))
            .mode(Mode::LinesMarkers)
            .name("rise")
            .line(Line::new().color(COLOURS[0]).width(2.0))
            .marker(Marker::new().color(COLOURS[0]).size(6)),
    );
    let limit = Shape::new()
        .shape_type(ShapeType::Line)
        .x_ref("paper")
        .x0(0.0)
        .x1(1.0)
        .y_ref("y")
        .y0(RISE)
        .y1(RISE)
        .line(ShapeLine::new().color(GREY).width(1.5).dash(DashType::Dot));
    let (low, high) = parameter.interval;
    let inside = Shape::new()
        .shape_type(ShapeType::Rect)
        .x_ref("x")
        .x0(rounded(low.map_or(ends.0, |low| low * shown.factor)))
        .x1(rounded(high.map_or(ends.1, |high| high * shown.factor)))
        .y_ref("paper")
        .y0(0.0)
        .y1(1.0)
        .fill_color(COLOURS[0])
        .opacity(0.12)
        .layer(ShapeLayer::Below)
        .line(ShapeLine::new().width(0.0));
    plot.set_layout(layout("", "rise of chi-square", false).shapes(vec![inside, limit]));
    plot
}
