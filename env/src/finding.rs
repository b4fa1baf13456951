//! A diagnosis on its way to Python: plain dictionaries and arrays, from which Python builds its classes.

use crate::compare::{failures_of, fit_of, noise_floors, parameter, unanswered_of};
use crate::error;
use crate::model::Model;
use bekker::diagnosis::{
    CandidateResult, Diagnosis, FinalParameter, LackOfFit, NoiseModel, PairResult, ParameterResult, Step,
};
use bekker::measurement::Run;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;

/// What a diagnosis found.
#[pyclass(module = "bekker._bekker", frozen)]
pub struct Finding {
    core: Diagnosis,
}

impl Finding {
    pub fn new(core: Diagnosis) -> Self {
        Self { core }
    }
}

#[pymethods]
impl Finding {
    /// The stable JSON of a diagnosis.
    fn json(&self) -> String {
        self.core.to_json().to_string()
    }

    /// The report, one self-contained HTML page.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        Ok(py.detach(|| error::fenced(|| bekker::report::diagnosis_page(&self.core)))?)
    }

    /// The improved model.
    fn improved(&self) -> Model {
        Model { core: self.core.improved.clone() }
    }

    /// All numbers.
    fn described<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (core, all) = (&self.core, PyDict::new(py));
        all.set_item("experiment", &core.experiment.name)?;
        all.set_item("kind", core.experiment.kind.name())?;
        all.set_item("runs", listed(&core.experiment.runs, |run| run_of(py, run))?)?;
        all.set_item("verdict", core.verdict.name())?;
        all.set_item("effects", &core.effects)?;
        all.set_item("noise_floor", noise_floors(py, &core.noise_floor)?)?;
        all.set_item("noise_floor_source", core.noise_floor_source.name())?;
        all.set_item("noise", noise_of(py, &core.noise)?)?;
        all.set_item("given", core.given.as_ref().map(|fit| fit_of(py, fit)).transpose()?)?;
        all.set_item("steps", listed(&core.steps, |step| step_of(py, step))?)?;
        all.set_item("candidates", listed(&core.candidates, |candidate| candidate_of(py, candidate))?)?;
        all.set_item("pairs", listed(&core.pairs, |pair| pair_of(py, pair))?)?;
        all.set_item("invisible", &core.invisible)?;
        let share = PyDict::new(py);
        share.set_item("enough", core.share.enough)?;
        share.set_item("other", core.share.other)?;
        all.set_item("share", share)?;
        all.set_item("lack_of_fit", lack_of_fit(py, &core.lack_of_fit)?)?;
        all.set_item("smallest_p", core.smallest_p)?;
        all.set_item("explained_share", core.explained_share)?;
        let confused: Vec<(&str, &str)> = core.confused_with.iter().map(|[a, b]| (a.as_str(), b.as_str())).collect();
        all.set_item("confused_with", confused)?;
        all.set_item("profiles", listed(&core.profiles, |profile| profile_of(py, profile))?)?;
        all.set_item("failures", failures_of(py, &core.failures)?)?;
        all.set_item("failures_left", failures_of(py, &core.failures_left)?)?;
        let suggestions = listed(&core.suggestions, |suggestion| {
            let described = PyDict::new(py);
            described.set_item("text", &suggestion.text)?;
            described.set_item("effects", &suggestion.effects)?;
            Ok(described)
        })?;
        all.set_item("sources", &core.sources)?;
        all.set_item("suggestions", suggestions)?;
        all.set_item("next_experiment", core.next_experiment())?;
        all.set_item("improved_is", core.improved_is())?;
        all.set_item("unanswered", unanswered_of(py, &core.unanswered)?)?;
        all.set_item("cautions", &core.cautions)?;
        all.set_item("interrupted", core.interrupted)?;
        all.set_item("not_tried", &core.not_tried)?;
        Ok(all)
    }
}

fn listed<'py, T>(items: &[T], f: impl Fn(&T) -> PyResult<Bound<'py, PyDict>>) -> PyResult<Vec<Bound<'py, PyDict>>> {
    items.iter().map(f).collect()
}

