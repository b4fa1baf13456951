//! A model beside the measurements, as a hand has set it; of several experiments on one soil beside those of one, with the errors of all.

use crate::bench::Bench;
use crate::error::Refusal;
use bekker::diagnosis::{Curves, Trial, Workbench};
use bekker::report::shown::{self, Form, Values};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::time::Instant;

/// What is asked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asked {
    #[serde(default)]
    values: Values,
    /// The input over which the model is drawn, of a single wheel.
    #[serde(default)]
    axis: Option<String>,
    /// Whether it is asked how the rover moves.
    #[serde(default)]
    motion: bool,
    /// The one of several experiments that is shown, by its short name; the first where it is not given.
    #[serde(default)]
    part: Option<String>,
}

/// The model with these values.
pub fn trial(bench: &Bench, asked: &Asked) -> Result<Value, Refusal> {
    let (workbench, start) = (bench.workbench(), Instant::now());
    let part = part_number(&workbench, asked.part.as_deref())?;
    let whole = workbench.trial(&asked.values, asked.motion)?;
    let axis = asked.axis.as_deref().and_then(shown::axis);
    let mut shown = match part {
        None => {
            let curves = axis.map(|axis| workbench.sketch(axis, &asked.values)).transpose()?.flatten();
            drawn(&workbench, &whole, curves.as_ref())
        }
        Some(k) => {
            let trial = workbench.trial_of_part(k, &whole, &asked.values, asked.motion)?;
            let curves = axis.map(|axis| workbench.sketch_of_part(k, axis, &asked.values)).transpose()?.flatten();
            drawn(&workbench.parts()[k], &trial, curves.as_ref())
        }
    };
    shown["rmse"] = json!(whole.fit.rmse);
    shown["milliseconds"] = json!(1e3 * start.elapsed().as_secs_f64());
    Ok(shown)
}

/// A trial with its curves.
fn drawn(workbench: &Workbench, trial: &Trial, curves: Option<&Curves>) -> Value {
    let form = Form::plain();
    let mut shown = shown::model(workbench.experiment(), &trial.fit, &trial.failures, &trial.unanswered, &form);
    let curves = curves.map(|curves| (curves.axis.name(), shown::curves(curves, None, &form)));
    shown["curves"] = json!(curves.into_iter().collect::<BTreeMap<_, _>>());
    shown
}

/// Number of the one of several experiments that is called `name`, or of the first; `None` where there is one experiment.
pub fn part_number(workbench: &Workbench, name: Option<&str>) -> Result<Option<usize>, Refusal> {
    let parts = &workbench.experiment().parts;
    let Some(name) = name else { return Ok((!parts.is_empty()).then_some(0)) };
    let found = parts.iter().position(|part| part.name == name);
    found.map(Some).ok_or_else(|| Refusal::missing(&format!("experiment `{name}` among these")))
}
