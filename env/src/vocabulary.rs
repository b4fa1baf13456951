//! Entries of the vocabulary as Python dictionaries.

use bekker::modeldescription::{Lookup, Parameters, Role, Variable};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Descriptions and present values of a group, in its order.
pub fn list<'py>(py: Python<'py>, group: &mut impl Parameters<f64>) -> PyResult<Vec<Bound<'py, PyDict>>> {
    group.list().into_iter().map(|(variable, value)| entry(py, &variable, value)).collect()
}

fn entry<'py>(py: Python<'py>, variable: &Variable, value: f64) -> PyResult<Bound<'py, PyDict>> {
    let entry = PyDict::new(py);
    entry.set_item("name", &variable.name)?;
    entry.set_item("value", value)?;
    entry.set_item("unit", variable.unit.symbol)?;
    entry.set_item("doc", &*variable.doc)?;
    entry.set_item("default", variable.default)?;
    entry.set_item("min", variable.min)?;
    entry.set_item("max", variable.max)?;
    entry.set_item("role", role(variable.role))?;
    entry.set_item("source", &*variable.source)?;
    Ok(entry)
}

fn role(role: Role) -> &'static str {
    match role {
        Role::Fixed => "fixed",
        Role::Rig => "rig",
        Role::Calibrated => "calibrated",
        Role::Effect => "effect",
        Role::Signal => "signal",
    }
}
