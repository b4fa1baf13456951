//! Measured beside modelled: against slip by load, or against time by group of repeats.

use super::{COLOURS, GREY, View, all_rounded, faded, layout, level_name};
use crate::measurement::{Experiment, Kind, Sample};
use crate::report::page::escape;
use crate::report::units::{of_column, spoken};
use plotly::common::{Fill, HoverInfo, Line, Marker, Mode};
use plotly::{Plot, Scatter};

/// More loads than this are not set-points but one cloud.
const MOST_CLASSES: usize = 6;

/// A plot has at most about this many points a model; the numbers are computed from all of them.
const MOST_POINTS: usize = 12_000;
/// A run keeps at least this many of them.
const FEWEST_POINTS: usize = 150;

/// Values that differ by less than this share of their range are one set-point.
const SAME_LEVEL: f64 = 0.02;

/// The plot of one signal.
pub(in crate::report) fn overlay(view: &View, signal: &str) -> Plot {
    match view.experiment.kind {
        Kind::SingleWheel => against_slip(view, signal),
        Kind::Traverse => against_time(view, signal),
    }
}

/// Boxes and a list that choose what the overlays show.
pub(in crate::report) fn controls(view: &View) -> String {
    let mut html = String::new();
    if view.models.len() > 1 {
        let boxes: String = view
            .models
            .iter()
            .map(|model| {
                format!(
                    "<label><input type=\"checkbox\" data-key=\"model\" value=\"{}\"{}> {}</label>",
                    model.key,
                    if model.shown { " checked" } else { "" },
                    escape(&model.name)
                )
            })
            .collect();
        html.push_str(&format!("<fieldset><legend>Lines</legend>{boxes}</fieldset>"));
    }
    let (label, options) = match view.experiment.kind {
        Kind::SingleWheel => ("Wheel speed", speed_options(view.experiment)),
        Kind::Traverse => ("Run", groups(view.experiment).into_iter().map(|(name, _)| name).collect()),
    };
    if options.len() > 1 {
        let all = match view.experiment.kind {
            Kind::SingleWheel => "<option value=\"all\">all</option>",
            Kind::Traverse => "",
        };
        let options: String = options
            .iter()
            .enumerate()
            .map(|(k, name)| format!("<option value=\"{k}\">{}</option>", escape(name)))
            .collect();
        html.push_str(&format!("<label>{label} <select data-key=\"group\">{all}{options}</select></label>"));
    }
    if html.is_empty() { html } else { format!("<div class=\"controls\">{html}</div>") }
}

/// One row of a single-wheel experiment.
#[derive(Clone)]
struct Point {
    at: Sample,
    load: f64,
    slip: f64,
    speed: f64,
}

fn points(experiment: &Experiment) -> Vec<Point> {
    let mut points = Vec::new();
    for (k, run) in experiment.runs.iter().enumerate() {
        for row in 0..run.data.rows() {
            let value = |name: &str| run.data.value(name, row).unwrap_or(f64::NAN);
            let point = Point {
                at: Sample { run: k, row },
                load: value("load"),
                slip: value("slip"),
                speed: value("wheel_speed"),
            };
            if !point.load.is_nan() && !point.slip.is_nan() {
                points.push(point);
            }
        }
    }
    points
}

/// Points in classes of about equal value; all in one where there are too many.
fn classes(mut points: Vec<Point>, value: fn(&Point) -> f64) -> Vec<Vec<Point>> {
    points.sort_by(|a, b| value(a).total_cmp(&value(b)));
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Vec::new() };
    let gap = SAME_LEVEL * (value(last) - value(first));
    // A missing value differs from nothing.
    let same = |a: &Point, b: &Point| {
        let step = value(b) - value(a);
        step.is_nan() || step <= gap
    };
    let classes: Vec<Vec<Point>> = points.chunk_by(same).map(<[Point]>::to_vec).collect();
    if classes.len() > MOST_CLASSES { vec![points] } else { classes }
}

