//! A diagnosis on its way to Python: the JSON of the core, and beside it what only the Python objects hold.

use crate::compare::{PartModels, failed, part_models};
use crate::error::{self, ModelError};
use crate::model::PyModel;
use bekker::diagnosis::{CandidateResult, Diagnosis, Failure, FinalParameter, Fit, NoiseFloor, ParameterResult, Step};
use bekker::measurement::{Kind, Run};
use pyo3::prelude::*;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// The result of a diagnosis, from which Python reads its own objects.
#[pyclass(module = "bekker._bekker", frozen)]
pub struct NativeDiagnosis {
    core: Diagnosis,
}

impl NativeDiagnosis {
    pub fn new(core: Diagnosis) -> Self {
        Self { core }
    }
}

#[pymethods]
impl NativeDiagnosis {
    /// The stable JSON of a diagnosis.
    fn json(&self) -> String {
        self.core.to_json().to_string()
    }

    /// What the Python objects hold beside that, as JSON to be merged with it; see [`Details`].
    fn details(&self) -> PyResult<String> {
        text(&Details::of(&self.core))
    }

    /// The report, one self-contained HTML page; of several experiments that of number `part`.
    #[pyo3(signature = (part = None))]
    fn html(&self, py: Python<'_>, part: Option<usize>) -> PyResult<String> {
        let page = || match part {
            Some(part) => bekker::report::diagnosed_part_page(&self.core, part),
            None => Ok(bekker::report::diagnosis_page(&self.core)),
        };
        py.detach(|| error::fenced(page))?.map_err(|refused| failed(&refused))
    }

    /// The improved model.
    fn improved(&self) -> PyModel {
        PyModel { core: self.core.improved.clone() }
    }

    /// Of several experiments the improved model of each, by its name.
    fn improved_parts(&self) -> PartModels {
        part_models(&self.core.improved_parts)
    }
}

/// JSON for the Python side; numbers that are not finite are null.
pub fn text(found: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(found).map_err(|refused| ModelError::new_err(refused.to_string()))
}

/// What the stable JSON leaves out, or has in a shorter form, under the names of the Python attributes: Python merges the two
/// documents key by key and lists entry by entry, and this one goes first.
#[derive(Serialize)]
struct Details<'a> {
    kind: Kind,
    runs: Vec<RunData<'a>>,
    noise_floor: &'a BTreeMap<String, NoiseFloor>,
    given: Option<&'a Fit>,
    steps: Vec<StepDetails<'a>>,
    candidates: Vec<CandidateDetails<'a>>,
    profiles: Vec<Profile<'a>>,
    failures: &'a [Failure],
    failures_left: &'a [Failure],
}

impl<'a> Details<'a> {
    fn of(core: &'a Diagnosis) -> Self {
        Self {
            kind: core.experiment.kind,
            runs: core.experiment.runs.iter().map(RunData::of).collect(),
            noise_floor: &core.noise_floor,
            given: core.given.as_ref(),
            steps: core.steps.iter().map(|Step { parameters, fit, .. }| StepDetails { parameters, fit }).collect(),
            candidates: core
                .candidates
                .iter()
                .map(|CandidateResult { parameters, .. }| CandidateDetails { parameters })
                .collect(),
            profiles: core.profiles.iter().map(Profile::of).collect(),
            failures: &core.failures,
            failures_left: &core.failures_left,
        }
    }
}

/// A run as it was measured.
#[derive(Serialize)]
struct RunData<'a> {
    name: &'a str,
    group: Option<&'a str>,
    inputs: &'a [String],
    measured: &'a [String],
    #[serde(serialize_with = "columns")]
    columns: &'a Run,
}

impl<'a> RunData<'a> {
    fn of(run: &'a Run) -> Self {
        let Run { name, inputs, measured, .. } = run;
        Self { name, group: run.group.as_deref(), inputs, measured, columns: run }
    }
}

/// The columns of a run by name, in their order.
fn columns<S: Serializer>(run: &Run, to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(run.data.names().iter().map(|name| (name, run.data.column(name).unwrap_or_default())))
}

#[derive(Serialize)]
struct StepDetails<'a> {
    parameters: &'a [ParameterResult],
    fit: &'a Fit,
}

#[derive(Serialize)]
struct CandidateDetails<'a> {
    parameters: &'a [ParameterResult],
}

/// A profile likelihood as two columns.
#[derive(Serialize)]
struct Profile<'a> {
    name: &'a str,
    values: Vec<f64>,
    rise: Vec<f64>,
}

impl<'a> Profile<'a> {
    fn of(core: &'a FinalParameter) -> Self {
        let (values, rise) = core.profile.iter().copied().unzip();
        Self { name: &core.name, values, rise }
    }
}
