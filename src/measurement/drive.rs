//! What drives the wheels of a traverse: commands or, where none were recorded, the measured speeds of the wheels.

use super::columns::Use;
use super::doubts::Doubts;
use super::error::{ExperimentError, Problem};
use super::experiment::{Experiment, Run};
use super::grid::Grid;

/// Longest time between two measured speeds over which those between them are interpolated, s: the wheels of a rover hardly
/// change their speed meanwhile. A longer one is a gap of the record.
const LONGEST: f64 = 0.5;

/// Runs that a note names.
const NAMED: usize = 3;

impl Run {
    /// Whether wheel speeds are imposed on a traverse: commanded ones, or [measured ones](Self::follows_measured_speeds).
    #[must_use]
    pub fn imposes_speeds(&self) -> bool {
        self.follows_measured_speeds() || self.inputs.iter().any(|name| name.ends_with("].speed_command"))
    }

    /// Whether the measured speeds of the wheels drive a traverse, since no command was recorded. They are inputs then, and are
    /// not compared with the model.
    #[must_use]
    pub fn follows_measured_speeds(&self) -> bool {
        self.inputs.iter().any(|name| name.ends_with("].speed"))
    }

    /// What drives `wheel` (from 1) of a traverse from each row to the next: rad/s where
    /// [speeds are imposed](Self::imposes_speeds), else N m. A command holds until the next row. A measured speed is that of its
    /// instant, so that the mean of two rows holds between them and the wheel turns as far as it did. Empty where the wheel
    /// has no input, 0 in a missing cell.
    #[must_use]
    pub fn held_inputs(&self, wheel: usize) -> Vec<f64> {
        let of_wheel = |name: &&String| name.starts_with(&format!("wheel[{wheel}]."));
        let column = self.inputs.iter().find(of_wheel).and_then(|name| self.data.column(name)).unwrap_or_default();
        let values: Vec<f64> = column.iter().map(|value| if value.is_nan() { 0.0 } else { *value }).collect();
        if !self.follows_measured_speeds() {
            return values;
        }
        (0..values.len()).map(|row| 0.5 * (values[row] + values[(row + 1).min(values.len() - 1)])).collect()
    }
}

impl Experiment {
    /// A note on the runs that are driven by measured wheel speeds; `None` where there are none.
    #[must_use]
    pub fn measured_drive(&self) -> Option<String> {
        let driven: Vec<&str> =
            self.runs.iter().filter(|run| run.follows_measured_speeds()).map(|run| run.name.as_str()).collect();
        let place = match driven.len() {
            0 => return None,
            all if all == self.runs.len() => ";".to_owned(),
            few if few <= NAMED => format!(" in {}; there", driven.join(", ")),
            many => format!(" in {} and {} more runs; there", driven[..NAMED].join(", "), many - NAMED),
        };
        let what = "the measured wheel speeds drive the rover and are not compared with the model";
        Some(format!("drive: no command was recorded{place} {what}"))
    }
}

/// Interpolates missing cells of measured wheel speeds that drive a rover (columns of `fields` that are inputs), and says so.
///
/// # Errors
/// [`ExperimentError`] for a missing cell without a value shortly before and after it.
pub(super) fn fill(grid: &mut Grid, fields: &[&str], doubts: &mut Doubts) -> Result<(), ExperimentError> {
    let Some(time) = grid.values("time").map(<[f64]>::to_vec) else { return Ok(()) };
    for at in 0..grid.columns.len() {
        let column = &grid.columns[at];
        let field = column.name.rsplit('.').next().unwrap_or_default();
        let drives = fields.contains(&field) && matches!(column.used, Use::Input | Use::Intermediate);
        let missing: Vec<usize> = (0..time.len()).filter(|row| column.values[*row].is_nan()).collect();
        if !drives || missing.is_empty() {
            continue;
        }
        let mut filled = column.values.clone();
        for row in &missing {
            let between = between(&time, &column.values, *row);
            filled[*row] =
                between.ok_or_else(|| grid.error_at(*row, column, Problem::MissingSpeed { longest: LONGEST }))?;
        }
        doubts.add(
            &grid.file,
            format!(
                "`{}` has no value in {} of {} rows; it drives the rover, as there is no command, and is interpolated there",
                column.source,
                missing.len(),
                time.len()
            ),
        );
        grid.columns[at].values = filled;
    }
    Ok(())
}

/// The value at `row` on the straight line in time through its neighbours that are there, where these are near.
fn between(time: &[f64], values: &[f64], row: usize) -> Option<f64> {
    let before = (0..row).rev().find(|k| !values[*k].is_nan())?;
    let after = (row + 1..values.len()).find(|k| !values[*k].is_nan())?;
    let length = time[after] - time[before];
    let share = (time[row] - time[before]) / length;
    (length > 0.0 && length <= LONGEST).then(|| values[before] + share * (values[after] - values[before]))
}
