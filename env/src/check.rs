//! Scripted tests, see [`bekker_script`].

use crate::error::{self, InputError, ModelError, SimulationError};
use crate::model::PyModel;
use bekker_fmu_import::{Fmu, FmuDoor, ImportError};
use bekker_script::{Core, Deviation, Door, DoorError, Problem, Report, Script, ScriptError, drive};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// A scripted test, read and checked.
#[pyclass(module = "bekker", name = "Script")]
pub struct PyScript {
    core: Script,
}

#[pymethods]
impl PyScript {
    /// Reads a script; with `to_record` its expected signals need not be there yet.
    #[new]
    #[pyo3(signature = (path, to_record = false))]
    fn new(path: PathBuf, to_record: bool) -> PyResult<Self> {
        let read = if to_record { Script::read_to_record(&path) } else { Script::read(&path) };
        read.map(|core| Self { core }).map_err(|refused| refuse(&refused))
    }

    /// Name for people.
    #[getter]
    fn name(&self) -> &str {
        &self.core.name
    }

    /// The model to be driven, its seed included.
    #[getter]
    fn model(&self) -> PyModel {
        PyModel { core: self.core.model.clone() }
    }

    /// Time between two samples, s.
    #[getter]
    fn interval(&self) -> f64 {
        self.core.interval
    }

    /// Names of the inputs, in order.
    #[getter]
    fn input_names(&self) -> Vec<String> {
        self.core.input_names.clone()
    }

    /// Values of the inputs: a row an interval.
    #[getter]
    fn inputs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (rows, width) = (self.core.inputs.len(), self.core.input_names.len());
        PyArray1::from_vec(py, self.core.inputs.concat()).reshape([rows, width])
    }

    /// Signals that are looked at, in order.
    #[getter]
    fn signals(&self) -> Vec<String> {
        self.core.signals.clone()
    }

    /// Drives the core.
    fn check_core(&self, py: Python<'_>) -> PyResult<PyReport> {
        let outcome = py.detach(|| error::fenced(|| self.core.check(&mut Core::new(&self.core))))?;
        outcome.map(|core| PyReport { core }).map_err(|stopped| stop(&stopped))
    }

    /// Drives the FMU in a file.
    fn check_fmu(&self, py: Python<'_>, path: PathBuf) -> PyResult<PyReport> {
        let outcome = py.detach(|| {
            error::fenced(|| {
                let fmu = Fmu::open(&path)?;
                Ok(self.core.check(&mut FmuDoor::new(&fmu, &self.core)?))
            })
        })?;
        let checked = outcome.map_err(|refused: ImportError| ModelError::new_err(refused.to_string()))?;
        checked.map(|core| PyReport { core }).map_err(|stopped| stop(&stopped))
    }

    /// Drives anything that has the methods of a door.
    fn check_door(&self, door: &Bound<'_, PyAny>) -> PyResult<PyReport> {
        let mut mine = PythonDoor { door, failed: None };
        match self.core.check(&mut mine) {
            Ok(core) => Ok(PyReport { core }),
            // What the door itself raised says more than its text.
            Err(stopped) => Err(mine.failed.take().unwrap_or_else(|| stop(&stopped))),
        }
    }

    /// Drives the core and writes its signals as what is expected from now on; returns the path.
    fn record(&self, py: Python<'_>) -> PyResult<PathBuf> {
        let outcome = py.detach(|| error::fenced(|| drive(&self.core, &mut Core::new(&self.core))))?;
        let recording = outcome.map_err(|stopped| stop(&stopped))?;
        self.core.write_expected(&recording).map_err(|refused| refuse(&refused))
    }

    fn __repr__(&self) -> String {
        format!(
            "<bekker.Script {:?}: {} intervals of {} s>",
            self.core.name,
            self.core.inputs.len(),
            self.core.interval
        )
    }
}

/// How a drive compares with its script. True where all is as expected.
#[pyclass(module = "bekker", name = "CheckReport")]
pub struct PyReport {
    core: Report,
}

#[pymethods]
impl PyReport {
    /// The script's name.
    #[getter]
    fn script(&self) -> &str {
        &self.core.script
    }

    /// What was driven.
    #[getter]
    fn door(&self) -> &str {
        &self.core.door
    }

