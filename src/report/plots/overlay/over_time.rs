//! A traverse: measured and modelled over time, a colour a wheel where wheels share a plot.

use super::{Panel, area, groups, legend_line, list, stretches};
use crate::diagnosis::Fit;
use crate::measurement::Experiment;
use crate::report::plots::{COLOURS, GREY, View, all_rounded, axis, layout};
use crate::report::units::{of_column, spoken, wheel_and_field};
use plotly::common::{Line, Marker, Mode};
use plotly::{Plot, Scatter};

/// A plot has at most about this many points a model; the numbers are computed from all of them.
const MOST_POINTS: usize = 12_000;
/// A run keeps at least this many of them.
const FEWEST_POINTS: usize = 150;

/// Time between rows, in usual times between them, from which on it is a gap, and the least that is one, s.
const GAP: f64 = 3.5;
const LEAST_GAP: f64 = 0.5;

/// Times and values of one signal of one run, display units.
type Series = (Vec<f64>, Vec<f64>);

/// One panel.
pub(in crate::report) fn panels(view: &View) -> Vec<Panel> {
    let plots =
        quantities(view.experiment).into_iter().map(|(title, signals)| (title, overlay(view, &signals))).collect();
    vec![Panel { when: String::new(), plots }]
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

/// Lists that choose the group of repeats and the wheel.
pub(in crate::report) fn controls(view: &View) -> String {
    let mut html = String::new();
    let names = groups(view.experiment).into_iter().enumerate().map(|(k, (name, _))| (k.to_string(), name));
    html.push_str(&list("Run", "group", "", &names.collect::<Vec<_>>()));
    let wheels = quantities(view.experiment).iter().map(|(_, signals)| signals.len()).max().unwrap_or(1);
    if wheels > 1 {
        let mut options = vec![("all".to_owned(), "all".to_owned())];
        options.extend((1..=wheels).map(|wheel| (wheel.to_string(), wheel.to_string())));
        html.push_str(&list("Wheel", "wheel", "", &options));
    }
    html
}

/// What the traces of one group of repeats and one signal share.
struct Drawing<'a> {
    view: &'a View<'a>,
    signal: &'a str,
    /// Number of the wheel, where wheels share the plot.
    wheel: Option<usize>,
    /// Colour of what was measured.
    colour: &'static str,
    group: usize,
    runs: &'a [usize],
}

/// The plot of one signal, or of the same quantity of several wheels.
pub(super) fn overlay(view: &View, signals: &[String]) -> Plot {
    let mut plot = Plot::new();
    let shared = signals.len() > 1;
    for (group, (_, runs)) in groups(view.experiment).iter().enumerate() {
        for (k, signal) in signals.iter().enumerate() {
            let wheel = wheel_and_field(signal).map(|(wheel, _)| wheel).filter(|_| shared);
            let colour = COLOURS[k % COLOURS.len()];
            Drawing { view, signal, wheel, colour, group, runs }.draw(&mut plot);
        }
        stretches::add(&mut plot, view, group, runs);
    }
    if shared {
        view.models.iter().for_each(|model| plot.add_trace(legend_line(model, GREY)));
    }
    let quantity = match signals.first().and_then(|signal| wheel_and_field(signal)) {
        Some((_, field)) if shared => field.replace('_', " "),
        _ => signals.first().map_or(String::new(), |signal| spoken(signal)),
    };
    let shown = of_column(signals.first().map_or("", String::as_str));
    let marks = axis("").overlaying("y").range(vec![0.0, 1.0]).visible(false);
    plot.set_layout(layout("time (s)", &shown.axis(&quantity), true).y_axis2(marks));
    plot
}

