//! Reading the runs of an experiment from its files.

use super::columns::{Column, Use};
use super::convert::{Part, conditions, grid, parts};
use super::derive::{derive, derived_names};
use super::dialect::Dialect;
use super::doubts::Doubts;
use super::error::{ExperimentError, Problem};
use super::experiment::{Kind, Run};
use super::files::Files;
use super::filter::admitted;
use super::grid::Grid;
use super::recognise::{names, recognised};
use super::settings::{RunSettings, Settings};
use super::sheet::Sheet;
use super::straight::{LeftOut, Stated, slip_angle, stretches};
use super::suspicion;
use super::table::Table;
use crate::wheel::Wheel;
use bekker_modeldescription::{STANDARD_GRAVITY, nearest};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Every run of the experiment, and what is doubtful in them.
pub(super) fn read_runs(
    files: &Files,
    settings: &Settings,
    planned: bool,
    doubts: &mut Doubts,
) -> Result<Vec<Run>, ExperimentError> {
    let mut runs = Vec::new();
    let mut headers = BTreeSet::new();
    for run in &settings.runs {
        let sheet = files.sheet(&run.file, &settings.dialect)?;
        headers.extend(sheet.header.iter().cloned());
        runs.extend(read_file(files, settings, run, &sheet, planned, doubts)?);
    }
    for (column, _, line) in &settings.columns {
        if !headers.contains(column) {
            let near = nearest(column, headers.iter().cloned());
            let near = if near.is_empty() { String::new() } else { format!("; did you mean {}?", near.join(", ")) };
            let all = headers.iter().cloned().collect::<Vec<_>>().join(", ");
            let message = format!("no file has this column{near} Found are {all}");
            return Err(ExperimentError::in_file(&settings.file, Problem::Setting(message))
                .at_line(*line)
                .at_column(format!("columns.{column}")));
        }
    }
    number_equal_names(&mut runs);
    Ok(runs)
}

/// Runs of one name, as parts of one file have it, get a number behind it: `trials#1`, `trials#2`.
fn number_equal_names(runs: &mut [Run]) {
    let names: Vec<String> = runs.iter().map(|run| run.name.clone()).collect();
    for (k, run) in runs.iter_mut().enumerate() {
        if names.iter().filter(|name| **name == names[k]).count() > 1 {
            let number = names[..=k].iter().filter(|name| **name == names[k]).count();
            run.name = format!("{}#{number}", names[k]);
        }
    }
}

