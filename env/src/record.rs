//! A whole run in one call.

use crate::error::{self, InputError};
use crate::model::PyModel;
use crate::run::{Refused, event, row};
use bekker::model::Run;
use bekker::simulation::Status;
use numpy::{AllowTypeChange, PyArray1, PyArray2, PyArrayLike2, PyArrayMethods};
use pyo3::prelude::*;

/// Inner steps between two checks of Python's signals (Ctrl-C): some ten milliseconds of work.
const STEPS_BETWEEN_LOOKS: u64 = 2000;

/// Time, signals (one row an instant), status, event in words.
type Recorded<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, &'static str, Option<String>);

/// What a run leaves behind.
#[derive(Default)]
struct Tape {
    time: Vec<f64>,
    signals: Vec<f64>,
}

impl Tape {
    /// Adds the present instant, once.
    fn add(&mut self, run: &Run) {
        if self.time.last() != Some(&run.time()) {
            self.time.push(run.time());
            self.signals.extend(row(run.signals()));
        }
    }
}

/// Runs `model` with row k of `inputs` held over the k-th interval of `steps` inner steps and records the
/// signals at the start and after every interval, until the inputs or the run end.
#[pyfunction]
pub fn record<'py>(
    py: Python<'py>,
    model: &PyModel,
    inputs: PyArrayLike2<'py, f64, AllowTypeChange>,
    steps: u64,
) -> PyResult<Recorded<'py>> {
    if steps == 0 {
        return Err(InputError::new_err("steps = 0: expected at least 1"));
    }
    let rows: Vec<Vec<f64>> = inputs.as_array().rows().into_iter().map(|row| row.to_vec()).collect();
    let mut run = match py.detach(|| error::fenced(|| model.core.start()))? {
        Ok(run) => run,
        Err(refused) => return Err(error::run(&refused)),
    };
    let mut tape = Tape::default();
    tape.add(&run);
    for some in rows.chunks((STEPS_BETWEEN_LOOKS / steps).max(1) as usize) {
        py.detach(|| error::fenced(|| drive(&mut run, &mut tape, some, steps)))??;
        py.check_signals()?;
    }
    let width = tape.signals.len() / tape.time.len();
    let signals = PyArray1::from_vec(py, tape.signals).reshape([tape.time.len(), width])?;
    Ok((PyArray1::from_vec(py, tape.time), signals, run.status().word(), event(run.status())))
}

fn drive(run: &mut Run, tape: &mut Tape, rows: &[Vec<f64>], steps: u64) -> Result<(), Refused> {
    for row in rows {
        if run.status() != Status::Running {
            break;
        }
        run.inputs_mut().set_all(row).map_err(Refused::Input)?;
        run.advance(steps).map_err(Refused::Step)?;
        tape.add(run);
    }
    Ok(())
}
