//! The plots of a comparison.

use super::units::{of_column, spoken};
use crate::diagnosis::{Comparison, levels};
use crate::measurement::{Experiment, Kind};
use plotly::common::{Anchor, Line, Marker, MarkerSymbol, Mode, Orientation, Title};
use plotly::layout::{Axis, Legend, Margin, Shape, ShapeLayer, ShapeLine, ShapeType};
use plotly::{Layout, Plot, Scatter};

/// Readable on white and on near-black.
const COLOURS: [&str; 6] = ["#3b82f6", "#e8871e", "#12a87b", "#e5484d", "#9b6bdf", "#0ea5b7"];
const BAND: &str = "#8b949e";

/// More loads than this are not set-points but one cloud.
const MOST_CLASSES: usize = 6;

/// A run is drawn with at most this many points a signal; the numbers are computed from all of them.
const MOST_POINTS: usize = 1500;

/// Measured beside modelled: against slip by load, or against time by run.
pub(super) fn overlay(comparison: &Comparison, signal: &str) -> Plot {
    match comparison.experiment.kind {
        Kind::SingleWheel => overlay_by_load(comparison, signal),
        Kind::Traverse => overlay_by_run(comparison, signal),
    }
}

/// One row of a single-wheel experiment.
struct Point {
    load: f64,
    slip: f64,
    measured: f64,
    modelled: f64,
}

fn points(comparison: &Comparison, signal: &str) -> Vec<Point> {
    let mut points = Vec::new();
    for (run, fit) in comparison.experiment.runs.iter().zip(&comparison.fit().runs) {
        let (Some(fit), Some(load), Some(slip)) =
            (fit.signal(signal), run.data.column("load"), run.data.column("slip"))
        else {
            continue;
        };
        for row in 0..load.len() {
            let (measured, modelled) = (fit.measured[row], fit.modelled[row]);
            points.push(Point { load: load[row], slip: slip[row], measured, modelled });
        }
    }
    points
}

fn overlay_by_load(comparison: &Comparison, signal: &str) -> Plot {
    let shown = of_column(signal);
    let mut points = points(comparison, signal);
    points.sort_by(|a, b| a.load.total_cmp(&b.load));
    let spread = points.last().map_or(0.0, |last| last.load) - points.first().map_or(0.0, |first| first.load);
    let classes: Vec<&[Point]> = points.chunk_by(|a, b| b.load - a.load <= 0.02 * spread).collect();
    let classes = if classes.len() > MOST_CLASSES { vec![points.as_slice()] } else { classes };
    let mut plot = Plot::new();
    for (k, class) in classes.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let (low, high) = (class[0].load, class[class.len() - 1].load);
        let name = if high - low < 0.05 { format!("{low:.0} N") } else { format!("{low:.0} to {high:.0} N") };
        let present = class.iter().filter(|p| !p.measured.is_nan());
        let (x, y) = present.map(|p| (p.slip, p.measured * shown.factor)).unzip();
        plot.add_trace(
            Scatter::new(x, y)
                .mode(Mode::Markers)
                .name(format!("{name} measured"))
                .legend_group(&name)
                .show_legend(false)
                .marker(Marker::new().color(colour).size(6).opacity(0.55)),
        );
        let (x, y) = model_line(class, shown.factor);
        plot.add_trace(
            Scatter::new(x, y)
                .mode(Mode::Lines)
                .name(&name)
                .legend_group(&name)
                .line(Line::new().color(colour).width(2.0)),
        );
    }
    plot.set_layout(layout("slip", &shown.axis(&spoken(signal)), true));
    plot
}

/// The modelled values of a class by slip, repeats averaged.
fn model_line(class: &[Point], factor: f64) -> (Vec<f64>, Vec<f64>) {
    let mut by_slip: Vec<(f64, f64)> = class.iter().map(|p| (p.slip, p.modelled * factor)).collect();
    by_slip.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mean = |group: &[(f64, f64)]| {
        let n = group.len() as f64;
        (group.iter().map(|p| p.0).sum::<f64>() / n, group.iter().map(|p| p.1).sum::<f64>() / n)
    };
    by_slip.chunk_by(|a, b| b.0 - a.0 < 0.005).map(mean).unzip()
}

