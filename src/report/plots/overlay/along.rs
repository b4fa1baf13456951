//! A test of a soil: measured and modelled along the input that takes its course, a colour a group of repeats.

use super::{Panel, groups, legend_line, list};
use crate::diagnosis::Fit;
use crate::report::plots::{COLOURS, DrawnModel, GREY, View, all_rounded, between, layout};
use crate::report::units::{of_column, spoken};
use plotly::common::{Line, Marker, Mode};
use plotly::{Plot, Scatter};

/// More groups than this have colours in order from the first to the last of these.
const MOST_NAMED: usize = COLOURS.len();
const ORDER: [&str; 4] = [COLOURS[0], COLOURS[2], COLOURS[1], COLOURS[3]];

/// One panel, along `input`.
pub(in crate::report) fn panels(view: &View, input: &str) -> Vec<Panel> {
    let plots = view.experiment.signals().into_iter().map(|signal| (spoken(&signal), overlay(view, input, &signal)));
    vec![Panel { when: String::new(), plots: plots.collect() }]
}

/// A list that chooses the group of repeats.
pub(in crate::report) fn controls(view: &View) -> String {
    let mut options = vec![("all".to_owned(), "all".to_owned())];
    options.extend(groups(view.experiment).into_iter().enumerate().map(|(k, (name, _))| (k.to_string(), name)));
    if options.len() > 2 { list("Run", "group", "", &options) } else { String::new() }
}

fn overlay(view: &View, input: &str, signal: &str) -> Plot {
    let (at, shown) = (of_column(input), of_column(signal));
    let all = groups(view.experiment);
    let mut plot = Plot::new();
    for (group, (name, runs)) in all.iter().enumerate() {
        let colour = match all.len() {
            count if count <= MOST_NAMED => COLOURS[group].to_owned(),
            count => between(&ORDER, group as f64 / (count - 1) as f64),
        };
        for (nth, run) in runs.iter().enumerate() {
            let along: Vec<f64> = view.experiment.runs[*run].data.column(input).unwrap_or_default().to_vec();
            let x = || all_rounded(along.iter().map(|x| x * at.factor));
            let series = |fit: &Fit, modelled: bool| -> Vec<f64> {
                let own = fit.runs.get(*run).and_then(|run| run.signal(signal));
                let values = own.map(|own| if modelled { &own.modelled } else { &own.measured });
                all_rounded(values.into_iter().flatten().map(|value| value * shown.factor))
            };
            let model_line = |model: &DrawnModel| {
                Scatter::new(x(), series(model.fit, true))
                    .mode(Mode::Lines)
                    .name(format!("{name}, {}", model.name))
                    .legend_group(name)
                    .show_legend(false)
                    .meta(format!("model={};group={group}", model.key))
                    .line(Line::new().color(colour.clone()).width(2.0).dash(model.dash.clone()))
            };
            // Repeats have about the same inputs, so one line stands for all.
            view.models.iter().filter(|_| nth == 0).for_each(|model| plot.add_trace(model_line(model)));
            let Some(first) = view.models.first() else { continue };
            plot.add_trace(
                Scatter::new(x(), series(first.fit, false))
                    .mode(Mode::Markers)
                    .name(name)
                    .legend_group(name)
                    .show_legend(nth == 0)
                    .meta(format!("group={group}"))
                    .marker(Marker::new().color(colour.clone()).size(5).opacity(0.6)),
            );
        }
    }
    view.models.iter().for_each(|model| plot.add_trace(legend_line(model, GREY)));
    plot.set_layout(layout(&at.axis(&spoken(input)), &shown.axis(&spoken(signal)), true));
    plot
}
