//! The rows of one run in SI units, with the lines on which they stand.

use super::columns::{Column, Use, mend_by, quoted};
use super::error::{ExperimentError, Problem};
use super::mapping::{Recorded, Side};
use super::table::Table;
use std::ops::Range;
use std::path::PathBuf;

/// Signals, inputs and time of one run.
#[derive(Clone)]
pub(super) struct Grid {
    pub file: PathBuf,
    pub header_line: u64,
    /// Line of each row.
    pub lines: Vec<u64>,
    pub columns: Vec<GridColumn>,
}

/// One signal or input.
#[derive(Clone)]
pub(super) struct GridColumn {
    /// The signal.
    pub name: String,
    /// The file's column.
    pub source: String,
    /// The column of the other side of the vehicle, with which it is averaged.
    pub beside: Option<String>,
    pub used: Use,
    pub recorded: Recorded,
    /// One value a row; NaN where it is missing.
    pub values: Vec<f64>,
}

impl GridColumn {
    /// A signal that a recorder gives as it is.
    pub fn plain(name: impl Into<String>, source: impl Into<String>, used: Use, values: Vec<f64>) -> Self {
        Self { name: name.into(), source: source.into(), beside: None, used, recorded: Recorded::default(), values }
    }

    /// The columns of the file, as a text has them.
    pub fn shown(&self) -> String {
        match &self.beside {
            Some(other) => format!("`{}` and `{other}`", self.source),
            None => format!("`{}`", self.source),
        }
    }

    /// What gives the file's columns another key: the whole line of `[columns]`, or the key for the entries that are there already.
    pub fn mend(&self, key: &str) -> String {
        match &self.beside {
            Some(other) => format!("`{key}` in the entries of {} and {}", quoted(&self.source), quoted(other)),
            None => mend_by(&self.source, &self.name, key),
        }
    }

    /// Whether it is of one side of the vehicle and `side` is the other.
    pub fn is_other_side(&self, side: Option<Side>) -> bool {
        matches!((self.recorded.side, side), (Some(own), Some(other)) if own != other)
    }
}

impl Grid {
    pub fn names(&self) -> Vec<String> {
        self.columns.iter().map(|column| column.name.clone()).collect()
    }

    pub fn column(&self, name: &str) -> Option<&GridColumn> {
        self.columns.iter().find(|column| column.name == name)
    }

    pub fn values(&self, name: &str) -> Option<&[f64]> {
        self.column(name).map(|column| column.values.as_slice())
    }

    /// Some of its rows.
    pub fn part(&self, rows: Range<usize>) -> Self {
        let of = |column: &GridColumn| GridColumn {
            name: column.name.clone(),
            source: column.source.clone(),
            beside: column.beside.clone(),
            used: column.used,
            recorded: column.recorded,
            values: column.values[rows.clone()].to_vec(),
        };
        Self {
            file: self.file.clone(),
            header_line: self.header_line,
            lines: self.lines[rows.clone()].to_vec(),
            columns: self.columns.iter().map(of).collect(),
        }
    }

    /// Whether anything that is compared with the model has a value in these rows.
    pub fn measures(&self, rows: Range<usize>) -> bool {
        let mut measured = self.columns.iter().filter(|column| column.used == Use::Measured);
        measured.any(|column| column.values[rows.clone()].iter().any(|value| !value.is_nan()))
    }

    /// Takes a column out.
    pub fn take(&mut self, name: &str) -> Option<GridColumn> {
        let at = self.columns.iter().position(|column| column.name == name)?;
        Some(self.columns.remove(at))
    }

    /// The values as a table, which nothing but NaN for missing ones gets into.
    pub fn table(&self) -> Result<Table, ExperimentError> {
        let broken = |_| self.error(Problem::Header("the columns do not form a table"));
        let mut table = Table::new(self.names()).map_err(broken)?;
        for row in 0..self.lines.len() {
            let cells = self.columns.iter().map(|column| Some(column.values[row]).filter(|value| !value.is_nan()));
            table.push_with_gaps(&cells.collect::<Vec<_>>()).map_err(broken)?;
        }
        Ok(table)
    }

    /// Fails where an input is missing, or a value lies outside what its unit allows.
    pub fn check_limits(&self, known: &[Column]) -> Result<(), ExperimentError> {
        for row in 0..self.lines.len() {
            for own in &self.columns {
                let Some(column) = known.iter().find(|column| column.name == own.name) else { continue };
                let value = own.values[row];
                if value.is_nan() && matches!(own.used, Use::Input | Use::Time | Use::Intermediate) {
                    return Err(self.error_at(row, own, Problem::MissingInput));
                }
                if let Some(limits) = column.limits.as_ref().filter(|limits| !value.is_nan() && !limits.allow(value)) {
                    let expected = limits.expected(&own.source, &own.name);
                    return Err(self.error_at(row, own, Problem::Implausible { value, expected }));
                }
            }
        }
        Ok(())
    }

    pub fn error(&self, problem: Problem) -> ExperimentError {
        ExperimentError::in_file(&self.file, problem)
    }

    pub fn error_at(&self, row: usize, column: &GridColumn, problem: Problem) -> ExperimentError {
        self.error(problem).at_line(self.lines[row]).at_column(&column.source)
    }
}
