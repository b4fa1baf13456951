//! What calibration did and can do, and the parameters of the final model.

use super::{begin, final_name};
use crate::diagnosis::{Diagnosis, ParameterResult, STANDARD_ERROR};
use crate::report::page::{Page, escape, table};
use crate::report::plots::{profile, visible_shares};
use crate::report::units::{Shown, digits, of_unit, short};

/// The baseline's parameters, and how much of each effect they can take on.
pub(super) fn add_calibration(page: &mut Page, diagnosis: &Diagnosis) {
    begin(
        page,
        "calibration",
        "Calibration moves the soil's parameters within published bounds and takes on a part of any missing effect. A value on its bound, or \
         far from its prior, is a sign of that.",
    );
    page.html(&parameter_table(diagnosis, &diagnosis.baseline().parameters, false));
    if !diagnosis.candidates.is_empty() {
        page.html(
            "<p>What calibration cannot take on is what is left to recognise an effect by: 1 is all of its trace in the measurements, 0 none.</p>",
        );
        page.html(&visible_shares(diagnosis));
    }
}

/// The final model's parameters, with profiles.
pub(super) fn add_parameters(page: &mut Page, diagnosis: &Diagnosis) {
    let model = if diagnosis.steps.len() > 1 {
        format!("The model {}", final_name(diagnosis))
    } else {
        "The calibrated baseline".to_owned()
    };
    let profiles = if diagnosis.profiles.is_empty() && diagnosis.interrupted {
        " The work was interrupted before the profiles."
    } else {
        ""
    };
    begin(
        page,
        "parameters",
        &format!(
            "{model}. Intervals are 95 % intervals of the profile likelihood; an end that is open within the bounds is marked.{profiles}"
        ),
    );
    page.html(&parameter_table(diagnosis, &diagnosis.last().parameters, true));
    page.html(&format!(
        "<p class=\"small\">Std. error, and what follows \u{b1} above: {}.</p>",
        escape(STANDARD_ERROR)
    ));
    let plots: Vec<_> = diagnosis
        .profiles
        .iter()
        .filter(|own| own.profile.len() > 1)
        .map(|own| {
            let shown = shown(diagnosis, &own.name);
            (shown.axis(&own.name), profile(own, shown, &shown.axis(&own.name)))
        })
        .collect();
    if !plots.is_empty() {
        page.html(
            "<p class=\"small\">Profiles: how much worse the fit gets with a parameter held at a value and all others refitted. The shaded \
             interval ends where the curve crosses the dotted line.</p>",
        );
        page.plots(&plots);
    }
}

/// Display unit of a parameter of the final model.
fn shown(diagnosis: &Diagnosis, name: &str) -> Shown {
    let parameters = &diagnosis.last().parameters;
    let known = parameters.iter().find(|parameter| parameter.fitted.variable.name == name);
    known.map_or(Shown { symbol: "", factor: 1.0 }, |parameter| of_unit(parameter.fitted.variable.unit))
}

fn parameter_table(diagnosis: &Diagnosis, parameters: &[ParameterResult], intervals: bool) -> String {
    let row = |parameter: &ParameterResult| {
        let fitted = &parameter.fitted;
        let shown = of_unit(fitted.variable.unit);
        let number = |value: f64| digits(value * shown.factor);
        let mut notes = Vec::new();
        if parameter.effect {
            notes.push("added effect".to_owned());
        }
        if let Some(note) = fitted.bound_note() {
            notes.push(note.to_owned());
        } else if fitted.deviation.is_none() {
            notes.push("not determined".to_owned());
        }
        if let Some(shift) = fitted.prior_shift() {
            notes.push(format!("{} sigma from its prior", digits(shift)));
        }
        let mut row = vec![
            fitted.variable.name.clone(),
            shown.symbol.to_owned(),
            number(fitted.start),
            number(fitted.value),
            fitted.deviation.map_or("\u{2013}".to_owned(), number),
        ];
        if intervals {
            row.push(interval(diagnosis, &fitted.variable.name, shown));
        }
        row.push(format!(
            "{} .. {}",
            short(fitted.variable.min * shown.factor),
            short(fitted.variable.max * shown.factor)
        ));
        row.push(notes.join(", "));
        row
    };
    let rows: Vec<Vec<String>> = parameters.iter().map(row).collect();
    let mut header = vec!["parameter", "unit", "given", "fitted", "std. error"];
    header.extend(intervals.then_some("95 % interval"));
    header.extend(["bounds", "note"]);
    table(&header, &rows)
}

fn interval(diagnosis: &Diagnosis, name: &str, shown: Shown) -> String {
    let Some(own) = diagnosis.profiles.iter().find(|own| own.name == name) else { return "\u{2013}".to_owned() };
    let end = |end: Option<f64>| end.map_or("open".to_owned(), |value| digits(value * shown.factor));
    format!("{} .. {}", end(own.interval.0), end(own.interval.1))
}
