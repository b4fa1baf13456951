//! What the page is sent: measurements, models and findings as JSON. Numbers that are not finite are null.

use crate::bench::Bench;
use bekker::diagnosis::{
    Adjustable, Axis, CalibratedParameter, Curves, Diagnosis, Failure, Motion, Trial, Workbench, levels,
};
use bekker::effects::{EFFECTS, Effects};
use bekker::measurement::{Experiment, Kind, Run, Table};
use bekker::report::{column_for_people, parameter_for_people};
use bekker::soil_test::TEST_EFFECTS;
use serde::ser::SerializeSeq;
use serde::{Serialize, Serializer};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// Values of parameters by name, SI units.
pub type Values = BTreeMap<String, f64>;

/// Numbers for a plot: seven digits, which take half the bytes.
struct Plotted<'a>(&'a [f64]);

impl Serialize for Plotted<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut all = to.serialize_seq(Some(self.0.len()))?;
        for value in self.0 {
            all.serialize_element(&(*value as f32))?;
        }
        all.end()
    }
}

fn plotted(values: &[f64]) -> Value {
    json!(Plotted(values))
}

/// An experiment in a list.
pub fn listed(bench: &Bench) -> Value {
    let workbench = bench.workbench();
    let experiment = workbench.experiment();
    json!({ "id": bench.id, "name": experiment.name, "kind": experiment.kind.name(), "example": bench.example })
}

/// All that the page has to know of an experiment but for what the models give.
pub fn experiment(bench: &Bench) -> Value {
    let workbench = bench.workbench();
    let experiment = workbench.experiment();
    let signals = experiment.signals();
    let mut columns: BTreeSet<&str> = signals.iter().map(String::as_str).collect();
    columns.extend(experiment.runs.iter().flat_map(|run| run.data.names().iter().map(String::as_str)));
    let floors = workbench
        .noise_floor()
        .iter()
        .map(|(signal, floor)| (signal.clone(), json!({ "value": floor.value(), "source": floor.source().name() })));
    json!({
        "id": bench.id,
        "name": experiment.name,
        "kind": experiment.kind.name(),
        "example": bench.example,
        "signals": signals,
        "columns": columns.into_iter().map(|name| (name.to_owned(), json!(column_for_people(name)))).collect::<Map<_, _>>(),
        "runs": experiment.runs.iter().map(run).collect::<Vec<_>>(),
        "noise": floors.collect::<Map<_, _>>(),
        "parameters": workbench.parameters().iter().map(|parameter| adjustable(&workbench, parameter)).collect::<Vec<_>>(),
        "effects": effects(&workbench),
        "calibration": workbench.baseline().map(|found| json!({
            "chi_square": found.calibration.chi_square,
            "degrees_of_freedom": found.calibration.degrees_of_freedom,
            "searches": found.calibration.searches,
            "agreeing": found.calibration.agreeing,
            "cautions": found.cautions,
        })),
        "doubts": experiment.doubts,
        "sources": workbench.sources(),
        "uncounted": workbench.uncounted().iter().map(|rows| json!({
            "run": rows.run, "first": rows.rows.0, "last": rows.rows.1, "why": rows.why.name(), "reason": rows.reason,
        })).collect::<Vec<_>>(),
        "wheel": wheel(&workbench),
    })
}

/// Dimensions for a drawing.
fn wheel(workbench: &Workbench) -> Value {
    let radius = workbench.model(&Values::new()).map(|model| model.rover.wheel.radius).ok();
    json!({ "radius": radius })
}

