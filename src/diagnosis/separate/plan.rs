//! What plans of all kinds of experiments share: run lists with their inputs, the measured columns empty. The plans themselves
//! stand with the [kinds](crate::diagnosis::kinds).

use crate::measurement::{Experiment, Kind, Run, Table, TableError};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Why there is no such experiment.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// A list of set-points is empty, or a number makes no sense.
    #[error("{name}: expected {expected}, found {found}")]
    Value {
        /// What was given.
        name: &'static str,
        /// What is possible.
        expected: &'static str,
        /// What was found.
        found: String,
    },
    /// The columns do not form a table.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// Fails where a list is empty or one of its numbers is not as `allowed` says.
pub(crate) fn check(
    name: &'static str,
    values: &[f64],
    expected: &'static str,
    allowed: impl Fn(f64) -> bool,
) -> Result<(), PlanError> {
    let found = match values.iter().find(|value| !(value.is_finite() && allowed(**value))) {
        _ if values.is_empty() => "nothing".to_owned(),
        Some(odd) => odd.to_string(),
        None => return Ok(()),
    };
    Err(PlanError::Value { name, expected, found })
}

/// A table of inputs, row by row, beside empty columns for what will be measured.
pub(crate) fn sheet(inputs: &[String], rows: &[Vec<f64>], measured: &[String]) -> Result<Table, TableError> {
    let mut table = Table::new(inputs.iter().chain(measured).cloned())?;
    for row in rows {
        let gaps = std::iter::repeat_n(None, measured.len());
        table.push_with_gaps(&row.iter().map(|value| Some(*value)).chain(gaps).collect::<Vec<_>>())?;
    }
    Ok(table)
}

pub(crate) fn experiment(name: &str, kind: Kind, parameters: &BTreeMap<String, f64>, runs: Vec<Run>) -> Experiment {
    Experiment {
        effects: Vec::new(),
        name: name.to_owned(),
        kind,
        folder: PathBuf::new(),
        parameters: parameters.clone(),
        priors: BTreeMap::new(),
        soil_class: None,
        shared: BTreeMap::new(),
        sensors: BTreeMap::new(),
        model: None,
        noise: BTreeMap::new(),
        runs,
        doubts: Vec::new(),
        parts: Vec::new(),
    }
}

/// a, b, c .. for the repeats of a run.
pub(crate) fn letter(repeat: usize) -> String {
    match u8::try_from(repeat) {
        Ok(k) if k < 26 => char::from(b'a' + k).to_string(),
        _ => format!("r{}", repeat + 1),
    }
}

/// Two significant digits: what a rig is set to.
pub(crate) fn handy(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return 0.0;
    }
    let scale = 10_f64.powf(value.abs().log10().floor() - 1.0);
    let rounded = (value / scale).round() * scale;
    // 12 digits take off what the scaling left: 0.30000000000000004.
    format!("{rounded:.12}").parse().unwrap_or(rounded)
}
