//! Residuals against a condition.

use super::Samples;
use super::figure::{COLOURS, Figure, GREY, Mark, Scale, Trace};
use crate::diagnosis::{LocalLine, set_points};
use crate::report::units::{Shown, of_column, spoken};

/// A plot has at most this many samples; means and smooths are computed from all of them.
const MOST_SAMPLES: usize = 1500;

/// Values of a condition that differ by less than this share of its range are one set-point.
const SAME_LEVEL: f64 = 0.02;
/// A condition has set-points where that many samples lie at each on average; otherwise it takes values all along.
const FEWEST: usize = 2;
/// Places of a smooth, and the share of the samples that each local line sees: so wide that accidental neighbours average
/// out (the usual choice for LOESS).
const PLACES: usize = 60;
const SPAN: f64 = 0.75;

/// Colours of the smooth and of groups of runs; the smooth's is none of theirs.
const SMOOTH: usize = COLOURS[1];
const GROUPS: [usize; 5] = [COLOURS[0], COLOURS[2], COLOURS[3], COLOURS[4], COLOURS[5]];

/// Residuals of a signal against a condition, what they are on average, and the band of two standard deviations of the
/// noise of one sample. The average is a mean with two standard errors at each set-point or run, or a smooth with two standard
/// errors where the condition takes values all along. `before` is the model without what was added.
pub(in crate::report) fn residuals(samples: &Samples, noise: Option<f64>, before: Option<&Samples>) -> Figure {
    let (shown, at) = (of_column(&samples.signal), samples.condition.shown());
    let mut traces = scatter(samples, shown, at);
    if let Some(before) = before {
        traces.extend(average(before, shown, at, "mean before", GREY, Mark::Dashed));
    }
    traces.extend(average(samples, shown, at, "mean", SMOOTH, Mark::Line));
    let x = Scale::numbers(&at.axis(&samples.condition.name()));
    let y = Scale::numbers(&shown.axis(&format!("{} residual", spoken(&samples.signal))));
    Figure { band: noise.map(|noise| 2.0 * noise * shown.factor), ..Figure::new(x, y, traces) }
}

/// The samples, a colour a group of repeats where there are few groups.
fn scatter(samples: &Samples, shown: Shown, at: Shown) -> Vec<Trace> {
    let every = samples.values.len().div_ceil(MOST_SAMPLES).max(1);
    let thinned: Vec<((f64, f64), usize)> =
        samples.values.iter().copied().zip(samples.groups.iter().copied()).step_by(every).collect();
    let coloured = samples.group_names.len() <= GROUPS.len();
    let shares = if coloured { samples.group_names.len() } else { 1 };
    let one = |(group, colour): (usize, &usize)| {
        let own = thinned.iter().filter(|(_, own)| !coloured || *own == group);
        let (x, y) = own.map(|((x, y), _)| (x * at.factor, y * shown.factor)).unzip();
        let name = if coloured { &samples.group_names[group] } else { "samples" };
        Trace::new(name, Mark::Points, *colour, x, y)
    };
    GROUPS.iter().enumerate().take(shares).map(one).collect()
}

/// Mean residuals at set-points, or a smooth over a condition without them; `None` where there are too few samples for one.
fn average(samples: &Samples, shown: Shown, at: Shown, name: &str, colour: usize, line: Mark) -> Option<Trace> {
    let places = samples.values.iter().map(|(x, _)| *x);
    let (low, high) = places.clone().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    let classes = if samples.condition.counts() {
        each_once(places).into_iter().map(|place| (place, place)).collect()
    } else {
        set_points(places, SAME_LEVEL * (high - low))
    };
    if classes.len() > 1 && samples.values.len() >= FEWEST * classes.len() {
        let means: Vec<[f64; 3]> = classes.iter().map(|class| mean(samples, *class)).collect();
        let of = |k: usize, factor: f64| means.iter().map(|mean| mean[k] * factor).collect();
        let mut trace = Trace::new(name, Mark::Means, colour, of(0, at.factor), of(1, shown.factor));
        trace.spread = of(2, 2.0 * shown.factor);
        return Some(trace);
    }
    let smooth = LocalLine::new(samples.values.iter().copied(), SPAN)?;
    let grid = smooth.places(PLACES);
    let values: Vec<_> = grid.iter().map(|x| smooth.at(*x)).collect();
    let x = grid.iter().map(|x| x * at.factor).collect();
    let mut trace = Trace::new(name, line, colour, x, values.iter().map(|s| s.value * shown.factor).collect());
    trace.spread = values.iter().map(|s| s.error.map_or(f64::NAN, |error| 2.0 * error * shown.factor)).collect();
    Some(trace)
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
