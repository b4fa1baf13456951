//! The plots of the reports.
//!
//! A trace may carry `key=value;..` as its meta; the page's boxes and lists with these keys show and hide it.

mod candidates;
mod conditions;
mod lines;
mod map;
mod overlay;
mod profile;
mod residuals;
mod steps;

pub(super) use candidates::{probabilities, visible_shares};
pub(super) use conditions::{Condition, Samples, conditions};
pub(super) use lines::lines;
pub(super) use map::map;
pub(super) use overlay::{controls, overlay};
pub(super) use profile::profile;
pub(super) use residuals::residuals;
pub(super) use steps::steps;

use super::units::digits;
use crate::diagnosis::{Fit, NoiseFloor};
use crate::measurement::Experiment;
use plotly::Layout;
use plotly::common::{Anchor, DashType, Orientation, Title};
use plotly::layout::{Axis, Legend, Margin, Shape, ShapeLayer, ShapeLine, ShapeType};
use std::collections::BTreeMap;

/// Readable on white and on near-black.
const COLOURS: [&str; 6] = ["#3b82f6", "#e8871e", "#12a87b", "#e5484d", "#9b6bdf", "#0ea5b7"];
const GREY: &str = "#8b949e";

/// A model beside the measurements.
pub(super) struct Modelled<'a> {
    /// Word for the page's boxes.
    pub key: &'static str,
    /// Name for people.
    pub name: String,
    /// Name for legends, where there is little room.
    pub short: &'static str,
    pub fit: &'a Fit,
    pub dash: DashType,
    /// Whether it is shown at first.
    pub shown: bool,
}

/// An experiment and the models drawn beside it.
pub(super) struct View<'a> {
    pub experiment: &'a Experiment,
    pub floors: &'a BTreeMap<String, NoiseFloor>,
    pub models: Vec<Modelled<'a>>,
}

impl View<'_> {
    /// Standard deviation of one sample, in the signal's unit.
    fn floor(&self, signal: &str) -> Option<f64> {
        self.floors.get(signal).and_then(NoiseFloor::value)
    }
}

/// A number of a plot: five digits are more than a screen shows, and keep the file small.
fn rounded(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}

fn all_rounded(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    values.into_iter().map(rounded).collect()
}

/// A colour of the list, translucent.
fn faded(colour: &str, opacity: f64) -> String {
    let part = |at: usize| colour.get(at..at + 2).and_then(|hex| u8::from_str_radix(hex, 16).ok()).unwrap_or(128);
    format!("rgba({}, {}, {}, {opacity})", part(1), part(3), part(5))
}

/// A level of a set-point in words, for legends.
fn level_name(low: f64, high: f64, unit: &str) -> String {
    if digits(low) == digits(high) {
        format!("{} {unit}", super::units::short(low))
    } else {
        format!("{} to {} {unit}", super::units::short(low), super::units::short(high))
    }
}

/// A horizontal band about zero.
fn band(half_width: f64) -> Shape {
    Shape::new()
        .shape_type(ShapeType::Rect)
        .x_ref("paper")
        .x0(0.0)
        .x1(1.0)
        .y_ref("y")
        .y0(-half_width)
        .y1(half_width)
        .fill_color(GREY)
        .opacity(0.22)
        .layer(ShapeLayer::Below)
        .line(ShapeLine::new().width(0.0))
}

fn axis(title: &str) -> Axis {
    Axis::new().title(Title::with_text(title)).auto_margin(true)
}

fn layout(x: &str, y: &str, legend: bool) -> Layout {
    layout_with(axis(x), axis(y), legend)
}

fn layout_with(x: Axis, y: Axis, legend: bool) -> Layout {
    Layout::new()
        .x_axis(x)
        .y_axis(y)
        .margin(Margin::new().left(56).right(12).top(12).bottom(48))
        .show_legend(legend)
        .legend(Legend::new().orientation(Orientation::Horizontal).x(0.0).y(1.02).y_anchor(Anchor::Bottom))
}
