//! The error falling step by step.

use super::{COLOURS, GREY, axis, layout_with, rounded};
use crate::diagnosis::Diagnosis;
use crate::report::units::spoken;
use plotly::common::{DashType, Line, Marker, MarkerSymbol, Mode};
use plotly::layout::{AxisType, Shape, ShapeLine, ShapeType};
use plotly::{Plot, Scatter};

/// More signals than this would make the legend larger than the plot.
const MOST_SIGNALS: usize = 6;

/// RMS error of every signal over its noise floor, by step, in the fit and on what was left out. Signals without a noise
/// floor are divided by the baseline's error.
pub(in crate::report) fn steps(diagnosis: &Diagnosis, names: &[String]) -> Plot {
    let mut plot = Plot::new();
    let baseline = diagnosis.baseline();
    let scale = |signal: &String| {
        let floor = diagnosis.noise_floor.get(signal).and_then(|floor| floor.value());
        floor.filter(|floor| *floor > 0.0).or_else(|| baseline.rmse.get(signal).copied()).unwrap_or(1.0)
    };
    let mut signals: Vec<(&String, f64)> =
        baseline.rmse.iter().map(|(signal, rmse)| (signal, rmse / scale(signal))).collect();
    signals.sort_by(|a, b| b.1.total_cmp(&a.1));
    for (k, (signal, _)) in signals.into_iter().take(MOST_SIGNALS).enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        for (held_out, dash, symbol) in
            [(false, DashType::Solid, MarkerSymbol::Circle), (true, DashType::Dash, MarkerSymbol::CircleOpen)]
        {
            let mut points: Vec<(String, f64)> = Vec::new();
            if let (false, Some(rmse)) = (held_out, diagnosis.given.as_ref().and_then(|fit| fit.rmse.get(signal))) {
                points.push((names[0].clone(), rounded(rmse / scale(signal))));
            }
            for (step, name) in diagnosis.steps.iter().zip(&names[1..]) {
                let rmse = if held_out { &step.heldout_rmse } else { &step.rmse };
                points.extend(rmse.get(signal).map(|rmse| (name.clone(), rounded(rmse / scale(signal)))));
            }
            let (x, y): (Vec<String>, Vec<f64>) = points.into_iter().unzip();
            let what = if held_out { ", left out" } else { "" };
            plot.add_trace(
                Scatter::new(x, y)
                    .mode(Mode::LinesMarkers)
                    .name(format!("{}{what}", spoken(signal)))
                    .legend_group(signal)
                    .show_legend(!held_out)
                    .line(Line::new().color(colour).width(2.0).dash(dash))
                    .marker(Marker::new().color(colour).size(8).symbol(symbol)),
            );
        }
    }
    let noise = Shape::new()
        .shape_type(ShapeType::Line)
        .x_ref("paper")
        .x0(0.0)
        .x1(1.0)
        .y_ref("y")
        .y0(1.0)
        .y1(1.0)
        .line(ShapeLine::new().color(GREY).width(2.0).dash(DashType::Dot));
    let x = axis("").type_(AxisType::Category);
    let y = axis("error / noise floor").type_(AxisType::Log).dtick(1.0);
    plot.set_layout(layout_with(x, y, true).shapes(vec![noise]));
    plot
}
