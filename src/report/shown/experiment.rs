//! What the page has to know of an experiment but for what the models give.

use super::{Form, Values, fitted_value};
use crate::diagnosis::{Adjustable, UncountedRows, Workbench, plain_effect};
use crate::effects::{EFFECTS, Effects};
use crate::measurement::{Experiment, Kind, Run, Table};
use crate::report::units::{column_for_people, parameter_for_people};
use crate::soil_test::TEST_EFFECTS;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// All that the page has to know of an experiment but for what the models give. `id` is its name in an address; `example` says that it
/// is the shipped example, with which the page teaches its use.
///
/// Of several experiments on one soil the measurements stand in `parts`, each under its own names; parameters, effects and the noise are
/// those of all.
#[must_use]
pub fn experiment(workbench: &Workbench, experiment: &Experiment, id: &str, example: bool, form: &Form) -> Value {
    let parts = experiment.parts.iter().zip(workbench.parts()).enumerate();
    let part = |(k, (part, bench)): (usize, (&crate::measurement::Part, &Workbench))| {
        let mut shown = measured(bench, &part.experiment, &workbench.uncounted_of_part(k), form);
        let _ = shown.insert("part".to_owned(), json!(part.name));
        shown
    };
    let parts: Vec<_> = parts.map(part).collect();
    let mut shown = match parts.is_empty() {
        true => measured(workbench, experiment, &workbench.uncounted(), form),
        false => of_all(workbench, experiment),
    };
    let about = json!({
        "id": id,
        "example": example,
        "parameters": adjustables(workbench, workbench.parameters()),
        // A file has no models for what no calibration moves.
        "known": if form.is_plain() { adjustables(workbench, workbench.known_parameters()) } else { Vec::new() },
        "effects": effects(workbench),
        "calibration": workbench.baseline().map(|found| json!({
            "chi_square": found.calibration.chi_square,
            "degrees_of_freedom": found.calibration.degrees_of_freedom,
            "searches": found.calibration.searches,
            "agreeing": found.calibration.agreeing,
            "cautions": found.cautions,
        })),
        "doubts": experiment.doubts,
        "sources": workbench.sources(),
        "parts": parts,
    });
    shown.extend(about.as_object().cloned().unwrap_or_default());
    Value::Object(shown)
}

/// What was measured in one experiment.
fn measured(
    workbench: &Workbench,
    experiment: &Experiment,
    uncounted: &[UncountedRows],
    form: &Form,
) -> Map<String, Value> {
    let signals = experiment.signals();
    let mut names: BTreeSet<&str> = signals.iter().map(String::as_str).collect();
    names.extend(experiment.runs.iter().flat_map(|run| run.data.names().iter().map(String::as_str)));
    let columns = names.into_iter().map(|name| (name.to_owned(), json!(column_for_people(name))));
    let runs = experiment.runs.iter().enumerate().map(|(number, own)| run(own, number, form));
    let mut shown = of_all(workbench, experiment);
    shown.extend([
        ("columns".to_owned(), Value::Object(columns.collect())),
        ("runs".to_owned(), runs.collect()),
        ("uncounted".to_owned(), left_out(uncounted, experiment, form).into()),
        ("wheel".to_owned(), wheel(workbench)),
    ]);
    shown
}

/// What is said of several experiments as of one.
fn of_all(workbench: &Workbench, experiment: &Experiment) -> Map<String, Value> {
    let floors = workbench
        .noise_floor()
        .iter()
        .map(|(signal, floor)| (signal.clone(), json!({ "value": floor.value(), "source": floor.source().name() })));
    let shown = json!({
        "name": experiment.name,
        "kind": experiment.kind.name(),
        "signals": experiment.signals(),
        "noise": floors.collect::<Map<_, _>>(),
        "columns": {},
        "runs": [],
        "uncounted": [],
        "wheel": { "radius": null },
    });
    shown.as_object().cloned().unwrap_or_default()
}

fn left_out(uncounted: &[UncountedRows], experiment: &Experiment, form: &Form) -> Vec<Value> {
    let number = |name: &String| experiment.runs.iter().position(|run| run.name == *name).unwrap_or(0);
    let shown = uncounted.iter().filter_map(|rows| {
        let kept = form.rows(number(&rows.run), rows.rows.0 - 1..rows.rows.1);
        (!kept.is_empty()).then(|| {
            json!({
                "run": rows.run, "first": kept.start + 1, "last": kept.end, "why": rows.why.name(), "reason": rows.reason,
            })
        })
    });
    shown.collect()
}

