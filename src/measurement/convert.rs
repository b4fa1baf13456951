//! From the text of a file to the runs that it holds, in SI units.

use super::columns::Use;
use super::error::{ExperimentError, Problem};
use super::grid::{Grid, GridColumn};
use super::mapping::{Recorded, Scale, Target};
use super::recognise::Recognised;
use super::settings::RunSettings;
use super::sheet::Sheet;
use super::stamps::{EXPECTED, Stamp};
use super::vocabulary::numbered;
use std::collections::BTreeMap;

/// Rows of a file that form a run: equal parameters, equal labels of the run.
pub(super) struct Part {
    /// Indices of the rows.
    pub rows: Vec<usize>,
    /// Parameters that columns give.
    pub parameters: BTreeMap<String, f64>,
    /// The label that a column gives to the run.
    pub label: Option<String>,
}

/// Parts of the rows, in the order in which they begin.
pub(super) fn parts(
    sheet: &Sheet,
    columns: &[Recognised],
    rows: &[usize],
    run: &RunSettings,
) -> Result<Vec<Part>, ExperimentError> {
    let mut parts: Vec<Part> = Vec::new();
    for index in rows {
        let row = &sheet.rows[*index];
        let mut parameters = BTreeMap::new();
        let mut label = None;
        for column in columns {
            match &column.target {
                Target::Parameter(name, scale) => {
                    let cell = sheet.number(row, column.position)?;
                    let missing = || sheet.error_at(row, column.position, Problem::MissingInput);
                    // Parameters are no weights: gravity has no part in them.
                    let value = scale.apply(cell.ok_or_else(missing)?, 1.0);
                    if parameters.insert(name.clone(), value).is_some() || run.parameters.contains_key(name) {
                        let other = "another column, or `parameters` of the run,".to_owned();
                        let problem = Problem::Twice { signal: name.clone(), other };
                        return Err(sheet.error_at(row, column.position, problem));
                    }
                }
                Target::Run => label = Some(row.cells[column.position].text().into_owned()),
                _ => {}
            }
        }
        match parts.iter_mut().find(|part| part.parameters == parameters && part.label == label) {
            Some(part) => part.rows.push(*index),
            None => parts.push(Part { rows: vec![*index], parameters, label }),
        }
    }
    Ok(parts)
}

/// The part's rows in SI, with the constant inputs; gravity (m/s2) turns masses into weights.
pub(super) fn grid(
    sheet: &Sheet,
    columns: &[Recognised],
    part: &Part,
    run: &RunSettings,
    gravity: f64,
) -> Result<Grid, ExperimentError> {
    let lines = part.rows.iter().map(|row| sheet.rows[*row].line).collect();
    let mut grid = Grid { file: sheet.file.clone(), header_line: sheet.header_line, lines, columns: Vec::new() };
    for column in columns {
        match &column.target {
            Target::TimeStamp => {
                let values = seconds(sheet, part, column.position)?;
                add(&mut grid, sheet, column.position, ("time", Recorded::default()), values)?;
            }
            Target::Signals(names, ..) if names.iter().any(|name| name == "condition") => {}
            Target::Signals(names, scale, recorded) => {
                let values = numbers(sheet, part, column.position, scale, gravity)?;
                for name in names {
                    add(&mut grid, sheet, column.position, (name, *recorded), values.clone())?;
                }
            }
            Target::Parameter(..) | Target::Run => {}
        }
    }
    for (name, number, factor) in &run.inputs {
        if let Some(other) = grid.column(name) {
            let problem = Problem::Twice { signal: name.clone(), other: "`inputs` of experiment.toml".to_owned() };
            return Err(grid.error(problem).at_column(&other.source));
        }
        let values = vec![factor.value(gravity) * number; grid.lines.len()];
        grid.columns.push(GridColumn::plain(name, name, Use::Measured, values));
    }
    give_signs(&mut grid)?;
    Ok(grid)
}

