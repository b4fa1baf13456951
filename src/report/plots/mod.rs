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
pub use lines::{LinePlot, Series};
pub(super) use map::map;
pub(super) use overlay::steady::MOST_NAMED;
pub(super) use overlay::stretches::REASONS;
pub(super) use overlay::{Panel, along, controls, list, models, over_time, overlays, steady};
pub(super) use profile::profile;
pub(super) use residuals::residuals;
pub(super) use steps::steps;

use crate::diagnosis::{Curves, Fit, UncountedRows};
use crate::measurement::Experiment;
use plotly::Layout;
use plotly::common::{Anchor, DashType, Orientation, Title};
use plotly::layout::{Axis, Legend, Margin, Shape, ShapeLayer, ShapeLine, ShapeType};
use std::collections::BTreeMap;

/// Readable on white and on near-black.
pub(super) const COLOURS: [&str; 6] = ["#3b82f6", "#e8871e", "#12a87b", "#e5484d", "#9b6bdf", "#0ea5b7"];
pub(super) const GREY: &str = "#8b949e";

/// A model beside the measurements.
pub(super) struct DrawnModel<'a> {
    /// Word for the page's buttons.
    pub key: &'static str,
    /// Name for people.
    pub name: String,
    /// Name where there is little room.
    pub short: &'static str,
    /// The step of its curves; `None` is the model as given.
    pub step: Option<usize>,
    pub fit: &'a Fit,
    pub dash: DashType,
    /// Its colour where colours do not tell groups or wheels apart.
    pub colour: &'static str,
}

impl View<'_> {
    /// Standard deviation of one sample of a signal, or where it is unknown the error of the first model shown.
    pub fn scale(&self, signal: &str) -> f64 {
        let rmse = || self.shown().and_then(|model| model.fit.rmse.get(signal).copied());
        self.noise.get(signal).copied().or_else(rmse).filter(|scale| *scale > 0.0).unwrap_or(1.0)
    }

    /// What [`scale`](Self::scale) is, in a word or two: the noise, or the usual error where no noise is known.
    pub fn measure(&self) -> &'static str {
        let unknown = self.experiment.signals().iter().filter(|signal| !self.noise.contains_key(*signal)).count();
        match unknown {
            0 => "noise",
            n if n == self.experiment.signals().len() => "usual error",
            _ => "noise or usual error",
        }
    }

    /// The first of the models that are shown at first.
    pub fn shown(&self) -> Option<&DrawnModel<'_>> {
        self.models.iter().find(|model| self.at_first.first() == Some(&model.key)).or(self.models.last())
    }
}

impl<'a> DrawnModel<'a> {
    /// The model with the parameters as given.
    pub fn given(fit: &'a Fit) -> Self {
        let name = "as given".to_owned();
        Self { key: "given", name, short: "as given", step: None, fit, dash: DashType::Dot, colour: GREY }
    }

    /// The calibrated model without added effects; dashed where another model is the result.
    pub fn calibrated(name: &str, short: &'static str, fit: &'a Fit, dash: DashType) -> Self {
        Self { key: "baseline", name: name.to_owned(), short, step: Some(0), fit, dash, colour: COLOURS[1] }
    }

    /// The model of the last step.
    pub fn last(name: String, step: usize, fit: &'a Fit) -> Self {
        let (short, dash) = ("final model", DashType::Solid);
        Self { key: "final", name, short, step: Some(step), fit, dash, colour: COLOURS[2] }
    }
}

/// An experiment and the models drawn beside it.
pub(super) struct View<'a> {
    pub experiment: &'a Experiment,
    /// Standard deviation of one sample by signal, as it is in force; a signal of unknown noise is missing.
    pub noise: BTreeMap<String, f64>,
    pub curves: &'a [Curves],
    /// Rows that no fit counts.
    pub uncounted: &'a [UncountedRows],
    pub models: Vec<DrawnModel<'a>>,
    /// Keys of the models shown at first.
    pub at_first: Vec<&'static str>,
}

/// A number of a plot: five digits are more than a screen shows, and keep the file small.
pub(super) fn rounded(value: f64) -> f64 {
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

/// The colour at a share of the way along a list of colours.
fn between(colours: &[&str], share: f64) -> String {
    let place = share.clamp(0.0, 1.0) * (colours.len() - 1) as f64;
    let from = (place as usize).min(colours.len().saturating_sub(2));
    let rest = place - from as f64;
    let part = |k: usize, at: usize| {
        let hex = colours.get(k).and_then(|colour| colour.get(at..at + 2));
        hex.and_then(|hex| u8::from_str_radix(hex, 16).ok()).map_or(128.0, f64::from)
    };
    let mixed = [1, 3, 5].map(|at| (1.0 - rest) * part(from, at) + rest * part(from + 1, at));
    format!("#{:02x}{:02x}{:02x}", mixed[0] as u8, mixed[1] as u8, mixed[2] as u8)
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

pub(super) fn axis(title: &str) -> Axis {
    Axis::new().title(Title::with_text(title)).auto_margin(true)
}

fn layout(x: &str, y: &str, legend: bool) -> Layout {
    layout_with(axis(x), axis(y), legend)
}

pub(super) fn layout_with(x: Axis, y: Axis, legend: bool) -> Layout {
    Layout::new()
        .x_axis(x)
        .y_axis(y)
        .margin(Margin::new().left(56).right(12).top(12).bottom(48))
        .show_legend(legend)
        .legend(Legend::new().orientation(Orientation::Horizontal).x(0.0).y(1.02).y_anchor(Anchor::Bottom))
}
