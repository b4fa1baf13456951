//! Inputs that follow from speeds that were recorded in their place.

use super::columns::Use;
use super::doubts::Doubts;
use super::error::{ExperimentError, Problem};
use super::grid::{Grid, GridColumn};
use crate::contact;

/// Recorded slip and slip from recorded speeds may differ by this much before it is said: rigs hold and record speeds
/// within a few per cent.
const SLIP_TOLERANCE: f64 = 0.05;

/// The names that there will be once everything is derived, for a file with these.
pub(super) fn derived_names(names: &[String]) -> Vec<String> {
    let has = |name: &str| names.iter().any(|own| own == name);
    let carriage = has("carriage_speed");
    let mut all: Vec<String> = names.iter().map(|name| rim_to_wheel(name).unwrap_or_else(|| name.clone())).collect();
    let speed = all.iter().any(|name| name == "wheel_speed");
    match (has("slip"), speed) {
        (false, true) if carriage => all.push("slip".to_owned()),
        (true, false) if carriage => all.push("wheel_speed".to_owned()),
        _ => {}
    }
    all.retain(|name| name != "carriage_speed");
    all
}

/// The wheel speed's name where `name` is a rim speed.
fn rim_to_wheel(name: &str) -> Option<String> {
    match name {
        "rim_speed" => Some("wheel_speed".to_owned()),
        _ if name.ends_with("].rim_speed") || name.ends_with("].rim_speed_command") => {
            Some(name.replace("].rim_", "]."))
        }
        _ => None,
    }
}

/// Puts wheel speeds in the place of rim speeds, and slip or wheel speed in the place of a carriage speed.
///
/// `radius` is the wheel's, m, where the experiment states it.
pub(super) fn derive(grid: &mut Grid, radius: Option<f64>, doubts: &mut Doubts) -> Result<(), ExperimentError> {
    for k in 0..grid.columns.len() {
        let Some(name) = rim_to_wheel(&grid.columns[k].name) else { continue };
        if let Some(other) = grid.column(&name) {
            let problem = Problem::Twice { signal: name, other: format!("column `{}`", other.source) };
            return Err(grid.error(problem).at_line(grid.header_line).at_column(&grid.columns[k].source));
        }
        let radius = needed(grid, radius, &grid.columns[k].source)?;
        let column = &mut grid.columns[k];
        column.name = name;
        column.values.iter_mut().for_each(|value| *value /= radius);
    }
    let Some(carriage) = grid.take("carriage_speed") else { return Ok(()) };
    let made = match (grid.values("slip"), grid.values("wheel_speed")) {
        (None, Some(spin)) => {
            let radius = needed(grid, radius, &carriage.source)?;
            made(grid, &carriage, "slip", spin, &|speed, spin| slip(speed, radius * spin))?
        }
        (Some(slips), None) => {
            let radius = needed(grid, radius, &carriage.source)?;
            made(grid, &carriage, "wheel_speed", slips, &|speed, slip| spin(speed, slip, radius))?
        }
        (Some(slips), Some(spin)) => {
            if let Some(radius) = radius {
                compare(grid, &carriage, slips, spin, radius, doubts);
            }
            return Ok(());
        }
        // What is missing is reported with the other inputs.
        (None, None) => return Ok(()),
    };
    grid.columns.push(made);
    Ok(())
}

fn needed(grid: &Grid, radius: Option<f64>, source: &str) -> Result<f64, ExperimentError> {
    radius.ok_or_else(|| {
        let message = "a speed of rim or carriage needs \"wheel.radius\" under [parameters]".to_owned();
        grid.error(Problem::Derived(message)).at_line(grid.header_line).at_column(source)
    })
}

fn made(
    grid: &Grid,
    carriage: &GridColumn,
    name: &str,
    other: &[f64],
    of: &dyn Fn(f64, f64) -> Option<f64>,
) -> Result<GridColumn, ExperimentError> {
    let mut values = Vec::with_capacity(other.len());
    for (row, (speed, other)) in carriage.values.iter().zip(other).enumerate() {
        let value = of(*speed, *other).ok_or_else(|| {
            let message = format!(
                "no {name} follows from a carriage speed of {speed} m/s and {} there",
                if name == "slip" { format!("a wheel speed of {other} rad/s") } else { format!("a slip of {other}") }
            );
            grid.error_at(row, carriage, Problem::Derived(message))
        })?;
        values.push(value);
    }
    Ok(GridColumn::plain(name, &carriage.source, Use::Input, values))
}

fn slip(speed: f64, rim: f64) -> Option<f64> {
    (speed != 0.0 || rim != 0.0).then(|| contact::slip(speed, rim)).filter(|slip| slip.is_finite())
}

/// Wheel speed where the carriage moves at `speed`: i = 1 - V/(r omega) driving, r omega/V - 1 in skid.
fn spin(speed: f64, slip: f64, radius: f64) -> Option<f64> {
    let rim = if slip >= 0.0 { speed / (1.0 - slip) } else { speed * (1.0 + slip) };
    (speed != 0.0 && rim.is_finite()).then_some(rim / radius)
}

/// Doubts a recorded slip that the recorded speeds contradict.
fn compare(grid: &Grid, carriage: &GridColumn, slips: &[f64], spin: &[f64], radius: f64, doubts: &mut Doubts) {
    let differences = carriage.values.iter().zip(slips.iter().zip(spin)).filter_map(|(speed, (recorded, spin))| {
        let computed = slip(*speed, radius * spin)?;
        ((recorded - computed).abs() > SLIP_TOLERANCE).then_some((*recorded, computed))
    });
    let differences: Vec<(f64, f64)> = differences.collect();
    if let Some((recorded, computed)) = differences.first() {
        let doubt = format!(
            "the recorded slip differs from that of the recorded speeds in {} of {} rows ({recorded:.3} where they give \
             {computed:.3}): slip is 1 - V/(r omega) driving and r omega/V - 1 in skid; is \"wheel.radius\" right, or slip \
             defined otherwise? Without the recorded slip, under `ignore`, it is computed",
            differences.len(),
            grid.lines.len()
        );
        doubts.add(&grid.file, doubt);
    }
}