fn add(
    grid: &mut Grid,
    sheet: &Sheet,
    position: usize,
    (name, recorded): (&str, Recorded),
    values: Vec<f64>,
) -> Result<(), ExperimentError> {
    let source = sheet.header[position].clone();
    let values = if recorded.magnitude { values.into_iter().map(f64::abs).collect() } else { values };
    if let Some(other) = grid.columns.iter_mut().find(|other| other.name == name) {
        let refused = |problem| sheet.error(problem).at_line(sheet.header_line).at_column(&source);
        if !other.is_other_side(recorded.side) {
            let other = format!("column `{}`", other.source);
            return Err(refused(Problem::Twice { signal: name.to_owned(), other }));
        }
        if other.recorded.magnitude != recorded.magnitude {
            let message = format!("`magnitude` is for both sides or for none; the other is `{}`", other.source);
            return Err(refused(Problem::Derived(message)));
        }
        other.values.iter_mut().zip(values).for_each(|(own, value)| *own = 0.5 * (*own + value));
        (other.beside, other.recorded.side) = (Some(source), None);
        return Ok(());
    }
    // What it is used for follows once all names are known.
    grid.columns.push(GridColumn { recorded, ..GridColumn::plain(name, source, Use::Measured, values) });
    Ok(())
}

/// Gives magnitudes the signs of the speeds of their wheels; those of wheels that stand are left out.
fn give_signs(grid: &mut Grid) -> Result<(), ExperimentError> {
    for at in 0..grid.columns.len() {
        let column = &grid.columns[at];
        let Some((_, _, wheels)) = numbered(&column.name).filter(|_| column.recorded.magnitude) else { continue };
        let speed = ["speed", "rim_speed", "speed_command", "rim_speed_command"]
            .iter()
            .find_map(|field| grid.values(&format!("wheel[{}].{field}", wheels[0])).map(<[f64]>::to_vec));
        let Some(speed) = speed else {
            let message =
                "a magnitude takes the sign of the wheel's speed; no speed or command of this wheel is recorded";
            let problem = Problem::Derived(message.to_owned());
            return Err(grid.error(problem).at_line(grid.header_line).at_column(&column.source));
        };
        let values = &mut grid.columns[at].values;
        values.iter_mut().zip(speed).for_each(|(value, speed)| {
            *value = if speed == 0.0 || speed.is_nan() { f64::NAN } else { *value * speed.signum() };
        });
    }
    Ok(())
}

fn numbers(
    sheet: &Sheet,
    part: &Part,
    position: usize,
    scale: &Scale,
    gravity: f64,
) -> Result<Vec<f64>, ExperimentError> {
    let one = |row: &usize| {
        let cell = sheet.number(&sheet.rows[*row], position)?;
        Ok(cell.map_or(f64::NAN, |cell| scale.apply(cell, gravity)))
    };
    part.rows.iter().map(one).collect()
}

/// Time stamps as seconds since the first row.
fn seconds(sheet: &Sheet, part: &Part, position: usize) -> Result<Vec<f64>, ExperimentError> {
    let mut first: Option<Stamp> = None;
    let mut before: Option<Stamp> = None;
    let mut midnights = 0.0;
    let mut all = Vec::with_capacity(part.rows.len());
    for index in &part.rows {
        let row = &sheet.rows[*index];
        let text = row.cells[position].text();
        if sheet.is_missing(&text) {
            return Err(sheet.error_at(row, position, Problem::MissingInput));
        }
        let refused = |expected: &str| {
            let problem = Problem::NotAStamp { text: text.clone().into_owned(), expected: expected.to_owned() };
            sheet.error_at(row, position, problem)
        };
        let stamp = Stamp::parse(&text).ok_or_else(|| refused(EXPECTED))?;
        let start = *first.get_or_insert(stamp);
        if !stamp.is_like(&start) {
            return Err(refused("the same form as in the first row"));
        }
        midnights += before.map_or(0.0, |before| stamp.midnights(&before));
        before = Some(stamp);
        all.push(stamp.since(&start) + midnights);
    }
    Ok(all)
}

/// Labels of the set-points, one a row; empty where the file has no such column.
pub(super) fn conditions(sheet: &Sheet, columns: &[Recognised], part: &Part) -> Vec<Option<String>> {
    let labels = |column: &&Recognised| matches!(&column.target, Target::Signals(names, ..) if names.iter().any(|name| name == "condition"));
    let Some(column) = columns.iter().find(labels) else { return Vec::new() };
    let label = |row: &usize| sheet.rows[*row].cells[column.position].text().into_owned();
    part.rows.iter().map(|row| Some(label(row)).filter(|label| !label.is_empty())).collect()
}
