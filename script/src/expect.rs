//! What a script expects of a drive.

use super::SAME_TIME;
use super::error::Problem;
use super::file::{Allowed, Expect, Parts};
use super::read::whole;
use super::rows::Rows;
use bekker::measurement::Table;
use bekker::simulation::Status;
use std::path::{Path, PathBuf};

/// How far a value may be from the expected one: |value - expected| <= absolute + relative |expected|.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// In the signal's unit.
    pub absolute: f64,
    /// Share of the expected value.
    pub relative: f64,
}

impl Tolerance {
    /// Without a word in the script: far above what libraries of mathematics differ by from one system to another, far
    /// below what an instrument would notice.
    pub const USUAL: Self = Self { absolute: 1e-9, relative: 1e-6 };

    /// The largest deviation from `expected` that is allowed.
    #[must_use]
    pub fn allows(&self, expected: f64) -> f64 {
        self.absolute + self.relative * expected.abs()
    }
}

/// What a script expects, by name and time.
#[derive(Clone, Debug)]
pub struct Expectation {
    /// How the run stands at the end of the script.
    pub status: String,
    /// Where an event ends it, s.
    pub ends_within: Option<[f64; 2]>,
    /// Signals that have expected values, and their tolerances.
    pub columns: Vec<(String, Tolerance)>,
    /// Times of the expected values, s.
    pub times: Vec<f64>,
    /// One row a time, one value a column; NaN where none is expected.
    pub rows: Vec<Vec<f64>>,
    /// Signals and the least and largest value that they may have.
    pub ranges: Vec<(String, [f64; 2])>,
    /// The file that recording writes.
    pub(super) file: Option<PathBuf>,
    /// What recording writes: signals (all where missing), and every how many intervals.
    pub(super) record: Option<Vec<String>>,
    pub(super) every: usize,
}

impl Expectation {
    /// Reads it; `clock` is the interval and the duration, s, `known` all signals of the rover.
    pub(super) fn read(
        read: &Expect,
        folder: &Path,
        known: &[String],
        (interval, duration): (f64, f64),
        recording: bool,
    ) -> Result<Self, Problem> {
        let status = read.status.clone().unwrap_or_else(|| "running".to_owned());
        if !Status::WORDS.contains(&status.as_str()) {
            return Err(Problem::value("expect.status", format!("\"{status}\""), Status::WORDS.join(", ")));
        }
        let file = read.signals.as_ref().and_then(toml::Value::as_str).map(|name| folder.join(name));
        let rows = match (&read.signals, recording) {
            (Some(value), false) => Rows::read("expect.signals", value, folder)?,
            _ => Rows::default(),
        };
        check_names("expect.signals", &rows.names, known)?;
        check_times(&rows.times, interval, duration, &status)?;
        let ends_within = read.ends_within.map(|ends| ordered("expect.ends_within", ends)).transpose()?;
        if ends_within.is_some() && status == "running" {
            return Err(Problem::content("expect.ends_within", "expected a `status` other than \"running\" beside it"));
        }
        let every = read.record_every.map(|time| whole("expect.record_every", time, "intervals", interval, 1e6));
        let record = read.record.as_ref().map(|names| spread("expect.record", names, known)).transpose()?;
        let all = Self {
            columns: tolerances(read, &rows.names, known)?,
            ranges: ranges(read, known)?,
            record: record.or_else(|| file.as_deref().filter(|_| recording).and_then(|file| columns(file, known))),
            every: every.transpose()?.map_or(1, |every| every as usize),
            times: rows.times,
            rows: rows.values,
            status,
            ends_within,
            file,
        };
        // A script that states nothing but the status it has without a word could not fail.
        let nothing = read.status.is_none() && all.columns.is_empty() && all.ranges.is_empty();
        if nothing && !recording {
            return Err(Problem::content("expect", "expected at least one of `status`, `signals`, `range`"));
        }
        Ok(all)
    }

    /// The signals to be looked at.
    pub(super) fn names(&self, known: &[String], recording: bool) -> Vec<String> {
        if recording {
            return self.record.clone().unwrap_or_else(|| known.to_vec());
        }
        let wanted = |name: &&String| {
            self.columns.iter().any(|(column, _)| column == *name) || self.ranges.iter().any(|(own, _)| own == *name)
        };
        known.iter().filter(wanted).cloned().collect()
    }
}

