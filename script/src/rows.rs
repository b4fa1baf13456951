//! Named values over time: a CSV file beside the script, one table that holds from the start, or a list of rows.

use super::error::Problem;
use bekker::measurement::Table;
use std::path::Path;

/// Columns of values, and the times of their rows, s. NaN marks a cell that is not given.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    pub names: Vec<String>,
    pub times: Vec<f64>,
    /// One row a time.
    pub values: Vec<Vec<f64>>,
}

const TIME: &str = "time";

impl Rows {
    /// Reads what stands under `key`.
    pub fn read(key: &'static str, value: &toml::Value, folder: &Path) -> Result<Self, Problem> {
        match value {
            toml::Value::String(name) => Self::of_table(key, &folder.join(name)),
            toml::Value::Table(table) => Self::of_rows(key, std::slice::from_ref(value), !table.contains_key(TIME)),
            toml::Value::Array(rows) if !rows.is_empty() => Self::of_rows(key, rows, false),
            other => {
                Err(Problem::value(key, other, "the name of a CSV file, a table, or a list of tables with a `time`"))
            }
        }
    }

    fn of_table(key: &'static str, file: &Path) -> Result<Self, Problem> {
        let table = Table::read(file).map_err(|error| Problem::Table { key, error: Box::new(error) })?;
        let Some(times) = table.column(TIME) else {
            return Err(Problem::content(key, format!("`{}` has no column `time`", file.display())));
        };
        let names: Vec<String> = table.names().iter().filter(|name| *name != TIME).cloned().collect();
        let row = |k: usize| names.iter().map(|name| table.value(name, k).unwrap_or(f64::NAN)).collect();
        Ok(Self { times: times.to_vec(), values: (0..table.rows()).map(row).collect(), names: names.clone() }).and_then(
            |rows| if rows.times.is_empty() { Err(Problem::content(key, "there are no rows")) } else { Ok(rows) },
        )
    }

    /// `timeless`: a single row that holds from the start and needs no time.
    fn of_rows(key: &'static str, rows: &[toml::Value], timeless: bool) -> Result<Self, Problem> {
        let mut all = Self::default();
        for (number, row) in rows.iter().enumerate() {
            let place = if timeless { key.to_owned() } else { format!("{key}[{}]", number + 1) };
            let Some(row) = row.as_table() else {
                return Err(Problem::value(place, row, "a table with a `time`"));
            };
            let mut cells = vec![f64::NAN; all.names.len()];
            let mut time = if timeless { Some(0.0) } else { None };
            for (name, value) in flat(&place, "", row)? {
                if name == TIME && !timeless {
                    time = Some(value);
                } else if let Some(k) = all.names.iter().position(|known| *known == name) {
                    cells[k] = value;
                } else {
                    all.names.push(name);
                    cells.push(value);
                }
            }
            let time = time.ok_or_else(|| Problem::content(&place, "the row has no `time`"))?;
            if all.times.last().is_some_and(|last| *last >= time) {
                return Err(Problem::value(format!("{place}.time"), time, "a later time than that of the row before"));
            }
            all.times.push(time);
            all.values.push(cells);
        }
        let width = all.names.len();
        all.values.iter_mut().for_each(|row| row.resize(width, f64::NAN));
        Ok(all)
    }

    /// Number of the row that holds at `time`: the last whose time has come.
    pub fn at(&self, time: f64, rounding: f64) -> Option<usize> {
        self.times.partition_point(|own| *own <= time + rounding).checked_sub(1)
    }
}

/// Names and numbers of a table; nested tables and dotted names mean the same.
pub(super) fn flat(key: &str, prefix: &str, table: &toml::Table) -> Result<Vec<(String, f64)>, Problem> {
    let mut all = Vec::new();
    for (name, value) in table {
        let name = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
        match value {
            toml::Value::Float(number) if number.is_finite() => all.push((name, *number)),
            toml::Value::Integer(number) => all.push((name, *number as f64)),
            toml::Value::Table(inner) => all.extend(flat(key, &name, inner)?),
            other => return Err(Problem::value(format!("{key}.{name}"), other, "a finite number")),
        }
    }
    Ok(all)
}
