//! Writing what a drive gave as what is expected from now on.

use super::door::Recording;
use super::error::{Problem, ScriptError};
use super::read::Script;
use bekker::measurement::{Table, TableError};
use std::path::PathBuf;

impl Script {
    /// Writes the signals of a drive into the file that the key `expect.signals` names, and returns its path. The rest of
    /// the script is the user's to write.
    ///
    /// # Errors
    /// [`ScriptError`] where the script names no file, the run did not end as the script says, or the file cannot be
    /// written.
    pub fn write_expected(&self, recording: &Recording) -> Result<PathBuf, ScriptError> {
        self.save(recording).map_err(|problem| problem.in_file(&self.file))
    }

    fn save(&self, recording: &Recording) -> Result<PathBuf, Problem> {
        let key = "expect.signals";
        let Some(file) = &self.expect.file else {
            return Err(Problem::content(key, "expected the name of a CSV file to record into"));
        };
        if recording.status != self.expect.status {
            let found = format!("\"{}\"", self.expect.status);
            let end = recording.times.last().copied().unwrap_or(0.0);
            let expected = format!("\"{}\", as which the recorded run ended at {end} s", recording.status);
            return Err(Problem::value("expect.status", found, expected));
        }
        let refused = |error: TableError| Problem::content(key, error.to_string());
        let mut table =
            Table::new(std::iter::once("time").chain(recording.names.iter().map(String::as_str))).map_err(refused)?;
        let last = recording.times.len().saturating_sub(1);
        for (k, (time, row)) in recording.times.iter().zip(&recording.rows).enumerate() {
            if k.is_multiple_of(self.expect.every) || k == last {
                let row: Vec<f64> = std::iter::once(*time).chain(row.iter().copied()).collect();
                table.push(&row).map_err(refused)?;
            }
        }
        table.save(file).map_err(|error| Problem::Unwritable { file: file.clone(), error })?;
        Ok(file.clone())
    }
}
