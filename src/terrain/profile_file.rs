//! A terrain from a CSV file: columns x and z and, where the soil varies, columns of soil parameters.

use super::soil_table::is_soil_column;
use super::spec::TerrainSpecError;
use super::{Samples, SamplesError, SoilColumn, SoilTable, SoilTableError};
use std::path::Path;

/// Prefix of the soil's columns.
const SOIL: &str = "soil.";

/// What the file holds.
pub(super) struct ProfileFile {
    pub samples: Samples,
    pub soil: Option<SoilTable>,
}

/// A table of numbers with the line of each row.
struct Table<'a> {
    file: &'a str,
    header: Vec<String>,
    /// Values by column.
    columns: Vec<Vec<f64>>,
    lines: Vec<u64>,
}

/// Reads `path`. Lines that begin with `#` are comments.
///
/// # Errors
/// [`TerrainSpecError`] naming file, line, column and what was expected.
pub(super) fn read(path: &Path) -> Result<ProfileFile, TerrainSpecError> {
    let file = path.display().to_string();
    let text =
        std::fs::read_to_string(path).map_err(|source| TerrainSpecError::Unreadable { file: file.clone(), source })?;
    let table = Table::read(&file, &text)?;
    let (x, z) = (table.column("x")?, table.column("z")?);
    let samples = Samples::new(x, z).map_err(|error| table.samples_error(&error))?;
    let soil: Vec<SoilColumn> = table
        .header
        .iter()
        .zip(&table.columns)
        .filter_map(|(name, values)| {
            Some(SoilColumn { name: name.strip_prefix(SOIL)?.to_owned(), values: values.clone() })
        })
        .collect();
    if soil.is_empty() {
        return Ok(ProfileFile { samples, soil: None });
    }
    let soil = SoilTable::new(x.to_vec(), soil).map_err(|error| table.soil_error(&error))?;
    Ok(ProfileFile { samples, soil: Some(soil) })
}

impl<'a> Table<'a> {
    /// Line by line, so that every error can name its line (blank lines and remarks count).
    fn read(file: &'a str, text: &str) -> Result<Self, TerrainSpecError> {
        let content = |(i, line): (usize, &'_ str)| (i as u64 + 1, line.trim().to_owned());
        let mut rows = text
            .trim_start_matches('\u{feff}')
            .lines()
            .enumerate()
            .map(content)
            .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let (line, header) = rows.next().unwrap_or((1, String::new()));
        let header: Vec<String> = header.split(',').map(|name| name.trim().trim_matches('"').to_owned()).collect();
        let mut table = Table { file, columns: vec![Vec::new(); header.len()], header, lines: Vec::new() };
        table.check_header(line)?;
        for (line, row) in rows {
            table.push(line, &row)?;
        }
        Ok(table)
    }

    fn push(&mut self, line: u64, row: &str) -> Result<(), TerrainSpecError> {
        let cells: Vec<&str> = row.split(',').map(str::trim).collect();
        if cells.len() != self.header.len() {
            let message = format!("expected {} fields, found {}", self.header.len(), cells.len());
            return Err(self.cell(line, &self.header.join(","), message));
        }
        for (i, text) in cells.into_iter().enumerate() {
            let value = text.parse();
            let value =
                value.map_err(|_| self.cell(line, &self.header[i], format!("expected a number, found `{text}`")))?;
            self.columns[i].push(value);
        }
        self.lines.push(line);
        Ok(())
    }

    fn check_header(&self, line: u64) -> Result<(), TerrainSpecError> {
        for (i, name) in self.header.iter().enumerate() {
            let known = name == "x" || name == "z" || name.strip_prefix(SOIL).is_some_and(is_soil_column);
            if !known {
                let message = "unknown column; expected `x`, `z`, or a soil parameter such as `soil.k_phi` or \
                               `soil.k_phi_factor`";
                return Err(self.cell(line, name, message.to_owned()));
            }
            if self.header[..i].contains(name) {
                return Err(self.cell(line, name, "expected one column of this name, found two".to_owned()));
            }
        }
        Ok(())
    }

    fn column(&self, name: &str) -> Result<&[f64], TerrainSpecError> {
        let found = self.header.iter().position(|column| column == name);
        found
            .map(|i| self.columns[i].as_slice())
            .ok_or_else(|| self.cell(1, name, format!("expected this column; found {}", self.header.join(", "))))
    }

    fn cell(&self, line: u64, column: &str, message: String) -> TerrainSpecError {
        TerrainSpecError::Cell { file: self.file.to_owned(), line, column: column.to_owned(), message }
    }

    fn line(&self, row: usize) -> u64 {
        self.lines.get(row - 1).copied().unwrap_or(0)
    }

    fn samples_error(&self, error: &SamplesError) -> TerrainSpecError {
        let (line, column) = match error {
            SamplesError::Value { row, column, .. } => (self.line(*row), *column),
            SamplesError::Unsorted { row, .. } => (self.line(*row), "x"),
            SamplesError::TooFew(_) | SamplesError::Unequal { .. } => (self.lines.last().copied().unwrap_or(1), "x"),
        };
        self.cell(line, column, error.to_string())
    }

    fn soil_error(&self, error: &SoilTableError) -> TerrainSpecError {
        let (line, column) = match error {
            SoilTableError::OutOfRange { name, row, .. } => (self.line(*row), name.as_str()),
            SoilTableError::Unknown { name, .. } | SoilTableError::Twice(name) => (1, name.as_str()),
            SoilTableError::Unequal { name, .. } => (1, name.as_str()),
            SoilTableError::Unsorted { row, .. } => (self.line(*row), "x"),
            SoilTableError::Empty => (1, "x"),
        };
        let column = if column == "x" { column.to_owned() } else { format!("{SOIL}{column}") };
        self.cell(line, &column, error.to_string())
    }
}
