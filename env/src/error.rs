//! Errors of the core as exceptions of `bekker.errors`, and the fence that no panic passes.

use bekker::model::{ModelError as CoreModelError, RunError};
use bekker::modeldescription::ParameterError;
use bekker::terrain::TerrainSpecError;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

pyo3::import_exception!(bekker.errors, InputError);
pyo3::import_exception!(bekker.errors, ModelError);
pyo3::import_exception!(bekker.errors, PlanningError);
pyo3::import_exception!(bekker.errors, SimulationError);
pyo3::import_exception!(bekker.errors, UnknownNameError);

/// The exception for a parameter that is refused.
pub fn parameter(error: &ParameterError) -> PyErr {
    match error {
        ParameterError::Unknown { .. } => UnknownNameError::new_err(error.to_string()),
        ParameterError::OutOfRange { .. } => ModelError::new_err(error.to_string()),
    }
}

/// The exception for a model that cannot be read; unreadable files are the `OSError` of their kind.
pub fn model(error: &CoreModelError) -> PyErr {
    match error {
        CoreModelError::Parameter(source) | CoreModelError::Terrain(TerrainSpecError::Parameter(source)) => {
            parameter(source)
        }
        CoreModelError::UnknownPreset { .. } => UnknownNameError::new_err(error.to_string()),
        CoreModelError::Unreadable { source, .. }
        | CoreModelError::Terrain(TerrainSpecError::Unreadable { source, .. }) => {
            unreachable_file(source, error.to_string())
        }
        _ => ModelError::new_err(error.to_string()),
    }
}

/// The exception for a run that cannot start or go on.
pub fn run(error: &RunError) -> PyErr {
    match error {
        RunError::Parameter(source) => parameter(source),
        RunError::Period { .. }
        | RunError::WheelOrder { .. }
        | RunError::ObstaclesWithoutBodies { .. }
        | RunError::NeedsJointCoordinates { .. }
        | RunError::NotTunable { .. }
        | RunError::NoController { .. }
        | RunError::Carriage { .. }
        | RunError::NoRigidBodies => ModelError::new_err(error.to_string()),
        RunError::InputLength { .. } => InputError::new_err(error.to_string()),
        RunError::Step(_) | RunError::Control { .. } => SimulationError::new_err(error.to_string()),
    }
}

/// The `OSError` for a file that cannot be read or written.
pub fn unreachable_file(source: &std::io::Error, message: String) -> PyErr {
    match source.raw_os_error() {
        // From the code, Python picks FileNotFoundError and its like.
        Some(code) => PyOSError::new_err((code, message)),
        None => PyOSError::new_err(message),
    }
}

/// A panic that was caught on its way to Python.
#[derive(Debug)]
pub struct Panic(String);

impl Panic {
    fn new(payload: &(dyn Any + Send)) -> Self {
        let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
        Self(text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_owned()))
    }
}

impl From<Panic> for PyErr {
    fn from(panic: Panic) -> Self {
        SimulationError::new_err(format!("internal error, please report it: {}", panic.0))
    }
}

/// Does `work`; a panic in it comes back as an error. What `work` changed must not be used afterwards.
pub fn fenced<T>(work: impl FnOnce() -> T) -> Result<T, Panic> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| Panic::new(&*payload))
}

#[cfg(test)]
mod tests {
    use super::fenced;

    #[test]
    fn property_panic_becomes_an_error() {
        assert!(matches!(fenced(|| 3), Ok(3)));
        let caught = fenced(|| assert!(std::hint::black_box(1) > 2, "one is not two"));
        assert!(caught.is_err_and(|panic| panic.0.contains("one is not two")));
    }
}