    /// Whether all is as expected.
    #[getter]
    fn passed(&self) -> bool {
        self.core.passed()
    }

    /// Samples taken.
    #[getter]
    fn samples(&self) -> usize {
        self.core.samples
    }

    /// How the run stood at the end: "running" or the id of the event that ended it.
    #[getter]
    fn status(&self) -> &str {
        &self.core.status.0
    }

    /// When that was, s.
    #[getter]
    fn end(&self) -> f64 {
        self.core.status.1
    }

    /// What is not as expected besides signals, in words.
    #[getter]
    fn remarks(&self) -> Vec<String> {
        self.core.remarks.clone()
    }

    /// For each signal its `name`, the numbers `compared` and `failed`, and the `first` and `largest` deviation: `time`,
    /// `value`, `expected`, `size`, `allowed`, or None.
    #[getter]
    fn signals<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let one = |signal: &bekker_script::SignalReport| {
            let dict = PyDict::new(py);
            dict.set_item("name", &signal.name)?;
            dict.set_item("compared", signal.compared)?;
            dict.set_item("failed", signal.failed)?;
            dict.set_item("first", signal.first.map(|found| deviation(py, &found)).transpose()?)?;
            dict.set_item("largest", signal.largest.map(|found| deviation(py, &found)).transpose()?)?;
            Ok(dict)
        };
        self.core.signals.iter().map(one).collect()
    }

    fn __bool__(&self) -> bool {
        self.core.passed()
    }

    fn __str__(&self) -> String {
        self.core.to_string()
    }

    fn __repr__(&self) -> String {
        format!("<bekker.CheckReport {}>", self.core)
    }
}

fn deviation<'py>(py: Python<'py>, found: &Deviation) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let Deviation { time, value, expected, size, allowed } = *found;
    for (name, number) in
        [("time", time), ("value", value), ("expected", expected), ("size", size), ("allowed", allowed)]
    {
        dict.set_item(name, number)?;
    }
    Ok(dict)
}

/// An object of Python's as a door.
struct PythonDoor<'a, 'py> {
    door: &'a Bound<'py, PyAny>,
    failed: Option<PyErr>,
}

impl PythonDoor<'_, '_> {
    fn keep<T>(&mut self, outcome: PyResult<T>) -> Result<T, String> {
        outcome.map_err(|raised| {
            let message = raised.to_string();
            self.failed = Some(raised);
            message
        })
    }
}

impl Door for PythonDoor<'_, '_> {
    fn name(&self) -> String {
        self.door.getattr("name").and_then(|name| name.extract()).unwrap_or_else(|_| "door".to_owned())
    }

    fn reset(&mut self) -> Result<(), String> {
        let outcome = self.door.call_method0("reset").map(drop);
        self.keep(outcome)
    }

    fn step(&mut self, inputs: &[f64]) -> Result<(), String> {
        let inputs = PyArray1::from_slice(self.door.py(), inputs);
        let outcome = self.door.call_method1("step", (inputs,)).map(drop);
        self.keep(outcome)
    }

    fn time(&self) -> f64 {
        self.door.getattr("time").and_then(|time| time.extract()).unwrap_or(f64::NAN)
    }

    fn signals(&mut self, out: &mut [f64]) -> Result<(), String> {
        let row = self.door.call_method0("signals").and_then(|row| row.extract::<Vec<f64>>());
        let row = self.keep(row)?;
        if row.len() != out.len() {
            return Err(format!("signals() gave {} values, expected {}", row.len(), out.len()));
        }
        out.copy_from_slice(&row);
        Ok(())
    }

    fn status(&mut self) -> Result<String, String> {
        let status = self.door.getattr("status").and_then(|status| status.extract());
        self.keep(status)
    }
}

fn refuse(refused: &ScriptError) -> PyErr {
    match &refused.problem {
        Problem::Unreadable(source) | Problem::Unwritable { error: source, .. } => {
            error::unreachable_file(source, refused.to_string())
        }
        Problem::Model(_) => ModelError::new_err(refused.to_string()),
        _ => InputError::new_err(refused.to_string()),
    }
}

fn stop(stopped: &DoorError) -> PyErr {
    SimulationError::new_err(stopped.to_string())
}
