//! A script, read and checked.

use super::SAME_TIME;
use super::door::{Door, DoorError, drive};
use super::error::{Problem, ScriptError};
use super::expect::Expectation;
use super::file::File;
use super::report::Report;
use super::rows::{Rows, flat};
use bekker::model::{Model, PRESETS};
use bekker::modeldescription::Lookup;
use bekker::signals::Signals;
use std::path::{Path, PathBuf};

/// Longest drive, in intervals: beyond it a slip of the pen is likelier than a test.
const MOST_INTERVALS: f64 = 1e6;

/// A scripted test, see [the module](super).
#[derive(Clone, Debug)]
pub struct Script {
    /// Name for people: the file's own, or that of the file.
    pub name: String,
    /// The file from which it came.
    pub file: PathBuf,
    /// The model to be driven, its seed included.
    pub model: Model,
    /// Parameters that the script itself sets in its model, by name, SI units.
    pub parameters: Vec<(String, f64)>,
    /// Time between two samples, s.
    pub interval: f64,
    /// Inner steps an interval.
    pub steps: u64,
    /// Names of the inputs, in the vocabulary's order.
    pub input_names: Vec<String>,
    /// Values of the inputs, one row an interval.
    pub inputs: Vec<Vec<f64>>,
    /// Intervals to be driven before the reset with which the test begins.
    pub warm_up: usize,
    /// Signals that are looked at.
    pub signals: Vec<String>,
    /// What is expected.
    pub expect: Expectation,
}

impl Script {
    /// Reads a script.
    ///
    /// # Errors
    /// [`ScriptError`] naming file and key, and what was expected.
    pub fn read(file: &Path) -> Result<Self, ScriptError> {
        Self::load(file, false).map_err(|problem| problem.in_file(file))
    }

    /// Reads a script whose expected signals are about to be recorded: their file may be missing, and what it holds is
    /// not looked at, but for the names of its columns where the script does not say what to record.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_to_record(file: &Path) -> Result<Self, ScriptError> {
        Self::load(file, true).map_err(|problem| problem.in_file(file))
    }

    fn load(file: &Path, recording: bool) -> Result<Self, Problem> {
        let text = std::fs::read_to_string(file).map_err(Problem::Unreadable)?;
        let read: File = toml::from_str(&text).map_err(|error| Problem::Syntax(Box::new(error)))?;
        let folder = file.parent().unwrap_or(Path::new("."));
        let mut model = model(&read.model, folder)?;
        model.stepping.seed = read.seed.unwrap_or(model.stepping.seed);
        let (steps, intervals) = clock(&read, model.stepping.step_size)?;
        let warm_up = if read.reset_after == 0.0 {
            0
        } else {
            whole("reset_after", read.reset_after, "intervals", read.interval, intervals as f64)? as usize
        };
        let (input_names, inputs) = inputs(&read, &model, folder, intervals)?;
        let (wheels, links) = (model.rover.wheels.len(), model.rover.links.len());
        let known: Vec<String> = Signals::of(wheels, links).list().into_iter().map(|(v, _)| v.name).collect();
        let duration = intervals as f64 * read.interval;
        let expect = Expectation::read(&read.expect, folder, &known, (read.interval, duration), recording)?;
        let parameters = match read.model.get("parameters").and_then(toml::Value::as_table) {
            Some(table) => flat("model.parameters", "", table)?,
            None => Vec::new(),
        };
        let stem = file.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Ok(Self {
            name: read.name.unwrap_or(stem),
            file: file.to_owned(),
            model,
            parameters,
            interval: read.interval,
            steps,
            input_names,
            inputs,
            warm_up,
            signals: expect.names(&known, recording),
            expect,
        })
    }

    /// Drives `door` and compares what it gives with what is expected.
    ///
    /// # Errors
    /// [`DoorError`] where the door does not start or cannot go on.
    pub fn check(&self, door: &mut dyn Door) -> Result<Report, DoorError> {
        Ok(self.expect.compare(self, &drive(self, door)?))
    }
}

/// The model under the key `model`.
fn model(value: &toml::Value, folder: &Path) -> Result<Model, Problem> {
    let refused = |error| Problem::Model(Box::new(error));
    match value {
        toml::Value::String(name) if PRESETS.iter().any(|(preset, _)| preset == name) => {
            Model::preset(name).map_err(refused)
        }
        toml::Value::String(name) if name.ends_with(".toml") => Model::read(&folder.join(name)).map_err(refused),
        toml::Value::String(name) => Err(refused(bekker::model::ModelError::UnknownPreset { name: name.clone() })),
        toml::Value::Table(table) => {
            let text = toml::to_string(table).map_err(|error| refused(error.into()))?;
            Model::from_toml(&text, Some(folder)).map_err(refused)
        }
        other => Err(Problem::value("model", other, "a built-in model, a model file (.toml), or a table")),
    }
}

