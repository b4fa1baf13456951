//! Class `ObservedSignals`: what an observation shows of a run's signals, and how.

use crate::error::InputError;
use bekker::modeldescription::Parameters;
use pyo3::prelude::*;

/// Entries of an observation that are signals.
///
/// Entry k is the signal at `places[k]` of the vocabulary's order, divided by `scales[k]` and clipped to -`limits[k]` ..
/// `limits[k]`; it stands in column `columns[k]` of a row of `width` entries. `readings` are the places of the signals that
/// sensors read, in the order of `Run.measured_names`.
#[pyclass(module = "bekker._bekker", name = "ObservedSignals", frozen)]
pub struct PyObservedSignals {
    pub width: usize,
    /// By place among the signals.
    truth: Vec<Entry>,
    /// Those that sensors read, by place among the readings.
    read: Vec<Entry>,
    readings: Vec<usize>,
}

/// Width, places, columns, scales, limits and readings.
type Arguments = (usize, Vec<usize>, Vec<usize>, Vec<f64>, Vec<f64>, Vec<usize>);

#[derive(Clone, Copy)]
struct Entry {
    place: usize,
    column: usize,
    scale: f64,
    limit: f64,
}

#[pymethods]
impl PyObservedSignals {
    #[new]
    fn new(
        width: usize,
        places: Vec<usize>,
        columns: Vec<usize>,
        scales: Vec<f64>,
        limits: Vec<f64>,
        readings: Vec<usize>,
    ) -> PyResult<Self> {
        let count = places.len();
        if [columns.len(), scales.len(), limits.len()] != [count; 3] {
            return Err(InputError::new_err(format!(
                "expected {count} columns, scales and limits, one for each place"
            )));
        }
        if let Some(column) = columns.iter().find(|column| **column >= width) {
            return Err(InputError::new_err(format!("column {column}: expected 0 to {}", width.saturating_sub(1))));
        }
        if !limits.iter().all(|limit| *limit > 0.0) {
            return Err(InputError::new_err("limits: expected numbers above 0"));
        }
        let entry = |k: usize| Entry { place: places[k], column: columns[k], scale: scales[k], limit: limits[k] };
        let mut truth: Vec<Entry> = (0..count).map(entry).collect();
        truth.sort_by_key(|entry| entry.place);
        let of_reading = |(place, signal): (usize, &usize)| {
            let shown: Vec<Entry> = truth.iter().filter(|entry| entry.place == *signal).copied().collect();
            shown.into_iter().map(move |entry| Entry { place, ..entry })
        };
        let read = readings.iter().enumerate().flat_map(of_reading).collect();
        Ok(Self { width, truth, read, readings })
    }

    /// The arguments of one that is the same, for copies and pickles.
    fn __getnewargs__(&self) -> Arguments {
        let of = |number: fn(&Entry) -> f64| self.truth.iter().map(number).collect();
        let places = self.truth.iter().map(|entry| entry.place).collect();
        let columns = self.truth.iter().map(|entry| entry.column).collect();
        (self.width, places, columns, of(|entry| entry.scale), of(|entry| entry.limit), self.readings.clone())
    }
}

impl PyObservedSignals {
    /// Writes the entries into a row of an observation.
    pub fn show(&self, signals: &impl Parameters<f64>, row: &mut [f32]) {
        show(&self.truth, signals, row);
    }

    /// Writes the entries that sensors read into a row of an observation.
    pub fn show_readings(&self, readings: &impl Parameters<f64>, row: &mut [f32]) {
        show(&self.read, readings, row);
    }
}

/// `entries` are in the order of their places.
fn show(entries: &[Entry], values: &impl Parameters<f64>, row: &mut [f32]) {
    let (mut entries, mut place) = (entries.iter().peekable(), 0);
    values.values(&mut |value| {
        while let Some(entry) = entries.next_if(|entry| entry.place == place) {
            // NaN stays NaN.
            row[entry.column] = (value / entry.scale).clamp(-entry.limit, entry.limit) as f32;
        }
        place += 1;
    });
}
