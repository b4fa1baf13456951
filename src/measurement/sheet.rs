//! A table as it was given, with line numbers, before anything is known of its columns.

use super::arrays::{Cells, Columns};
use super::dialect::{Decimal, Dialect, Kept, Separator, decimal_of};
use super::error::{ExperimentError, Problem};
use bekker_modeldescription::Unit;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Header and rows of a table; every row is as wide as the header.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    pub file: PathBuf,
    pub header: Vec<String>,
    /// Units that the row under the header names, column by column; empty where there is no such row.
    pub units: Vec<String>,
    pub rows: Vec<SheetRow>,
    /// Line of the header, counted from 1.
    pub header_line: u64,
    separator: Separator,
    decimal: Decimal,
    missing: Vec<String>,
}

/// One row and the line on which it stands.
#[derive(Clone, Debug)]
pub(super) struct SheetRow {
    pub line: u64,
    pub cells: Vec<Cell>,
}

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Cell {
    /// As a file has it, or a label.
    Text(String),
    /// Of an array; NaN where it is missing.
    Number(f64),
}

impl Cell {
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Text(text) => text.is_empty(),
            Self::Number(number) => number.is_nan(),
        }
    }

    pub fn text(&self) -> Cow<'_, str> {
        match self {
            Self::Text(text) => Cow::Borrowed(text),
            Self::Number(number) if number.is_nan() => Cow::Borrowed(""),
            Self::Number(number) => Cow::Owned(number.to_string()),
        }
    }
}

impl Sheet {
    /// The sheet in `text`, which is written as `dialect` says; what that leaves open is found out. `file` is for errors.
    pub fn parse(file: &Path, text: &str, dialect: &Dialect) -> Result<Self, ExperimentError> {
        let unreadable = |message: String| ExperimentError::in_file(file, Problem::Unreadable(message));
        // A byte-order mark, which spreadsheets like to write.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let kept = Kept::of(text, dialect);
        let first =
            kept.lines.first().map(|(line, _)| *line).ok_or_else(|| unreadable("the file is empty".to_owned()))?;
        if let Some(header) = dialect.header_line.filter(|header| *header != first) {
            return Err(unreadable(format!("line {header}, `header_line` under [file], holds no names")));
        }
        let separator = kept.separator(dialect).map_err(|message| unreadable(message).at_line(first))?;
        let mut rows = records(file, &kept, separator)?;
        let header = texts(&rows.remove(0));
        let mut sheet = Self {
            file: file.to_owned(),
            header,
            units: Vec::new(),
            rows,
            header_line: first,
            separator,
            decimal: Decimal::Point,
            missing: dialect.missing.clone(),
        };
        sheet.drop_empty_edge();
        sheet.check_shape()?;
        sheet.take_units_row(dialect);
        sheet.decimal = sheet.find_decimal(dialect)?;
        sheet.check_header()?;
        Ok(sheet)
    }

    /// The sheet of columns that are arrays; the header is line 1. Rows without any value are left out, as in a file. `file` is for
    /// errors.
    pub fn of_columns(file: &Path, columns: &Columns) -> Result<Self, ExperimentError> {
        let unreadable = |message: String| ExperimentError::in_file(file, Problem::Unreadable(message));
        let (first, cells) = columns.first().ok_or_else(|| unreadable("there are no columns".to_owned()))?;
        if let Some((name, other)) = columns.iter().find(|(_, other)| other.len() != cells.len()) {
            let (found, expected) = (other.len(), cells.len());
            return Err(unreadable(format!("column `{name}` has {found} rows where `{first}` has {expected}")));
        }
        let cell = |cells: &Cells, row: usize| match cells {
            Cells::Numbers(numbers) => Cell::Number(numbers[row]),
            Cells::Labels(labels) => Cell::Text(labels[row].trim().to_owned()),
        };
        let row = |row: usize| SheetRow {
            line: row as u64 + 2,
            cells: columns.iter().map(|(_, cells)| cell(cells, row)).collect(),
        };
        let sheet = Self {
            file: file.to_owned(),
            header: columns.iter().map(|(name, _)| name.trim().to_owned()).collect(),
            units: Vec::new(),
            rows: (0..cells.len()).map(row).filter(|row| !row.cells.iter().all(Cell::is_empty)).collect(),
            header_line: 1,
            separator: Separator::Comma,
            decimal: Decimal::Point,
            missing: Vec::new(),
        };
        sheet.check_header()?;
        Ok(sheet)
    }

    /// A separator at the end of every line, as loggers write it, makes a column without name or values: none.
    fn drop_empty_edge(&mut self) {
        let blank = |cells: &[Cell], from: usize| cells.len() > from && cells[from..].iter().all(Cell::is_empty);
        let width = self.header.len();
        if self.header.last().is_some_and(String::is_empty)
            && self.rows.iter().all(|row| row.cells.len() < width || blank(&row.cells, width - 1))
        {
            self.header.truncate(width - 1);
        }
        let width = self.header.len();
        for row in self.rows.iter_mut().filter(|row| blank(&row.cells, width)) {
            row.cells.truncate(width);
        }
    }

    fn check_shape(&self) -> Result<(), ExperimentError> {
        let expected = self.header.len();
        match self.rows.iter().find(|row| row.cells.len() != expected) {
            None => Ok(()),
            Some(row) => Err(self.error(Problem::Ragged { found: row.cells.len(), expected }).at_line(row.line)),
        }
    }

