//! A rover on a profile: what its recorded speeds, angles and torques say of each other.

use super::super::columns::Use;
use super::super::grid::{Grid, GridColumn};
use super::{largest, mean, present};

/// A rover at this pitch, rad, has fallen over.
const STEEPEST: f64 = 1.2;

/// Rim speed over the rover's speed, averaged over a run: five times means 80 % slip, a fifth means as much skid. A speed in
/// rpm is off by 9.5, one in deg/s by 57.
const RIM_RATIO: f64 = 5.0;

/// Speeds below this, m/s, are standstill and say nothing of a ratio.
const MOVING: f64 = 1e-3;

/// Share of its largest speed under which a rover stands, share of its usual speed at which a wheel still turns, and the time, s, for
/// which both hold until the last row.
const STANDS: f64 = 0.1;
const STILL_TURNS: f64 = 0.5;
const STANDS_FOR: f64 = 1.0;

/// Number of backward rows from which a signal that is never negative is not due to chance.
const BACKWARD: i32 = 10;

pub(in crate::measurement) fn look(grid: &Grid, radius: Option<f64>) -> Vec<String> {
    let mut doubts = Vec::new();
    for column in &grid.columns {
        let field = column.name.rsplit('.').next().unwrap_or_default();
        match field {
            "pitch" | "contact_angle" => doubts.extend(steep(column)),
            "speed" if column.used == Use::Input => {
                doubts.extend(radius.and_then(|radius| unlike_the_rover(grid, column, radius)));
            }
            "speed_command" => doubts.extend(radius.and_then(|radius| unlike_the_rover(grid, column, radius))),
            _ => {}
        }
    }
    doubts.extend(stands_at_its_end(grid));
    doubts
}

/// What the signs of all rows of a run say, before it is cut where the vehicle turns.
pub(in crate::measurement) fn look_at_signs(grid: &Grid) -> Vec<String> {
    let doubt = |column: &GridColumn| match column.name.rsplit('.').next()? {
        "torque" | "current" => unsigned(grid, column).or_else(|| against_the_speed(grid, column)),
        "speed" | "rim_speed" if column.used != Use::Input => against_the_speed(grid, column),
        _ => None,
    };
    grid.columns.iter().filter_map(doubt).collect()
}

/// The rover stands while its wheels turn until the recording ends: it is stuck, or their speed was no longer updated.
fn stands_at_its_end(grid: &Grid) -> Option<String> {
    let (time, velocity) = (grid.values("time")?, grid.column("velocity")?);
    let turns = |column: &&GridColumn| column.name.ends_with("].speed_command") || column.name.ends_with("].speed");
    let wheel = grid.columns.iter().find(turns)?;
    let fastest = largest(&velocity.values)?;
    let usual = mean(present(&wheel.values).map(f64::abs))?;
    let stands =
        |row: &usize| velocity.values[*row].abs() < STANDS * fastest && wheel.values[*row].abs() >= STILL_TURNS * usual;
    let first = (0..time.len()).rev().take_while(stands).last().filter(|_| usual > 0.0)?;
    let held = wheel.values[first..].windows(2).all(|pair| (pair[0] - pair[1]).abs() < f64::EPSILON);
    (time[time.len() - 1] - time[first] >= STANDS_FOR).then(|| {
        format!(
            "from {:.1} s to the last row the rover stands while `{}` goes on{}: it is stuck, or that speed was no longer updated, \
             in which case these rows do not belong to the drive and should be left out",
            time[first],
            wheel.source,
            if held { " at the same value in every row" } else { "" }
        )
    })
}

fn steep(column: &GridColumn) -> Option<String> {
    let most = largest(&column.values).filter(|most| *most > STEEPEST)?;
    Some(format!(
        "{} reaches {most:.2} rad, where a rover has fallen over; if it is in degrees, write under [columns]: {}",
        column.shown(),
        column.mend("unit = \"deg\"")
    ))
}

