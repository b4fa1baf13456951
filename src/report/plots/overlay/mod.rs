//! Measured beside modelled: against slip (or another input) by group of rows, or against time by group of repeats.

pub(in crate::report) mod along;
pub(in crate::report) mod over_time;
pub(in crate::report) mod steady;
pub(super) mod stretches;

use super::{DrawnModel, View, all_rounded, faded};
use crate::measurement::Experiment;
use crate::report::kinds::of;
use crate::report::page::escape;
use plotly::common::{Fill, HoverInfo, Line, Mode};
use plotly::{Plot, Scatter};

/// The plots of one axis, all signals.
pub(in crate::report) struct Panel {
    /// `axis=slip`, where the reader can choose the axis.
    pub when: String,
    pub plots: Vec<(String, Plot)>,
}

/// All overlays.
pub(in crate::report) fn overlays(view: &View) -> Vec<Panel> {
    of(view.experiment).overlays(view)
}

/// Buttons, boxes and lists that choose what the overlays show. `place` tells the buttons of one part of the page from
/// those of another.
pub(in crate::report) fn controls(view: &View, place: &str) -> String {
    let mut html = models(view, place, true);
    html.push_str(&of(view.experiment).controls(view));
    if html.is_empty() { html } else { format!("<div class=\"controls\">{html}</div>") }
}

/// Buttons that put each model one click apart, and with `together` all those that are shown at first.
pub(in crate::report) fn models(view: &View, place: &str, together: bool) -> String {
    let mut options: Vec<(String, String)> =
        view.models.iter().map(|model| (model.key.to_owned(), model.name.clone())).collect();
    if options.len() < 2 {
        return String::new();
    }
    let at_first =
        if together { view.at_first.join(" ") } else { view.shown().map_or("", |model| model.key).to_owned() };
    if !options.iter().any(|(keys, _)| *keys == at_first) {
        options.push((at_first.clone(), "both".to_owned()));
    }
    let button = |(keys, name): &(String, String)| {
        let checked = if *keys == at_first { " checked" } else { "" };
        format!(
            "<label><input type=\"radio\" name=\"model-{place}\" data-key=\"model\" value=\"{keys}\"{checked}>{}</label>",
            escape(name)
        )
    };
    let buttons: String = options.iter().map(button).collect();
    format!("<fieldset class=\"switch\"><legend>Model</legend>{buttons}</fieldset>")
}

/// A list to choose from, where there is a choice.
pub(in crate::report) fn list(
    label: &str,
    key: &str,
    attributes: &str,
    options: &[(impl AsRef<str>, String)],
) -> String {
    if options.len() < 2 {
        return String::new();
    }
    let option =
        |(value, name): &(_, String)| format!("<option value=\"{}\">{}</option>", AsRef::as_ref(value), escape(name));
    let options: String = options.iter().map(option).collect();
    format!("<label{attributes}>{label} <select data-key=\"{key}\">{options}</select></label>")
}

/// Names of the groups of repeats, a single run being a group of its own, and the runs of each.
pub(super) fn groups(experiment: &Experiment) -> Vec<(String, Vec<usize>)> {
    let mut groups: Vec<(String, Vec<usize>)> = Vec::new();
    for (k, run) in experiment.runs.iter().enumerate() {
        let known =
            groups.iter_mut().find(|(_, runs)| run.group.is_some() && experiment.runs[runs[0]].group == run.group);
        match known {
            Some((_, runs)) => runs.push(k),
            None => groups.push((run.group.clone().unwrap_or_else(|| run.name.clone()), vec![k])),
        }
    }
    groups
}

/// A line of the legend without points of its own, in the style of a model.
fn legend_line(model: &DrawnModel, colour: &str) -> Box<Scatter<f64, f64>> {
    Scatter::new(vec![f64::NAN], vec![f64::NAN])
        .mode(Mode::Lines)
        .name(model.short)
        .meta(format!("model={}", model.key))
        .line(Line::new().color(colour.to_owned()).width(2.0).dash(model.dash.clone()))
}

/// The area between two curves over x; a place where either is NaN is a gap.
pub(super) fn area(x: &[f64], low: &[f64], high: &[f64], colour: &str, opacity: f64) -> Box<Scatter<f64, f64>> {
    let (mut along, mut outline) = (Vec::new(), Vec::new());
    let rows: Vec<usize> = (0..x.len()).collect();
    let present = |k: &usize| !(low[*k].is_nan() || high[*k].is_nan());
    for part in rows.chunk_by(|a, b| present(a) == present(b)).filter(|part| present(&part[0])) {
        along.extend(part.iter().map(|k| x[*k]).chain(part.iter().rev().map(|k| x[*k])));
        outline.extend(part.iter().map(|k| high[*k]).chain(part.iter().rev().map(|k| low[*k])));
        along.push(f64::NAN);
        outline.push(f64::NAN);
    }
    Scatter::new(all_rounded(along), all_rounded(outline))
        .mode(Mode::Lines)
        .show_legend(false)
        .fill(Fill::ToSelf)
        .fill_color(faded(colour, opacity))
        .hover_info(HoverInfo::Skip)
        .line(Line::new().width(0.0).color(colour.to_owned()))
}
