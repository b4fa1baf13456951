//! Residuals against a condition.

use super::overlay::area;
use super::{COLOURS, GREY, Samples, all_rounded, axis, band, layout_with};
use crate::diagnosis::{LocalLine, set_points};
use crate::report::units::{Shown, of_column, spoken};
use plotly::common::{DashType, ErrorData, ErrorType, HoverInfo, Line, Marker, MarkerSymbol, Mode};
use plotly::{Plot, Scatter};

/// A plot has at most this many samples; means and smooths are computed from all of them.
const MOST_SAMPLES: usize = 1500;

/// Up to this many samples are drawn nearly opaque: they hide one another less than they are hard to see.
const FEW: usize = 100;

/// More runs than this are not ticked one by one.
const MOST_TICKS: f64 = 12.0;

/// Values of a condition that differ by less than this share of its range are one set-point.
const SAME_LEVEL: f64 = 0.02;
/// A condition has set-points where that many samples lie at each on average; otherwise it takes values all along.
const FEWEST: usize = 2;
/// Places of a smooth, and the share of the samples that each local line sees: so wide that accidental neighbours average
/// out (the usual choice for LOESS).
const PLACES: usize = 60;
const SPAN: f64 = 0.75;

/// Colours of the smooth and of groups of runs; the smooth's is none of theirs.
const SMOOTH: &str = COLOURS[1];
const GROUPS: [&str; 5] = [COLOURS[0], COLOURS[2], COLOURS[4], COLOURS[5], COLOURS[3]];

/// Residuals of a signal against a condition, what they are on average, and the band of two standard deviations of the
/// noise of one sample. The average is a mean with its standard error at each set-point or run, or a smooth with its standard
/// error where the condition takes values all along. `before` is the model without what was added.
pub(in crate::report) fn residuals(samples: &Samples, noise: Option<f64>, before: Option<&Samples>) -> Plot {
    let (shown, at) = (of_column(&samples.signal), samples.condition.shown());
    let mut plot = Plot::new();
    scatter(&mut plot, samples, shown, at);
    if let Some(before) = before {
        average(&mut plot, before, shown, at, "mean before", GREY, DashType::Dash);
    }
    average(&mut plot, samples, shown, at, "mean", SMOOTH, DashType::Solid);
    let mut x_axis = axis(&at.axis(&samples.condition.name()));
    if samples.condition.counts() && samples.levels.iter().all(|level| level.high <= MOST_TICKS) {
        x_axis = x_axis.dtick(1.0);
    }
    let mut layout = layout_with(x_axis, axis(&shown.axis(&format!("{} residual", spoken(&samples.signal)))), false);
    if let Some(noise) = noise {
        layout = layout.shapes(vec![band(2.0 * noise * shown.factor)]);
    }
    plot.set_layout(layout);
    plot
}

/// The samples, a colour a group of repeats where there are few groups.
fn scatter(plot: &mut Plot, samples: &Samples, shown: Shown, at: Shown) {
    let every = samples.values.len().div_ceil(MOST_SAMPLES).max(1);
    let thinned: Vec<((f64, f64), usize)> =
        samples.values.iter().copied().zip(samples.groups.iter().copied()).step_by(every).collect();
    let coloured = samples.group_names.len() <= GROUPS.len();
    let shares = if coloured { samples.group_names.len() } else { 1 };
    for (group, colour) in GROUPS.iter().enumerate().take(shares) {
        let own = thinned.iter().filter(|(_, own)| !coloured || *own == group);
        let (x, y): (Vec<f64>, Vec<f64>) = own.map(|((x, y), _)| (x * at.factor, y * shown.factor)).unzip();
        plot.add_trace(
            Scatter::new(all_rounded(x), all_rounded(y))
                .mode(Mode::Markers)
                .name(if coloured { &samples.group_names[group] } else { "samples" })
                .marker(Marker::new().color(*colour).size(5).opacity(if thinned.len() > FEW { 0.45 } else { 0.8 })),
        );
    }
}

/// Mean residuals at set-points, or a smooth over a condition without them.
fn average(
    plot: &mut Plot,
    samples: &Samples,
    shown: Shown,
    at: Shown,
    name: &str,
    colour: &'static str,
    dash: DashType,
) {
    let places = samples.values.iter().map(|(x, _)| *x);
    let (low, high) = places.clone().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    let classes = if samples.condition.counts() {
        each_once(places).into_iter().map(|place| (place, place)).collect()
    } else {
        set_points(places, SAME_LEVEL * (high - low))
    };
    if classes.len() > 1 && samples.values.len() >= FEWEST * classes.len() {
        let means: Vec<[f64; 3]> = classes.iter().map(|class| mean(samples, *class)).collect();
        let errors = means.iter().map(|m| 2.0 * m[2] * shown.factor);
        plot.add_trace(
            Scatter::new(
                all_rounded(means.iter().map(|m| m[0] * at.factor)),
                all_rounded(means.iter().map(|m| m[1] * shown.factor)),
            )
            .mode(Mode::Markers)
            .name(name)
            .error_y(ErrorData::new(ErrorType::Data).array(all_rounded(errors)).color(colour).thickness(1.5).width(4))
            .marker(Marker::new().color(colour).size(8).symbol(MarkerSymbol::Diamond)),
        );
        return;
    }
    let Some(smooth) = LocalLine::new(samples.values.iter().copied(), SPAN) else { return };
    let grid = smooth.places(PLACES);
    let values: Vec<_> = grid.iter().map(|x| smooth.at(*x)).collect();
    let x = all_rounded(grid.iter().map(|x| x * at.factor));
    let edge = |sign: f64| {
        let of =
            |s: &crate::diagnosis::Smoothed| s.error.map_or(f64::NAN, |e| (s.value + sign * 2.0 * e) * shown.factor);
        values.iter().map(of).collect::<Vec<_>>()
    };
    plot.add_trace(area(&x, &edge(-1.0), &edge(1.0), colour, 0.22));
    plot.add_trace(
        Scatter::new(x, all_rounded(values.iter().map(|s| s.value * shown.factor)))
            .mode(Mode::Lines)
            .name(name)
            .hover_info(HoverInfo::Skip)
            .line(Line::new().color(colour).width(2.0).dash(dash)),
    );
}

fn each_once(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.filter(|value| !value.is_nan()).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// Mean place, mean residual and its standard error (0 for one sample) of a class.
fn mean(samples: &Samples, (low, high): (f64, f64)) -> [f64; 3] {
    let own: Vec<(f64, f64)> = samples.values.iter().copied().filter(|(x, _)| (low..=high).contains(x)).collect();
    let count = own.len() as f64;
    let (x, y) = (own.iter().map(|p| p.0).sum::<f64>() / count, own.iter().map(|p| p.1).sum::<f64>() / count);
    let squares: f64 = own.iter().map(|p| (p.1 - y).powi(2)).sum();
    [x, y, if own.len() > 1 { (squares / (count - 1.0) / count).sqrt() } else { 0.0 }]
}
