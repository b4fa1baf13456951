//! Comparing the model with measurements; the results leave as dictionaries, from which Python builds its classes.

use crate::error::{self, ModelError, SimulationError, UnknownNameError};
use crate::experiment::Source;
use crate::model::Model;
use bekker::diagnosis::{
    CalibratedParameter, Calibration, CompareError, CompareOptions, Comparison, Failure, Fit, Given, NoiseFloor,
    RunFit, UnansweredRows, compare as core_compare,
};
use bekker::modeldescription::ParameterError;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;

/// A model and the name that it was asked for by.
pub type Asked = Option<(Py<Model>, String)>;

/// What is given beside an experiment: a model, and values that are set by hand.
pub fn given(py: Python<'_>, model: &Asked, values: &BTreeMap<String, f64>) -> Given {
    let given = Given::default().values_by("parameters");
    let given = match model {
        Some((model, name)) => given.with_model(model.borrow(py).core.clone(), name),
        None => given,
    };
    values.iter().fold(given, |given, (name, value)| given.with_value(name, *value))
}

/// Runs a model on the inputs of an experiment, with effects added and calibrated on request, and compares.
#[pyfunction]
pub fn compare<'py>(
    py: Python<'py>,
    experiment: Source<'_>,
    model: Asked,
    values: BTreeMap<String, f64>,
    calibrate: bool,
    added: Vec<String>,
) -> PyResult<Bound<'py, PyDict>> {
    let (experiment, _) = experiment.read(py)?;
    let options = CompareOptions { calibrate, added };
    let given = given(py, &model, &values);
    let comparison = py
        .detach(|| error::fenced(|| core_compare(given, &experiment, &options)))?
        .map_err(|refused| failed(&refused))?;
    let described = described(py, &comparison)?;
    described.set_item("model", Py::new(py, Model { core: comparison.model.clone() })?)?;
    Ok(described)
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

fn described<'py>(py: Python<'py>, comparison: &Comparison) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    all.set_item("experiment", &comparison.experiment.name)?;
    all.set_item("given", comparison.given.as_ref().ok().map(|fit| fit_of(py, fit)).transpose()?)?;
    all.set_item("given_error", comparison.given.as_ref().err().map(ToString::to_string))?;
    let calibrated = comparison.calibrated.as_ref();
    all.set_item("calibration", calibrated.map(|(found, _)| calibration(py, found)).transpose()?)?;
    all.set_item("calibrated", calibrated.map(|(_, fit)| fit_of(py, fit)).transpose()?)?;
    all.set_item("noise_floor", noise_floors(py, &comparison.noise_floor)?)?;
    let curves =
        serde_json::to_string(&comparison.curves).map_err(|refused| ModelError::new_err(refused.to_string()))?;
    all.set_item("curves", curves)?;
    all.set_item("failures", failures_of(py, &comparison.failures)?)?;
    all.set_item("unanswered", unanswered_of(py, &comparison.unanswered)?)?;
    all.set_item("given_unanswered", unanswered_of(py, &comparison.given_unanswered)?)?;
    all.set_item("cautions", &comparison.cautions)?;
    all.set_item("sources", &comparison.sources)?;
    Ok(all)
}

/// Rows without an answer.
pub fn unanswered_of<'py>(py: Python<'py>, unanswered: &[UnansweredRows]) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let one = |rows: &UnansweredRows| {
        let described = PyDict::new(py);
        described.set_item("run", &rows.run)?;
        described.set_item("first_row", rows.rows.0)?;
        described.set_item("last_row", rows.rows.1)?;
        described.set_item("reason", &rows.reason)?;
        Ok(described)
    };
    unanswered.iter().map(one).collect()
}

/// A fit, its values as arrays.
pub fn fit_of<'py>(py: Python<'py>, fit: &Fit) -> PyResult<Bound<'py, PyDict>> {
    let described = PyDict::new(py);
    described.set_item("runs", fit.runs.iter().map(|run| run_of(py, run)).collect::<PyResult<Vec<_>>>()?)?;
    described.set_item("rmse", fit.rmse.clone())?;
    Ok(described)
}

fn run_of<'py>(py: Python<'py>, run: &RunFit) -> PyResult<Bound<'py, PyDict>> {
    let described = PyDict::new(py);
    described.set_item("name", &run.run)?;
    let signals = PyDict::new(py);
    for signal in &run.signals {
        let columns = PyDict::new(py);
        columns.set_item("measured", PyArray1::from_slice(py, &signal.measured))?;
        columns.set_item("modelled", PyArray1::from_slice(py, &signal.modelled))?;
        columns.set_item("residual", PyArray1::from_slice(py, &signal.residual))?;
        signals.set_item(&signal.signal, columns)?;
    }
    described.set_item("signals", signals)?;
    Ok(described)
}

fn calibration<'py>(py: Python<'py>, found: &Calibration) -> PyResult<Bound<'py, PyDict>> {
    let described = PyDict::new(py);
    let parameters = found.parameters.iter().map(|p| parameter(py, p)).collect::<PyResult<Vec<_>>>()?;
    described.set_item("parameters", parameters)?;
    described.set_item("weights", found.weights.clone())?;
    described.set_item("chi_square", found.chi_square)?;
    described.set_item("degrees_of_freedom", found.degrees_of_freedom)?;
    described.set_item("steps", found.steps)?;
    described.set_item("converged", found.converged)?;
    described.set_item("searches", found.searches)?;
    described.set_item("agreeing", found.agreeing)?;
    Ok(described)
}

/// A free parameter after a fit.
pub fn parameter<'py>(py: Python<'py>, found: &CalibratedParameter) -> PyResult<Bound<'py, PyDict>> {
    let described = PyDict::new(py);
    described.set_item("name", &found.variable.name)?;
    described.set_item("unit", found.variable.unit.symbol)?;
    described.set_item("min", found.variable.min)?;
    described.set_item("max", found.variable.max)?;
    described.set_item("start", found.start)?;
    described.set_item("value", found.value)?;
    described.set_item("deviation", found.deviation)?;
    described.set_item("at_bound", found.at_bound)?;
    described.set_item("prior_shift", found.prior_shift())?;
    Ok(described)
}

/// Noise floors by signal.
pub fn noise_floors<'py>(py: Python<'py>, floors: &BTreeMap<String, NoiseFloor>) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    for (signal, floor) in floors {
        all.set_item(signal, noise_floor(py, floor)?)?;
    }
    Ok(all)
}

fn noise_floor<'py>(py: Python<'py>, floor: &NoiseFloor) -> PyResult<Bound<'py, PyDict>> {
    let described = PyDict::new(py);
    described.set_item("value", floor.value())?;
    described.set_item("source", floor.source().name())?;
    Ok(described)
}

/// Where the model fails, the worst first.
pub fn failures_of<'py>(py: Python<'py>, failures: &[Failure]) -> PyResult<Vec<Bound<'py, PyDict>>> {
    failures.iter().map(|failure| failure_of(py, failure)).collect()
}

fn failure_of<'py>(py: Python<'py>, failure: &Failure) -> PyResult<Bound<'py, PyDict>> {
    let described = PyDict::new(py);
    described.set_item("signal", &failure.signal)?;
    described.set_item("condition", &failure.condition)?;
    described.set_item("low", failure.level.low)?;
    described.set_item("high", failure.level.high)?;
    described.set_item("mean", failure.level.mean)?;
    described.set_item("samples", failure.level.samples)?;
    described.set_item("spread", failure.spread)?;
    described.set_item("noise", failure.noise)?;
    Ok(described)
}