/// The runs of one file: one for each set of equal parameters that its columns give.
fn read_file(
    files: &Files,
    settings: &Settings,
    run: &RunSettings,
    sheet: &Sheet,
    planned: bool,
    doubts: &mut Doubts,
) -> Result<Vec<Run>, ExperimentError> {
    let columns = recognised(sheet, settings, run, doubts)?;
    let given: Vec<String> = columns.iter().flat_map(|column| names(&column.target)).cloned().collect();
    let stamps = columns.iter().any(|column| matches!(column.target, super::mapping::Target::TimeStamp));
    let constants = run.inputs.iter().map(|(name, ..)| name.clone());
    let time = stamps.then(|| "time".to_owned());
    let all: Vec<String> = given.into_iter().chain(constants).chain(time).collect();
    check_inputs(sheet, settings.kind, &derived_names(&all))?;
    let rows = admitted(sheet, &run.filters)?;
    if rows.len() < settings.kind.format().least_rows() {
        return Err(sheet.error(Problem::TooFewRows { found: rows.len(), needed: settings.kind.format().least_rows() }));
    }
    let parts = parts(sheet, &columns, &rows, run)?;
    let several = parts.len() > 1;
    let terrain = run.terrain.as_ref().map(|file| read_terrain(files, file)).transpose()?;
    let mut recorded = Vec::new();
    for part in &parts {
        let mut own = run.parameters.clone();
        own.extend(part.parameters.clone());
        let stated = |name: &str| own.get(name).or_else(|| settings.parameters.get(name)).copied();
        let gravity = stated("gravity").unwrap_or(STANDARD_GRAVITY);
        let mut grid = grid(sheet, &columns, part, run, gravity)?;
        let radius = stated("wheel.radius");
        let vehicle = Stated {
            radius,
            lever: lever(&settings.parameters, &own),
            x0: run.x0,
            has_ground: terrain.is_some(),
            least_rows: settings.kind.format().least_rows(),
            planned,
        };
        // What neighbouring rows tell is asked before the run is cut.
        put_to_use(settings.kind, &mut grid, radius);
        settings.kind.format().complete(&mut grid, doubts)?;
        let signs = settings.kind.format().look_at_signs(&grid);
        signs.into_iter().for_each(|doubt| doubts.add(&sheet.file, doubt));
        recorded.push((own, grid, vehicle));
    }
    let limit = slip_angle(recorded.iter().map(|(_, grid, vehicle)| (grid, vehicle)));
    let mut runs = Vec::new();
    let mut left_out = LeftOut::default();
    for ((number, part), (own, grid, vehicle)) in (1..).zip(&parts).zip(recorded) {
        let radius = vehicle.radius;
        let width = own.get("wheel.width").or_else(|| settings.parameters.get("wheel.width")).copied();
        let all = 0..grid.lines.len();
        let stretches = stretches(grid, &vehicle, limit, &mut left_out)?;
        let is_cut = stretches.len() != 1 || stretches.iter().any(|stretch| stretch.rows != all);
        if run.group.is_some() && is_cut {
            let message =
                "its runs repeat each other row by row, and this one is cut where the vehicle turns; leave out `group`";
            return Err(sheet.error(Problem::NotARepeat(message.to_owned())));
        }
        let stem = run.name.clone().unwrap_or_else(|| Path::new(&run.file).with_extension("").display().to_string());
        let conditions = conditions(sheet, &columns, part);
        for stretch in stretches {
            let (data, used) = checked(settings.kind, stretch.grid, radius, width, planned, doubts)?;
            let group = run.group.as_ref();
            runs.push(Run {
                name: name_of(&stem, part),
                file: sheet.file.clone(),
                group: group.map(|group| if several { format!("{group}#{number}") } else { group.clone() }),
                terrain: stretch.ground.or_else(|| terrain.clone()),
                x0: stretch.x0,
                conditions: conditions.get(stretch.rows).map(<[_]>::to_vec).unwrap_or_default(),
                inputs: used.inputs,
                measured: used.measured,
                parameters: own.clone(),
                data,
            });
        }
    }
    left_out.say(&sheet.file, doubts)?;
    Ok(runs)
}

/// Distance of the axle that is farthest from the middle among stated places of wheels, m; those of the run go before the experiment's.
fn lever(experiment: &BTreeMap<String, f64>, run: &BTreeMap<String, f64>) -> Option<f64> {
    let all = experiment.iter().filter(|(name, _)| !run.contains_key(*name)).chain(run);
    let places = all.filter(|(name, _)| name.starts_with("wheel[") && name.ends_with("].x"));
    places.map(|(_, x)| x.abs()).reduce(f64::max)
}

/// Says of each column what it is used for; the columns that such an experiment may have.
fn put_to_use(kind: Kind, grid: &mut Grid, radius: Option<f64>) -> Vec<Column> {
    let known = kind.format().columns(&grid.names(), radius.unwrap_or(Wheel::<f64>::default().radius));
    for column in &mut grid.columns {
        let found = known.iter().find(|known| known.name == column.name);
        column.used = found.map_or(column.used, |known| known.used);
    }
    known
}

/// A part with a label of its own is called by it.
fn name_of(stem: &str, part: &Part) -> String {
    let Some(label) = part.label.as_ref().filter(|_| part.parameters.is_empty()) else { return stem.to_owned() };
    let plain = |c: char| if c.is_alphanumeric() || "._-".contains(c) { c } else { '_' };
    format!("{stem}#{}", label.chars().map(plain).collect::<String>())
}

/// Names of a run's columns by their use.
struct Used {
    inputs: Vec<String>,
    measured: Vec<String>,
}

