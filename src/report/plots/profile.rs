//! The profile likelihood of a parameter.

use super::figure::{COLOURS, Figure, Mark, Scale, Trace};
use crate::diagnosis::FinalParameter;
use crate::report::units::Shown;

/// 95 % point of chi-square with one degree of freedom.
const RISE: f64 = 3.841;

/// Rise of chi-square over the value of a parameter, with its 95 % interval.
pub(in crate::report) fn profile(parameter: &FinalParameter, shown: Shown, label: &str) -> Figure {
    let (x, y): (Vec<f64>, Vec<f64>) =
        parameter.profile.iter().map(|(value, rise)| (value * shown.factor, *rise)).unzip();
    let ends = (x.first().copied().unwrap_or(0.0), x.last().copied().unwrap_or(0.0));
    let (low, high) = parameter.interval;
    let inside = [low.map_or(ends.0, |low| low * shown.factor), high.map_or(ends.1, |high| high * shown.factor)];
    let traces = vec![Trace::new("rise", Mark::Joined, COLOURS[0], x, y)];
    let figure = Figure::new(Scale::numbers(label), Scale::numbers("rise of chi-square"), traces);
    Figure { level: Some(RISE), inside: Some(inside), ..figure }
}
