//! The page of a comparison, in this order: what was measured, how large is the error against
//! the noise, what do measurement and model look like, where does it fail, what did the calibration do.

use super::diagnosis::how_drawn;
use super::drive;
use super::page::{Page, escape, table};
use super::plots::{Condition, DrawnModel, Samples, View, residuals};
use super::saved::saved_comparison;
use super::units::{digits, of_column, of_unit, short, spoken};
use super::words::{first_capital, sentence, source, summary, what_was_measured};
use crate::diagnosis::{Calibration, Comparison, Failure, UnansweredRows, determined_in_words};
use crate::report::kinds::of;
use serde_json::Value;

/// Sentences on where the model fails.
const MOST_SENTENCES: usize = 5;

/// A self-contained HTML page of a comparison: no network, light and dark, readable on a phone.
#[must_use]
pub fn comparison_page(comparison: &Comparison) -> String {
    page_with(comparison, &saved_comparison(comparison), None)
}

/// The same with the models that `saved` holds, and a `note` before anything else is said.
pub(super) fn page_with(comparison: &Comparison, saved: &Value, note: Option<&str>) -> String {
    let name = &comparison.experiment.name;
    let mut page = Page::new(&format!("{name}: model and measurement"));
    page.data(saved.to_string());
    page.html("<div id=\"first\">");
    page.html(&format!("<h1>{}: model and measurement</h1>", escape(name)));
    page.html(&format!("<p class=\"lead\">{}</p>", escape(&what_was_measured(&comparison.experiment))));
    page.html(&note.map_or_else(String::new, |note| format!("<p>{}</p>", escape(note))));
    let sentences: String = summary(comparison).iter().map(|s| format!("<p>{}</p>", escape(s))).collect();
    page.html(&format!("<div class=\"verdict\">{sentences}</div>"));
    let view = view(comparison);
    page.html(&drive::at_first_sight(&view));
    page.html(&errors(comparison));
    page.html(&unanswered("As given", &comparison.given_unanswered));
    if comparison.calibrated.is_some() {
        page.html(&unanswered("Calibrated", &comparison.unanswered));
    }
    let cautions: String = comparison.cautions.iter().map(|c| format!("<p>{}</p>", escape(c))).collect();
    page.html(&cautions);
    page.html("</div>");
    if drive::is_shown(&view) {
        page.section_at("drive", "The drive", "");
        drive::add(&mut page, &view, comparison.model.rover.wheel.radius);
    }
    page.html(&format!("<p class=\"lead\">{}</p>", escape(&how_drawn(view.experiment, &view.noise))));
    add_failures(&mut page, comparison);
    if let Some((calibration, _)) = &comparison.calibrated {
        add_parameters(&mut page, calibration);
        let determined = determined_in_words(&comparison.identified);
        page.html(
            &determined.iter().map(|words| format!("<p>{}.</p>", escape(&first_capital(words)))).collect::<String>(),
        );
    }
    page.finish()
}

/// Root mean square error by signal beside the noise floor.
fn errors(comparison: &Comparison) -> String {
    let rows: Vec<Vec<String>> = comparison
        .experiment
        .signals()
        .iter()
        .map(|signal| {
            let shown = of_column(signal);
            let error = |fit: Option<&crate::diagnosis::Fit>| {
                fit.and_then(|fit| fit.rmse.get(signal)).map_or("none".to_owned(), |rmse| shown.number(*rmse))
            };
            let floor = comparison.noise_floor.get(signal).and_then(|floor| floor.value());
            let ratio = floor.zip(comparison.fit().rmse.get(signal)).map(|(floor, rmse)| rmse / floor);
            let mut row = vec![spoken(signal), error(comparison.given.as_ref().ok())];
            row.extend(comparison.calibrated.as_ref().map(|(_, fit)| error(Some(fit))));
            row.push(floor.map_or("unknown".to_owned(), |floor| shown.number(floor)));
            row.push(ratio.map_or(String::new(), digits));
            row.push(source(&comparison.noise_floor, signal));
            row
        })
        .collect();
    let mut header = vec!["error (RMS)", "as given"];
    header.extend(comparison.calibrated.is_some().then_some("calibrated"));
    header.extend(["noise floor", "error / noise", "floor from"]);
    table(&header, &rows)
}

