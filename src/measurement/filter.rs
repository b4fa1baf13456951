//! `where`: which rows of a file belong to the experiment.

use super::error::{ExperimentError, Problem};
use super::sheet::{Sheet, SheetRow};
use toml::Value;

/// What the cells of one column must be, in the file's own units.
#[derive(Clone, Debug)]
pub(super) struct Filter {
    pub column: String,
    accepts: Accepts,
}

#[derive(Clone, Debug)]
enum Accepts {
    /// One of these.
    OneOf(Vec<Wanted>),
    /// A number from the first to the last.
    Between(f64, f64),
}

#[derive(Clone, Debug)]
enum Wanted {
    Number(f64),
    Text(String),
}

impl Filter {
    /// A condition as it is written: a number, a text, a list of them, or `{ min = .., max = .. }`.
    ///
    /// # Errors
    /// A message that says so.
    pub fn of(column: &str, value: &Value) -> Result<Self, String> {
        let accepts = match value {
            Value::Array(several) => several.iter().map(wanted).collect::<Option<Vec<_>>>().map(Accepts::OneOf),
            Value::Table(table) => {
                let bound = |key: &str, otherwise: f64| table.get(key).map_or(Some(otherwise), number);
                let known = !table.is_empty() && table.keys().all(|key| key == "min" || key == "max");
                let bounds = bound("min", f64::NEG_INFINITY).zip(bound("max", f64::INFINITY));
                bounds.filter(|_| known).map(|(min, max)| Accepts::Between(min, max))
            }
            one => wanted(one).map(|one| Accepts::OneOf(vec![one])),
        };
        let expected = "expected a number, a text, a list of them, or { min = .., max = .. }";
        let accepts = accepts.ok_or_else(|| format!("{value}: {expected}"))?;
        Ok(Self { column: column.to_owned(), accepts })
    }

    fn admits(&self, sheet: &Sheet, row: &SheetRow, column: usize) -> bool {
        let cell = &row.cells[column];
        let value = sheet.value(cell);
        match &self.accepts {
            Accepts::Between(min, max) => value.is_some_and(|value| (*min..=*max).contains(&value)),
            Accepts::OneOf(several) => several.iter().any(|wanted| match wanted {
                Wanted::Number(number) => value == Some(*number),
                Wanted::Text(text) => cell.text() == text.as_str(),
            }),
        }
    }
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|number| number as f64)).filter(|number| !number.is_nan())
}

fn wanted(value: &Value) -> Option<Wanted> {
    value.as_str().map(|text| Wanted::Text(text.to_owned())).or_else(|| number(value).map(Wanted::Number))
}

/// Indices of the rows that all filters admit.
pub(super) fn admitted(sheet: &Sheet, filters: &[Filter]) -> Result<Vec<usize>, ExperimentError> {
    let place = |filter: &Filter| {
        sheet.position(&filter.column).ok_or_else(|| {
            let problem =
                Problem::Setting(format!("`where` names this column; the file has {}", sheet.header.join(", ")));
            sheet.error(problem).at_line(sheet.header_line).at_column(&filter.column)
        })
    };
    let places: Vec<usize> = filters.iter().map(place).collect::<Result<_, _>>()?;
    let admits = |row: &SheetRow| filters.iter().zip(&places).all(|(filter, at)| filter.admits(sheet, row, *at));
    let rows: Vec<usize> = (0..sheet.rows.len()).filter(|k| admits(&sheet.rows[*k])).collect();
    if rows.is_empty() && !sheet.rows.is_empty() && !filters.is_empty() {
        let columns: Vec<&str> = filters.iter().map(|filter| filter.column.as_str()).collect();
        let message = format!("no row has what `where` wants of {}", columns.join(", "));
        return Err(sheet.error(Problem::Setting(message)));
    }
    Ok(rows)
}
