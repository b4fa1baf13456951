//! What was expected against what came.

use super::SAME_TIME;
use super::door::Recording;
use super::expect::{Expectation, Tolerance};
use super::read::Script;
use std::fmt;

/// One value that is not as expected, or the one that is furthest from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Time, s.
    pub time: f64,
    /// The value that came.
    pub value: f64,
    /// The expected one; the bound that was passed where there is a range.
    pub expected: f64,
    /// How far apart they are, in the signal's unit.
    pub size: f64,
    /// How far apart they may be.
    pub allowed: f64,
}

impl Deviation {
    /// Whether it is more than allowed; NaN is.
    #[must_use]
    pub fn fails(&self) -> bool {
        let holds = self.size <= self.allowed;
        !holds
    }

    /// Larger for what is further out; NaN is furthest.
    fn rank(&self) -> f64 {
        if self.size.is_nan() { f64::INFINITY } else { self.size }
    }
}

/// How one signal compares.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalReport {
    /// Name, with `in range` behind it where a range was asked for.
    pub name: String,
    /// Values compared.
    pub compared: usize,
    /// Values that are not as expected.
    pub failed: usize,
    /// The first of these.
    pub first: Option<Deviation>,
    /// The largest deviation, allowed or not; none where nothing could be compared.
    pub largest: Option<Deviation>,
}

impl SignalReport {
    fn of(name: String, deviations: impl Iterator<Item = Deviation>) -> Self {
        let mut report = Self { name, compared: 0, failed: 0, first: None, largest: None };
        for deviation in deviations {
            report.compared += 1;
            if deviation.fails() {
                report.failed += 1;
                report.first = report.first.or(Some(deviation));
            }
            if report.largest.is_none_or(|largest| deviation.rank() > largest.rank()) {
                report.largest = Some(deviation);
            }
        }
        report
    }
}

/// How a drive compares with its script.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The script's name.
    pub script: String,
    /// What was driven.
    pub door: String,
    /// Samples taken.
    pub samples: usize,
    /// How the run stood at the end, and when, s.
    pub status: (String, f64),
    /// Signals with expected values or ranges.
    pub signals: Vec<SignalReport>,
    /// What else is not as expected: the status, the time of an event, samples that never came.
    pub remarks: Vec<String>,
}

impl Report {
    /// Whether all is as expected.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.remarks.is_empty() && self.signals.iter().all(|signal| signal.failed == 0)
    }
}

impl Expectation {
    /// Compares what a door gave.
    pub(super) fn compare(&self, script: &Script, recording: &Recording) -> Report {
        let end = recording.times.last().copied().unwrap_or(0.0);
        let mut remarks = Vec::new();
        if recording.status != self.status {
            remarks.push(format!("status at {end} s: {}, expected {}", recording.status, self.status));
        } else if let Some([low, high]) = self.ends_within.filter(|[low, high]| end < *low || end > *high) {
            remarks.push(format!("{} at {end} s, expected within {low} .. {high} s", recording.status));
        }
        let rounding = SAME_TIME * script.interval;
        let sample = |time: f64| recording.times.iter().position(|own| (own - time).abs() <= rounding);
        let places: Vec<Option<usize>> = self.times.iter().map(|time| sample(*time)).collect();
        let missing: Vec<f64> =
            self.times.iter().zip(&places).filter(|(_, place)| place.is_none()).map(|(time, _)| *time).collect();
        if let [first, ..] = missing[..] {
            let count = missing.len();
            remarks.push(format!(
                "no sample at {first} s ({count} of {} missing), the drive ended at {end} s",
                self.times.len()
            ));
        }
        let mut signals: Vec<SignalReport> = Vec::new();
        for (column, (name, tolerance)) in self.columns.iter().enumerate() {
            let Some(signal) = recording.names.iter().position(|own| own == name) else { continue };
            let deviations = self.rows.iter().zip(&places).filter_map(|(row, place)| {
                let (expected, place) = (row[column], (*place)?);
                (!expected.is_nan())
                    .then(|| deviation(recording.times[place], recording.rows[place][signal], expected, *tolerance))
            });
            signals.push(SignalReport::of(name.clone(), deviations));
        }
        for (name, range) in &self.ranges {
            let Some(signal) = recording.names.iter().position(|own| own == name) else { continue };
            let outside =
                recording.times.iter().zip(&recording.rows).map(|(time, row)| beyond(*time, row[signal], *range));
            signals.push(SignalReport::of(format!("{name} in range"), outside));
        }
        Report {
            script: script.name.clone(),
            door: recording.door.clone(),
            samples: recording.times.len(),
            status: (recording.status.clone(), end),
            signals,
            remarks,
        }
    }
}

fn deviation(time: f64, value: f64, expected: f64, tolerance: Tolerance) -> Deviation {
    Deviation { time, value, expected, size: (value - expected).abs(), allowed: tolerance.allows(expected) }
}

/// How far a value is outside of a range.
fn beyond(time: f64, value: f64, [low, high]: [f64; 2]) -> Deviation {
    let expected = if value > high { high } else { low };
    let size = if value >= low && value <= high { 0.0 } else { (value - expected).abs() };
    Deviation { time, value, expected, size, allowed: 0.0 }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.passed() { "ok  " } else { "FAIL" };
        let (status, end) = &self.status;
        write!(f, "{verdict} {} on {}: {} samples, {status} at {end} s", self.script, self.door, self.samples)?;
        let closest = |signal: &&SignalReport| signal.largest.map_or(0.0, |largest| largest.size / largest.allowed);
        if let Some(signal) =
            self.signals.iter().filter(|s| s.failed == 0).max_by(|a, b| closest(a).total_cmp(&closest(b)))
            && let Some(largest) = signal.largest.filter(|largest| largest.allowed > 0.0)
        {
            write!(f, ", nearest to its tolerance {}: {:.1e} of {:.1e}", signal.name, largest.size, largest.allowed)?;
        }
        for remark in &self.remarks {
            write!(f, "\n  {remark}")?;
        }
        for signal in self.signals.iter().filter(|signal| signal.failed > 0) {
            write!(f, "\n  {}: {} of {} values off", signal.name, signal.failed, signal.compared)?;
            for (word, found) in [("first", signal.first), ("largest", signal.largest)] {
                if let Some(Deviation { time, value, expected, size, allowed }) = found {
                    write!(
                        f,
                        "\n    {word} at {time} s: {value}, expected {expected}, off by {size:.3e}, allowed {allowed:.3e}"
                    )?;
                }
            }
        }
        Ok(())
    }
}
