//! Class `Batch`: many runs stepped together, through arrays that are bound once.

use crate::ahead::PyAhead;
use crate::error::{self, InputError, SimulationError};
use crate::observation::PyObservedSignals;
use crate::run::{PyRun, contiguous, row};
use bekker::batch::{Batch, BatchError};
use bekker::model::Ahead;
use bekker::simulation::Status;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

/// Inner steps of all runs together from which on other Python threads may go on meanwhile: about 50 us of work, a hundred
/// times what giving and taking the lock costs.
const FREE_FROM: u64 = 25;

/// Many runs of models of one structure, stepped together.
///
/// `inputs` (a row of input values a run) is read and `signals` (a row of signals a run) and `codes` (a place of
/// `statuses` a run) are written by every step.
#[pyclass(module = "bekker", name = "Batch")]
pub struct PyBatch {
    core: Batch,
    inputs: Py<PyArray2<f64>>,
    signals: Py<PyArray2<f64>>,
    codes: Py<PyArray1<u8>>,
    /// A panic left the core in an unknown state.
    broken: bool,
}

/// Words for `codes`, by place. A run that failed is not running any more, and its error tells why.
pub const STATUSES: [&str; FAILED + 1] = {
    let mut words = ["failed"; FAILED + 1];
    let (known, _) = words.split_at_mut(FAILED);
    known.copy_from_slice(&Status::WORDS);
    words
};
const FAILED: usize = Status::WORDS.len();

#[pymethods]
impl PyBatch {
    #[new]
    #[pyo3(signature = (runs, inputs, signals, codes, threads = 1))]
    fn new(
        runs: Vec<PyRef<'_, PyRun>>,
        inputs: Bound<'_, PyArray2<f64>>,
        signals: Bound<'_, PyArray2<f64>>,
        codes: Bound<'_, PyArray1<u8>>,
        threads: usize,
    ) -> PyResult<Self> {
        let py = inputs.py();
        let runs = runs.iter().map(|run| run.taken()).collect::<PyResult<Vec<_>>>()?;
        let core = Batch::new(runs, threads).map_err(|refused| failed(&refused))?;
        let (wide, long) = ([core.len(), core.input_count()], [core.len(), core.signal_count()]);
        check("inputs", inputs.as_any(), &wide)?;
        check("signals", signals.as_any(), &long)?;
        check("codes", codes.as_any(), &[core.len()])?;
        let (inputs, signals, codes) = (inputs.unbind(), signals.unbind(), codes.unbind());
        let batch = Self { core, inputs, signals, codes, broken: false };
        batch.write(py)?;
        Ok(batch)
    }

    /// Makes `steps` inner steps with the inputs held, in the runs that `active` marks (in all where it is None), and
    /// writes signals and codes.
    #[pyo3(signature = (steps = 1, active = None))]
    fn step(own: &Bound<'_, Self>, steps: u64, active: Option<&Bound<'_, PyArray1<bool>>>) -> PyResult<()> {
        let (py, mut own) = (own.py(), own.try_borrow_mut().map_err(|_| occupied())?);
        if own.broken {
            return Err(SimulationError::new_err("this batch broke in an earlier step, make a new one"));
        }
        own.hold(py, active)?;
        let core = &mut own.core;
        let work = steps.saturating_mul(core.len() as u64);
        let mut all = || error::fenced(|| core.advance(steps));
        let outcome = if work < FREE_FROM { all() } else { py.detach(all) };
        own.broken = outcome.is_err();
        outcome?.map_err(|refused| failed(&refused))?;
        own.write(py)
    }

    /// Puts a copy of another run into a place, and its signals and code into the arrays.
    fn replace(own: &Bound<'_, Self>, index: usize, run: &PyRun) -> PyResult<()> {
        let (py, mut own) = (own.py(), own.try_borrow_mut().map_err(|_| occupied())?);
        own.inside(index)?;
        let run = run.taken()?;
        let (status, values) = (run.status().place(), row(run.signals()));
        own.core.replace(index, run).map_err(|refused| failed(&refused))?;
        let width = values.len();
        let mine = index * width..(index + 1) * width;
        written(py, "signals", &own.signals, |all| copy(all, mine.clone(), &values))?;
        written(py, "codes", &own.codes, |codes| codes.iter_mut().skip(index).take(1).for_each(|c| *c = status as u8))?;
        Ok(())
    }

    /// Writes a row of an observation for each run: of its signals, and over them of what its sensors have read, where
    /// `observed` has readings. Entries that are no signals stay as they are.
    fn observe(own: &Bound<'_, Self>, observed: &PyObservedSignals, out: &Bound<'_, PyArray2<f32>>) -> PyResult<()> {
        let own = seen(own)?;
        let expected = [own.core.len(), observed.width];
        // Every step of an environment comes here: `check`, which asks Python for each flag, is for arrays that are refused.
        if out.shape() != expected || !out.is_c_contiguous() {
            check("out", out.as_any(), &expected)?;
        }
        let mut out = out.try_readwrite().map_err(|e| refuse("out", &e))?;
        let rows = out.as_slice_mut().map_err(|e| refuse("out", &e))?.chunks_exact_mut(observed.width.max(1));
        for (index, row) in rows.enumerate() {
            observed.show(own.core.signals_of(index), row);
            let readings = own.core.measurement(index);
            if !readings.wheels.is_empty() {
                observed.show_readings(readings, row);
            }
        }
        Ok(())
    }