    /// Takes the row under the header off where it holds units: where the settings say so, or where none of its cells is
    /// a number and one of them is a unit.
    fn take_units_row(&mut self, dialect: &Dialect) {
        let Some(first) = self.rows.first() else { return };
        let cells = texts(first);
        let numbers = cells.iter().any(|cell| cell.bytes().any(|byte| byte.is_ascii_digit()) && number(cell));
        let unit = |cell: &String| !cell.is_empty() && Unit::spelled(cell).is_some();
        let looks = !numbers && cells.iter().any(unit);
        if dialect.units_row.unwrap_or(looks) {
            self.units = texts(&self.rows.remove(0));
        }
    }

    fn find_decimal(&self, dialect: &Dialect) -> Result<Decimal, ExperimentError> {
        if let Some(given) = dialect.decimal {
            return Ok(given);
        }
        let shows = |wanted: Decimal| {
            let mut cells = self.rows.iter().flat_map(|row| row.cells.iter().map(|cell| (row.line, cell.text())));
            cells.find(|(_, cell)| decimal_of(cell) == Some(wanted))
        };
        // Where commas separate cells, a comma within a number stands in a quoted cell; that cell is refused when it is read.
        if self.separator == Separator::Comma {
            return Ok(Decimal::Point);
        }
        match (shows(Decimal::Comma), shows(Decimal::Point)) {
            (None, _) => Ok(Decimal::Point),
            (Some(_), None) => Ok(Decimal::Comma),
            (Some((a, comma)), Some((b, point))) => {
                let message = format!(
                    "the decimal mark is not clear: line {a} has `{comma}` and line {b} `{point}`; write it as `decimal` under [file]"
                );
                Err(self.error(Problem::Unreadable(message)))
            }
        }
    }

    fn check_header(&self) -> Result<(), ExperimentError> {
        if self.header.iter().all(|name| number(name)) {
            let problem = Problem::Header(
                "this line holds numbers where the names of the columns are expected; where they stand in another line, a comment line say, write its number as `header_line` under [file]",
            );
            return Err(self.error(problem).at_line(self.header_line));
        }
        for (k, name) in self.header.iter().enumerate() {
            let problem = if name.is_empty() {
                Problem::Header("a column without a name")
            } else if self.header[..k].contains(name) {
                Problem::Header("this column appears twice")
            } else {
                continue;
            };
            let shown = if name.is_empty() { format!("number {}", k + 1) } else { name.clone() };
            return Err(self.error(problem).at_line(self.header_line).at_column(shown));
        }
        Ok(())
    }

    /// Whether a cell holds no value.
    pub fn is_missing(&self, text: &str) -> bool {
        text.is_empty() || self.missing.iter().any(|missing| missing == text)
    }

    /// Number in a cell; `None` where it is missing.
    pub fn number(&self, row: &SheetRow, column: usize) -> Result<Option<f64>, ExperimentError> {
        let cell = &row.cells[column];
        let missing = match cell {
            Cell::Text(text) => self.is_missing(text),
            Cell::Number(number) => number.is_nan(),
        };
        if missing {
            return Ok(None);
        }
        self.value(cell).map(Some).ok_or_else(|| {
            let text = cell.text().into_owned();
            let understood = self.understood(&text);
            self.error_at(row, column, Problem::NotANumber { text, understood })
        })
    }

    /// A finite number, in a file in its own decimal mark.
    pub fn value(&self, cell: &Cell) -> Option<f64> {
        let text = match cell {
            Cell::Number(number) => return Some(*number).filter(|value| value.is_finite()),
            Cell::Text(text) => text,
        };
        let plain = match self.decimal {
            Decimal::Point => text.parse::<f64>(),
            Decimal::Comma if text.contains('.') => return None,
            Decimal::Comma => text.replace(',', ".").parse::<f64>(),
        };
        plain.ok().filter(|value| value.is_finite())
    }

    /// How the file was read, where that may be why a cell is no number.
    fn understood(&self, text: &str) -> String {
        if !text.contains([',', '.']) || !text.bytes().any(|byte| byte.is_ascii_digit()) {
            return String::new();
        }
        let mark = if self.decimal == Decimal::Comma { "comma" } else { "point" };
        format!(
            "; the file was read with {} between cells and a decimal {mark}: `separator` and `decimal` under [file] change that",
            self.separator.shown()
        )
    }

    /// Separator and decimal mark, as [`Dialect`] writes them.
    pub fn dialect(&self) -> [String; 2] {
        let separator = match self.separator {
            Separator::Comma => ",",
            Separator::Semicolon => ";",
            Separator::Tab => "tab",
            Separator::Space => "space",
        };
        let decimal = if self.decimal == Decimal::Comma { "," } else { "." };
        [separator, decimal].map(str::to_owned)
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

/// All records, the header first, with the lines on which they stand; records whose cells are all empty are left out.
fn records(file: &Path, kept: &Kept, separator: Separator) -> Result<Vec<SheetRow>, ExperimentError> {
    let text = kept.text(separator);
    let mut reader = csv::ReaderBuilder::new()
        .flexible(true)
        .has_headers(false)
        .delimiter(separator.byte())
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| ExperimentError::in_file(file, Problem::Unreadable(e.to_string())))?;
        let at = record.position().map_or(0, |position| position.line().saturating_sub(1) as usize);
        let line = kept.lines.get(at).map_or(0, |(line, _)| *line);
        let cells: Vec<Cell> = record.iter().map(|cell| Cell::Text(cell.to_owned())).collect();
        if rows.is_empty() || !cells.iter().all(Cell::is_empty) {
            rows.push(SheetRow { line, cells });
        }
    }
    Ok(rows)
}

fn texts(row: &SheetRow) -> Vec<String> {
    row.cells.iter().map(|cell| cell.text().into_owned()).collect()
}

/// Whether a cell is a number with either decimal mark.
fn number(cell: &str) -> bool {
    cell.replace(',', ".").parse::<f64>().is_ok()
}