/// A torque or current that is never negative, although its wheel turns both ways: its sign was lost, as in the log of many a motor
/// driver.
fn unsigned(grid: &Grid, column: &GridColumn) -> Option<String> {
    let speed = speed_of_wheel(grid, column)?;
    let size = mean(present(&column.values).map(f64::abs))?;
    let backward = column.values.iter().zip(speed).filter(|(value, speed)| !value.is_nan() && **speed < 0.0);
    let (count, sum) = backward.fold((0, 0.0), |(count, sum), (value, _)| (count + 1, sum + value));
    let never_negative = present(&column.values).all(|value| value >= 0.0) && speed.iter().any(|speed| *speed > 0.0);
    // Backward it is as large as elsewhere.
    (never_negative && count >= BACKWARD && sum > 0.5 * size * f64::from(count)).then(|| {
        format!(
            "{} is never negative, although its wheel turns backward in {count} rows; if its sign was not recorded, write under [columns]: \
             {}, which gives it the sign of the wheel's speed",
            column.shown(),
            column.mend("magnitude = true")
        )
    })
}

/// Measured or commanded speed of the wheel whose signal a column holds, of the first where it is a sum.
fn speed_of_wheel<'g>(grid: &'g Grid, column: &GridColumn) -> Option<&'g [f64]> {
    let wheel = column.name.split_once('[')?.1.split(['+', ']']).next()?;
    let is_speed = column.name.ends_with("speed");
    let fields = ["speed", "rim_speed", "speed_command", "rim_speed_command"];
    let others = fields.iter().filter(|field| !is_speed || field.ends_with("command"));
    others.map(|field| format!("wheel[{wheel}].{field}")).find_map(|name| grid.values(&name))
}

/// A drive takes power: torque and current have the sign of the wheel's speed, but for a wheel that is braked downhill; and a
/// wheel turns as it is told.
fn against_the_speed(grid: &Grid, column: &GridColumn) -> Option<String> {
    let speed = speed_of_wheel(grid, column)?;
    let rows = column.values.iter().zip(speed).filter(|(value, speed)| !value.is_nan() && !speed.is_nan());
    let products = rows.map(|(value, speed)| value * speed.signum() * f64::from(u8::from(*speed != 0.0)));
    let (with, size) = (mean(products)?, mean(present(&column.values).map(f64::abs))?);
    // Half of its mean size against the motion is more than braking downhill and noise come to.
    (with < -0.5 * size).then(|| {
        format!(
            "{} has the opposite sign of the wheel's speed nearly everywhere; if its sign is turned, write under [columns]: {}",
            column.shown(),
            column.mend("sign = -1")
        )
    })
}

/// Wheels turn, as commanded or measured, as the rover moves.
fn unlike_the_rover(grid: &Grid, command: &GridColumn, radius: f64) -> Option<String> {
    let speed = grid.column("velocity")?;
    let moving = |speed: f64| speed.abs() > MOVING;
    let rows = command.values.iter().zip(&speed.values).filter(|(_, speed)| moving(**speed));
    let rim = mean(rows.clone().map(|(command, _)| (radius * command).abs()))?;
    let rover = mean(rows.clone().map(|(_, speed)| speed.abs()))?;
    let same = mean(rows.map(|(command, speed)| command.signum() * speed.signum()))?;
    let against = (same < -0.5).then(|| {
        format!(
            "{} has the opposite sign of the recorded {}; if the sign of the latter is turned, write under [columns]: {}",
            command.shown(),
            speed.shown(),
            speed.mend("sign = -1")
        )
    });
    let unlike = (rim > RIM_RATIO * rover || rover > RIM_RATIO * rim).then(|| {
        format!(
            "{} moves the rims at {rim:.3} m/s on average, where {} is {rover:.3} m/s; is one of them in another unit? For example {}",
            command.shown(),
            speed.shown(),
            command.mend(if rim > rover { "unit = \"rpm\"" } else { "unit = \"rev/s\"" })
        )
    });
    against.or(unlike)
}
