//! What was measured, and how it is drawn beside the model.

use super::{begin, noise};
use crate::diagnosis::Diagnosis;
use crate::measurement::{Experiment, Run};
use crate::report::kinds::of;
use crate::report::page::{Page, escape, table};
use crate::report::units::{of_column, short, spoken};
use std::collections::BTreeMap;

/// The groups of runs and the ranges of what was set and measured.
pub(super) fn add_measured(page: &mut Page, diagnosis: &Diagnosis) {
    let experiment = &diagnosis.experiment;
    let known: Vec<String> =
        experiment.parameters.iter().map(|(name, value)| format!("{name} = {}", short(*value))).collect();
    let known =
        if known.is_empty() { String::new() } else { format!("Known of the rig (SI units): {}. ", known.join(", ")) };
    let of_sensors = experiment.sensor_parameters().into_iter().map(|(variable, prior)| (variable.name, prior));
    let priors = experiment.priors.iter().map(|(name, prior)| (name.clone(), *prior)).chain(of_sensors);
    let priors: Vec<String> = priors
        .map(|(name, prior)| format!("{name} = {} \u{b1} {}", short(prior.mean), short(prior.deviation)))
        .collect();
    let priors = if priors.is_empty() { String::new() } else { format!("Priors (SI units): {}.", priors.join(", ")) };
    let drive = experiment.measured_drive().map_or_else(String::new, |note| format!(" Of the {note}."));
    begin(page, "measured", (known + &priors + &drive).trim());
    page.html(&format!("<p class=\"lead\">{}</p>", escape(&how_drawn(experiment, &noise(diagnosis)))));
    page.html(&ranges(experiment));
    let rows: Vec<Vec<String>> = groups(experiment);
    let count = rows.len();
    let table = table(&["group", "runs", "rows", "changed for it (SI units)"], &rows);
    page.html(&format!("<details><summary>The runs, in {count} groups of repeats</summary>{table}</details>"));
}

/// Lowest and highest value of every column.
fn ranges(experiment: &Experiment) -> String {
    let measured = experiment.signals();
    let mut columns: Vec<(String, &str)> = Vec::new();
    columns.extend(of(experiment).inputs().iter().map(|name| ((*name).to_owned(), "input")));
    for name in experiment.runs.iter().flat_map(|run| &run.inputs) {
        if !columns.iter().any(|(known, _)| known == name) {
            columns.push((name.clone(), "input"));
        }
    }
    columns.extend(measured.into_iter().map(|name| (name, "measured")));
    let row = |(name, what): &(String, &str)| {
        let values = experiment.runs.iter().flat_map(|run| run.data.column(name).unwrap_or_default());
        let present: Vec<f64> = values.copied().filter(|v| !v.is_nan()).collect();
        let low = present.iter().copied().fold(f64::INFINITY, f64::min);
        let high = present.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let shown = of_column(name);
        (!present.is_empty()).then(|| {
            let range = format!("{} .. {}", short(low * shown.factor), short(high * shown.factor));
            vec![spoken(name), (*what).to_owned(), range, shown.symbol.to_owned(), present.len().to_string()]
        })
    };
    let rows: Vec<Vec<String>> = columns.iter().filter_map(row).collect();
    table(&["column", "", "range", "unit", "values"], &rows)
}

fn groups(experiment: &Experiment) -> Vec<Vec<String>> {
    let mut groups: Vec<(String, Vec<&Run>)> = Vec::new();
    for run in &experiment.runs {
        let name = run.group.clone().unwrap_or_else(|| run.name.clone());
        match groups.iter_mut().find(|(known, _)| *known == name) {
            Some((_, runs)) => runs.push(run),
            None => groups.push((name, vec![run])),
        }
    }
    let row = |(name, runs): (String, Vec<&Run>)| {
        let rows: usize = runs.iter().map(|run| run.data.rows()).sum();
        let changed: Vec<String> =
            runs[0].parameters.iter().map(|(name, value)| format!("{name} = {}", short(*value))).collect();
        vec![name, runs.len().to_string(), rows.to_string(), changed.join(", ")]
    };
    groups.into_iter().map(row).collect()
}

/// What points, bars, lines and bands of the plots are.
pub(in crate::report) fn how_drawn(experiment: &Experiment, noise: &BTreeMap<String, f64>) -> String {
    let known: Vec<String> = noise
        .iter()
        .map(|(signal, deviation)| format!("{} {}", spoken(signal), of_column(signal).number(2.0 * deviation)))
        .collect();
    of(experiment).how_drawn(&known.join(", "))
}
