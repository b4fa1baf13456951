//! An experiment folder, read and checked.

use super::columns::{Column, Use, known, under_load};
use super::error::{ExperimentError, Problem};
use super::files::Files;
use super::settings::{RunSettings, Settings};
use super::sheet::{Sheet, SheetRow};
use super::table::Table;
use crate::effects::EffectDefinition;
use crate::wheel::Wheel;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What was done in an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A wheel on a carriage: every row is a steady point.
    SingleWheel,
    /// A rover on a profile: every run is a time series.
    Traverse,
}

impl Kind {
    /// The name in `experiment.toml`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::SingleWheel => "single_wheel",
            Self::Traverse => "traverse",
        }
    }

    /// Fewest rows of a run: a steady point stands for itself, a time series needs some to be one.
    fn least_rows(self) -> usize {
        match self {
            Self::SingleWheel => 1,
            Self::Traverse => 10,
        }
    }
}

/// What a separate test says of a parameter: a normal distribution.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Prior {
    /// The value that the test gave, in the parameter's unit.
    pub mean: f64,
    /// Its standard deviation.
    #[serde(rename = "sd")]
    pub deviation: f64,
}

/// Measurements, what they were made with and what is known of their noise. Everything in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// Name for people.
    pub name: String,
    /// What was done.
    pub kind: Kind,
    /// The folder it was read from; empty where it was made in memory.
    pub folder: PathBuf,
    /// What is known of the rig, by the model's parameter names.
    pub parameters: BTreeMap<String, f64>,
    /// Parameters known from separate tests.
    pub priors: BTreeMap<String, Prior>,
    /// Class of the soil, whose priors stand in for tests that were not made; one of [`SOIL_CLASSES`](crate::soil_class).
    pub soil_class: Option<String>,
    /// The vehicle or rig: a built-in model or a model file, as the experiment names it.
    pub model: Option<String>,
    /// Stated standard deviation of one sample, by signal.
    pub noise: BTreeMap<String, f64>,
    /// Effects of the user's own, neutral unless a parameter says otherwise; candidates of a diagnosis.
    pub effects: Vec<EffectDefinition>,
    /// The runs, in the order of the file.
    pub runs: Vec<Run>,
}

/// One CSV file of an experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The file's path below the folder, without its ending.
    pub name: String,
    /// The file.
    pub file: PathBuf,
    /// Runs of the same group repeat the same inputs; rows pair by index.
    pub group: Option<String>,
    /// What was changed for this run, by the model's parameter names.
    pub parameters: BTreeMap<String, f64>,
    /// Profile of the ground, columns `x` and `z`, m; flat where missing.
    pub terrain: Option<Table>,
    /// Where the rover starts, m.
    pub x0: Option<f64>,
    /// Inputs and measured signals; for a traverse also `time`.
    pub data: Table,
    /// Label of the set-point of each row; empty where the file has no such column.
    pub conditions: Vec<Option<String>>,
    /// Names of the input columns.
    pub inputs: Vec<String>,
    /// Names of the measured columns that have at least one value; of a plan, all measured columns.
    pub measured: Vec<String>,
}

impl Experiment {
    /// Reads `experiment.toml` in `folder` and the CSV files that it names.
    ///
    /// # Errors
    /// [`ExperimentError`] with file, line and column: the format is described in the [module](super).
    /// The names of parameters are not checked here but by the model that they are given to.
    pub fn read(folder: impl AsRef<Path>) -> Result<Self, ExperimentError> {
        Self::read_from(&Files::Folder(folder.as_ref()), false)
    }

