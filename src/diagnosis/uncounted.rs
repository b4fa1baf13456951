//! Rows that no fit counts, and why.

use super::problem::Problem;
use super::unanswered::{UnansweredRows, first_and_last};
use super::windows::cut;
use crate::measurement::Run;
use serde::Serialize;
use std::collections::BTreeSet;
use std::fmt;

/// Why rows do not count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Uncounted {
    /// The start of a run.
    Start,
    /// What follows a gap in the recording.
    Gap,
    /// A stretch that differs from the rest of the drive, which no effect accounts for.
    Odd,
    /// The calibrated model has no answer there.
    NoAnswer,
    /// A window that takes no part in the fits, so that it can judge the final model.
    Spared,
}

impl Uncounted {
    /// One word for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Gap => "after a gap",
            Self::Odd => "odd stretch",
            Self::NoAnswer => "no answer",
            Self::Spared => "spared",
        }
    }
}

/// Neighbouring rows of a run that no fit counts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UncountedRows {
    /// Name of the run.
    pub run: String,
    /// First and last of the rows, counted from 1; `first_row` and `last_row` in JSON.
    #[serde(flatten, serialize_with = "first_and_last")]
    pub rows: (usize, usize),
    /// Times of these rows, s; `None` where rows have no time.
    pub seconds: Option<[f64; 2]>,
    /// Why.
    pub why: Uncounted,
    /// The same in words.
    pub reason: String,
}

impl UncountedRows {
    /// Number of rows.
    #[must_use]
    pub fn count(&self) -> usize {
        self.rows.1 + 1 - self.rows.0
    }
}

impl fmt::Display for UncountedRows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (first, last) = self.rows;
        write!(f, "run {}, ", self.run)?;
        match self.seconds {
            Some([from, to]) => write!(f, "{from:.1} to {to:.1} s")?,
            None if first == last => write!(f, "row {first}")?,
            None => write!(f, "rows {first} to {last}")?,
        }
        write!(f, ": {}", self.reason)
    }
}

/// Stretches of rows that are told as one: starts of runs for the same reason, or a single stretch.
#[derive(Clone, Debug, PartialEq)]
pub struct UncountedGroup<'a> {
    /// The stretches, in the order of the experiment.
    pub stretches: Vec<&'a UncountedRows>,
}

impl<'a> UncountedGroup<'a> {
    /// Of all stretches, in the order in which each reason first occurs.
    #[must_use]
    pub fn of(all: &'a [UncountedRows]) -> Vec<Self> {
        let mut groups: Vec<Self> = Vec::new();
        for rows in all {
            let alike = |group: &&mut Self| {
                matches!(rows.why, Uncounted::Start | Uncounted::Spared)
                    && group.stretches.iter().all(|other| other.reason == rows.reason)
            };
            match groups.iter_mut().find(alike) {
                Some(group) => group.stretches.push(rows),
                None => groups.push(Self { stretches: vec![rows] }),
            }
        }
        groups
    }

    /// Number of rows.
    #[must_use]
    pub fn count(&self) -> usize {
        self.stretches.iter().map(|rows| rows.count()).sum()
    }

    /// Of which runs: the name of one, or how many.
    #[must_use]
    pub fn runs(&self) -> String {
        let runs = self.stretches.iter().map(|rows| &rows.run).collect::<BTreeSet<_>>().len();
        match (self.stretches.as_slice(), runs) {
            ([one], _) => one.run.clone(),
            (several, 1) => format!("{} stretches of run {}", several.len(), several[0].run),
            (several, runs) if several.len() == runs => format!("{runs} runs"),
            (several, runs) => format!("{} stretches of {runs} runs", several.len()),
        }
    }

    /// When, as a reader says it.
    #[must_use]
    pub fn when(&self) -> String {
        let lengths: Vec<f64> = self.stretches.iter().filter_map(|rows| rows.seconds).map(|[a, b]| b - a).collect();
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        match (self.stretches[0].why, self.stretches[0].seconds) {
            (Uncounted::Start, Some(_)) if longest - shortest < 0.05 => format!("the first {longest:.1} s"),
            (Uncounted::Start, Some(_)) => format!("the first {shortest:.1} to {longest:.1} s"),
            (_, Some(_)) if self.stretches.len() > 1 => format!("{:.0} s in all", lengths.iter().sum::<f64>()),
            (_, Some([from, to])) => format!("{from:.1} to {to:.1} s"),
            (_, None) => format!("rows {} to {}", self.stretches[0].rows.0, self.stretches[0].rows.1),
        }
    }

    /// Why.
    #[must_use]
    pub fn reason(&self) -> &str {
        &self.stretches[0].reason
    }
}

impl fmt::Display for UncountedGroup<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let one = self.stretches.len() == 1;
        let run = if one { format!("run {}", self.runs()) } else { self.runs() };
        write!(f, "{run}, {} ({} rows): {}", self.when(), self.count(), self.reason())
    }
}

