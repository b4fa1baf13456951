//! What the page of a comparison or a diagnosis holds of its models.

use super::{Saved, Step, Tried};
use crate::diagnosis::{Calibration, Comparison, Curves, Diagnosis, Workbench, failures};
use crate::report::shown::{self, Values};
use serde_json::Value;
use std::borrow::Cow;

/// The data of a comparison's page.
pub(in crate::report) fn saved_comparison(comparison: &Comparison) -> Value {
    let (floors, bench) = (&comparison.noise_floor, &comparison.workbench);
    let given = comparison.given.iter().map(|fit| Step {
        label: "as given".to_owned(),
        effects: Vec::new(),
        values: Values::new(),
        fit: Cow::Borrowed(fit),
        failures: failures(&comparison.experiment, fit, floors),
        unanswered: comparison.given_unanswered.as_slice().into(),
        curves: drawn(&comparison.curves, None),
        toml: toml(bench, &Values::new()),
    });
    let calibrated = comparison.calibrated.iter().map(|(calibration, fit)| Step {
        label: "calibrated".to_owned(),
        effects: Vec::new(),
        values: values_of(calibration),
        fit: Cow::Borrowed(fit),
        failures: comparison.failures.clone(),
        unanswered: comparison.unanswered.as_slice().into(),
        curves: drawn(&comparison.curves, Some(0)),
        toml: toml(bench, &values_of(calibration)),
    });
    let found = comparison.calibrated.iter().map(|(calibration, _)| Tried {
        effects: Vec::new(),
        values: values_of(calibration),
        found: shown::found(&[], calibration),
    });
    let saved = Saved {
        experiment: &comparison.experiment,
        workbench: bench,
        steps: given.chain(calibrated).collect(),
        tried: found.collect(),
        diagnosis: None,
    };
    saved.json()
}

/// The data of a diagnosis's page.
pub(in crate::report) fn saved_diagnosis(diagnosis: &Diagnosis) -> Value {
    let tried = fits(diagnosis).map(|(effects, calibration)| Tried {
        values: values_of(calibration),
        found: shown::found(effects, calibration),
        effects: effects.to_vec(),
    });
    let saved = Saved {
        experiment: &diagnosis.experiment,
        workbench: &diagnosis.workbench,
        steps: steps(diagnosis),
        tried: tried.collect(),
        diagnosis: Some(found_of(diagnosis)),
    };
    saved.json()
}

/// The models of a diagnosis: as given, calibrated, and with each effect that was added.
pub(super) fn steps(diagnosis: &Diagnosis) -> Vec<Step<'_>> {
    let (floors, bench) = (&diagnosis.noise_floor, &diagnosis.workbench);
    let mut effects = Vec::new();
    let given = diagnosis.given.iter().map(|fit| Step {
        label: "as given".to_owned(),
        effects: Vec::new(),
        values: Values::new(),
        fit: Cow::Borrowed(fit),
        failures: failures(&diagnosis.experiment, fit, floors),
        unanswered: Cow::default(),
        curves: drawn(&diagnosis.curves, None),
        toml: toml(bench, &Values::new()),
    });
    let steps = diagnosis.steps.iter().enumerate().map(|(number, step)| {
        effects.extend(step.added.clone());
        let values: Values = step.parameters.iter().map(|p| (p.fitted.variable.name.clone(), p.fitted.value)).collect();
        Step {
            label: step.added.as_ref().map_or("soil calibrated".to_owned(), |id| format!("+ {}", id.replace('_', " "))),
            effects: effects.clone(),
            fit: Cow::Borrowed(&step.fit),
            failures: if number == 0 {
                diagnosis.failures.clone()
            } else {
                failures(&diagnosis.experiment, &step.fit, floors)
            },
            unanswered: diagnosis.unanswered.as_slice().into(),
            curves: drawn(&diagnosis.curves, Some(number)),
            toml: toml(bench, &values),
            values,
        }
    });
    given.chain(steps).collect()
}

/// The fits of a diagnosis with their effects, the baseline's first.
pub(super) fn fits(diagnosis: &Diagnosis) -> impl Iterator<Item = (&[String], &Calibration)> {
    let baseline = diagnosis.workbench.baseline().map(|found| (&[][..], &found.calibration));
    baseline.into_iter().chain(diagnosis.tried.iter().map(|fit| (fit.effects.as_slice(), &fit.calibration)))
}

/// What a diagnosis found, as far as the page shows it.
pub(super) fn found_of(diagnosis: &Diagnosis) -> Value {
    let mut shown = shown::diagnosis(diagnosis);
    if let Some(all) = shown.as_object_mut() {
        all.remove("noise_models");
    }
    shown
}

/// Fitted values by name.
pub(super) fn values_of(calibration: &Calibration) -> Values {
    calibration.parameters.iter().map(|p| (p.variable.name.clone(), p.value)).collect()
}

fn drawn(curves: &[Curves], number: Option<usize>) -> Vec<(Cow<'_, Curves>, Option<usize>)> {
    curves.iter().map(|curves| (Cow::Borrowed(curves), number)).collect()
}

fn toml(bench: &Workbench, values: &Values) -> Option<String> {
    bench.model(values).ok().and_then(|model| model.to_toml().ok())
}
