//! Rows of an experiment that the model cannot answer: a load that the soil does not carry, a rover that got stuck before
//! the measurements ended. One such row is one bad row; it does not end a comparison. The rules:
//!
//! - **Given parameters**: rows without an answer are left out of the errors and listed. It is an error only where no
//!   measured value has an answer.
//! - **A search** for parameters counts such a row against them. On a carriage each of its measured values counts as missed
//!   by [`MISSED_BY`](super::thresholds::MISSED_BY) times the scatter of its signal over the experiment, and by up to twice
//!   as much, in proportion to the share of the load that the soil does not carry. That is finite, so that a single bad row cannot force the fit, and
//!   worse than predicting the signal's mean everywhere, so that giving up a row does not pay. On a traverse the rover
//!   stays as it was at the last row that it reached, while the measured one drives on. Predictions of what was left out
//!   of a fit count alike.
//! - **Rows without an answer at the best fit** of the baseline are left out, and the fit is repeated without them, until
//!   every row that counts has an answer. They are left out of all that follows (noise, errors, effects), are listed, and
//!   are a caution. From then on a fit that does not answer all rows that count is no fit.
//!   In windows a row has no answer either where its value depends on the last digits of the parameters
//!   ([`undetermined`](super::undetermined)); such rows are looked for after the first fits only.
//! - **Too few are left**, and it is an error, where less than [`LEAST_ANSWERED`](super::thresholds::LEAST_ANSWERED) of the
//!   measured rows have an answer, or no more measured values than there are free parameters.

use super::layout::Layout;
use super::prediction::PredictionError;
use serde::{Serialize, Serializer};
use std::fmt;
use std::ops::Range;

/// Neighbouring rows of a run that the model cannot answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct UnansweredRows {
    /// Name of the run.
    pub run: String,
    /// First and last of the rows, counted from 1; `first_row` and `last_row` in JSON.
    #[serde(flatten, serialize_with = "first_and_last")]
    pub rows: (usize, usize),
    /// Why there is no answer.
    pub reason: String,
}

/// The keys of a range of rows.
pub(super) fn first_and_last<S: Serializer>((first_row, last_row): &(usize, usize), to: S) -> Result<S::Ok, S::Error> {
    to.collect_map([("first_row", first_row), ("last_row", last_row)])
}

impl UnansweredRows {
    /// Number of rows.
    #[must_use]
    pub fn count(&self) -> usize {
        self.rows.1 + 1 - self.rows.0
    }
}

impl fmt::Display for UnansweredRows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (first, last) = self.rows;
        if first == last {
            write!(f, "run {}, row {first}: {}", self.run, self.reason)
        } else {
            write!(f, "run {}, rows {first} to {last}: {}", self.run, self.reason)
        }
    }
}

/// The same with the index of the run, rows counted from 0.
#[derive(Clone, Debug)]
pub(crate) struct Unanswered {
    pub run: usize,
    pub rows: Range<usize>,
    pub error: PredictionError,
}

/// What the model says row by row.
#[derive(Clone, Debug)]
pub(crate) struct Answers {
    /// Values in the layout's order; NaN in rows without an answer.
    pub values: Vec<f64>,
    /// The rows without an answer, by run and row.
    pub unanswered: Vec<Unanswered>,
}

impl Answers {
    /// The values, where every row that counts has an answer.
    ///
    /// # Errors
    /// [`PredictionError`] of the first row that counts and has none.
    pub fn complete(self, layout: &Layout) -> Result<Vec<f64>, PredictionError> {
        all_answered(&self.unanswered, layout)?;
        Ok(self.values)
    }

    /// Rows that count and have no answer, and why.
    pub fn missing(&self, layout: &Layout) -> Vec<Unanswered> {
        let mut missing = Vec::new();
        for Unanswered { run, rows, error } in &self.unanswered {
            let counting = rows.clone().filter(|row| layout.counts(*run, *row));
            missing.extend(counting.map(|row| Unanswered { run: *run, rows: row..row + 1, error: error.clone() }));
        }
        missing
    }

    /// Whether some measured value that counts has an answer.
    pub fn any(&self, layout: &Layout) -> bool {
        self.values.iter().zip(&layout.measured).any(|(modelled, measured)| !modelled.is_nan() && !measured.is_nan())
    }
}

/// Fails with the first row that counts and has no answer.
pub(crate) fn all_answered(unanswered: &[Unanswered], layout: &Layout) -> Result<(), PredictionError> {
    let counts = |rows: &&Unanswered| rows.rows.clone().any(|row| layout.counts(rows.run, row));
    unanswered.iter().find(counts).map_or(Ok(()), |rows| Err(rows.error.clone()))
}

/// Rows for a reader, in the order of the experiment; neighbours that lack an answer for the same reason stand together.
pub(crate) fn listed(mut unanswered: Vec<Unanswered>) -> Vec<UnansweredRows> {
    unanswered.sort_by_key(|rows| (rows.run, rows.rows.start));
    let mut all: Vec<UnansweredRows> = Vec::new();
    for Unanswered { rows, error, .. } in unanswered {
        let (run, reason) = (error.run().to_owned(), error.reason());
        match all.last_mut().filter(|last| last.run == run && last.reason == reason && last.rows.1 == rows.start) {
            Some(last) => last.rows.1 = rows.end,
            None => all.push(UnansweredRows { run, rows: (rows.start + 1, rows.end), reason }),
        }
    }
    all
}
