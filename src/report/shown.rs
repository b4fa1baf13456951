//! What the page is told: measurements, models and findings as JSON. A server sends it piece by piece, a saved report holds it. Numbers
//! that are not finite are null.

use super::units::{column_for_people, parameter_for_people};
use crate::diagnosis::{
    Adjustable, Axis, CalibratedParameter, Calibration, Curves, Diagnosis, Failure, Fit, Motion, UnansweredRows,
    Workbench, levels,
};
use crate::effects::{EFFECTS, Effects};
use crate::measurement::{Experiment, Kind, Run, Table};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

pub use super::packed::Form;

/// Values of parameters by name, SI units.
pub type Values = BTreeMap<String, f64>;

/// All that the page has to know of an experiment but for what the models give. `id` is its name in an address; `example` says that it
/// is the shipped example, with which the page teaches its use.
#[must_use]
pub fn experiment(workbench: &Workbench, experiment: &Experiment, id: &str, example: bool, form: &Form) -> Value {
    let signals = experiment.signals();
    let mut columns: BTreeSet<&str> = signals.iter().map(String::as_str).collect();
    columns.extend(experiment.runs.iter().flat_map(|run| run.data.names().iter().map(String::as_str)));
    let floors = workbench
        .noise_floor()
        .iter()
        .map(|(signal, floor)| (signal.clone(), json!({ "value": floor.value(), "source": floor.source().name() })));
    let runs = experiment.runs.iter().enumerate().map(|(number, own)| run(own, number, form));
    json!({
        "id": id,
        "name": experiment.name,
        "kind": experiment.kind.name(),
        "example": example,
        "signals": signals,
        "columns": columns.into_iter().map(|name| (name.to_owned(), json!(column_for_people(name)))).collect::<Map<_, _>>(),
        "runs": runs.collect::<Vec<_>>(),
        "noise": floors.collect::<Map<_, _>>(),
        "parameters": workbench.parameters().iter().map(|parameter| adjustable(workbench, parameter)).collect::<Vec<_>>(),
        "known": known(workbench, form),
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
        "uncounted": uncounted(workbench, experiment, form),
        "wheel": wheel(workbench),
    })
}

/// What no calibration moves; a file has no models for it.
fn known(workbench: &Workbench, form: &Form) -> Vec<Value> {
    let all = if form.is_plain() { workbench.known_parameters() } else { Vec::new() };
    all.iter().map(|parameter| adjustable(workbench, parameter)).collect()
}

fn uncounted(workbench: &Workbench, experiment: &Experiment, form: &Form) -> Vec<Value> {
    let number = |name: &String| experiment.runs.iter().position(|run| run.name == *name).unwrap_or(0);
    let all = workbench.uncounted();
    let shown = all.iter().filter_map(|rows| {
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
        "prior": parameter.prior,
        "fitted": fitted.map(fitted_value),
    })
}

/// A fit of some effects, `found` in the background or by a diagnosis.
#[must_use]
pub fn found(effects: &[String], fit: &Calibration) -> Value {
    let all = fit.parameters.iter();
    let mut effects = effects.to_vec();
    effects.sort();
    json!({
        "effects": effects,
        "values": all.clone().map(|p| (p.variable.name.clone(), json!(p.value))).collect::<Map<_, _>>(),
        "chi_square": fit.chi_square,
        "fitted": all.map(|p| (p.variable.name.clone(), fitted_value(p))).collect::<Map<_, _>>(),
    })
}

/// A fitted parameter.
#[must_use]
pub fn fitted_value(fitted: &CalibratedParameter) -> Value {
    json!({
        "value": fitted.value, "std": fitted.deviation, "at_bound": fitted.at_bound, "prior_shift": fitted.prior_shift(),
    })
}

/// The effects that may be added, with their meaning.
fn effects(workbench: &Workbench) -> Vec<Value> {
    let mut ids: Vec<String> = Vec::new();
    for id in workbench.parameters().into_iter().filter_map(|parameter| parameter.effect) {
        if !ids.contains(&id) {
            ids.push(id);
        }
    }
    let own = &workbench.experiment().effects;
    let about = |id: &String| {
        let listed = EFFECTS.iter().find(|(known, _)| known == id).map(|(_, about)| (*about).trim().to_owned());
        listed.or_else(|| own.iter().find(|own| own.id == *id).map(|own| own.about.clone())).unwrap_or_default()
    };
    let on_carriage = workbench.experiment().kind == Kind::SingleWheel;
    let library = Effects::<f64>::default();
    // An effect without facts, the user's own, may show anywhere.
    let shows = |id: &str| !on_carriage || library.facts_of(id).is_none_or(|facts| !facts.seen_on_carriage.is_empty());
    ids.iter().map(|id| json!({ "id": id, "about": about(id), "shows": shows(id) })).collect()
}

