//! What a saved report holds in the place of a server: the models of its steps, and the model along the strength of each effect that was
//! tried. A comparison and a diagnosis of one experiment (`whole`), or what a diagnosis of several says of one of them (`part`).

mod part;
mod whole;

use super::packed::differences;
use super::shown::{self, Form, Values};
use crate::diagnosis::{Curves, Failure, Fit, Response, UnansweredRows, Workbench};
use crate::measurement::Experiment;
pub(super) use part::saved_part;
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::collections::BTreeMap;
pub(super) use whole::{saved_comparison, saved_diagnosis};

/// Rows of all runs that a file keeps at most.
const MOST_ROWS: usize = 6000;
/// Bytes that the responses of all effects take where a byte a value is fine enough, from which the rows of long drives follow; they are
/// at most twice as many.
const MOST_BYTES: usize = 3_000_000;
/// Bytes of a value at the fitted strength, and of one at another strength, in base64.
const OF_FITTED: f64 = 8.0 / 3.0;
const OF_OTHERS: f64 = 4.0 / 3.0;
/// Strengths of a response at most: those at first and as many between them, but for the fitted one.
const OTHERS: f64 = 10.0;

/// Largest error of a rounding, in multiples of the noise.
const ROUNDED: f64 = 0.05;

/// A model of the history.
struct Step<'a> {
    label: String,
    effects: Vec<String>,
    values: Values,
    fit: Cow<'a, Fit>,
    failures: Vec<Failure>,
    unanswered: Cow<'a, [UnansweredRows]>,
    /// Curves by axis, and which of the models in them it is.
    curves: Vec<(Cow<'a, Curves>, Option<usize>)>,
    /// The model as the page hands it out.
    toml: Option<String>,
}

/// A fit of effects that were tried.
struct Tried {
    effects: Vec<String>,
    values: Values,
    found: Value,
}

/// All that a file holds.
struct Saved<'a> {
    experiment: &'a Experiment,
    workbench: &'a Workbench,
    steps: Vec<Step<'a>>,
    tried: Vec<Tried>,
    /// What a diagnosis found.
    diagnosis: Option<Value>,
}