fn speed_options(experiment: &Experiment) -> Vec<String> {
    let classes = classes(points(experiment), |p| p.speed);
    classes.iter().map(|class| level_name(class[0].speed, class[class.len() - 1].speed, "rad/s")).collect()
}

fn against_slip(view: &View, signal: &str) -> Plot {
    let shown = of_column(signal);
    let all = points(view.experiment);
    let loads = classes(all.clone(), |p| p.load);
    let speeds = classes(all, |p| p.speed);
    let floor = view.floor(signal).map(|floor| 2.0 * floor * shown.factor);
    let mut plot = Plot::new();
    for (k, load) in loads.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let name = level_name(load[0].load, load[load.len() - 1].load, "N");
        for (s, speed) in speeds.iter().enumerate() {
            let class: Vec<&Point> = load.iter().filter(|p| speed.iter().any(|other| other.at == p.at)).collect();
            if class.is_empty() {
                continue;
            }
            let value = |point: &Point| {
                let fit = view.models[0].fit.runs.get(point.at.run)?.signal(signal)?;
                fit.measured.get(point.at.row).map(|v| v * shown.factor).filter(|v| !v.is_nan())
            };
            if let Some(half) = floor {
                let band = Band { middle: repeats_mean(view.experiment, &class, &value), half };
                plot.add_trace(band.trace(colour).meta(format!("group={s}")).legend_group(&name));
            }
            let (x, y): (Vec<f64>, Vec<f64>) = class.iter().filter_map(|p| Some((p.slip, value(p)?))).unzip();
            plot.add_trace(
                Scatter::new(all_rounded(x), all_rounded(y))
                    .mode(Mode::Markers)
                    .name(&name)
                    .legend_group(&name)
                    .show_legend(s == 0)
                    .meta(format!("group={s}"))
                    .marker(Marker::new().color(colour).size(6).opacity(0.6)),
            );
            for model in &view.models {
                let modelled = |p: &Point| {
                    let fit = model.fit.runs.get(p.at.run)?.signal(signal)?;
                    fit.modelled.get(p.at.row).map(|v| v * shown.factor)
                };
                let (x, y): (Vec<f64>, Vec<f64>) = mean_by_slip(&class, &modelled).into_iter().unzip();
                plot.add_trace(
                    Scatter::new(all_rounded(x), all_rounded(y))
                        .mode(Mode::Lines)
                        .name(format!("{name}, {}", model.short))
                        .legend_group(&name)
                        .show_legend(false)
                        .meta(format!("model={};group={s}", model.key))
                        .line(Line::new().color(colour).width(2.0).dash(model.dash.clone())),
                );
            }
        }
    }
    plot.set_layout(layout("slip", &shown.axis(&spoken(signal)), true));
    plot
}

/// The values of a class by slip, repeats averaged.
fn mean_by_slip(class: &[&Point], value: &dyn Fn(&Point) -> Option<f64>) -> Vec<(f64, f64)> {
    let mut by_slip: Vec<(f64, f64)> = class.iter().filter_map(|p| Some((p.slip, value(p)?))).collect();
    by_slip.sort_by(|a, b| a.0.total_cmp(&b.0));
    by_slip.chunk_by(|a, b| b.0 - a.0 < 0.005).map(mean).collect()
}

fn mean(points: &[(f64, f64)]) -> (f64, f64) {
    let n = points.len() as f64;
    (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n)
}

/// Means of the set-points of a class that were measured more than once, by slip.
fn repeats_mean(experiment: &Experiment, class: &[&Point], value: &dyn Fn(&Point) -> Option<f64>) -> Vec<(f64, f64)> {
    let mut means = Vec::new();
    for set in experiment.replicates() {
        let own = class.iter().filter(|p| set.contains(&p.at));
        let points: Vec<(f64, f64)> = own.filter_map(|p| Some((p.slip, value(p)?))).collect();
        if points.len() > 1 {
            means.push(mean(&points));
        }
    }
    means.sort_by(|a, b| a.0.total_cmp(&b.0));
    means
}

