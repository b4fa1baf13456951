//! The first screen: the verdict, the key figures, what the effects mean, what to beware of.

use super::words::{answer, meaning, named_and_tied, probability, reasons, shown_step};
use crate::diagnosis::{Diagnosis, ParameterResult, Verdict};
use crate::report::page::escape;
use crate::report::units::{digits, of_column, of_unit, spoken};
use crate::report::words::NOISE_ONLY;

/// Signals with a tile of their own; the table of the steps has all.
const MOST_TILES: usize = 4;
/// Cautions that stand open.
const MOST_CAUTIONS: usize = 3;

/// The verdict and its reasons.
pub(super) fn verdict(diagnosis: &Diagnosis) -> String {
    let class = if diagnosis.verdict == Verdict::Explained { "verdict explained" } else { "verdict" };
    let partial = if diagnosis.interrupted { "Interrupted, so far: " } else { "" };
    let reasons: String =
        reasons(diagnosis).iter().filter(|s| !s.is_empty()).map(|s| format!("{} ", escape(s))).collect();
    let next = diagnosis.suggestions.first().map_or_else(String::new, |suggestion| {
        format!("<p><strong>Next:</strong> {} <a href=\"#next\">More</a></p>", escape(&suggestion.text))
    });
    format!(
        "<div class=\"{class}\"><p class=\"answer\">{partial}{}</p>\n<p>{}</p>{}{next}</div>",
        escape(&answer(diagnosis)),
        reasons.trim_end(),
        effects(diagnosis)
    )
}

/// The named or tied effects with their meaning, probability and parameters.
fn effects(diagnosis: &Diagnosis) -> String {
    let (_, tied) = named_and_tied(diagnosis);
    let item = |effect: &String| {
        let candidate = diagnosis.candidates.iter().find(|candidate| candidate.effect == *effect);
        let probability = candidate.map_or_else(String::new, |c| format!("probability {}", probability(c.probability)));
        let in_step = diagnosis.last().parameters.iter().filter(|p| p.effect);
        let own = |p: &&ParameterResult| p.fitted.variable.name.starts_with(&format!("{effect}."));
        let mut parameters: Vec<&ParameterResult> = in_step.filter(own).collect();
        if parameters.is_empty() {
            parameters.extend(candidate.iter().flat_map(|c| &c.parameters));
        }
        let mut facts: Vec<String> = vec![probability];
        if tied.contains(effect) || candidate.is_some_and(|c| c.tied) {
            facts.push("tied".to_owned());
        }
        facts.extend(parameters.into_iter().map(value_with_error));
        facts.retain(|fact| !fact.is_empty());
        format!(
            "<li><code>{}</code> {} <span class=\"small\">{}</span></li>",
            escape(effect),
            escape(&meaning(effect)),
            escape(&facts.join(" \u{b7} "))
        )
    };
    let items: String = diagnosis.involved().iter().map(item).collect();
    if items.is_empty() { items } else { format!("<ul class=\"effects\">{items}</ul>") }
}

/// `name = value ± error unit`.
fn value_with_error(parameter: &ParameterResult) -> String {
    let fitted = &parameter.fitted;
    let shown = of_unit(fitted.variable.unit);
    let error = fitted.deviation.map_or_else(String::new, |d| format!(" \u{b1} {}", digits(d * shown.factor)));
    let bound = fitted.bound_note().map_or_else(String::new, |note| format!(" ({note})"));
    let text = format!("{} = {}{error} {}", fitted.variable.name, digits(fitted.value * shown.factor), shown.symbol);
    format!("{}{bound}", text.trim_end())
}

/// One tile a signal: error before and after against the noise floor.
pub(super) fn tiles(diagnosis: &Diagnosis) -> String {
    let (baseline, last) = (diagnosis.baseline(), shown_step(diagnosis));
    let mut signals: Vec<(&String, f64, Option<f64>)> = baseline
        .rmse
        .iter()
        .map(|(signal, rmse)| (signal, *rmse, diagnosis.noise_floor.get(signal).and_then(|floor| floor.value())))
        .collect();
    let ratio = |entry: &(&String, f64, Option<f64>)| entry.2.map_or(0.0, |floor| entry.1 / floor);
    signals.sort_by(|a, b| ratio(b).total_cmp(&ratio(a)));
    let more = signals.len().saturating_sub(MOST_TILES);
    let tiles: String = signals
        .into_iter()
        .take(MOST_TILES)
        .map(|(signal, before, floor)| {
            let after = last.rmse.get(signal).copied().unwrap_or(before);
            tile(signal, before, last.added.is_some().then_some(after), floor)
        })
        .collect();
    let bars = if last.added.is_some() {
        "Bars: error of the calibrated baseline (grey) and with what was added (coloured); the mark is the noise floor."
    } else {
        "Bars: error of the calibrated baseline; the mark is the noise floor."
    };
    let more = match more {
        0 => String::new(),
        n => format!(
            " {n} more signals, with less error for their noise, in <a href=\"#steps\">the error, step by step</a>."
        ),
    };
    format!("<div class=\"tiles\">{tiles}</div><p class=\"small\">{bars}{more}</p>")
}

fn tile(signal: &str, before: f64, after: Option<f64>, floor: Option<f64>) -> String {
    let shown = of_column(signal);
    let last = after.unwrap_or(before);
    let full = before.max(last).max(floor.unwrap_or(0.0)).max(f64::MIN_POSITIVE) * 1.02;
    let width = |value: f64| 100.0 * value / full;
    let above = floor.is_none_or(|floor| last > NOISE_ONLY * floor);
    let figure = match after {
        Some(after) => format!("{} \u{2192} {}", digits(before * shown.factor), shown.number(after)),
        None => shown.number(before),
    };
    let tick = floor.map_or_else(String::new, |floor| format!("<u style=\"left:{:.1}%\"></u>", width(floor)));
    let noise = floor.map_or("noise unknown".to_owned(), |floor| {
        let times = digits(last / floor);
        format!("noise {}; error now {times} times that", shown.number(floor))
    });
    format!(
        "<div class=\"tile\"><span>error in {}</span><b>{}</b><div class=\"track\" aria-hidden=\"true\">\
         <i style=\"width:{:.1}%\"></i><i class=\"after{}\" style=\"width:{:.1}%\"></i>{tick}</div><span>{}</span></div>",
        escape(&spoken(signal)),
        escape(&figure),
        width(before),
        if above { " above" } else { "" },
        width(last),
        escape(&noise)
    )
}

/// What the reader should beware of.
pub(super) fn cautions(diagnosis: &Diagnosis) -> String {
    let item = |caution: &String| format!("<li>{}</li>", escape(caution));
    let open: String = diagnosis.cautions.iter().take(MOST_CAUTIONS).map(item).collect();
    let rest: String = diagnosis.cautions.iter().skip(MOST_CAUTIONS).map(item).collect();
    if open.is_empty() {
        return String::new();
    }
    let rest = if rest.is_empty() {
        rest
    } else {
        let count = diagnosis.cautions.len() - MOST_CAUTIONS;
        format!("<details><summary>{count} more</summary><ul class=\"cautions\">{rest}</ul></details>")
    };
    format!("<p><strong>Beware</strong></p><ul class=\"cautions\">{open}</ul>{rest}")
}
