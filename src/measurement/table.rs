//! Columns of numbers with names.

use std::io::Write;
use std::path::Path;

/// Why a table could not be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TableError {
    /// Two columns have the same name.
    #[error("column `{0}` appears twice")]
    Duplicate(String),
    /// A row has the wrong number of values.
    #[error("a row of {found} values in a table of {expected} columns")]
    Width {
        /// Values in the row.
        found: usize,
        /// Columns of the table.
        expected: usize,
    },
    /// A value is NaN or infinite.
    #[error("column `{column}`, row {row}: the value is not finite")]
    NotFinite {
        /// Name of the column.
        column: String,
        /// Row, counted from 0.
        row: usize,
    },
}

/// Named columns of equal length, in SI units; cells may be missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    names: Vec<String>,
    // NaN marks a missing cell. No other NaN gets in: both ways to fill a table refuse it.
    columns: Vec<Vec<f64>>,
}

impl Table {
    /// An empty table with these columns.
    ///
    /// # Errors
    /// [`TableError::Duplicate`] where two names are equal.
    pub fn new<N: Into<String>>(names: impl IntoIterator<Item = N>) -> Result<Self, TableError> {
        let names: Vec<String> = names.into_iter().map(Into::into).collect();
        for (k, name) in names.iter().enumerate() {
            if names[..k].contains(name) {
                return Err(TableError::Duplicate(name.clone()));
            }
        }
        let columns = vec![Vec::new(); names.len()];
        Ok(Self { names, columns })
    }

    /// Adds a row without missing cells.
    ///
    /// # Errors
    /// [`TableError::Width`] and [`TableError::NotFinite`]; nothing is added then.
    pub fn push(&mut self, row: &[f64]) -> Result<(), TableError> {
        self.check(row.len(), row.iter().map(|v| v.is_finite()))?;
        self.columns.iter_mut().zip(row).for_each(|(column, value)| column.push(*value));
        Ok(())
    }

    /// Adds a row in which cells may be missing.
    ///
    /// # Errors
    /// As [`push`](Table::push).
    pub fn push_with_gaps(&mut self, row: &[Option<f64>]) -> Result<(), TableError> {
        self.check(row.len(), row.iter().map(|v| v.is_none_or(f64::is_finite)))?;
        self.columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value.unwrap_or(f64::NAN)));
        Ok(())
    }

    fn check(&self, width: usize, mut finite: impl Iterator<Item = bool>) -> Result<(), TableError> {
        if width != self.names.len() {
            return Err(TableError::Width { found: width, expected: self.names.len() });
        }
        match finite.position(|finite| !finite) {
            None => Ok(()),
            Some(k) => Err(TableError::NotFinite { column: self.names[k].clone(), row: self.rows() }),
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Names of the columns, in order.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The column called `name`; NaN marks a missing cell.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let k = self.names.iter().position(|n| n == name)?;
        Some(&self.columns[k])
    }

    /// One cell; `None` where it is missing or there is no such cell.
    #[must_use]
    pub fn value(&self, name: &str, row: usize) -> Option<f64> {
        self.column(name)?.get(row).copied().filter(|v| !v.is_nan())
    }

    /// The same with other names of columns, which stay different from each other.
    pub(crate) fn renamed(&self, name: impl Fn(&str) -> String) -> Self {
        Self { names: self.names.iter().map(|own| name(own)).collect(), columns: self.columns.clone() }
    }

    /// Writes one header line and one line a row; numbers read back to the same bits, a missing cell is empty.
    ///
    /// # Errors
    /// Whatever the writer reports.
    pub fn write_csv(&self, writer: impl Write) -> std::io::Result<()> {
        let mut csv = csv::Writer::from_writer(writer);
        csv.write_record(&self.names)?;
        for row in 0..self.rows() {
            csv.write_record(self.columns.iter().map(|column| match column[row] {
                value if value.is_nan() => String::new(),
                value => format!("{value:?}"),
            }))?;
        }
        csv.flush()
    }

    /// Writes the table to a file, see [`write_csv`](Table::write_csv).
    ///
    /// # Errors
    /// Whatever the file system reports.
    pub fn save(&self, path: impl AsRef<Path>) -> std::io::Result<()> {
        self.write_csv(std::io::BufWriter::new(std::fs::File::create(path)?))
    }
}