/// Two standard deviations of one sample about the mean of repeats.
struct Band {
    middle: Vec<(f64, f64)>,
    half: f64,
}

impl Band {
    fn trace(&self, colour: &str) -> Box<Scatter<f64, f64>> {
        let upper = self.middle.iter().map(|(x, y)| (*x, y + self.half));
        let lower = self.middle.iter().rev().map(|(x, y)| (*x, y - self.half));
        let (x, y): (Vec<f64>, Vec<f64>) = upper.chain(lower).unzip();
        Scatter::new(all_rounded(x), all_rounded(y))
            .mode(Mode::Lines)
            .name("repeats, two standard deviations")
            .show_legend(false)
            .fill(Fill::ToSelf)
            .fill_color(faded(colour, 0.18))
            .hover_info(HoverInfo::Skip)
            .line(Line::new().width(0.0).color(colour.to_owned()))
    }
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

fn against_time(view: &View, signal: &str) -> Plot {
    let shown = of_column(signal);
    let experiment = view.experiment;
    let most = (MOST_POINTS / experiment.runs.len().max(1)).max(FEWEST_POINTS);
    let floor = view.floor(signal).map(|floor| 2.0 * floor * shown.factor);
    let mut plot = Plot::new();
    for (k, (_, runs)) in groups(experiment).iter().enumerate() {
        let series = |run: usize, fit: &crate::diagnosis::Fit, measured: bool| -> Vec<(f64, f64)> {
            let (Some(time), Some(fit)) =
                (experiment.runs[run].data.column("time"), fit.runs.get(run).and_then(|run| run.signal(signal)))
            else {
                return Vec::new();
            };
            let values = if measured { &fit.measured } else { &fit.modelled };
            let every = time.len().div_ceil(most);
            time.iter().zip(values).step_by(every).map(|(t, v)| (*t, v * shown.factor)).collect()
        };
        let measured: Vec<Vec<(f64, f64)>> = runs.iter().map(|run| series(*run, view.models[0].fit, true)).collect();
        if let (Some(half), true) = (floor, runs.len() > 1) {
            let band = Band { middle: mean_of_rows(&measured), half };
            plot.add_trace(band.trace(GREY).meta(format!("group={k}")));
        }
        for (nth, points) in measured.iter().enumerate() {
            let (x, y): (Vec<f64>, Vec<f64>) = points.iter().filter(|(_, v)| !v.is_nan()).copied().unzip();
            plot.add_trace(
                Scatter::new(all_rounded(x), all_rounded(y))
                    .mode(Mode::Markers)
                    .name("measured")
                    .legend_group("measured")
                    .show_legend(nth == 0)
                    .meta(format!("group={k}"))
                    .marker(Marker::new().color(COLOURS[0]).size(4).opacity(0.6)),
            );
        }
        for (nth, model) in view.models.iter().enumerate() {
            let (x, y): (Vec<f64>, Vec<f64>) = series(runs[0], model.fit, false).into_iter().unzip();
            let colour = COLOURS[1 + (nth + 1) % (COLOURS.len() - 1)];
            plot.add_trace(
                Scatter::new(all_rounded(x), all_rounded(y))
                    .mode(Mode::Lines)
                    .name(model.short)
                    .meta(format!("model={};group={k}", model.key))
                    .line(Line::new().color(colour).width(2.0).dash(model.dash.clone())),
            );
        }
    }
    plot.set_layout(layout("time (s)", &shown.axis(&spoken(signal)), true));
    plot
}

/// Mean of repeats row by row, over those that measured the row.
fn mean_of_rows(repeats: &[Vec<(f64, f64)>]) -> Vec<(f64, f64)> {
    let rows = repeats.iter().map(Vec::len).max().unwrap_or(0);
    let at = |row: usize| {
        let present: Vec<(f64, f64)> =
            repeats.iter().filter_map(|run| run.get(row).copied()).filter(|(_, v)| !v.is_nan()).collect();
        (!present.is_empty()).then(|| mean(&present))
    };
    (0..rows).filter_map(at).collect()
}
