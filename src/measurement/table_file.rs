//! Reading a table of numbers.

use super::dialect::Dialect;
use super::error::{ExperimentError, Problem};
use super::files::read_text;
use super::sheet::Sheet;
use super::table::Table;
use std::path::Path;

impl Table {
    /// Reads a CSV file of numbers: one header line, then rows; an empty cell is missing. Separator and decimal mark are found
    /// out, lines that begin with `#`, `%` or `//` are left out. A column `time`
    /// must be complete and increase.
    ///
    /// # Errors
    /// [`ExperimentError`] naming file, line and column, and what was expected.
    pub fn read(file: &Path) -> Result<Self, ExperimentError> {
        let sheet = Sheet::parse(file, &read_text(file)?, &Dialect::default())?;
        let refused =
            |error: super::table::TableError| ExperimentError::in_file(file, Problem::Unreadable(error.to_string()));
        let mut table = Self::new(sheet.header.iter().cloned()).map_err(refused)?;
        let time = sheet.position("time");
        let mut last = f64::NEG_INFINITY;
        for row in &sheet.rows {
            let cells = (0..sheet.header.len()).map(|column| sheet.number(row, column));
            let cells = cells.collect::<Result<Vec<_>, _>>()?;
            if let Some(column) = time {
                let now = cells[column].ok_or_else(|| sheet.error_at(row, column, Problem::MissingInput))?;
                if now <= last {
                    return Err(sheet.error_at(row, column, Problem::TimeOrder { time: now, previous: last }));
                }
                last = now;
            }
            table.push_with_gaps(&cells).map_err(refused)?;
        }
        Ok(table)
    }
}