/// Dimensions for a drawing.
fn wheel(workbench: &Workbench) -> Value {
    let radius = workbench.model(&Values::new()).map(|model| model.rover.wheel.radius).ok();
    json!({ "radius": radius })
}

fn run(run: &Run, number: usize, form: &Form) -> Value {
    let columns = |table: &Table, of: &dyn Fn(&[f64]) -> Value| {
        let column = |name: &String| (name.clone(), of(table.column(name).unwrap_or_default()));
        table.names().iter().map(column).collect::<Map<_, _>>()
    };
    json!({
        "name": run.name,
        "group": run.group,
        "parameters": run.parameters,
        "measured": run.measured,
        "inputs": run.inputs,
        "data": columns(&run.data, &|values| form.of_run(number, values)),
        "terrain": run.terrain.as_ref().map(|terrain| columns(terrain, &|values| form.of_all(values))),
        "rows": run.data.rows(),
    })
}

fn adjustables(workbench: &Workbench, all: &[Adjustable]) -> Vec<Value> {
    all.iter().map(|parameter| adjustable(workbench, parameter)).collect()
}

fn adjustable(workbench: &Workbench, parameter: &Adjustable) -> Value {
    let variable = &parameter.variable;
    let people = parameter_for_people(variable);
    let fitted = workbench
        .baseline()
        .and_then(|found| found.calibration.parameters.iter().find(|fitted| fitted.variable.name == variable.name));
    json!({
        "name": variable.name,
        "about": variable.doc,
        "source": variable.source,
        "unit": people.unit,
        "factor": people.factor,
        "min": variable.min,
        "max": variable.max,
        "start": parameter.start,
        "typical": parameter.typical,
        "effect": parameter.effect,
        "parts": parameter.parts.as_ref().map(|parts| names(workbench, parts)),
        "prior": parameter.prior,
        "fitted": fitted.map(fitted_value),
    })
}

/// Short names of some of several experiments.
fn names<'a>(workbench: &'a Workbench, parts: &[usize]) -> Vec<&'a str> {
    parts.iter().map(|k| workbench.experiment().parts[*k].name.as_str()).collect()
}

/// The effects that may be added, with their meaning; of several experiments once for every place in which one may act.
fn effects(workbench: &Workbench) -> Vec<Value> {
    let mut all: Vec<(&String, &Option<Vec<usize>>)> = Vec::new();
    for parameter in workbench.parameters() {
        if let Some(id) = parameter.effect.as_ref().filter(|id| all.iter().all(|(known, _)| known != id)) {
            all.push((id, &parameter.parts));
        }
    }
    let library = Effects::<f64>::default();
    let effect = |(id, parts): (&String, &Option<Vec<usize>>)| {
        let plain = plain_effect(id);
        json!({
            "id": id,
            "plain": plain,
            "parts": parts.as_ref().map(|parts| names(workbench, parts)),
            "about": about(workbench.experiment(), plain),
            "shows": shows(&library, workbench.experiment(), plain, parts.as_deref()),
        })
    };
    all.into_iter().map(effect).collect()
}

/// What an effect is, in words: of the library, or as the experiment defines it.
fn about(experiment: &Experiment, id: &str) -> String {
    let known = EFFECTS.iter().chain(TEST_EFFECTS).find(|(known, _)| *known == id);
    let all = std::iter::once(experiment).chain(experiment.parts.iter().map(|part| &part.experiment));
    let own = || all.flat_map(|experiment| &experiment.effects).find(|own| own.id == id).map(|own| own.about.clone());
    known.map(|(_, about)| (*about).trim().to_owned()).or_else(own).unwrap_or_default()
}

/// Whether an effect can show where it acts. One without facts, the user's own, may show anywhere.
fn shows(library: &Effects<f64>, experiment: &Experiment, id: &str, parts: Option<&[usize]>) -> bool {
    let on_carriage = library.facts_of(id).is_none_or(|facts| !facts.seen_on_carriage.is_empty());
    let of_kind = |kind: Kind| kind != Kind::SingleWheel || on_carriage;
    match parts {
        Some(parts) => parts.iter().any(|k| of_kind(experiment.parts[*k].experiment.kind)),
        None => of_kind(experiment.kind),
    }
}