fn overlay_by_run(comparison: &Comparison, signal: &str) -> Plot {
    let shown = of_column(signal);
    let mut plot = Plot::new();
    for (k, (run, fit)) in comparison.experiment.runs.iter().zip(&comparison.fit().runs).enumerate() {
        let (Some(fit), Some(time)) = (fit.signal(signal), run.data.column("time")) else { continue };
        let colour = COLOURS[k % COLOURS.len()];
        let every = time.len().div_ceil(MOST_POINTS);
        let pick = |values: &[f64]| {
            let shown = time.iter().zip(values).step_by(every).filter(|(_, v)| !v.is_nan());
            shown.map(|(t, v)| (*t, v * of_column(signal).factor)).unzip()
        };
        let (x, y) = pick(&fit.measured);
        plot.add_trace(
            Scatter::new(x, y)
                .mode(Mode::Markers)
                .name(format!("{} measured", run.name))
                .legend_group(&run.name)
                .show_legend(false)
                .marker(Marker::new().color(colour).size(4).opacity(0.5)),
        );
        let (x, y) = pick(&fit.modelled);
        plot.add_trace(
            Scatter::new(x, y)
                .mode(Mode::Lines)
                .name(&run.name)
                .legend_group(&run.name)
                .line(Line::new().color(colour).width(2.0)),
        );
    }
    plot.set_layout(layout("time (s)", &shown.axis(&spoken(signal)), true));
    plot
}

/// Residuals of a signal against a column, their mean by level and the band of two standard deviations of the noise; `None`
/// where the column is not recorded or does not vary.
pub(super) fn residuals(comparison: &Comparison, signal: &str, condition: &str) -> Option<Plot> {
    let (experiment, fit) = (&comparison.experiment, comparison.fit());
    let levels = levels(experiment, fit, signal, condition);
    if levels.is_empty() {
        return None;
    }
    let (shown, at) = (of_column(signal), of_column(condition));
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for (run, fit) in experiment.runs.iter().zip(&fit.runs) {
        let (Some(fit), Some(column)) = (fit.signal(signal), run.data.column(condition)) else { continue };
        let every = column.len().div_ceil(MOST_POINTS);
        for (value, residual) in column.iter().zip(&fit.residual).step_by(every) {
            if !value.is_nan() && !residual.is_nan() {
                x.push(value * at.factor);
                y.push(residual * shown.factor);
            }
        }
    }
    let mut plot = Plot::new();
    plot.add_trace(
        Scatter::new(x, y)
            .mode(Mode::Markers)
            .name("samples")
            .marker(Marker::new().color(COLOURS[0]).size(5).opacity(0.45)),
    );
    let middle = levels.iter().map(|l| 0.5 * (l.low + l.high) * at.factor).collect();
    let means = levels.iter().map(|l| l.mean * shown.factor).collect();
    plot.add_trace(
        Scatter::new(middle, means)
            .mode(Mode::LinesMarkers)
            .name("mean")
            .line(Line::new().color(COLOURS[1]).width(2.0))
            .marker(Marker::new().color(COLOURS[1]).size(7).symbol(MarkerSymbol::Diamond)),
    );
    let mut layout = layout(&at.axis(&spoken(condition)), &shown.axis("measured - model"), false);
    if let Some(noise) = comparison.noise_floor.get(signal).and_then(|floor| floor.value()) {
        layout = layout.shapes(vec![band(2.0 * noise * shown.factor)]);
    }
    plot.set_layout(layout);
    Some(plot)
}

/// Columns against which residuals are drawn.
pub(super) fn residual_conditions(experiment: &Experiment) -> Vec<&'static str> {
    match experiment.kind {
        Kind::SingleWheel => vec!["slip", "load", "wheel_speed"],
        Kind::Traverse => vec!["time", "x", "pitch"],
    }
}

fn band(half_width: f64) -> Shape {
    Shape::new()
        .shape_type(ShapeType::Rect)
        .x_ref("paper")
        .x0(0.0)
        .x1(1.0)
        .y_ref("y")
        .y0(-half_width)
        .y1(half_width)
        .fill_color(BAND)
        .opacity(0.22)
        .layer(ShapeLayer::Below)
        .line(ShapeLine::new().width(0.0))
}

fn layout(x: &str, y: &str, legend: bool) -> Layout {
    let axis = |title: &str| Axis::new().title(Title::with_text(title)).auto_margin(true);
    Layout::new()
        .x_axis(axis(x))
        .y_axis(axis(y))
        .margin(Margin::new().left(56).right(12).top(12).bottom(48))
        .show_legend(legend)
        .legend(Legend::new().orientation(Orientation::Horizontal).x(0.0).y(1.02).y_anchor(Anchor::Bottom))
}
