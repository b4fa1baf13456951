//! Comparing the model with measurements; the result leaves as JSON, from which Python builds its classes.

use crate::error::{self, InputError, ModelError, SimulationError, UnknownNameError};
use crate::experiment::Source;
use crate::finding::text;
use crate::model::PyModel;
use bekker::diagnosis::{
    Calibration, CompareError, CompareOptions, Comparison, Curves, Failure, Fit, Given, Identified, NoiseFloor,
    UnansweredRows, UncountedRows, compare as core_compare,
};
use bekker::known_soil::KnownSoil;
use bekker::measurement::Share;
use bekker::model::Model;
use bekker::modeldescription::ParameterError;
use pyo3::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// A model and the name that it was asked for by.
pub type Asked = Option<(Py<PyModel>, String)>;

/// The text of a known soil and how messages call it.
pub type SoilAsked = Option<(String, String)>;

/// What is given beside an experiment: a model, values that are set by hand, what is known of the soil, and what is said of several
/// experiments together.
pub fn given(
    py: Python<'_>,
    model: &Asked,
    values: &BTreeMap<String, f64>,
    soil: &SoilAsked,
    asked: &TogetherAsked,
) -> PyResult<Given> {
    let given = Given::default().values_by("parameters");
    let given = match model {
        Some((model, name)) => given.with_model(model.borrow(py).core.clone(), name),
        None => given,
    };
    let given = values.iter().fold(given, |given, (name, value)| given.with_value(name, *value));
    let given = match soil {
        Some((text, name)) => given.with_soil(read_soil(text)?, name),
        None => given,
    };
    together(given, asked)
}

/// Of several experiments: the scatter of the soil from one to the next, and what they share; none where nothing is said.
pub type TogetherAsked = (Option<f64>, Option<Vec<String>>);

/// The same with what is said of several experiments.
pub fn together(mut given: Given, (scatter, share): &TogetherAsked) -> PyResult<Given> {
    if let Some(deviation) = scatter {
        given = given
            .with_soil_scatter(*deviation)
            .map_err(|refused| InputError::new_err(format!("soil_scatter: {refused}")))?;
    }
    let Some(share) = share else { return Ok(given) };
    let known = |name: &String| {
        let expected = Share::ALL.map(Share::name).join(", ");
        Share::find(name)
            .ok_or_else(|| InputError::new_err(format!("share: expected some of {expected}, found {name:?}")))
    };
    Ok(given.with_share(&share.iter().map(known).collect::<PyResult<Vec<_>>>()?))
}

/// Models of several experiments by their names.
pub type PartModels = Vec<(String, PyModel)>;

/// The models of several experiments for Python.
pub fn part_models(models: &[(String, Model)]) -> PartModels {
    models.iter().map(|(name, core)| (name.clone(), PyModel { core: core.clone() })).collect()
}

/// A known soil from the text of its file.
pub fn read_soil(text: &str) -> PyResult<KnownSoil> {
    KnownSoil::from_toml(text).map_err(|refused| InputError::new_err(refused.to_string()))
}

/// A known soil as JSON.
#[pyfunction]
pub fn known_soil(soil: &str) -> PyResult<String> {
    text(&read_soil(soil)?)
}

/// Runs a model on the inputs of an experiment, with effects added and calibrated on request, and compares. Returns the
/// comparison as JSON, its model and, of several experiments, that of each.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "keywords of the Python function")]
pub fn compare(
    py: Python<'_>,
    experiment: Source<'_>,
    model: Asked,
    values: BTreeMap<String, f64>,
    calibrate: bool,
    added: Vec<String>,
    windows: usize,
    soil: SoilAsked,
    together: TogetherAsked,
) -> PyResult<(String, PyModel, PartModels)> {
    let (experiment, _) = experiment.read(py)?;
    let options = CompareOptions { calibrate, added, windows };
    let given = given(py, &model, &values, &soil, &together)?;
    let comparison = py
        .detach(|| error::fenced(|| core_compare(given, &experiment, &options)))?
        .map_err(|refused| failed(&refused))?;
    let parts = part_models(&comparison.part_models);
    Ok((text(&Described::of(&comparison))?, PyModel { core: comparison.model }, parts))
}

/// The exception for a comparison or diagnosis that is impossible.
pub fn failed(refused: &CompareError) -> PyErr {
    let message = refused.to_string();
    match refused {
        CompareError::Prediction(_)
        | CompareError::TooFewAnswers { .. }
        | CompareError::NoStart(_)
        | CompareError::NoFit => SimulationError::new_err(message),
        CompareError::Parameter { source: ParameterError::Unknown { .. }, .. } | CompareError::UnknownEffect { .. } => {
            UnknownNameError::new_err(message)
        }
        _ => ModelError::new_err(message),
    }
}

/// A comparison for Python, under the names of its attributes.
#[derive(Serialize)]
struct Described<'a> {
    experiment: &'a str,
    given: Option<&'a Fit>,
    given_error: Option<String>,
    calibration: Option<&'a Calibration>,
    calibrated: Option<&'a Fit>,
    noise_floor: &'a BTreeMap<String, NoiseFloor>,
    failures: &'a [Failure],
    curves: &'a [Curves],
    unanswered: &'a [UnansweredRows],
    given_unanswered: &'a [UnansweredRows],
    uncounted: &'a [UncountedRows],
    cautions: &'a [String],
    sources: &'a [String],
    soil: Option<String>,
    identified: &'a [Identified],
}

impl<'a> Described<'a> {
    fn of(core: &'a Comparison) -> Self {
        Self {
            experiment: &core.experiment.name,
            given: core.given.as_ref().ok(),
            given_error: core.given.as_ref().err().map(ToString::to_string),
            calibration: core.calibrated.as_ref().map(|(found, _)| found),
            calibrated: core.calibrated.as_ref().map(|(_, fit)| fit),
            noise_floor: &core.noise_floor,
            failures: &core.failures,
            curves: &core.curves,
            unanswered: &core.unanswered,
            given_unanswered: &core.given_unanswered,
            uncounted: &core.uncounted,
            cautions: &core.cautions,
            sources: &core.sources,
            soil: core.soil.as_ref().and_then(|soil| soil.to_toml().ok()),
            identified: &core.identified,
        }
    }
}
