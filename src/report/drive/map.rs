//! Every window of every run at a glance.

use super::stretch::{Stretch, stretches};
use crate::report::page::escape;
use crate::report::plots::{DrawnModel, REASONS, View, axis, layout_with, rounded};
use crate::report::units::{digits, spoken};
use plotly::layout::BarMode;
use plotly::{Plot, Trace};
use serde::Serialize;
use serde_json::{Value, json};

/// Multiples of the noise at the ends of the colours: up to the first an error passes for noise.
pub(super) const NOISE: f64 = 1.0;
pub(super) const LARGE: f64 = 5.0;
/// From noise to large errors; told apart also by those who do not see red and green.
pub(super) const COLOURS: [(f64, &str); 5] =
    [(0.0, "#3b82f6"), (0.2, "#3b82f6"), (0.4, "#e8c31e"), (0.7, "#e8871e"), (1.0, "#b3261e")];
/// Names of runs longer than this leave no room on a phone: their numbers stand in for them.
const LONG_NAME: usize = 12;
/// Height of the plot of few runs, pixels: the scale of its colours has to be legible.
const LEAST_HEIGHT: usize = 240;
/// Signals that the text of a window names.
const NAMED: usize = 3;

/// A trace of its JSON, with what the traces of the plotting crate lack.
#[derive(Clone, Serialize)]
#[serde(transparent)]
struct Json(Value);

impl Trace for Json {
    fn to_json(&self) -> String {
        self.0.to_string()
    }
}

/// Bars over time, one row a run and one bar a window, coloured by the error over the noise.
pub(super) fn map(view: &View) -> Plot {
    let mut plot = Plot::new();
    let signals = view.experiment.signals();
    for model in &view.models {
        let all = stretches(view, model);
        let counted: Vec<&Stretch> = all.iter().filter(|stretch| stretch.why.is_none()).collect();
        let meta = |signal: &str| format!("model={};error={signal}", model.key);
        let words: Vec<String> = counted.iter().map(|stretch| words(view, model, stretch)).collect();
        plot.add_trace(bars(view, &counted, &|stretch| stretch.worst(), &words, &meta("worst")));
        for signal in &signals {
            let ratio = |stretch: &Stretch| {
                stretch.ratios.iter().find(|(own, _)| own == signal).map_or(f64::NAN, |(_, ratio)| *ratio)
            };
            let words: Vec<String> = counted.iter().map(|own| of_signal(view, own, signal, ratio(own))).collect();
            plot.add_trace(bars(view, &counted, &ratio, &words, &meta(signal)));
        }
    }
    if let Some(model) = view.shown() {
        add_uncounted(&mut plot, view, &stretches(view, model));
    }
    let runs = view.experiment.runs.len();
    // The first run on top.
    let rows = axis(run_axis(view)).range(vec![runs as f64 - 0.5, -0.5]);
    let rows = rows.tick_values((0..runs).map(|run| run as f64).collect());
    let rows = rows.tick_text((0..runs).map(|run| escape(&label(view, run))).collect());
    let layout = layout_with(axis("time (s)"), rows, true)
        .bar_mode(BarMode::Overlay)
        .height((130 + 22 * runs).max(LEAST_HEIGHT));
    plot.set_layout(layout);
    plot
}

/// Names of the runs on the axis: short ones as they are.
fn label(view: &View, run: usize) -> String {
    if are_short(view) { view.experiment.runs[run].name.clone() } else { (run + 1).to_string() }
}

fn are_short(view: &View) -> bool {
    view.experiment.runs.iter().all(|run| run.name.len() <= LONG_NAME)
}

fn run_axis(view: &View) -> &'static str {
    if are_short(view) { "run" } else { "run number" }
}

/// Where bars stand.
fn places<'s>(stretches: impl Iterator<Item = &'s Stretch>) -> Value {
    let (mut y, mut base, mut x, mut at) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for stretch in stretches {
        y.push(stretch.run);
        base.push(rounded(stretch.seconds[0]));
        x.push(rounded(stretch.seconds[1] - stretch.seconds[0]));
        at.push(json!([stretch.run, rounded(stretch.seconds[0])]));
    }
    json!({ "type": "bar", "orientation": "h", "y": y, "base": base, "x": x, "width": 0.8, "customdata": at })
}

fn bars(
    view: &View,
    stretches: &[&Stretch],
    ratio: &dyn Fn(&Stretch) -> f64,
    words: &[String],
    meta: &str,
) -> Box<dyn Trace> {
    let mut trace = places(stretches.iter().copied());
    let colour = |stretch: &&Stretch| {
        let ratio = ratio(stretch);
        ratio.is_finite().then(|| rounded(ratio))
    };
    let scale: Vec<Value> = COLOURS.iter().map(|(at, colour)| json!([at, colour])).collect();
    trace["marker"] = json!({
        "color": stretches.iter().map(colour).collect::<Vec<_>>(),
        "colorscale": scale,
        "cmin": 0.0,
        "cmax": LARGE,
        "showscale": true,
        "colorbar": { "title": { "text": format!("error / {}", view.measure()), "side": "right" }, "thickness": 12, "dtick": NOISE },
        "line": { "width": 1, "color": "rgba(128, 128, 128, 0.6)" },
    });
    trace["meta"] = json!(meta);
    trace["hovertext"] = json!(words);
    trace["hoverinfo"] = json!("text");
    trace["showlegend"] = json!(false);
    Box::new(Json(trace))
}

fn add_uncounted(plot: &mut Plot, view: &View, all: &[Stretch]) {
    for (why, colour) in REASONS {
        let own: Vec<&Stretch> = all.iter().filter(|stretch| stretch.why == Some(why)).collect();
        if own.is_empty() {
            continue;
        }
        let mut trace = places(own.iter().copied());
        let words = |stretch: &&Stretch| escape(&format!("{}: not counted, {}", place(view, stretch), why.name()));
        trace["marker"] = json!({ "color": colour, "opacity": 0.45, "pattern": { "shape": "/", "size": 6 } });
        trace["name"] = json!(format!("not counted: {}", why.name()));
        trace["hovertext"] = json!(own.iter().map(words).collect::<Vec<_>>());
        trace["hoverinfo"] = json!("text");
        trace["showlegend"] = json!(true);
        plot.add_trace(Box::new(Json(trace)));
    }
}

/// Run, window and time of a stretch.
fn place(view: &View, stretch: &Stretch) -> String {
    let [from, to] = stretch.seconds;
    format!("run {}, window {}, {from:.1} to {to:.1} s", view.experiment.runs[stretch.run].name, stretch.window)
}

fn words(view: &View, model: &DrawnModel, stretch: &Stretch) -> String {
    let mut lines = vec![place(view, stretch)];
    lines.extend(super::ground_under(model, stretch));
    let one = |(signal, ratio): &(String, f64)| {
        format!("{}: {} times its {}", spoken(signal), digits(*ratio), view.measure())
    };
    lines.extend(stretch.ratios.iter().take(NAMED).map(one));
    lines.iter().map(|line| escape(line)).collect::<Vec<_>>().join("<br>")
}

fn of_signal(view: &View, stretch: &Stretch, signal: &str, ratio: f64) -> String {
    let text = if ratio.is_nan() {
        "nothing measured".to_owned()
    } else {
        format!("{} times its {}", digits(ratio), view.measure())
    };
    format!("{}<br>{}", escape(&place(view, stretch)), escape(&format!("{}: {text}", spoken(signal))))
}