    /// The same for an experiment that may still have to be made: columns of measured signals may be empty, and count
    /// as signals that will be measured.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_plan(folder: impl AsRef<Path>) -> Result<Self, ExperimentError> {
        Self::read_from(&Files::Folder(folder.as_ref()), true)
    }

    pub(super) fn read_from(files: &Files, planned: bool) -> Result<Self, ExperimentError> {
        let settings = Settings::read(files)?;
        let default_radius = Wheel::<f64>::default().radius;
        let radius_of = |run: &RunSettings| {
            let own = run.parameters.get("wheel.radius").or_else(|| settings.parameters.get("wheel.radius"));
            own.copied().unwrap_or(default_radius)
        };
        let runs: Vec<Run> = settings
            .runs
            .iter()
            .map(|run| read_run(files, &settings, run, radius_of(run), planned))
            .collect::<Result<_, _>>()?;
        let experiment = Self {
            name: settings.name,
            kind: settings.kind,
            folder: files.folder(),
            parameters: settings.parameters,
            priors: settings.priors,
            soil_class: settings.soil_class,
            model: settings.model,
            effects: settings.effects,
            noise: settings.noise.iter().map(|(name, (sd, _))| (name.clone(), *sd)).collect(),
            runs,
        };
        let measured = experiment.signals();
        for (name, (_, line)) in &settings.noise {
            if !measured.contains(name) {
                let message = format!("no run measures this signal; measured are {}", measured.join(", "));
                return Err(ExperimentError::in_file(&settings.file, Problem::Setting(message))
                    .at_line(*line)
                    .at_column(format!("noise.{name}")));
            }
        }
        experiment.check_groups()?;
        Ok(experiment)
    }

    /// Names of all signals that some run measures, in the order of their first appearance.
    #[must_use]
    pub fn signals(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for name in self.runs.iter().flat_map(|run| &run.measured) {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        names
    }
}

fn read_run(
    files: &Files,
    settings: &Settings,
    run: &RunSettings,
    radius: f64,
    planned: bool,
) -> Result<Run, ExperimentError> {
    let sheet = Sheet::parse(&files.path(&run.file), &files.text(&run.file)?)?;
    sheet.need_rows(settings.kind.least_rows())?;
    let known = known(settings.kind, &sheet.header, radius);
    let columns = recognised(&sheet, &known, &settings.ignore)?;
    check_inputs(&sheet, settings.kind)?;
    let data = numbers(&sheet, &columns)?;
    check_time(&sheet, &data)?;
    if settings.kind == Kind::SingleWheel {
        check_forces(&sheet, &data, radius)?;
    }
    let named = |used: Use| columns.iter().filter(move |(_, c)| c.used == used).map(|(_, c)| c.name.clone());
    let has_value = |name: &String| data.column(name).is_some_and(|v| v.iter().any(|v| !v.is_nan()));
    let measured: Vec<String> = named(Use::Measured).filter(|name| planned || has_value(name)).collect();
    if measured.is_empty() {
        let known = known.iter().filter(|c| c.used == Use::Measured).map(|c| c.name.as_str()).collect::<Vec<_>>();
        return Err(sheet.error(Problem::NothingMeasured { known: known.join(", ") }));
    }
    Ok(Run {
        name: Path::new(&run.file).with_extension("").display().to_string(),
        group: run.group.clone(),
        parameters: run.parameters.clone(),
        terrain: run.terrain.as_ref().map(|file| read_terrain(files, file)).transpose()?,
        x0: run.x0,
        conditions: conditions(&sheet),
        inputs: named(Use::Input).collect(),
        measured,
        file: sheet.file,
        data,
    })
}

/// The columns of the sheet that are known, with their positions.
fn recognised<'a>(
    sheet: &Sheet,
    known: &'a [Column],
    ignore: &[String],
) -> Result<Vec<(usize, &'a Column)>, ExperimentError> {
    let mut columns = Vec::new();
    for (position, name) in sheet.header.iter().enumerate() {
        if ignore.contains(name) {
            continue;
        }
        let Some(column) = known.iter().find(|column| column.name == *name) else {
            let known = known.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ");
            return Err(sheet.error(Problem::UnknownColumn { known }).at_line(1).at_column(name));
        };
        columns.push((position, column));
    }
    Ok(columns)
}

/// Fails where a required column is missing, or where a traverse mixes the two kinds of command.
fn check_inputs(sheet: &Sheet, kind: Kind) -> Result<(), ExperimentError> {
    let missing = |name: &str| {
        let problem = Problem::MissingColumn { kind: kind.name(), found: sheet.header.join(", ") };
        Err(sheet.error(problem).at_line(1).at_column(name))
    };
    let required: &[&str] = match kind {
        Kind::SingleWheel => &["load", "slip", "wheel_speed"],
        Kind::Traverse => &["time"],
    };
    if let Some(name) = required.iter().find(|name| sheet.position(name).is_none()) {
        return missing(name);
    }
    if kind == Kind::Traverse {
        let commands = |what: &str| sheet.header.iter().filter(|n| n.ends_with(what)).count();
        let (speeds, torques) = (commands(".speed_command"), commands(".torque_command"));
        if speeds + torques == 0 {
            return missing("wheel[1].speed_command");
        }
        if speeds > 0 && torques > 0 {
            return Err(sheet
                .error(Problem::Header("speed and torque commands in one run; give one of them"))
                .at_line(1));
        }
    }
    Ok(())
}