/// Inner steps an interval, and intervals.
fn clock(read: &File, step_size: f64) -> Result<(u64, usize), Problem> {
    let steps = whole("interval", read.interval, "inner steps", step_size, MOST_INTERVALS)?;
    let intervals = whole("duration", read.duration, "intervals", read.interval, MOST_INTERVALS)?;
    Ok((steps, intervals as usize))
}

/// How many `unit` make `seconds`.
pub(super) fn whole(key: &str, seconds: f64, what: &str, unit: f64, most: f64) -> Result<u64, Problem> {
    let ratio = seconds / unit;
    let near = (ratio - ratio.round()).abs() <= SAME_TIME;
    if ratio.is_finite() && near && ratio.round() >= 1.0 && ratio.round() <= most {
        Ok(ratio.round() as u64)
    } else {
        Err(Problem::value(key, seconds, format!("a whole number of {what} of {unit} s, 1 to {most}")))
    }
}

/// Names of the inputs, and their values in each interval.
fn inputs(
    read: &File,
    model: &Model,
    folder: &Path,
    intervals: usize,
) -> Result<(Vec<String>, Vec<Vec<f64>>), Problem> {
    let mut held = model.inputs();
    let (names, start): (Vec<String>, Vec<f64>) = held.list().into_iter().map(|(v, value)| (v.name, value)).unzip();
    let actions = |k: usize| format!("action[{}]", k + 1);
    let (key, rows, scale) = match (&read.inputs, &read.actions, read.action_scale) {
        (Some(_), Some(_), _) => {
            return Err(Problem::content("actions", "there are `inputs` too; expected one of them"));
        }
        (_, None, Some(scale)) => return Err(Problem::value("action_scale", scale, "`actions`, which it is for")),
        (None, Some(_), None) => return Err(Problem::content("actions", "expected an `action_scale` beside them")),
        (None, None, None) => return Ok((names, vec![start; intervals])),
        (Some(value), None, None) => ("inputs", Rows::read("inputs", value, folder)?, 1.0),
        (None, Some(value), Some(scale)) => ("actions", Rows::read("actions", value, folder)?, scale),
    };
    if !(scale.is_finite() && scale > 0.0) {
        return Err(Problem::value("action_scale", scale, "a finite number above 0"));
    }
    let own: Vec<String> = if key == "actions" { (0..names.len()).map(actions).collect() } else { names.clone() };
    let mut places = Vec::with_capacity(rows.names.len());
    for name in &rows.names {
        let place = own.iter().position(|known| known == name);
        places.push(place.ok_or_else(|| {
            Problem::content(key, format!("`{name}` is none of this model's: expected {}", own.join(", ")))
        })?);
    }
    check_times(key, &rows.times, read.interval)?;
    let mut values = start;
    let mut all = Vec::with_capacity(intervals);
    let mut used = 0;
    for k in 0..intervals {
        let now = rows.at(k as f64 * read.interval, SAME_TIME * read.interval).map_or(0, |row| row + 1);
        for (time, row) in rows.times[used..now].iter().zip(&rows.values[used..now]) {
            for (&place, &value) in places.iter().zip(row).filter(|(_, value)| !value.is_nan()) {
                if key == "actions" && value.abs() > 1.0 {
                    return Err(Problem::value(format!("{} at time {time}", own[place]), value, "-1 to 1"));
                }
                values[place] = value * scale;
                held.set(&names[place], values[place]).map_err(|error| {
                    Problem::content(
                        key,
                        format!("at time {time}: {}", error.to_string().replace("parameter", "input")),
                    )
                })?;
            }
        }
        used = used.max(now);
        all.push(values.clone());
    }
    Ok((names, all))
}

/// Refuses inputs that change between two samples: a door with an interval of its own could not follow.
fn check_times(key: &str, times: &[f64], interval: f64) -> Result<(), Problem> {
    match times.first() {
        Some(first) if *first > 0.0 => return Err(Problem::value(format!("{key}, first time"), first, "0 or before")),
        _ => {}
    }
    let on_grid = |time: &f64| (time / interval - (time / interval).round()).abs() <= SAME_TIME;
    match times.iter().find(|time| **time > 0.0 && !on_grid(time)) {
        Some(time) => {
            Err(Problem::value(format!("{key}, time"), time, format!("a whole number of intervals of {interval} s")))
        }
        None => Ok(()),
    }
}
