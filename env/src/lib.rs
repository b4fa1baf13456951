//! The Python door: a thin layer over [`bekker::model`]. All physics stays in the core; what is
//! convenient in Python (arguments of many kinds, the environment) is written in Python.
//!
//! A class that wraps a type of the core has its name in Python and the prefix `Py` here: `PyModel` is Python's `Model` and
//! wraps the core's.

mod ahead;
mod batch;
mod check;
mod compare;
mod controller;
mod diagnose;
mod error;
mod experiment;
mod export;
mod finding;
mod model;
mod observation;
mod planning;
mod record;
mod render;
mod run;
mod studio;
mod vocabulary;

use pyo3::pymodule;

/// Native part of the package `bekker`.
#[pymodule]
mod _bekker {
    #[pymodule_export]
    use super::ahead::PyAhead;
    #[pymodule_export]
    use super::batch::PyBatch;
    #[pymodule_export]
    use super::check::PyReport;
    #[pymodule_export]
    use super::check::PyScript;
    #[pymodule_export]
    use super::compare::compare;
    #[pymodule_export]
    use super::compare::known_soil;
    #[pymodule_export]
    use super::controller::PyController;
    #[pymodule_export]
    use super::diagnose::diagnose;
    #[pymodule_export]
    use super::diagnose::fit_task;
    #[pymodule_export]
    use super::experiment::check_experiment;
    #[pymodule_export]
    use super::experiment::import_experiment;
    #[pymodule_export]
    use super::export::export_fmu;
    #[pymodule_export]
    use super::finding::NativeDiagnosis;
    #[pymodule_export]
    use super::model::PyModel;
    #[pymodule_export]
    use super::observation::PyObservedSignals;
    #[pymodule_export]
    use super::planning::{plan, planning_settings, pose, robots};
    #[pymodule_export]
    use super::record::record;
    #[pymodule_export]
    use super::render::Renderer;
    #[pymodule_export]
    use super::run::PyRun;
    #[pymodule_export]
    use super::studio::NativeStudio;
    #[pymodule_export]
    use super::studio::open_studio;
    use pyo3::prelude::*;

    /// Names and meanings of the built-in models.
    #[pyfunction]
    fn presets() -> Vec<(&'static str, &'static str)> {
        bekker::model::PRESETS.to_vec()
    }

    /// Ids and meanings of the effects that every model has, neutral by default.
    #[pyfunction]
    fn effects() -> Vec<(&'static str, &'static str)> {
        bekker::effects::EFFECTS.iter().map(|(id, doc)| (*id, doc.trim())).collect()
    }

    /// Ids and meanings of the effects on tests of a soil.
    #[pyfunction]
    fn test_effects() -> Vec<(&'static str, &'static str)> {
        bekker::soil_test::TEST_EFFECTS.iter().map(|(id, doc)| (*id, doc.trim())).collect()
    }

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
