//! Under which conditions a model fails: signals against conditions in one table.

use crate::report::kinds::of;
use crate::report::page::escape;
use crate::report::plots::{Condition, Samples, View};
use crate::report::units::{digits, short, spoken, wheel_and_field};

/// A mean residual of this many standard deviations of one sample has the full colour.
const FULL: f64 = 3.0;
/// Under this many it has none.
const NONE: f64 = 0.5;

/// The table; `radius` is that of the wheels, m.
pub(super) fn table(view: &View, radius: f64) -> String {
    let experiment = view.experiment;
    let headings = ["time", "position", "pitch", "slope", "load (model)", "slip", "speed"];
    let head: String = headings.iter().map(|name| format!("<th>{name}</th>")).collect();
    let row = |signal: &String| {
        let wheel = wheel_and_field(signal).map_or(1, |(wheel, _)| wheel);
        let conditions = of(experiment).conditions(experiment, wheel, radius);
        let cells: String = conditions.iter().map(|condition| cell(view, signal, condition)).collect();
        format!("<tr><td>{}</td>{cells}</tr>\n", escape(&spoken(signal)))
    };
    let mut signals = experiment.signals();
    let size = |signal: &String| view.model.fit.rmse.get(signal).copied().unwrap_or(0.0) / view.scale(signal);
    signals.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let rows: String = signals.iter().map(row).collect();
    format!(
        "<div class=\"scroll\" tabindex=\"0\"><table class=\"places\">\n<thead><tr><th>largest mean residual over its {}</th>{head}</tr></thead>\n\
         <tbody>\n{rows}</tbody></table></div>",
        view.measure()
    )
}

fn cell(view: &View, signal: &str, condition: &Condition) -> String {
    let nothing = "<td>\u{2013}</td>".to_owned();
    if *condition == Condition::column(signal) {
        return nothing;
    }
    let Some(samples) = Samples::new(view.experiment, view.model.fit, signal, condition) else { return nothing };
    let Some(level) = samples.worst_level() else { return nothing };
    let shown = condition.shown();
    let ratio = level.mean / view.scale(signal);
    let strength = ((ratio.abs() - NONE) / (FULL - NONE)).clamp(0.0, 1.0);
    let ends = [level.low, level.high].map(|end| short(end * shown.factor));
    let place = if ends[0] == ends[1] { ends[0].clone() } else { format!("{} to {}", ends[0], ends[1]) };
    let sign = if ratio > 0.0 { "+" } else { "\u{2212}" };
    let bold = if ratio.abs() >= 1.0 { ("<b>", "</b>") } else { ("", "") };
    format!(
        "<td style=\"--strength:{strength:.2}\">{}{sign}{}{}<br><span class=\"small\">{}</span></td>",
        bold.0,
        digits(ratio.abs()),
        bold.1,
        escape(format!("{place} {}", shown.symbol).trim_end())
    )
}