/// Signals that `name` stands for: itself, or with `wheel.` or `link.` that of every wheel or link.
fn family<'a>(name: &'a str, known: &'a [String]) -> impl Iterator<Item = &'a String> {
    let parts = ["wheel", "link"].iter().find_map(|group| Some((*group, name.strip_prefix(group)?.strip_prefix('.')?)));
    known.iter().filter(move |own| match parts {
        None => *own == name,
        Some((group, signal)) => {
            own.strip_prefix(group).is_some_and(|rest| rest.starts_with('[') && rest.ends_with(&format!("].{signal}")))
        }
    })
}

/// All signals that `names` stand for.
fn spread(key: &str, names: &[String], known: &[String]) -> Result<Vec<String>, Problem> {
    let mut all = Vec::new();
    for name in names {
        let before = all.len();
        all.extend(family(name, known).cloned());
        if all.len() == before {
            return Err(unknown(key, name, known));
        }
    }
    Ok(all)
}

fn unknown(key: &str, name: &str, known: &[String]) -> Problem {
    Problem::content(key, format!("`{name}` is no signal of this rover: expected some of {}", known.join(", ")))
}

fn check_names(key: &str, names: &[String], known: &[String]) -> Result<(), Problem> {
    names.iter().find(|name| !known.contains(name)).map_or(Ok(()), |name| Err(unknown(key, name, known)))
}

/// Times at which there will be samples. Where an event ends the run, the last may be the event's.
fn check_times(times: &[f64], interval: f64, duration: f64, status: &str) -> Result<(), Problem> {
    let off = |time: f64| (time / interval - (time / interval).round()).abs() > SAME_TIME;
    for (k, &time) in times.iter().enumerate() {
        let event = status != "running" && k + 1 == times.len();
        if !(0.0..=duration + SAME_TIME * interval).contains(&time) || (off(time) && !event) {
            let expected = format!("a whole number of intervals of {interval} s, 0 to {duration} s");
            return Err(Problem::value("expect.signals, time", time, expected));
        }
    }
    Ok(())
}

/// The tolerance of every column: its own, its family's, the script's, the usual one.
fn tolerances(read: &Expect, names: &[String], known: &[String]) -> Result<Vec<(String, Tolerance)>, Problem> {
    const DEFAULT: &str = "default";
    for (name, allowed) in &read.tolerance {
        let key = format!("expect.tolerance.{name}");
        if name != DEFAULT && family(name, known).next().is_none() {
            return Err(unknown(&key, name, known));
        }
        let Tolerance { absolute, relative } = tolerance(*allowed);
        for part in [absolute, relative] {
            if !(part.is_finite() && part >= 0.0) {
                return Err(Problem::value(key, part, "a finite number from 0"));
            }
        }
    }
    let of = |name: &String| {
        let group = read.tolerance.iter().find(|(key, _)| family(key, known).any(|own| own == name));
        let stated = read.tolerance.get(name).or(group.map(|(_, allowed)| allowed)).or(read.tolerance.get(DEFAULT));
        stated.copied().map_or(Tolerance::USUAL, tolerance)
    };
    Ok(names.iter().map(|name| (name.clone(), of(name))).collect())
}

fn tolerance(allowed: Allowed) -> Tolerance {
    match allowed {
        Allowed::Absolute(absolute) => Tolerance { absolute, relative: 0.0 },
        Allowed::Parts(Parts { absolute, relative }) => Tolerance { absolute, relative },
    }
}

fn ranges(read: &Expect, known: &[String]) -> Result<Vec<(String, [f64; 2])>, Problem> {
    let mut all = Vec::new();
    for (name, range) in &read.range {
        let key = format!("expect.range.{name}");
        let range = ordered(&key, *range)?;
        all.extend(spread(&key, std::slice::from_ref(name), known)?.into_iter().map(|name| (name, range)));
    }
    Ok(all)
}

fn ordered(key: &str, [low, high]: [f64; 2]) -> Result<[f64; 2], Problem> {
    if low <= high { Ok([low, high]) } else { Err(Problem::value(key, format!("[{low}, {high}]"), "[low, high]")) }
}

/// The signals in an older recording, so that the next has the same.
fn columns(file: &Path, known: &[String]) -> Option<Vec<String>> {
    let table = Table::read(file).ok()?;
    let names: Vec<String> = table.names().iter().filter(|name| known.contains(name)).cloned().collect();
    (!names.is_empty()).then_some(names)
}
