//! A CSV file as text with line numbers, before anything is known of its columns.

use super::error::{ExperimentError, Problem};
use std::path::{Path, PathBuf};

/// Header and rows of a CSV file; every row is as wide as the header.
pub(super) struct Sheet {
    pub file: PathBuf,
    pub header: Vec<String>,
    pub rows: Vec<SheetRow>,
}

/// One row and the line on which it stands.
pub(super) struct SheetRow {
    pub line: u64,
    pub cells: Vec<String>,
}

impl Sheet {
    /// The sheet in `text`; `file` is for errors.
    pub fn parse(file: &Path, text: &str) -> Result<Self, ExperimentError> {
        let unreadable = |message: String| ExperimentError::in_file(file, Problem::Unreadable(message));
        // A byte-order mark, which spreadsheets like to write.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .has_headers(false)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let mut header: Option<Vec<String>> = None;
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|e| unreadable(e.to_string()))?;
            let line = record.position().map_or(0, csv::Position::line);
            let cells: Vec<String> = record.iter().map(str::to_owned).collect();
            match &header {
                None => header = Some(cells),
                Some(header) if header.len() != cells.len() => {
                    let problem = Problem::Ragged { found: cells.len(), expected: header.len() };
                    return Err(ExperimentError::in_file(file, problem).at_line(line));
                }
                Some(_) => rows.push(SheetRow { line, cells }),
            }
        }
        let header = header.ok_or_else(|| unreadable("the file is empty".to_owned()))?;
        let sheet = Self { file: file.to_owned(), header, rows };
        sheet.check_header()?;
        Ok(sheet)
    }

    fn check_header(&self) -> Result<(), ExperimentError> {
        for (k, name) in self.header.iter().enumerate() {
            let problem = if name.is_empty() {
                Problem::Header("a column without a name")
            } else if self.header[..k].contains(name) {
                Problem::Header("this column appears twice")
            } else {
                continue;
            };
            let shown = if name.is_empty() { format!("number {}", k + 1) } else { name.clone() };
            return Err(self.error(problem).at_line(1).at_column(shown));
        }
        Ok(())
    }

    /// Number in a cell; `None` where it is empty.
    pub fn number(&self, row: &SheetRow, column: usize) -> Result<Option<f64>, ExperimentError> {
        let text = row.cells[column].as_str();
        if text.is_empty() {
            return Ok(None);
        }
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => Err(self.error_at(row, column, Problem::NotANumber { text: text.to_owned() })),
        }
    }

    pub fn position(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|n| n == name)
    }

    pub fn error(&self, problem: Problem) -> ExperimentError {
        ExperimentError::in_file(&self.file, problem)
    }

    pub fn error_at(&self, row: &SheetRow, column: usize, problem: Problem) -> ExperimentError {
        self.error(problem).at_line(row.line).at_column(&self.header[column])
    }

    /// Fails where there are fewer than `needed` rows.
    pub fn need_rows(&self, needed: usize) -> Result<(), ExperimentError> {
        if self.rows.len() < needed {
            return Err(self.error(Problem::TooFewRows { found: self.rows.len(), needed }));
        }
        Ok(())
    }
}
