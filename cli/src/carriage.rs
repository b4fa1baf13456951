//! `bekker simulate` of a wheel on a carriage: a steady point for each row of inputs.

use crate::model::assignment;
use anyhow::{Context, Result, anyhow, bail};
use bekker::carriage::{SetPoint, SteadyPoint};
use bekker::measurement::Table;
use bekker::model::Model;
use bekker::modeldescription::{Lookup, Parameters};
use std::path::Path;

const TIME: &str = "time";

/// The inputs of all steady points: a table, values for all rows, or both.
pub struct Points {
    /// Times of the rows, where the file has them.
    time: Option<Vec<f64>>,
    sets: Vec<SetPoint>,
    /// Where the rows come from, for errors.
    source: Option<String>,
}

impl Points {
    /// Reads them from `--input NAME=VALUE` and the columns of `--input-file`.
    pub fn read(inputs: &[String], file: Option<&Path>) -> Result<Self> {
        let mut given: Vec<(&str, f64)> = Vec::new();
        let mut set = SetPoint::default();
        for input in inputs {
            let (name, value) = assignment(input)?;
            if given.iter().any(|(known, _)| *known == name) {
                bail!("input `{name}` is given twice");
            }
            set.set(name, value).map_err(|refused| anyhow!("--input {input}: {refused}"))?;
            given.push((name, value));
        }
        let table = file.map(Table::read).transpose()?;
        let source = file.map(|file| file.display().to_string());
        let place = source.as_ref().map_or(String::new(), |file| format!(" or as a column of `{file}`"));
        let columns = table.as_ref().map_or(&[][..], Table::names);
        for (variable, _) in set.list() {
            let (by_value, by_column) =
                (given.iter().any(|(name, _)| *name == variable.name), columns.contains(&variable.name));
            if by_value && by_column {
                bail!("input `{}` is given twice: by --input and as a column of --input-file", variable.name);
            }
            if !by_value && !by_column {
                bail!(
                    "input `{0}` is missing; give it by --input {0}=..{place} ({1})",
                    variable.name,
                    variable.range()
                );
            }
        }
        let Some(table) = &table else { return Ok(Self { time: None, sets: vec![set], source: None }) };
        let name = source.unwrap_or_default();
        if let Some(strange) = columns.iter().find(|column| *column != TIME && set.get(column).is_err()) {
            bail!("`{name}`: column `{strange}` is no input of a wheel on a carriage (load, slip, wheel_speed; time)");
        }
        let sets = (0..table.rows()).map(|row| of_row(set, table, row).with_context(|| format!("`{name}`")));
        let sets = sets.collect::<Result<Vec<_>>>()?;
        Ok(Self { time: table.column(TIME).map(<[f64]>::to_vec), sets, source: Some(name) })
    }

    /// Inputs and the signals asked for (all where none are named), row by row.
    pub fn solve(&self, model: &Model, signals: Option<&[String]>) -> Result<Table> {
        let known: Vec<String> = SteadyPoint::<f64>::default().list().into_iter().map(|(v, _)| v.name).collect();
        if let Some(strange) = signals.unwrap_or_default().iter().find(|name| !known.contains(name)) {
            bail!("`{strange}` is no signal of a wheel on a carriage; expected {}", known.join(", "));
        }
        let shown: Vec<String> = signals.map_or(known, <[String]>::to_vec);
        let failed = |(row, error): (usize, bekker::diagnosis::SteadyError)| match &self.source {
            Some(file) => anyhow!("`{file}`, line {}: {error}", row + 2),
            None => anyhow!("{error}"),
        };
        let points = model.steady_points(&self.sets).map_err(failed)?;
        let time = self.time.as_ref().map(|_| TIME.to_owned());
        let inputs = SetPoint::<f64>::default().list().into_iter().map(|(variable, _)| variable.name);
        let mut table = Table::new(time.into_iter().chain(inputs).chain(shown.iter().cloned()))?;
        for (row, (set, mut point)) in self.sets.iter().zip(points).enumerate() {
            let mut cells: Vec<f64> = self.time.iter().map(|time| time[row]).collect();
            set.values(&mut |value| cells.push(value));
            for name in &shown {
                cells.push(point.get(name)?);
            }
            table.push(&cells)?;
        }
        Ok(table)
    }
}

/// The set-point of a row; what the table does not have is as in `set`.
fn of_row(mut set: SetPoint, table: &Table, row: usize) -> Result<SetPoint> {
    for name in table.names().iter().filter(|name| *name != TIME) {
        let value = table.value(name, row);
        let value = value.ok_or_else(|| anyhow!("line {}, column `{name}`: expected a number", row + 2))?;
        set.set(name, value).map_err(|refused| anyhow!("line {}: {refused}", row + 2))?;
    }
    Ok(set)
}