/// The part's table, once all of it is checked.
fn checked(
    kind: Kind,
    mut grid: Grid,
    radius: Option<f64>,
    width: Option<f64>,
    planned: bool,
    doubts: &mut Doubts,
) -> Result<(Table, Used), ExperimentError> {
    let assumed = radius.unwrap_or(Wheel::<f64>::default().radius);
    if grid.lines.len() < kind.format().least_rows() {
        return Err(grid.error(Problem::TooFewRows { found: grid.lines.len(), needed: kind.format().least_rows() }));
    }
    let first = put_to_use(kind, &mut grid, radius);
    grid.check_limits(&first)?;
    derive(&mut grid, radius, doubts)?;
    // What was derived has limits too.
    let known = put_to_use(kind, &mut grid, radius);
    grid.check_limits(&known)?;
    check_time(&grid)?;
    kind.format().check_rows(&grid, assumed)?;
    suspicion::look(kind, &grid, radius, width, doubts)?;
    let named = |used: Use| grid.columns.iter().filter(move |column| column.used == used);
    let inputs = named(Use::Input).map(|column| column.name.clone()).collect();
    let has_value = |values: &[f64]| values.iter().any(|value| !value.is_nan());
    let measured = named(Use::Measured).filter(|column| planned || has_value(&column.values));
    let measured: Vec<String> = measured.map(|column| column.name.clone()).collect();
    if measured.is_empty() {
        let known = known.iter().filter(|column| column.used == Use::Measured).map(|column| column.name.as_str());
        return Err(grid.error(Problem::NothingMeasured { known: known.collect::<Vec<_>>().join(", ") }));
    }
    Ok((grid.table()?, Used { inputs, measured }))
}

/// Fails where a required column is missing, or where commands do not go together. `names` are those of
/// all signals, derived ones included.
fn check_inputs(sheet: &Sheet, kind: Kind, names: &[String]) -> Result<(), ExperimentError> {
    if let Some((name, instead)) =
        kind.format().required().iter().find(|(name, _)| !names.iter().any(|own| own == name))
    {
        return Err(missing_column(sheet, kind, name, instead));
    }
    kind.format().check_commands(sheet, names)
}

/// The error of a column that must be there.
pub(super) fn missing_column(sheet: &Sheet, kind: Kind, name: &str, instead: &'static str) -> ExperimentError {
    let problem = Problem::MissingColumn { kind: kind.name(), instead, found: sheet.header.join(", ") };
    sheet.error(problem).at_line(sheet.header_line).at_column(name)
}

pub(super) fn check_time(grid: &Grid) -> Result<(), ExperimentError> {
    let Some(time) = grid.column("time") else { return Ok(()) };
    if let Some(row) = time.values.iter().position(|time| time.is_nan()) {
        return Err(grid.error_at(row, time, Problem::MissingInput));
    }
    for (k, pair) in time.values.windows(2).enumerate() {
        if pair[1] <= pair[0] {
            let problem = Problem::TimeOrder { time: pair[1], previous: pair[0] };
            return Err(grid.error_at(k + 1, time, problem));
        }
    }
    Ok(())
}

/// A profile: columns `x` (increasing) and `z`, m.
fn read_terrain(files: &Files, name: &str) -> Result<Table, ExperimentError> {
    let sheet = files.sheet(name, &Dialect::default())?;
    sheet.need_rows(2)?;
    let at = |name: &str| {
        sheet.position(name).ok_or_else(|| {
            let problem =
                Problem::MissingColumn { kind: "traverse", instead: " in its terrain", found: sheet.header.join(", ") };
            sheet.error(problem).at_line(sheet.header_line).at_column(name)
        })
    };
    let (x, z) = (at("x")?, at("z")?);
    if let Some(other) = sheet.header.iter().find(|name| *name != "x" && *name != "z") {
        let problem = Problem::UnknownColumns { unknown: format!("column `{other}`"), known: "x, z".to_owned() };
        return Err(sheet.error(problem).at_line(sheet.header_line).at_column(other));
    }
    let broken = |_| sheet.error(Problem::Header("the columns do not form a table"));
    let mut table = Table::new(["x", "z"]).map_err(broken)?;
    let mut before = f64::NEG_INFINITY;
    for row in &sheet.rows {
        let number = |column: usize| {
            let missing = || sheet.error_at(row, column, Problem::MissingInput);
            sheet.number(row, column)?.ok_or_else(missing)
        };
        let place = [number(x)?, number(z)?];
        if place[0] <= before {
            let expected = format!("an x in m beyond {before} m of the row before");
            return Err(sheet.error_at(row, x, Problem::Implausible { value: place[0], expected }));
        }
        before = place[0];
        table.push(&place).map_err(broken)?;
    }
    Ok(table)
}