impl Drawing<'_> {
    fn draw(&self, plot: &mut Plot) {
        let Some(first) = self.view.models.first() else { return };
        let measured: Vec<Series> = self.runs.iter().map(|run| self.series(*run, first.fit, true)).collect();
        if let Some(deviation) = self.view.noise.get(self.signal) {
            let half = 2.0 * deviation * of_column(self.signal).factor;
            let (time, middle) = without_gaps(mean_of_rows(&measured));
            let ends = |sign: f64| middle.iter().map(|v| v + sign * half).collect::<Vec<_>>();
            plot.add_trace(area(&time, &ends(-1.0), &ends(1.0), self.colour, 0.16).meta(self.meta("")));
        }
        let name = self.wheel.map_or("measured".to_owned(), |wheel| format!("wheel {wheel}"));
        for (nth, (time, values)) in measured.into_iter().enumerate() {
            plot.add_trace(
                Scatter::new(all_rounded(time), all_rounded(values))
                    .mode(Mode::Markers)
                    .name(&name)
                    .legend_group(&name)
                    .show_legend(nth == 0)
                    .meta(self.meta(""))
                    .marker(Marker::new().color(self.colour).size(4).opacity(0.45)),
            );
        }
        for model in &self.view.models {
            // Repeats have the same commands, so one stands for all.
            let (time, values) = self.series(self.runs[0], model.fit, false);
            let colour = if self.wheel.is_some() { self.colour } else { model.colour };
            plot.add_trace(
                Scatter::new(all_rounded(time), all_rounded(values))
                    .mode(Mode::Lines)
                    .name(if self.wheel.is_some() { format!("{name}, {}", model.short) } else { model.name.clone() })
                    .legend_group(if self.wheel.is_some() { &name } else { model.key })
                    .show_legend(self.wheel.is_none())
                    .meta(self.meta(&format!("model={};", model.key)))
                    .line(Line::new().color(colour).width(2.0).dash(model.dash.clone())),
            );
        }
    }

    fn meta(&self, model: &str) -> String {
        let wheel = self.wheel.map_or(String::new(), |wheel| format!("wheel={wheel};"));
        format!("{model}{wheel}group={}", self.group)
    }

    /// Number of the window of a row.
    fn window(&self, run: usize, row: usize) -> Option<usize> {
        let motion = self.view.shown()?.fit.motion.get(run)?;
        motion.windows.iter().position(|window| window.contains(&row))
    }

    /// Thinned evenly where there is more than a screen shows; missing values are gaps.
    fn series(&self, run: usize, fit: &Fit, measured: bool) -> Series {
        let experiment = self.view.experiment;
        let most = (MOST_POINTS / experiment.runs.len().max(1)).max(FEWEST_POINTS);
        let (Some(time), Some(fit)) =
            (experiment.runs[run].data.column("time"), fit.runs.get(run).and_then(|run| run.signal(self.signal)))
        else {
            return (Vec::new(), Vec::new());
        };
        let values = if measured { &fit.measured } else { &fit.modelled };
        let factor = of_column(self.signal).factor;
        let mut series = Series::default();
        let every = time.len().div_ceil(most).max(1);
        let begins = |row: usize| !measured && self.window(run, row) != self.window(run, row.saturating_sub(every));
        for (row, (t, v)) in time.iter().zip(values).enumerate().step_by(every) {
            // Each window begins anew, so that its line does not go on from the one before.
            if begins(row) {
                series.0.push(*t);
                series.1.push(f64::NAN);
            }
            series.0.push(*t);
            series.1.push(v * factor);
        }
        series
    }
}

/// The same with NaN in each gap of the recording, so that nothing is drawn there.
fn without_gaps((time, values): Series) -> Series {
    let usual = time.last().zip(time.first()).map_or(0.0, |(last, first)| last - first) / time.len() as f64;
    let mut series = Series::default();
    for (row, (t, value)) in time.iter().zip(values).enumerate() {
        if row > 0 && t - time[row - 1] > (GAP * usual).max(LEAST_GAP) {
            series.0.push(*t);
            series.1.push(f64::NAN);
        }
        series.0.push(*t);
        series.1.push(value);
    }
    series
}

/// Mean of repeats row by row, over those that measured the row; NaN where none did.
fn mean_of_rows(repeats: &[Series]) -> Series {
    let rows = repeats.iter().map(|(time, _)| time.len()).max().unwrap_or(0);
    let mean = |row: usize| {
        let at = |values: &dyn Fn(&Series) -> Option<f64>| {
            let present: Vec<f64> = repeats.iter().filter_map(values).filter(|v| !v.is_nan()).collect();
            present.iter().sum::<f64>() / present.len() as f64
        };
        (at(&|(time, _)| time.get(row).copied()), at(&|(_, values)| values.get(row).copied()))
    };
    (0..rows).map(mean).unzip()
}
