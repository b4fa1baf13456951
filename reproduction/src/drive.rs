//! One drive over a course, as every study of chapter 4 makes it.

use super::{ReproductionError, Series};
use bekker::measurement::{Record, Table};
use bekker::model::{Model, Summary, SummaryBuilder};
use bekker::modeldescription::Lookup;
use bekker::simulation::{Event, Status};

/// Two speeds closer than this share count as equal.
const EQUAL_SPEED: f64 = 0.01;
/// Bisections after which the nearest speed found stands.
const BISECTIONS: usize = 30;

/// How far, how long and how finely sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    /// Way of the chassis reference point that completes it, m.
    pub length: f64,
    /// A rover that has not arrived by then has not completed it, s.
    pub time_limit: f64,
    /// Time between two samples, s.
    pub sample: f64,
}

/// What a drive gave.
#[derive(Clone, Debug)]
pub struct Drive {
    /// All signals over time.
    pub table: Table,
    /// Averages over the time driven.
    pub summary: Summary,
    /// Whether it arrived.
    pub completed: bool,
    /// What ended it before, if anything but the time limit.
    pub event: Option<Event>,
}

/// Drives `model` at the commanded speed (m/s).
///
/// # Errors
/// Whatever the run says; an event of the simulation is a result, not an error.
pub fn drive(model: &Model, speed: f64, course: &Course) -> Result<Drive, ReproductionError> {
    let mut run = model.start()?;
    run.inputs_mut().set("velocity_command", speed)?;
    let stride = (course.sample / run.step_size()).round().max(1.0) as u64;
    let mut record = Record::new(&mut run.signals().clone(), None)?;
    let mut summary = SummaryBuilder::default();
    summary.push(&run);
    record.push(run.time(), run.signals())?;
    let start = run.signals().body.x;
    let arrived = |x: f64| x - start >= course.length;
    while !arrived(run.signals().body.x) && run.time() < course.time_limit && run.status() == Status::Running {
        run.advance(stride)?;
        summary.push(&run);
        record.push(run.time(), run.signals())?;
    }
    let event = match run.status() {
        Status::Running => None,
        Status::Ended(event) => Some(event),
    };
    let completed = arrived(run.signals().body.x);
    Ok(Drive { table: record.into_table(), summary: summary.summary(&run), completed, event })
}

/// The drive whose mean speed is `speed` (m/s), by bisection on the commanded one; the nearest found where none is.
///
/// # Errors
/// As [`drive`].
pub fn drive_at(model: &Model, speed: f64, course: &Course) -> Result<Drive, ReproductionError> {
    let (mut low, mut high, mut commanded) = (0.0, 8.0 * speed, speed);
    let off = |drive: &Drive| (drive.summary.speed / speed - 1.0).abs();
    let mut best = drive(model, commanded, course)?;
    let mut slow = best.summary.speed < speed;
    for _ in 0..BISECTIONS {
        if off(&best) < EQUAL_SPEED {
            break;
        }
        if slow {
            low = commanded
        } else {
            high = commanded
        }
        commanded = 0.5 * (low + high);
        let found = drive(model, commanded, course)?;
        slow = found.summary.speed < speed;
        if off(&found) < off(&best) {
            best = found;
        }
    }
    Ok(best)
}

impl Drive {
    /// A column of the table over another; empty where there is none of that name.
    #[must_use]
    pub fn column(&self, name: &str) -> &[f64] {
        self.table.column(name).unwrap_or_default()
    }

    /// Mean speed along x over the last `duration` s, or the whole drive where that is shorter, m/s; 0 where it ends at once. The
    /// signal `velocity`, the speed along the path, also counts hops.
    #[must_use]
    pub fn final_speed(&self, duration: f64) -> f64 {
        let (time, x) = (self.column("time"), self.column("x"));
        let (Some(end), Some(there)) = (time.last(), x.last()) else { return 0.0 };
        let first = time.partition_point(|t| *t < end - duration);
        let elapsed = end - time[first];
        if elapsed > 0.0 { (there - x[first]) / elapsed } else { 0.0 }
    }

    /// Sum over the wheels of a wheel's signal, row by row.
    #[must_use]
    pub fn total(&self, signal: &str) -> Vec<f64> {
        let mut sum = vec![0.0; self.table.rows()];
        for k in 1.. {
            let Some(column) = self.table.column(&format!("wheel[{k}].{signal}")) else { break };
            sum.iter_mut().zip(column).for_each(|(sum, value)| *sum += value);
        }
        sum
    }

    /// Mean over the wheels of a wheel's signal, row by row.
    #[must_use]
    pub fn mean(&self, signal: &str) -> Vec<f64> {
        let wheels = (1..).take_while(|k| self.table.column(&format!("wheel[{k}].{signal}")).is_some()).count();
        self.total(signal).into_iter().map(|sum| sum / wheels.max(1) as f64).collect()
    }

    /// `y` over the column `x` as a line of a plot.
    #[must_use]
    pub fn series(&self, name: &str, x: &str, y: Vec<f64>) -> Series {
        Series { name: name.to_owned(), x: self.column(x).to_vec(), y }
    }
}