    /// Reads the ground ahead of each run into a row of `out`: all heights (m), then which cells are there (1 or 0), then the
    /// relative strengths of the soil.
    fn look_ahead(own: &Bound<'_, Self>, ahead: &PyAhead, out: &Bound<'_, PyArray2<f64>>) -> PyResult<()> {
        let own = seen(own)?;
        let expected = [own.core.len(), Ahead::ROWS * ahead.core().distances().len()];
        if out.shape() != expected || !out.is_c_contiguous() {
            check("out", out.as_any(), &expected)?;
        }
        let mut out = out.try_readwrite().map_err(|e| refuse("out", &e))?;
        own.core.look_ahead(ahead.core(), out.as_slice_mut().map_err(|e| refuse("out", &e))?);
        Ok(())
    }

    /// A copy of the run at a place; it goes on to the same bits.
    fn run(own: &Bound<'_, Self>, index: usize) -> PyResult<PyRun> {
        let own = seen(own)?;
        own.inside(index)?;
        Ok(PyRun::new(own.core.run(index)))
    }

    /// Why the run at a place failed, in words; None where it did not.
    fn error(own: &Bound<'_, Self>, index: usize) -> PyResult<Option<String>> {
        let own = seen(own)?;
        own.inside(index)?;
        Ok(own.core.error(index).map(ToString::to_string))
    }

    /// Time since the start of the run at a place, s.
    fn time(own: &Bound<'_, Self>, index: usize) -> PyResult<f64> {
        let own = seen(own)?;
        own.inside(index)?;
        Ok(own.core.time(index))
    }

    /// Times of all runs since their starts, s.
    fn times<'py>(own: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (py, own) = (own.py(), seen(own)?);
        Ok(PyArray1::from_iter(py, (0..own.core.len()).map(|index| own.core.time(index))))
    }

    /// Words for the codes, by place.
    #[classattr]
    fn statuses(py: Python<'_>) -> PyResult<Bound<'_, PyTuple>> {
        PyTuple::new(py, STATUSES)
    }

    fn __len__(own: &Bound<'_, Self>) -> PyResult<usize> {
        Ok(seen(own)?.core.len())
    }

    fn __repr__(own: &Bound<'_, Self>) -> PyResult<String> {
        Ok(format!("<bekker.Batch of {} runs>", seen(own)?.core.len()))
    }
}

/// The batch, to look at.
fn seen<'py>(own: &Bound<'py, PyBatch>) -> PyResult<PyRef<'py, PyBatch>> {
    own.try_borrow().map_err(|_| occupied())
}

/// During a step other Python threads go on; they may not use what is being stepped.
fn occupied() -> PyErr {
    SimulationError::new_err("another thread steps these rovers just now: give each thread environments of its own")
}

impl PyBatch {
    fn inside(&self, index: usize) -> PyResult<()> {
        if index < self.core.len() {
            return Ok(());
        }
        Err(InputError::new_err(format!("run {index}: expected 0 to {}", self.core.len() - 1)))
    }

    /// Copies the inputs into the runs, before the lock is given away: Python may change its arrays during a step.
    fn hold(&mut self, py: Python<'_>, active: Option<&Bound<'_, PyArray1<bool>>>) -> PyResult<()> {
        let Self { core, inputs, .. } = self;
        let inputs = inputs.bind(py).try_readonly().map_err(|e| refuse("inputs", &e))?;
        let inputs = inputs.as_slice().map_err(|e| refuse("inputs", &e))?;
        let marks = active.map(|marks| marks.try_readonly().map_err(|e| refuse("active", &e))).transpose()?;
        let marks = marks.as_ref().map(contiguous);
        let held = error::fenced(|| core.hold(inputs, marks.as_deref()));
        self.broken = held.is_err();
        held?.map_err(|refused| failed(&refused))
    }

    fn write(&self, py: Python<'_>) -> PyResult<()> {
        written(py, "signals", &self.signals, |all| self.core.signals(all))?;
        written(py, "codes", &self.codes, |codes| {
            for (index, (code, status)) in codes.iter_mut().zip(self.core.statuses()).enumerate() {
                *code = if self.core.error(index).is_some() { FAILED } else { status.place() } as u8;
            }
        })
    }
}

/// Lets `fill` write into an array of Python's.
fn written<T: numpy::Element, D: numpy::ndarray::Dimension>(
    py: Python<'_>,
    name: &str,
    array: &Py<numpy::PyArray<T, D>>,
    fill: impl FnOnce(&mut [T]),
) -> PyResult<()> {
    let mut array = array.bind(py).try_readwrite().map_err(|e| refuse(name, &e))?;
    fill(array.as_slice_mut().map_err(|e| refuse(name, &e))?);
    Ok(())
}

fn copy(all: &mut [f64], mine: std::ops::Range<usize>, values: &[f64]) {
    all[mine].copy_from_slice(values);
}

fn refuse(name: &str, why: &impl std::fmt::Display) -> PyErr {
    InputError::new_err(format!("{name}: {why}"))
}

/// Refuses an array that cannot be bound.
fn check(name: &str, array: &Bound<'_, PyAny>, expected: &[usize]) -> PyResult<()> {
    let flags = array.getattr("flags")?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    let good = |flag| flags.getattr(flag).and_then(|flag| flag.extract::<bool>());
    if shape == expected && good("c_contiguous")? && good("writeable")? && good("aligned")? {
        return Ok(());
    }
    Err(InputError::new_err(format!(
        "{name}: expected a writeable array in C order of shape {expected:?}, found shape {shape:?}"
    )))
}

fn failed(refused: &BatchError) -> PyErr {
    let message = refused.to_string();
    match refused {
        BatchError::Panicked => SimulationError::new_err(format!("internal error, please report it: {message}")),
        _ => InputError::new_err(message.replace("parameter", "input")),
    }
}
