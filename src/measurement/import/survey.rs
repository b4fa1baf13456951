//! What is in the files: columns by name, their texts and numbers.

use super::super::dialect::Dialect;
use super::super::experiment::Kind;
use super::super::sheet::Sheet;
use super::super::stamps::Stamp;
use super::super::suggestion::{self, Suggested};
use super::ImportError;
use std::path::PathBuf;

/// All files.
#[derive(Clone, Debug)]
pub(in crate::measurement) struct Survey {
    pub sheets: Vec<Sheet>,
    /// Each name once, in the order of its first appearance.
    pub columns: Vec<FoundColumn>,
}

/// A column of one name in all files that have it.
#[derive(Clone, Debug)]
pub(in crate::measurement) struct FoundColumn {
    pub name: String,
    /// Cells that hold something.
    pub texts: Vec<String>,
    /// Cells that are numbers.
    pub numbers: Vec<f64>,
    /// Unit in a row under the header.
    pub unit: Option<String>,
}

impl FoundColumn {
    /// Whether all that is there is a number.
    pub fn is_numeric(&self) -> bool {
        !self.texts.is_empty() && self.texts.len() == self.numbers.len()
    }

    /// Whether all that is there is a time stamp.
    pub fn is_stamp(&self) -> bool {
        !self.texts.is_empty() && self.texts.iter().all(|text| Stamp::parse(text).is_some())
    }

    /// Different texts, no more than `most`; `None` where there are more.
    pub fn distinct(&self, most: usize) -> Option<Vec<&str>> {
        let mut found: Vec<&str> = Vec::new();
        for text in &self.texts {
            if !found.contains(&text.as_str()) {
                found.push(text);
            }
            if found.len() > most {
                return None;
            }
        }
        Some(found)
    }
}

impl Survey {
    pub fn of(files: &[(PathBuf, String)]) -> Result<Self, ImportError> {
        if files.is_empty() {
            return Err(ImportError::NoFiles);
        }
        let mut survey = Self { sheets: Vec::new(), columns: Vec::new() };
        for (file, text) in files {
            let sheet = Sheet::parse(file, text, &Dialect::default())?;
            sheet.need_rows(1)?;
            survey.take(&sheet);
            survey.sheets.push(sheet);
        }
        Ok(survey)
    }

    fn take(&mut self, sheet: &Sheet) {
        for (k, name) in sheet.header.iter().enumerate() {
            let at = self.columns.iter().position(|column| column.name == *name).unwrap_or_else(|| {
                let unit = sheet.units.get(k).cloned().filter(|unit| !unit.is_empty());
                self.columns.push(FoundColumn { name: name.clone(), texts: Vec::new(), numbers: Vec::new(), unit });
                self.columns.len() - 1
            });
            let column = &mut self.columns[at];
            for row in &sheet.rows {
                let cell = &row.cells[k];
                if !cell.is_empty() {
                    column.texts.push(cell.text().into_owned());
                    column.numbers.extend(sheet.value(cell));
                }
            }
        }
    }

    pub fn names(&self) -> String {
        self.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>().join(", ")
    }

    /// The kind of experiment that the columns tell.
    pub fn kind(&self) -> Option<Kind> {
        Kind::told_by(|kind, wanted| {
            self.columns.iter().any(|column| {
                suggestion::of(kind, &column.name).is_some_and(
                    |found| matches!(&found.target, Suggested::Signal(signal) if wanted.contains(&signal.as_str())),
                )
            })
        })
    }

    /// Names of the copies: those of the files, numbered where two are equal.
    pub fn copies(&self) -> Vec<String> {
        let mut copies: Vec<String> = Vec::new();
        for sheet in &self.sheets {
            let part = |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
            let (stem, ending) = (part(sheet.file.file_stem()), part(sheet.file.extension()));
            let name = |number: usize| {
                let number = if number == 1 { String::new() } else { format!("_{number}") };
                if ending.is_empty() { format!("{stem}{number}") } else { format!("{stem}{number}.{ending}") }
            };
            let free = (1..).map(name).find(|name| !copies.contains(name));
            copies.extend(free);
        }
        copies
    }
}
