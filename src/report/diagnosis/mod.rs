//! The page of a diagnosis. The script shows the verdict first, measured beside modelled with the effects that were tried, and where
//! the model fails; below stands the argument in this order: what was measured; where the baseline fails; is that more than noise; what
//! calibration can absorb; which effect; how the error falls; the final model; its parameters; what remains; what to measure next.

mod evidence;
mod first_screen;
mod measured;
mod misfit;
mod parameters;
mod words;

pub(super) use measured::how_drawn;
pub use words::verdict_in_words;

use super::drive;
use super::page::{Page, escape};
use super::plots::{DrawnModel, View};
use super::saved::saved_diagnosis;
use super::units::spoken;
use super::words::what_was_measured;
use crate::diagnosis::{Diagnosis, Verdict};
use std::collections::BTreeMap;
use words::listed;

/// The place of what only a drive has.
const DRIVE: &str = "drive";

/// Places of the page and the questions that they answer.
const PLACES: [(&str, &str); 11] = [
    (DRIVE, "The drive"),
    ("measured", "What was measured"),
    ("fails", "Where the baseline fails"),
    ("noise", "Is it more than noise?"),
    ("calibration", "What calibration can absorb"),
    ("effects", "Which effect?"),
    ("steps", "The error, step by step"),
    ("improved", "The final model"),
    ("parameters", "Parameters"),
    ("remains", "What remains"),
    ("next", "The next experiment"),
];

/// A self-contained HTML page of a diagnosis: no network, light and dark, readable on a phone.
#[must_use]
pub fn diagnosis_page(diagnosis: &Diagnosis) -> String {
    let name = &diagnosis.experiment.name;
    let mut page = Page::new(&format!("{name}: diagnosis"));
    page.data(saved_diagnosis(diagnosis).to_string());
    page.html("<div id=\"first\">");
    page.html(&format!("<h1>{}: diagnosis</h1>", escape(name)));
    page.html(&format!("<p class=\"lead\">{}</p>", escape(&what_was_measured(&diagnosis.experiment))));
    let view = view(diagnosis);
    page.html(&first_screen::verdict(diagnosis));
    page.html(&drive::at_first_sight(&view));
    page.html(&first_screen::tiles(diagnosis));
    page.html(&first_screen::cautions(diagnosis));
    page.html("</div>");
    let places = PLACES.iter().filter(|(place, _)| *place != DRIVE || drive::is_shown(&view));
    let links: String = places.map(|(place, title)| format!("<a href=\"#{place}\">{title}</a> ")).collect();
    page.html(&format!("<nav aria-label=\"Contents\">{links}</nav>"));
    if drive::is_shown(&view) {
        begin(&mut page, DRIVE, "");
        drive::add(&mut page, &view, diagnosis.improved.rover.wheel.radius);
    }
    measured::add_measured(&mut page, diagnosis);
    misfit::add_failures(&mut page, diagnosis);
    evidence::add_noise(&mut page, diagnosis);
    parameters::add_calibration(&mut page, diagnosis);
    evidence::add_candidates(&mut page, diagnosis);
    evidence::add_steps(&mut page, diagnosis);
    add_final_model(&mut page, diagnosis);
    parameters::add_parameters(&mut page, diagnosis);
    misfit::add_remains(&mut page, diagnosis);
    add_next(&mut page, diagnosis);
    page.finish()
}

/// Adds the heading of a place.
fn begin(page: &mut Page, place: &str, lead: &str) {
    let title = PLACES.iter().find(|(known, _)| *known == place).map_or(place, |(_, title)| title);
    page.section_at(place, title, lead);
}

/// Effects of the final model, in the order in which they were added.
fn added(diagnosis: &Diagnosis) -> Vec<String> {
    diagnosis.steps.iter().filter_map(|step| step.added.clone()).collect()
}

/// "with slip sinkage", for the legend of the final model.
fn final_name(diagnosis: &Diagnosis) -> String {
    format!("with {}", listed(&added(diagnosis), "and"))
}

/// The baseline, whose failures the text tells.
fn view(diagnosis: &Diagnosis) -> View<'_> {
    View {
        experiment: &diagnosis.experiment,
        noise: noise(diagnosis),
        uncounted: &diagnosis.uncounted,
        model: DrawnModel { name: "the calibrated model", fit: &diagnosis.baseline().fit },
    }
}

/// Standard deviation of one sample by signal, as the diagnosis weighs it.
fn noise(diagnosis: &Diagnosis) -> BTreeMap<String, f64> {
    diagnosis.noise.iter().map(|(signal, noise)| (signal.clone(), noise.deviation)).collect()
}

fn add_final_model(page: &mut Page, diagnosis: &Diagnosis) {
    if diagnosis.steps.len() < 2 {
        begin(page, "improved", "No effect was added: the final model is the calibrated baseline.");
        return;
    }
    let named = if words::tried(diagnosis).is_empty() { "" } else { ", which is the nearest but not named" };
    let lead =
        format!("The residuals that the model {}{named} leaves; the baseline's means are grey.", final_name(diagnosis));
    begin(page, "improved", &lead);
    misfit::add_residuals_left(page, diagnosis);
}

fn add_next(page: &mut Page, diagnosis: &Diagnosis) {
    let lead = match diagnosis.verdict {
        Verdict::Undetermined => "What would settle what this experiment leaves open, the most useful first.",
        _ => "What would tell more, the most useful first.",
    };
    if diagnosis.suggestions.is_empty() {
        let why = if diagnosis.interrupted {
            "The work was interrupted before one was looked for."
        } else {
            "No further experiment is suggested."
        };
        begin(page, "next", why);
        return;
    }
    begin(page, "next", lead);
    let item = |suggestion: &crate::diagnosis::Suggestion| {
        let effects = if suggestion.effects.is_empty() {
            String::new()
        } else {
            let names: Vec<String> = suggestion.effects.iter().map(|effect| spoken(effect)).collect();
            format!(" <span class=\"small\">(for {})</span>", escape(&names.join(", ")))
        };
        format!("<li>{}{effects}</li>", escape(&suggestion.text))
    };
    let items: String = diagnosis.suggestions.iter().map(item).collect();
    page.html(&format!("<ol>{items}</ol>"));
}