impl Saved<'_> {
    fn json(&self) -> Value {
        let lines = self.lines();
        let form = Form::packed(&self.rows(), self.most_rows(lines.len()));
        let mut responses = Vec::new();
        // One at a time: the models of a long drive along all effects would not fit into memory.
        for (tried, parameter) in lines {
            // What cannot be computed has no slider.
            if let Ok(Some(response)) = self.workbench.response(&tried.effects, &tried.values, &parameter) {
                responses.push(self.line(&response, &form));
            }
        }
        let total: usize = self.rows().iter().sum();
        let kept: usize = (0..self.experiment.runs.len()).map(|run| form.rows(run, 0..usize::MAX).len()).sum();
        json!({
            "experiment": shown::experiment(self.workbench, self.experiment, "saved", false, &form),
            "snapshot": {
                "steps": self.steps.iter().enumerate().map(|(at, step)| self.step(at, step)).collect::<Vec<_>>(),
                "found": self.tried.iter().map(|tried| tried.found.clone()).collect::<Vec<_>>(),
                "diagnosis": self.diagnosis,
                "separation": null,
                "jobs": [],
            },
            "models": self.steps.iter().map(|step| self.model(step, &form)).collect::<Vec<_>>(),
            "responses": responses,
            "rows": { "kept": kept, "of": total },
        })
    }

    fn rows(&self) -> Vec<usize> {
        self.experiment.runs.iter().map(|run| run.data.rows()).collect()
    }

    /// So many rows that the responses of `lines` stay within their bytes.
    fn most_rows(&self, lines: usize) -> usize {
        let row = lines as f64 * self.experiment.signals().len() as f64 * (OF_FITTED + OTHERS * OF_OTHERS);
        let fitting = (MOST_BYTES as f64 / row.max(1.0)) as usize;
        MOST_ROWS.min(fitting.max(self.experiment.runs.len()))
    }

    /// Every strength that can be moved: the parameters of the effects of each fit.
    fn lines(&self) -> Vec<(&Tried, String)> {
        let parameters = self.workbench.parameters();
        let of = |tried: &Tried| {
            let own = parameters.iter().filter(|p| p.effect.as_ref().is_some_and(|id| tried.effects.contains(id)));
            own.map(|p| p.variable.name.clone()).collect::<Vec<_>>()
        };
        self.tried.iter().flat_map(|tried| of(tried).into_iter().map(move |name| (tried, name))).collect()
    }

    fn step(&self, at: usize, step: &Step) -> Value {
        json!({
            "label": step.label, "parent": at.checked_sub(1), "effects": step.effects, "values": step.values, "rmse": step.fit.rmse,
            "toml": step.toml,
        })
    }

    /// A response as the page reads it: values at the fitted strength in two bytes, those at others as their differences in one.
    fn line(&self, response: &Response, form: &Form) -> Value {
        let fitted = response.values.get(&response.parameter).copied().unwrap_or_default();
        let apart = |k: &usize| (response.strengths[*k] - fitted).abs();
        let base = (0..response.strengths.len()).min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or_default();
        let mut rounding: BTreeMap<String, f64> = BTreeMap::new();
        let runs: Vec<Value> = (0..self.experiment.runs.len())
            .map(|run| {
                let signals = response.models[base].runs[run].signals.iter().enumerate().map(|(place, own)| {
                    let of = |fit: &Fit| form.kept_of(run, &fit.runs[run].signals[place].modelled);
                    let all: Vec<Vec<f64>> = response.models.iter().map(of).collect();
                    let noise = self.workbench.noise_floor().get(&own.signal).and_then(|floor| floor.value());
                    let (others, error) = differences(&all, &all[base], ROUNDED * noise.unwrap_or(f64::INFINITY));
                    let largest = rounding.entry(own.signal.clone()).or_insert(0.0);
                    *largest = largest.max(error);
                    (own.signal.clone(), json!({ "base": form.of_all(&all[base]), "others": others }))
                });
                Value::Object(signals.collect())
            })
            .collect();
        let curves = response.curves[base].iter().enumerate().map(|(axis, own)| {
            let groups = own.groups.iter().enumerate().map(|(group, own)| {
                let signals = own.models.iter().flat_map(|model| model.signals.keys()).map(|signal| {
                    let of = |curves: &Vec<Curves>| curves[axis].groups[group].models[0].signals[signal].value.clone();
                    let all: Vec<Vec<f64>> = response.curves.iter().map(of).collect();
                    (signal.clone(), json!({ "base": form.of_all(&all[base]), "others": differences(&all, &all[base], f64::INFINITY).0 }))
                });
                Value::Object(signals.collect())
            });
            (own.axis.name().to_owned(), Value::Array(groups.collect()))
        });
        let curves: Map<String, Value> = curves.collect();
        json!({
            "effects": response.effects,
            "parameter": response.parameter,
            "values": response.values,
            "strengths": response.strengths,
            "base": base,
            "products": products(response),
            "runs": runs,
            "curves": curves,
            "largest_error": response.largest_error,
            "rounding": rounding,
        })
    }

    fn model(&self, step: &Step, form: &Form) -> Value {
        let mut model = shown::model(self.experiment, &step.fit, &step.failures, &step.unanswered, form);
        let of_axis = |(curves, number): &(Cow<Curves>, Option<usize>)| {
            (curves.axis.name().to_owned(), shown::curves(curves, *number, form))
        };
        model["curves"] = Value::Object(step.curves.iter().map(of_axis).collect());
        model
    }
}

/// By signal the mean product of the residuals at each two strengths, over the rows that have one at all. The mean square error of what
/// is interpolated with weights w follows from it over all rows: w' P w.
fn products(response: &Response) -> Map<String, Value> {
    let count = response.models.len();
    let mut sums: BTreeMap<&str, (Vec<f64>, usize)> = BTreeMap::new();
    for (number, run) in response.models[0].runs.iter().enumerate() {
        for (place, signal) in run.signals.iter().enumerate() {
            let (sum, rows) = sums.entry(&signal.signal).or_insert_with(|| (vec![0.0; count * count], 0));
            for row in 0..signal.residual.len() {
                let at: Vec<f64> =
                    response.models.iter().map(|fit| fit.runs[number].signals[place].residual[row]).collect();
                if at.iter().any(|residual| residual.is_nan()) {
                    continue;
                }
                *rows += 1;
                for (k, cell) in sum.iter_mut().enumerate() {
                    *cell += at[k / count] * at[k % count];
                }
            }
        }
    }
    let mean = |(signal, (sum, rows)): (&str, (Vec<f64>, usize))| {
        let rows_of: Vec<Vec<f64>> =
            sum.chunks(count).map(|row| row.iter().map(|cell| cell / rows as f64).collect()).collect();
        (rows > 0).then(|| (signal.to_owned(), json!(rows_of)))
    };
    sums.into_iter().filter_map(mean).collect()
}
