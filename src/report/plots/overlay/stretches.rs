//! Windows of a run, and the rows that do not count, behind signals over time.

use crate::diagnosis::Uncounted;
use crate::report::plots::{GREY, View, all_rounded, faded};
use plotly::common::{DashType, Fill, HoverInfo, Line, Mode};
use plotly::{Plot, Scatter};

/// The axis from 0 to 1 that shadings fill from bottom to top.
const WHOLE_HEIGHT: &str = "y2";

/// Why rows do not count, and the colour of each reason.
pub(in crate::report) const REASONS: [(Uncounted, &str); 4] = [
    (Uncounted::Start, "#8b949e"),
    (Uncounted::Gap, "#0ea5b7"),
    (Uncounted::Odd, "#9b6bdf"),
    (Uncounted::NoAnswer, "#e5484d"),
];

/// Adds both for one group of repeats.
pub(super) fn add(plot: &mut Plot, view: &View, group: usize, runs: &[usize]) {
    let meta = format!("group={group}");
    for (why, colour) in REASONS {
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for [from, to] in spans(view, runs, why) {
            x.extend([from, from, to, to, f64::NAN]);
            y.extend([0.0, 1.0, 1.0, 0.0, f64::NAN]);
        }
        if x.is_empty() {
            continue;
        }
        plot.add_trace(
            Scatter::new(all_rounded(x), y)
                .mode(Mode::Lines)
                .name(format!("not counted: {}", why.name()))
                .y_axis(WHOLE_HEIGHT)
                .meta(meta.clone())
                .fill(Fill::ToSelf)
                .fill_color(faded(colour, 0.2))
                .hover_info(HoverInfo::Skip)
                .line(Line::new().width(0.0).color(colour)),
        );
    }
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for begin in boundaries(view, runs) {
        x.extend([begin, begin, f64::NAN]);
        y.extend([0.0, 1.0, f64::NAN]);
    }
    if !x.is_empty() {
        plot.add_trace(
            Scatter::new(all_rounded(x), y)
                .mode(Mode::Lines)
                .name("window begins")
                .y_axis(WHOLE_HEIGHT)
                .meta(meta)
                .hover_info(HoverInfo::Skip)
                .line(Line::new().width(1.0).color(GREY).dash(DashType::Dot)),
        );
    }
}

/// Times of the stretches of the runs that do not count for this reason, each once.
fn spans(view: &View, runs: &[usize], why: Uncounted) -> Vec<[f64; 2]> {
    let named = |name: &str| runs.iter().any(|run| view.experiment.runs[*run].name == name);
    let own = view.uncounted.iter().filter(|rows| rows.why == why && named(&rows.run));
    let mut spans: Vec<[f64; 2]> = own.filter_map(|rows| rows.seconds).collect();
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut joined: Vec<[f64; 2]> = Vec::new();
    for [from, to] in spans {
        match joined.last_mut().filter(|last| from <= last[1]) {
            Some(last) => last[1] = last[1].max(to),
            None => joined.push([from, to]),
        }
    }
    joined
}

/// Times at which windows of the first of the runs begin, but for the first.
fn boundaries(view: &View, runs: &[usize]) -> Vec<f64> {
    let run = runs[0];
    let motion = view.shown().and_then(|model| model.fit.motion.get(run));
    let time = view.experiment.runs[run].data.column("time").unwrap_or_default();
    let windows = motion.map_or(&[][..], |motion| &motion.windows);
    windows.iter().skip(1).filter_map(|window| time.get(window.start).copied()).collect()
}
