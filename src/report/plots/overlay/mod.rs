//! Measured beside modelled: against slip (or another input) by group of rows, or against time by group of repeats.

mod over_time;
mod steady;

pub(in crate::report) use steady::MOST_NAMED;

use super::{Model, View, all_rounded, faded};
use crate::diagnosis::Curves;
use crate::measurement::{Experiment, Kind};
use crate::report::page::escape;
use crate::report::units::{spoken, wheel_and_field};
use plotly::common::{Fill, HoverInfo, Line, Mode};
use plotly::{Plot, Scatter};

/// Where there are more points than this, the model's value at each is not marked at first.
const MOST_MARKED: usize = 60;

/// The plots of one axis, all signals.
pub(in crate::report) struct Panel {
    /// `axis=slip`, where the reader can choose the axis.
    pub when: String,
    pub plots: Vec<(String, Plot)>,
}

/// All overlays: one panel an axis for a wheel on a carriage, one for a traverse.
pub(in crate::report) fn overlays(view: &View) -> Vec<Panel> {
    match view.experiment.kind {
        Kind::SingleWheel => {
            let one = |curves: Option<&Curves>| {
                let signals = view.experiment.signals();
                let plots = signals.iter().map(|signal| (spoken(signal), steady::overlay(view, curves, signal)));
                let when = curves.map_or(String::new(), |curves| format!("axis={}", curves.axis.name()));
                Panel { when, plots: plots.collect() }
            };
            if view.curves.is_empty() { vec![one(None)] } else { view.curves.iter().map(|c| one(Some(c))).collect() }
        }
        Kind::Traverse => {
            let plots = quantities(view.experiment)
                .into_iter()
                .map(|(title, signals)| (title, over_time::overlay(view, &signals)))
                .collect();
            vec![Panel { when: String::new(), plots }]
        }
    }
}

/// Signals that share a plot: the same quantity of every wheel.
fn quantities(experiment: &Experiment) -> Vec<(String, Vec<String>)> {
    let mut all: Vec<(String, Vec<String>)> = Vec::new();
    for signal in experiment.signals() {
        let field = wheel_and_field(&signal).map(|(_, field)| field.replace('_', " "));
        let title = field.map_or_else(|| spoken(&signal), |field| format!("{field} of the wheels"));
        match all.iter_mut().find(|(known, _)| *known == title) {
            Some((_, signals)) => signals.push(signal),
            None => all.push((title, vec![signal])),
        }
    }
    for (title, signals) in all.iter_mut().filter(|(_, signals)| signals.len() == 1) {
        *title = spoken(&signals[0]);
    }
    all
}

/// Buttons, boxes and lists that choose what the overlays show. `place` tells the buttons of one part of the page from
/// those of another.
pub(in crate::report) fn controls(view: &View, place: &str) -> String {
    let mut html = models(view, place);
    match view.experiment.kind {
        Kind::SingleWheel => {
            let axes = view.curves.iter().map(|curves| (curves.axis.name(), spoken(curves.axis.name())));
            html.push_str(&list("Over", "axis", "", &axes.collect::<Vec<_>>()));
            for curves in view.curves {
                let names = curves.groups.iter().enumerate().map(|(k, group)| (k.to_string(), group.name.clone()));
                let mut options = vec![("all".to_owned(), "all".to_owned())];
                options.extend(names);
                let when = format!(" data-when=\"axis={}\"", curves.axis.name());
                if curves.groups.len() > 1 {
                    html.push_str(&list("Rows", steady::group_key(curves.axis), &when, &options));
                }
            }
            let points = view.experiment.runs.iter().map(|run| run.data.rows()).sum::<usize>();
            let checked = if points <= MOST_MARKED { " checked" } else { "" };
            html.push_str(&format!(
                "<label><input type=\"checkbox\" data-key=\"points\" value=\"yes\"{checked}> model at each point</label>"
            ));
        }
        Kind::Traverse => {
            let names = groups(view.experiment).into_iter().enumerate().map(|(k, (name, _))| (k.to_string(), name));
            html.push_str(&list("Run", "group", "", &names.collect::<Vec<_>>()));
            let wheels = quantities(view.experiment).iter().map(|(_, signals)| signals.len()).max().unwrap_or(1);
            if wheels > 1 {
                let mut options = vec![("all".to_owned(), "all".to_owned())];
                options.extend((1..=wheels).map(|wheel| (wheel.to_string(), wheel.to_string())));
                html.push_str(&list("Wheel", "wheel", "", &options));
            }
        }
    }
    if html.is_empty() { html } else { format!("<div class=\"controls\">{html}</div>") }
}

/// Buttons that put each model, and all those shown at first, one click apart.
fn models(view: &View, place: &str) -> String {
    let mut options: Vec<(String, String)> =
        view.models.iter().map(|model| (model.key.to_owned(), model.name.clone())).collect();
    if options.len() < 2 {
        return String::new();
    }
    let at_first = view.at_first.join(" ");
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
fn list(label: &str, key: &str, attributes: &str, options: &[(impl AsRef<str>, String)]) -> String {
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
fn legend_line(model: &Model, colour: &str) -> Box<Scatter<f64, f64>> {
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