/// The rows without an answer, which the errors leave out; nothing where there are none.
fn unanswered(which: &str, unanswered: &[UnansweredRows]) -> String {
    if unanswered.is_empty() {
        return String::new();
    }
    let count: usize = unanswered.iter().map(UnansweredRows::count).sum();
    let item = |rows: &UnansweredRows| format!("<li>{}</li>", escape(&rows.to_string()));
    let items: String = unanswered.iter().map(item).collect();
    format!("<p>{which}, the model has no answer in {count} rows, which its errors leave out:</p><ul>{items}</ul>")
}

/// The model whose failures the text tells.
fn view(comparison: &Comparison) -> View<'_> {
    let name = if comparison.calibrated.is_some() { "the calibrated model" } else { "the model as given" };
    let noise = comparison.noise_floor.iter().filter_map(|(signal, floor)| Some((signal.clone(), floor.value()?)));
    View {
        experiment: &comparison.experiment,
        noise: noise.collect(),
        uncounted: &comparison.uncounted,
        model: DrawnModel { name, fit: comparison.fit() },
    }
}

fn add_failures(page: &mut Page, comparison: &Comparison) {
    page.section(
        "Where it fails",
        "Residuals (measured less model) against the conditions. The band is two standard deviations of the noise of one sample; \
         diamonds are means at set-points, lines are smooths, each with two standard errors: away from zero they are structure, not \
         noise.",
    );
    let clear = |failure: &&Failure| failure.ratio().is_none_or(|ratio| ratio > 1.0);
    let items: String = comparison
        .failures
        .iter()
        .filter(clear)
        .take(MOST_SENTENCES)
        .map(|failure| format!("<li>{}</li>", escape(&sentence(failure))))
        .collect();
    let nothing = "<p>No mean residual exceeds the noise of one sample.</p>".to_owned();
    page.html(&if items.is_empty() { nothing } else { format!("<ul>{items}</ul>") });
    for signal in comparison.experiment.signals() {
        let floor = comparison.noise_floor.get(&signal).and_then(|floor| floor.value());
        let plots: Vec<_> = of(&comparison.experiment)
            .residual_conditions()
            .iter()
            .filter(|condition| **condition != signal)
            .filter_map(|condition| {
                let title = format!("{} against {}", spoken(&signal), spoken(condition));
                let condition = Condition::Column((*condition).to_owned());
                let samples = Samples::new(&comparison.experiment, comparison.fit(), &signal, &condition)?;
                Some((title, residuals(&samples, floor, None)))
            })
            .collect();
        if !plots.is_empty() {
            page.plots(&plots);
        }
    }
}

fn add_parameters(page: &mut Page, calibration: &Calibration) {
    let how = if calibration.converged { "converged" } else { "did NOT converge" };
    page.section(
        "Calibrated parameters",
        &format!(
            "{} of {} searches from different starts ended at the same error; the best {how} in {} steps. Standard errors take the \
             residuals as independent.",
            calibration.agreeing, calibration.searches, calibration.steps
        ),
    );
    let rows: Vec<Vec<String>> = calibration
        .parameters
        .iter()
        .map(|p| {
            let shown = of_unit(p.variable.unit);
            let number = |value: f64| digits(value * shown.factor);
            let mut notes = Vec::new();
            if let Some(note) = p.bound_note() {
                notes.push(note.to_owned());
            } else if p.deviation.is_none() {
                notes.push("not determined".to_owned());
            }
            if let Some(shift) = p.prior_shift() {
                notes.push(format!("{} sigma from its prior", digits(shift)));
            }
            vec![
                p.variable.name.clone(),
                shown.symbol.to_owned(),
                number(p.start),
                number(p.value),
                p.deviation.map_or(String::new(), number),
                format!("{} .. {}", short(p.variable.min * shown.factor), short(p.variable.max * shown.factor)),
                notes.join(", "),
            ]
        })
        .collect();
    page.html(&table(&["parameter", "unit", "before", "after", "std. error", "bounds", "note"], &rows));
    let weights: Vec<String> = calibration
        .weights
        .iter()
        .map(|(signal, deviation)| format!("{} {}", spoken(signal), of_column(signal).number(*deviation)))
        .collect();
    page.html(&format!("<p class=\"small\">Residuals were divided by: {}.</p>", escape(&weights.join(", "))));
}
