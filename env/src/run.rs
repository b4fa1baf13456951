//! Class `Run`.

use crate::error::{self, InputError, SimulationError};
use bekker::model::{Run, RunError};
use bekker::modeldescription::{Lookup, Parameters};
use bekker::signals::{Measurement, Signals};
use bekker::simulation::Status;
use numpy::{AllowTypeChange, PyArray1, PyArrayLike1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::borrow::Cow;

/// A model in motion. A copy goes on to the same bits.
#[pyclass(module = "bekker", name = "Run")]
pub struct PyRun {
    core: Run,
    /// A panic left the core in an unknown state.
    broken: bool,
}

impl PyRun {
    pub fn new(core: Run) -> Self {
        Self { core, broken: false }
    }

    /// The core's run, for a batch.
    pub fn taken(&self) -> PyResult<Run> {
        if self.broken {
            return Err(broke());
        }
        Ok(self.core.clone())
    }

    /// The true signals.
    pub fn truth(&self) -> &Signals {
        self.core.signals()
    }

    fn advance(&mut self, py: Python<'_>, inputs: &[f64], steps: u64) -> PyResult<Status> {
        if self.broken {
            return Err(broke());
        }
        let core = &mut self.core;
        // Before the lock is given away: Python may change its array during the steps.
        let outcome = error::fenced(|| core.inputs_mut().set_all(inputs)).and_then(|held| match held {
            Err(refused) => Ok(Err(Refused::Input(refused))),
            Ok(()) => py.detach(|| error::fenced(|| core.advance(steps).map_err(Refused::Step))),
        });
        self.broken = outcome.is_err();
        Ok(outcome??)
    }
}

/// The values of an array in one piece; copied only where the array is a view with gaps.
pub fn contiguous<'a, T: numpy::Element + Copy>(array: &'a PyReadonlyArray1<'_, T>) -> Cow<'a, [T]> {
    array.as_slice().map_or_else(|_| array.as_array().to_vec().into(), Cow::from)
}

fn broke() -> PyErr {
    SimulationError::new_err("this run broke in an earlier step, start a new one")
}

/// Which part of a step failed: bad inputs are the caller's, the rest is the simulation's.
pub enum Refused {
    Input(RunError),
    Step(RunError),
}

impl From<Refused> for PyErr {
    fn from(refused: Refused) -> Self {
        match refused {
            Refused::Input(refused) => InputError::new_err(refused.to_string().replace("parameter", "input")),
            Refused::Step(failed) => error::run(&failed),
        }
    }
}

#[pymethods]
impl PyRun {
    /// Makes `steps` inner steps with `inputs` held, writes the signals into `out`, returns the status.
    #[pyo3(signature = (inputs, steps = 1, out = None))]
    fn step(
        &mut self,
        py: Python<'_>,
        inputs: PyArrayLike1<'_, f64, AllowTypeChange>,
        steps: u64,
        out: Option<&Bound<'_, PyArray1<f64>>>,
    ) -> PyResult<&'static str> {
        let status = self.advance(py, &contiguous(&inputs), steps)?;
        if let Some(out) = out {
            self.read(out)?;
        }
        Ok(status.word())
    }

    /// Writes the true signals into `out`, in the order of `signal_names`.
    fn read(&self, out: &Bound<'_, PyArray1<f64>>) -> PyResult<()> {
        let refuse = |message: String| InputError::new_err(message);
        let mut out = out.try_readwrite().map_err(|e| refuse(format!("out: {e}")))?;
        let out = out.as_slice_mut().map_err(|_| refuse("out: expected a contiguous array".to_owned()))?;
        let (got, expected) = (out.len(), count(self.core.signals()));
        if got != expected {
            return Err(refuse(format!("out has {got} places, this run has {expected} signals")));
        }
        let mut places = out.iter_mut();
        self.core.signals().values(&mut |value| {
            if let Some(place) = places.next() {
                *place = value;
            }
        });
        Ok(())
    }

    /// The true signals at the present time, in the order of `signal_names`.
    fn signals<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, row(self.core.signals()))
    }

    /// Names of the signals, in order.
    #[getter]
    fn signal_names(&self) -> Vec<String> {
        names(&mut self.core.signals().clone())
    }

    /// Names of the inputs, in order.
    #[getter]
    fn input_names(&self) -> Vec<String> {
        names(&mut self.core.inputs().clone())
    }

    /// Time since the start, s.
    #[getter]
    fn time(&self) -> f64 {
        self.core.time()
    }

    /// Inner step, s.
    #[getter]
    fn step_size(&self) -> f64 {
        self.core.step_size()
    }

    /// "running", or the id of the event that ended the run.
    #[getter]
    fn status(&self) -> &'static str {
        self.core.status().word()
    }

    /// What ended the run, in words; None while it goes on.
    #[getter]
    fn event(&self) -> Option<String> {
        event(self.core.status())
    }

    /// Reads the sensors every `period` seconds from now on, where no controller does.
    fn sense_every(&mut self, period: f64) -> PyResult<()> {
        self.core.sense_every(period).map_err(|refused| error::run(&refused))
    }

    /// Names of the signals that sensors read.
    #[getter]
    fn measured_names(&self) -> Vec<String> {
        let signals = self.core.signals();
        names(&mut Measurement::of(signals.wheels.len(), signals.links.len()))
    }

    /// What moves, as bytes; a run of the same model goes on from it to the same bits, here or in another process.
    fn snapshot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.core.snapshot().map_err(|refused| SimulationError::new_err(refused.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Goes on from a snapshot of a run of the same model; where it is refused, nothing changes.
    fn restore(&mut self, snapshot: &[u8]) -> PyResult<()> {
        self.core.restore(snapshot).map_err(|refused| InputError::new_err(refused.to_string()))
    }

    /// An independent run; it goes on to the same bits.
    fn copy(&self) -> Self {
        Self { core: self.core.clone(), broken: self.broken }
    }

    fn __copy__(&self) -> Self {
        self.copy()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.copy()
    }

    fn __repr__(&self) -> String {
        format!("<bekker.Run t = {} s, {}>", self.time(), self.status())
    }
}

/// What ended a run, in words.
pub fn event(status: Status) -> Option<String> {
    match status {
        Status::Running => None,
        Status::Ended(event) => Some(event.to_string()),
    }
}

/// Signals in the vocabulary's order.
pub fn row(signals: &Signals) -> Vec<f64> {
    let mut row = Vec::new();
    signals.values(&mut |value| row.push(value));
    row
}

fn count(signals: &Signals) -> usize {
    let mut count = 0;
    signals.values(&mut |_| count += 1);
    count
}

fn names(group: &mut impl Parameters<f64>) -> Vec<String> {
    group.list().into_iter().map(|(variable, _)| variable.name).collect()
}