/// A model beside the measurements; `curves` are those of it to be drawn, `step` which of their models it is.
#[must_use]
pub fn model(
    experiment: &Experiment,
    fit: &Fit,
    failures: &[Failure],
    unanswered: &[UnansweredRows],
    form: &Form,
) -> Value {
    let runs = fit.runs.iter().enumerate().map(|(number, run)| {
        let signal = |fit: &crate::diagnosis::SignalFit| (fit.signal.clone(), form.of_run(number, &fit.modelled));
        run.signals.iter().map(signal).collect::<Map<_, _>>()
    });
    json!({
        "rmse": fit.rmse,
        "runs": runs.collect::<Vec<_>>(),
        "unanswered": unanswered,
        "failures": failures.iter().map(|failure| self::failure(failure, fit, experiment)).collect::<Vec<_>>(),
        "motion": fit.motion.iter().enumerate().map(|(number, own)| motion(own, number, form)).collect::<Vec<_>>(),
    })
}

fn failure(failure: &Failure, fit: &Fit, experiment: &Experiment) -> Value {
    let levels = levels(experiment, fit, &failure.signal, &failure.condition);
    json!({
        "signal": failure.signal, "condition": failure.condition, "place": failure.place(),
        "mean": failure.level.mean, "ratio": failure.ratio(), "levels": levels,
    })
}

/// The curves of one of the models over an input.
#[must_use]
pub fn curves(curves: &Curves, step: Option<usize>, form: &Form) -> Value {
    let groups = curves.groups.iter().map(|group| {
        let own = group.models.iter().find(|model| model.step == step);
        let signals = own.map(|model| {
            let one = |curve: &crate::diagnosis::Curve| {
                let band = curve.high != curve.value || curve.low != curve.value;
                let ends = band.then(|| [form.of_all(&curve.low), form.of_all(&curve.high)]);
                json!({ "value": form.of_all(&curve.value), "band": ends })
            };
            model.signals.iter().map(|(signal, curve)| (signal.clone(), one(curve))).collect::<Map<_, _>>()
        });
        let row = |(run, row): &(usize, usize)| form.place(*run, *row).map(|row| [*run, row]);
        let rows: Vec<_> = group.rows.iter().filter_map(row).collect();
        json!({ "name": group.name, "rows": rows, "at": form.of_all(&group.at), "signals": signals })
    });
    json!({ "axis": curves.axis.name(), "groups": groups.collect::<Vec<_>>() })
}

fn motion(motion: &Motion, number: usize, form: &Form) -> Value {
    let of = |values: &[f64]| form.of_run(number, values);
    let chassis = |k: usize| of(&motion.chassis.iter().map(|chassis| chassis[k]).collect::<Vec<_>>());
    let wheels = motion.centres.first().map_or(0, Vec::len);
    let centre = |wheel: usize, k: usize| {
        let own = motion.centres.iter().map(|row| row.get(wheel).map_or(f64::NAN, |centre| centre[k]));
        of(&own.collect::<Vec<_>>())
    };
    let windows = motion.windows.iter().map(|window| form.rows(number, window.clone()));
    json!({
        "windows": windows.filter(|rows| !rows.is_empty()).map(|rows| [rows.start, rows.end]).collect::<Vec<_>>(),
        "x": chassis(0),
        "z": chassis(1),
        "pitch": chassis(2),
        "centres": (0..wheels).map(|wheel| [centre(wheel, 0), centre(wheel, 1)]).collect::<Vec<_>>(),
        "radius": motion.radius,
        "slip": motion.slip.iter().map(|slip| of(slip)).collect::<Vec<_>>(),
        "load": motion.load.iter().map(|load| of(load)).collect::<Vec<_>>(),
        "ground": of(&motion.ground),
    })
}

/// The axis called `name`.
#[must_use]
pub fn axis(name: &str) -> Option<Axis> {
    Axis::ALL.into_iter().find(|axis| axis.name() == name)
}

/// What a diagnosis found, without its arrays.
#[must_use]
pub fn diagnosis(diagnosis: &Diagnosis) -> Value {
    let mut shown = diagnosis.to_json();
    if let Some(all) = shown.as_object_mut() {
        all.remove("curves");
        all.remove("profiles");
    }
    shown
}
