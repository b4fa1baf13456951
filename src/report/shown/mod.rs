//! What the page is told: measurements, models and findings as JSON. A server sends it piece by piece, a saved report holds it. Numbers
//! that are not finite are null.

mod experiment;

use crate::diagnosis::{
    Axis, CalibratedParameter, Calibration, Curves, Diagnosis, Failure, Fit, Motion, UnansweredRows, levels,
};
use crate::measurement::Experiment;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

pub use super::packed::Form;
pub use experiment::experiment;

/// Values of parameters by name, SI units.
pub type Values = BTreeMap<String, f64>;

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