fn run(run: &Run) -> Value {
    let column = |table: &Table, name: &String| (name.clone(), json!(table.column(name).unwrap_or_default()));
    let columns = |table: &Table| table.names().iter().map(|name| column(table, name)).collect::<Map<_, _>>();
    json!({
        "name": run.name,
        "group": run.group,
        "parameters": run.parameters,
        "measured": run.measured,
        "inputs": run.inputs,
        "data": columns(&run.data),
        "terrain": run.terrain.as_ref().map(columns),
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

/// A fitted parameter.
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
        let listed = EFFECTS
            .iter()
            .chain(TEST_EFFECTS)
            .find(|(known, _)| known == id)
            .map(|(_, about)| (*about).trim().to_owned());
        listed.or_else(|| own.iter().find(|own| own.id == *id).map(|own| own.about.clone())).unwrap_or_default()
    };
    let on_carriage = workbench.experiment().kind == Kind::SingleWheel;
    let library = Effects::<f64>::default();
    // An effect without facts, the user's own, may show anywhere.
    let shows = |id: &str| !on_carriage || library.facts_of(id).is_none_or(|facts| !facts.seen_on_carriage.is_empty());
    ids.iter().map(|id| json!({ "id": id, "about": about(id), "shows": shows(id) })).collect()
}

/// A model beside the measurements.
pub fn trial(trial: &Trial, curves: Option<&Curves>, experiment: &Experiment) -> Value {
    let runs = trial.fit.runs.iter().map(|run| {
        run.signals
            .iter()
            .map(|fit| {
                (
                    fit.signal.clone(),
                    json!({
                        "modelled": plotted(&fit.modelled),
                        // Rows that do not count have no residual.
                        "residual": plotted(&fit.residual),
                    }),
                )
            })
            .collect::<Map<_, _>>()
    });
    json!({
        "rmse": trial.fit.rmse,
        "runs": runs.collect::<Vec<_>>(),
        "unanswered": trial.unanswered,
        "failures": trial.failures.iter().map(|failure| self::failure(failure, trial, experiment)).collect::<Vec<_>>(),
        "curves": curves.map(self::curves),
        "motion": trial.fit.motion.iter().map(motion).collect::<Vec<_>>(),
    })
}

fn failure(failure: &Failure, trial: &Trial, experiment: &Experiment) -> Value {
    let levels = levels(experiment, &trial.fit, &failure.signal, &failure.condition);
    json!({
        "signal": failure.signal, "condition": failure.condition, "place": failure.place(),
        "mean": failure.level.mean, "ratio": failure.ratio(), "levels": levels,
    })
}

fn curves(curves: &Curves) -> Value {
    let groups = curves.groups.iter().map(|group| {
        let signals = group.models.first().map(|model| {
            model.signals.iter().map(|(signal, curve)| (signal.clone(), plotted(&curve.value))).collect::<Map<_, _>>()
        });
        json!({ "name": group.name, "rows": group.rows, "at": plotted(&group.at), "signals": signals })
    });
    json!({ "axis": curves.axis.name(), "groups": groups.collect::<Vec<_>>() })
}

fn motion(motion: &Motion) -> Value {
    json!({
        "windows": motion.windows.iter().map(|window| [window.start, window.end]).collect::<Vec<_>>(),
        "x": plotted(&motion.chassis.iter().map(|chassis| chassis[0]).collect::<Vec<_>>()),
        "z": plotted(&motion.chassis.iter().map(|chassis| chassis[1]).collect::<Vec<_>>()),
        "pitch": plotted(&motion.chassis.iter().map(|chassis| chassis[2]).collect::<Vec<_>>()),
        "centres": motion.centres.iter().map(|row| {
            row.iter().map(|centre| [centre[0] as f32, centre[1] as f32]).collect::<Vec<_>>()
        }).collect::<Vec<_>>(),
        "radius": motion.radius,
        "slip": motion.slip.iter().map(|slip| plotted(slip)).collect::<Vec<_>>(),
        "load": motion.load.iter().map(|load| plotted(load)).collect::<Vec<_>>(),
        "ground": plotted(&motion.ground),
    })
}

/// The axis called `name`.
pub fn axis(name: &str) -> Option<Axis> {
    Axis::ALL.into_iter().find(|axis| axis.name() == name)
}

/// What a diagnosis found, without its arrays.
pub fn diagnosis(diagnosis: &Diagnosis) -> Value {
    let mut shown = diagnosis.to_json();
    if let Some(all) = shown.as_object_mut() {
        all.remove("curves");
        all.remove("profiles");
    }
    shown
}
