//! Soil that varies along x: values of soil parameters, or factors on them, by name.

use crate::scalar::Scalar;
use crate::soil::Soil;
use bekker_modeldescription::{Lookup, Parameters};
use std::cell::Cell;

/// Ending of a column's name that makes it a factor on the parameter instead of its value.
const FACTOR: &str = "_factor";
/// Allowed factors.
const FACTORS: std::ops::RangeInclusive<f64> = 0.01..=100.0;

/// One soil parameter along x.
#[derive(Clone, Debug, PartialEq)]
pub struct SoilColumn {
    /// Name of the parameter without `soil.`, for example `k_phi`; with the ending `_factor` the values multiply
    /// the parameter, without it they replace it.
    pub name: String,
    /// One value for each position, SI.
    pub values: Vec<f64>,
}

/// Soil parameters at given positions: linear between them, constant beyond.
#[derive(Clone, Debug, PartialEq)]
pub struct SoilTable {
    x: Vec<f64>,
    columns: Vec<SoilColumn>,
    /// For each soil parameter in the order of its group, the column that changes it.
    changes: Vec<Option<Change>>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Change {
    Value(usize),
    Factor(usize),
}

/// Why a soil table is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SoilTableError {
    /// A column that no soil parameter has the name of.
    #[error("unknown soil column `{name}`; expected one of {known}, or one of these with the ending `_factor`")]
    Unknown {
        /// The name found.
        name: String,
        /// The names of all soil parameters.
        known: String,
    },
    /// A parameter that two columns change.
    #[error("soil column `{0}`: another column already changes this parameter; expected one column for each")]
    Twice(String),
    /// A column of another length than x.
    #[error("soil column `{name}` has {found} values; expected {expected}, one for each x")]
    Unequal {
        /// The column.
        name: String,
        /// Its length.
        found: usize,
        /// The number of positions.
        expected: usize,
    },
    /// A value out of range.
    #[error("soil column `{name}`, row {row}: {value}; expected {range}")]
    OutOfRange {
        /// The column.
        name: String,
        /// Row, counted from 1.
        row: usize,
        /// The value found.
        value: f64,
        /// The allowed range.
        range: String,
    },
    /// Positions that are missing, not finite, or do not grow.
    #[error("soil table, row {row}: x = {value}; expected finite positions that grow")]
    Unsorted {
        /// Row, counted from 1.
        row: usize,
        /// The value found.
        value: f64,
    },
    /// Nothing to interpolate.
    #[error("expected a soil table with at least one position and one column")]
    Empty,
}

impl SoilTable {
    /// A table of `columns` at the positions `x` (m, growing).
    ///
    /// # Errors
    /// [`SoilTableError`] naming column, row and what was expected.
    pub fn new(x: Vec<f64>, columns: Vec<SoilColumn>) -> Result<Self, SoilTableError> {
        if x.is_empty() || columns.is_empty() {
            return Err(SoilTableError::Empty);
        }
        let grows = |i: usize| x[i].is_finite() && (i == 0 || x[i] > x[i - 1]);
        if let Some(i) = (0..x.len()).find(|&i| !grows(i)) {
            return Err(SoilTableError::Unsorted { row: i + 1, value: x[i] });
        }
        let mut changes = vec![None; Soil::<f64>::default().list().len()];
        for (i, column) in columns.iter().enumerate() {
            let (parameter, change) = check(column, i, x.len())?;
            if changes[parameter].replace(change).is_some() {
                return Err(SoilTableError::Twice(column.name.clone()));
            }
        }
        Ok(Self { x, columns, changes })
    }

    /// The positions, m.
    #[must_use]
    pub fn positions(&self) -> &[f64] {
        &self.x
    }

    /// The columns.
    #[must_use]
    pub fn columns(&self) -> &[SoilColumn] {
        &self.columns
    }

    /// `base` with what the table says at `x`. No allocation.
    pub(super) fn apply<S: Scalar>(&self, base: &Soil<S>, x: S) -> Soil<S> {
        let (row, part) = self.place(x);
        let read = |column: usize| {
            let values = &self.columns[column].values;
            let next = values[(row + 1).min(values.len() - 1)];
            part * (next - values[row]) + values[row]
        };
        // `map` goes through the parameters in the order of the group, as `list` did.
        let next = Cell::new(0);
        base.map(&|parameter| match self.changes[next.replace(next.get() + 1)] {
            None => parameter,
            Some(Change::Value(column)) => read(column),
            Some(Change::Factor(column)) => parameter * read(column),
        })
    }

    /// Row before `x` and the part of the way to the next.
    fn place<S: Scalar>(&self, x: S) -> (usize, S) {
        let row = self.x.partition_point(|at| *at <= x.value());
        if row == 0 || row == self.x.len() {
            return (row.saturating_sub(1), S::from(0.0));
        }
        let (from, to) = (self.x[row - 1], self.x[row]);
        (row - 1, (x - from) / (to - from))
    }
}

/// Which parameter the column changes and how.
fn check(column: &SoilColumn, number: usize, rows: usize) -> Result<(usize, Change), SoilTableError> {
    let known = Soil::<f64>::default().list();
    let find = |name: &str| known.iter().position(|(variable, _)| variable.name == name);
    let name = &column.name;
    let factor = name.strip_suffix(FACTOR).and_then(find);
    let Some(parameter) = factor.or_else(|| find(name)) else {
        let known = known.into_iter().map(|(variable, _)| variable.name).collect::<Vec<_>>().join(", ");
        return Err(SoilTableError::Unknown { name: name.clone(), known });
    };
    if column.values.len() != rows {
        return Err(SoilTableError::Unequal { name: name.clone(), found: column.values.len(), expected: rows });
    }
    let variable = &known[parameter].0;
    let allowed = |value: f64| if factor.is_some() { FACTORS.contains(&value) } else { variable.allows(value) };
    if let Some((i, &value)) = column.values.iter().enumerate().find(|(_, value)| !allowed(**value)) {
        let factors = || format!("a factor {} .. {}", FACTORS.start(), FACTORS.end());
        let range = if factor.is_some() { factors() } else { variable.range() };
        return Err(SoilTableError::OutOfRange { name: name.clone(), row: i + 1, value, range });
    }
    Ok((parameter, if factor.is_some() { Change::Factor(number) } else { Change::Value(number) }))
}

/// Whether `name` (without `soil.`) is that of a soil column.
pub(super) fn is_soil_column(name: &str) -> bool {
    let mut soil = Soil::<f64>::default();
    let mut found = false;
    let parameter = name.strip_suffix(FACTOR).unwrap_or(name);
    soil.visit("", &mut |variable, _| found |= variable.name == parameter);
    found
}