/// Why a rover's first rows do not count.
const FROM_REST: &str = "start from rest: how the contacts break loose is an assumption of the model";
const UNKNOWN: &str = "taken for a start from rest, since neither position nor velocity was measured: how the contacts break loose is an \
                       assumption of the model";
const IN_MOTION: &str = "start in motion: what came before is not known, and what is quick settles first";

const SPARED: &str = "takes no part in the fits, so that it can judge the final model: the drive is long";

/// All rows that do not count, in the order of the experiment; `odd` (run, row) are odd stretches, `unanswered` the rows in which the
/// calibrated model has no answer.
pub(crate) fn uncounted(
    problem: &Problem,
    odd: &[(usize, usize)],
    unanswered: &[UnansweredRows],
) -> Vec<UncountedRows> {
    let mut all: Vec<UncountedRows> = Vec::new();
    for (number, run) in problem.experiment.runs.iter().enumerate() {
        let time = run.data.column("time");
        let missing: Vec<&UnansweredRows> = unanswered.iter().filter(|rows| rows.run == run.name).collect();
        for row in 0..run.data.rows() {
            let without = missing.iter().find(|rows| (rows.rows.0..=rows.rows.1).contains(&(row + 1)));
            let why = if odd.contains(&(number, row)) {
                Uncounted::Odd
            } else if row < problem.layout.starts[number] {
                Uncounted::Start
            } else if problem.layout.is_unsettled(number, row) {
                Uncounted::Gap
            } else if problem.layout.is_spared(number, row) {
                Uncounted::Spared
            } else if without.is_some() {
                Uncounted::NoAnswer
            } else {
                continue;
            };
            let reason = match (why, without) {
                (Uncounted::Start, _) => start(problem.experiment.recorded_run(number)).to_owned(),
                (Uncounted::Gap, _) => gap(time.unwrap_or_default(), row),
                (Uncounted::Spared, _) => SPARED.to_owned(),
                (Uncounted::NoAnswer, Some(rows)) => format!("the model has no answer: {}", rows.reason),
                _ => "differs from the rest of the drive, and no effect accounts for it".to_owned(),
            };
            let seconds = time.map(|time| [time[row]; 2]);
            match all.last_mut().filter(|last| last.run == run.name && last.rows.1 == row && last.reason == reason) {
                Some(last) => {
                    last.rows.1 = row + 1;
                    last.seconds = last.seconds.zip(seconds).map(|([from, _], [_, to])| [from, to]);
                }
                None => {
                    all.push(UncountedRows { run: run.name.clone(), rows: (row + 1, row + 1), seconds, why, reason })
                }
            }
        }
    }
    all
}

fn start(run: &Run) -> &'static str {
    let moves = |signal: &String| signal == "x" || signal == "velocity";
    match run.measured.iter().any(moves) {
        _ if cut::starts_in_motion(run) => IN_MOTION,
        false => UNKNOWN,
        true => FROM_REST,
    }
}

/// Words on the gap before a row, with the time of its last row before and of the first behind it.
fn gap(time: &[f64], row: usize) -> String {
    let begin = cut::pieces(time).into_iter().map(|piece| piece.start).rfind(|start| (1..=row).contains(start));
    begin.map_or_else(
        || "the motion has not settled yet".to_owned(),
        |begin| {
            format!(
                "no rows from {:.1} to {:.1} s: the simulation begins anew from the measured state behind this gap and has not settled yet",
                time[begin - 1],
                time[begin]
            )
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(run: &str, why: Uncounted, seconds: [f64; 2]) -> UncountedRows {
        UncountedRows { run: run.to_owned(), rows: (1, 10), seconds: Some(seconds), why, reason: "why".to_owned() }
    }

    fn told(all: &[UncountedRows]) -> Vec<String> {
        UncountedGroup::of(all).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn property_stretches_of_one_reason_are_told_as_one() {
        let spared = |run, from| rows(run, Uncounted::Spared, [from, from + 6.0]);
        assert_eq!(told(&[spared("a", 6.0), spared("a", 18.0)]), ["2 stretches of run a, 12 s in all (20 rows): why"]);
        let several = [spared("a", 6.0), spared("a", 18.0), spared("b", 6.0)];
        assert_eq!(told(&several), ["3 stretches of 2 runs, 18 s in all (30 rows): why"]);
        let starts = [rows("a", Uncounted::Start, [0.0, 0.5]), rows("b", Uncounted::Start, [0.0, 0.9])];
        assert_eq!(told(&starts), ["2 runs, the first 0.5 to 0.9 s (20 rows): why"]);
        assert_eq!(told(&[rows("a", Uncounted::Odd, [3.0, 6.0])]), ["run a, 3.0 to 6.0 s (10 rows): why"]);
    }
}