fn run_of<'py>(py: Python<'py>, run: &Run) -> PyResult<Bound<'py, PyDict>> {
    let (described, columns) = (PyDict::new(py), PyDict::new(py));
    for name in run.data.names() {
        columns.set_item(name, PyArray1::from_slice(py, run.data.column(name).unwrap_or_default()))?;
    }
    described.set_item("name", &run.name)?;
    described.set_item("group", run.group.as_deref())?;
    described.set_item("inputs", &run.inputs)?;
    described.set_item("measured", &run.measured)?;
    described.set_item("columns", columns)?;
    Ok(described)
}

fn noise_of<'py>(py: Python<'py>, models: &BTreeMap<String, NoiseModel>) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    for (signal, noise) in models {
        let described = PyDict::new(py);
        described.set_item("deviation", noise.deviation)?;
        described.set_item("run_share", noise.run_share)?;
        described.set_item("correlation", noise.correlation)?;
        all.set_item(signal, described)?;
    }
    Ok(all)
}

fn parameters<'py>(py: Python<'py>, all: &[ParameterResult]) -> PyResult<Vec<Bound<'py, PyDict>>> {
    listed(all, |result| {
        let described = parameter(py, &result.fitted)?;
        described.set_item("effect", result.effect)?;
        Ok(described)
    })
}

fn step_of<'py>(py: Python<'py>, step: &Step) -> PyResult<Bound<'py, PyDict>> {
    let described = PyDict::new(py);
    described.set_item("added", step.added.as_deref())?;
    described.set_item("rmse", step.rmse.clone())?;
    described.set_item("heldout_rmse", step.heldout_rmse.clone())?;
    described.set_item("parameters", parameters(py, &step.parameters)?)?;
    described.set_item("chi_square", step.chi_square)?;
    described.set_item("degrees_of_freedom", step.degrees_of_freedom)?;
    described.set_item("left", step.left)?;
    described.set_item("fit", fit_of(py, &step.fit)?)?;
    Ok(described)
}

fn candidate_of<'py>(py: Python<'py>, candidate: &CandidateResult) -> PyResult<Bound<'py, PyDict>> {
    let described = PyDict::new(py);
    described.set_item("effect", &candidate.effect)?;
    described.set_item("probability", candidate.probability)?;
    described.set_item("tied", candidate.tied)?;
    described.set_item("heldout_gain", candidate.heldout_gain)?;
    described.set_item("better", candidate.better)?;
    described.set_item("p_value", candidate.p_value)?;
    described.set_item("gain", candidate.gain)?;
    described.set_item("left", candidate.left)?;
    described.set_item("refitted", candidate.refitted)?;
    described.set_item("visible_share", candidate.visible_share)?;
    described.set_item("parameters", parameters(py, &candidate.parameters)?)?;
    Ok(described)
}

fn pair_of<'py>(py: Python<'py>, pair: &PairResult) -> PyResult<Bound<'py, PyDict>> {
    let described = PyDict::new(py);
    described.set_item("effects", (&pair.effects[0], &pair.effects[1]))?;
    described.set_item("gain", pair.gain)?;
    described.set_item("refitted", pair.refitted)?;
    Ok(described)
}

fn lack_of_fit<'py>(py: Python<'py>, lack: &LackOfFit) -> PyResult<Bound<'py, PyDict>> {
    let described = PyDict::new(py);
    described.set_item("chi_square", lack.chi_square)?;
    described.set_item("degrees_of_freedom", lack.degrees_of_freedom)?;
    described.set_item("p_value", lack.p_value)?;
    described.set_item("p_common", lack.p_common)?;
    described.set_item("explainable", lack.explainable)?;
    described.set_item("p_structure", lack.p_structure)?;
    Ok(described)
}

fn profile_of<'py>(py: Python<'py>, profile: &FinalParameter) -> PyResult<Bound<'py, PyDict>> {
    let described = PyDict::new(py);
    let (values, rise): (Vec<f64>, Vec<f64>) = profile.profile.iter().copied().unzip();
    described.set_item("name", &profile.name)?;
    described.set_item("interval", profile.interval)?;
    described.set_item("values", PyArray1::from_vec(py, values))?;
    described.set_item("rise", PyArray1::from_vec(py, rise))?;
    Ok(described)
}