/// All numbers of the recognised columns, each within what its unit allows.
fn numbers(sheet: &Sheet, columns: &[(usize, &Column)]) -> Result<Table, ExperimentError> {
    let numeric: Vec<_> = columns.iter().filter(|(_, c)| c.used != Use::Condition).collect();
    let broken = |_| sheet.error(Problem::Header("the columns do not form a table"));
    let mut table = Table::new(numeric.iter().map(|(_, c)| c.name.clone())).map_err(broken)?;
    for row in &sheet.rows {
        let cells: Vec<Option<f64>> =
            numeric.iter().map(|(position, column)| cell(sheet, row, *position, column)).collect::<Result<_, _>>()?;
        table.push_with_gaps(&cells).map_err(broken)?;
    }
    Ok(table)
}

fn cell(sheet: &Sheet, row: &SheetRow, position: usize, column: &Column) -> Result<Option<f64>, ExperimentError> {
    let value = sheet.number(row, position)?;
    match (value, &column.limits) {
        (None, _) if matches!(column.used, Use::Input | Use::Time) => {
            Err(sheet.error_at(row, position, Problem::MissingInput))
        }
        (Some(value), Some((range, expected))) if !range.contains(&value) => {
            Err(sheet.error_at(row, position, Problem::Implausible { value, expected: expected.clone() }))
        }
        _ => Ok(value),
    }
}

fn check_time(sheet: &Sheet, data: &Table) -> Result<(), ExperimentError> {
    let (Some(column), Some(time)) = (sheet.position("time"), data.column("time")) else { return Ok(()) };
    for (k, pair) in time.windows(2).enumerate() {
        if pair[1] <= pair[0] {
            let problem = Problem::TimeOrder { time: pair[1], previous: pair[0] };
            return Err(sheet.error_at(&sheet.rows[k + 1], column, problem));
        }
    }
    Ok(())
}

fn check_forces(sheet: &Sheet, data: &Table, radius: f64) -> Result<(), ExperimentError> {
    for (k, row) in sheet.rows.iter().enumerate() {
        for name in ["drawbar_pull", "torque"] {
            let (Some(value), Some(load), Some(column)) =
                (data.value(name, k), data.value("load", k), sheet.position(name))
            else {
                continue;
            };
            if let Some((range, expected)) = under_load(name, load, radius)
                && !range.contains(&value)
            {
                return Err(sheet.error_at(row, column, Problem::Implausible { value, expected }));
            }
        }
    }
    Ok(())
}

fn conditions(sheet: &Sheet) -> Vec<Option<String>> {
    let Some(column) = sheet.position("condition") else { return Vec::new() };
    sheet.rows.iter().map(|row| Some(row.cells[column].clone()).filter(|label| !label.is_empty())).collect()
}

/// A profile: columns `x` (increasing) and `z`, m.
fn read_terrain(files: &Files, name: &str) -> Result<Table, ExperimentError> {
    let sheet = Sheet::parse(&files.path(name), &files.text(name)?)?;
    sheet.need_rows(2)?;
    let limits = || None;
    let known = ["x", "z"].map(|name| Column { name: name.to_owned(), used: Use::Input, limits: limits() });
    let columns = recognised(&sheet, &known, &[])?;
    for name in ["x", "z"] {
        if sheet.position(name).is_none() {
            let problem = Problem::MissingColumn { kind: "traverse", found: sheet.header.join(", ") };
            return Err(sheet.error(problem).at_line(1).at_column(name));
        }
    }
    let table = numbers(&sheet, &columns)?;
    let x = table.column("x").unwrap_or_default();
    if let Some(k) = x.windows(2).position(|pair| pair[1] <= pair[0]) {
        let expected = format!("an x in m beyond {} m of the row before", x[k]);
        let problem = Problem::Implausible { value: x[k + 1], expected };
        return Err(sheet.error_at(&sheet.rows[k + 1], sheet.position("x").unwrap_or(0), problem));
    }
    Ok(table)
}
