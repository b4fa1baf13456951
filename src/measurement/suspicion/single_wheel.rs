//! A wheel on a carriage: what pull, torque, sinkage and speed can be under a load.

use super::super::columns::{mend, mend_sign};
use super::super::error::{ExperimentError, Problem};
use super::super::grid::{Grid, GridColumn};
use super::{ALL_ROWS, largest, mean, median};

/// Range of slips over which a pull changes by much more than [`NO_PULL`] of the load on any soil.
const SLIP_RANGE: f64 = 0.2;

/// A pull within this share of the load over such a range is no pull on soil; a pull in kN under a load in N stays below it.
const NO_PULL: f64 = 0.01;

/// Largest tangential force over the load that published soils give a driven wheel, with room: tan phi and adhesion of lugs
/// come to about 1. Above it the load is likely to be in kg. A skidding wheel may plough against much more.
const LARGEST_PULL: f64 = 1.5;

/// Least mean pressure under a wheel over its sinkage, Pa/m, that anybody calls soil: ten times that of water. Freely
/// rolling wheels only, for slip-sinkage deepens the others.
const SOFTEST: f64 = 1e5;
const ROLLING: f64 = 0.3;

/// Fastest rims of carriages, m/s: of wheels under [`SMALL`] (m) and of larger ones. Rigs run at centimetres a second; a
/// speed in rpm is ten times that in rad/s.
const FAST_RIM: [f64; 2] = [1.0, 3.0];
const SMALL: f64 = 0.3;
const LARGE: f64 = 0.5;

/// Slips that certainly drive or skid: radius and speed are known better than this.
const CLEAR_SLIP: f64 = 0.15;

/// A pull's sign is judged by at least so many rows at either end of the slips, and by a fall of this share of the load.
const ROWS: usize = 2;
const FALL: f64 = 0.05;

/// Slips up to here are low, from there high, where only driving was recorded.
const LOW: f64 = 0.1;
const HIGH: f64 = 0.25;

pub(in crate::measurement) fn look(
    grid: &Grid,
    radius: Option<f64>,
    width: Option<f64>,
) -> Result<Vec<String>, ExperimentError> {
    let (Some(load), Some(slip)) = (grid.column("load"), grid.column("slip")) else { return Ok(Vec::new()) };
    let turning = |speed: &f64| if *speed < 0.0 { -1.0 } else { 1.0 };
    let forward = grid.values("wheel_speed").unwrap_or_default().iter().map(turning).collect::<Vec<f64>>();
    if forward.len() != load.values.len() {
        return Ok(Vec::new());
    }
    let rows = Rows { grid, load, slip, forward };
    let mut doubts = Vec::new();
    if let Some(pull) = grid.column("drawbar_pull") {
        if let Some(refused) = flipped_in_skid(&rows, pull) {
            return Err(refused);
        }
        doubts.extend(small_pull(&rows, pull));
        doubts.extend(falling_pull(&rows, pull));
    }
    doubts.extend(light_load(&rows, radius, width));
    doubts.extend(radius.and_then(|radius| fast(grid, radius)));
    Ok(doubts)
}

/// Rows of one run, with the names by which the file calls what it holds.
struct Rows<'a> {
    grid: &'a Grid,
    load: &'a GridColumn,
    slip: &'a GridColumn,
    /// 1 where the wheel turns forward or not at all, -1 where it turns backward, which turns pull and torque.
    forward: Vec<f64>,
}

impl Rows<'_> {
    /// A force over the load in the direction of turning, in rows whose slip is accepted.
    fn ratios(&self, force: &GridColumn, accepts: impl Fn(f64) -> bool) -> Vec<f64> {
        let Self { load, slip, forward, .. } = self;
        (0..force.values.len())
            .filter(|row| !force.values[*row].is_nan() && accepts(slip.values[*row]))
            .map(|row| forward[row] * force.values[row] / load.values[row])
            .collect()
    }
}

/// A wheel in skid is towed: where all of them pull, and more than driven wheels do, the sign is turned.
fn flipped_in_skid(rows: &Rows, pull: &GridColumn) -> Option<ExperimentError> {
    let skid = rows.ratios(pull, |slip| slip < -CLEAR_SLIP);
    let driven = mean(rows.ratios(pull, |slip| slip > CLEAR_SLIP).into_iter());
    let least = skid.iter().copied().reduce(f64::min)?;
    let turned = skid.len() >= ROWS && least > 0.0 && driven.is_none_or(|driven| driven < least);
    turned.then(|| {
        let message = format!(
            "all {} rows with a slip below -{CLEAR_SLIP} pull forward, which a skidding wheel cannot; a drawbar pull is positive where the \
             wheel pulls the carriage: write under [columns]: {}",
            skid.len(),
            mend_sign(&pull.source, "drawbar_pull")
        );
        rows.grid.error(Problem::Suspicious(message)).at_column(&pull.source)
    })
}

/// Only driving recorded: a pull that is positive where the wheel rolls freely and falls as it slips.
fn falling_pull(rows: &Rows, pull: &GridColumn) -> Option<String> {
    let low = rows.ratios(pull, |slip| slip < LOW);
    let high = rows.ratios(pull, |slip| slip > HIGH);
    let (rolls, slips) = (mean(low.iter().copied())?, mean(high.iter().copied())?);
    let falls = low.len() >= ROWS && high.len() >= ROWS && rolls > 0.0 && slips < rolls - FALL;
    falls.then(|| {
        format!(
            "`{}` falls with slip, from {rolls:.2} of the load below slip {LOW} to {slips:.2} above {HIGH}; if its sign is turned, write under [columns]: {}",
            pull.source,
            mend_sign(&pull.source, "drawbar_pull")
        )
    })
}

fn small_pull(rows: &Rows, pull: &GridColumn) -> Option<String> {
    let all = rows.ratios(pull, |_| true);
    let (low, high) = rows.slip.values.iter().fold((f64::MAX, f64::MIN), |(l, h), s| (l.min(*s), h.max(*s)));
    let most = largest(&all).filter(|most| *most > 0.0 && *most < NO_PULL)?;
    (all.len() >= ALL_ROWS && high - low > SLIP_RANGE).then(|| {
        format!(
            "`{}` is at most {:.2} % of the load over slips from {low} to {high}; if it is in kN, write under [columns]: {}",
            pull.source,
            100.0 * most,
            mend(&pull.source, "drawbar_pull", "kN")
        )
    })
}

/// A load that is too small for what is measured under it.
fn light_load(rows: &Rows, radius: Option<f64>, width: Option<f64>) -> Option<String> {
    let Rows { grid, load, .. } = rows;
    let over = |name: &str, arm: f64| {
        let column = grid.column(name)?;
        largest(&rows.ratios(column, |slip| slip > 0.0)).map(|ratio| ratio / arm)
    };
    let reason = match (over("drawbar_pull", 1.0), radius.and_then(|radius| over("torque", radius))) {
        (Some(pull), _) if pull > LARGEST_PULL => format!("a pull of up to {pull:.1} times the load"),
        (_, Some(torque)) if torque > LARGEST_PULL => {
            format!("a torque of up to {torque:.1} times load times radius")
        }
        _ => {
            let stiffness = stiffness(rows, radius?, width?)?;
            if stiffness >= SOFTEST {
                return None;
            }
            format!("a pressure under the wheel of {:.0} kPa for each metre of sinkage", stiffness / 1e3)
        }
    };
    Some(format!(
        "{reason} is hardly possible on soil: if `{}` is in kg, write under [columns]: {} (it is then multiplied by gravity)",
        load.source,
        mend(&load.source, "load", "kg")
    ))
}

/// Median over freely rolling wheels of the mean pressure over the sinkage, Pa/m. The area is width times the chord
/// that the ground's level cuts from the rim, half of which touches.
fn stiffness(Rows { grid, load, slip, .. }: &Rows, radius: f64, width: f64) -> Option<f64> {
    let sinkage = grid.column("sinkage")?;
    let rows = sinkage.values.iter().zip(load.values.iter().zip(&slip.values));
    let rolling = rows.filter(|(sinkage, (_, slip))| **sinkage > 0.0 && slip.abs() < ROLLING);
    let all: Vec<f64> = rolling
        .map(|(sinkage, (load, _))| load / (width * (2.0 * radius * sinkage - sinkage * sinkage).sqrt() * sinkage))
        .collect();
    (all.len() >= ALL_ROWS).then(|| median(&all))
}

fn fast(grid: &Grid, radius: f64) -> Option<String> {
    let speed = grid.column("wheel_speed")?;
    let rim = largest(&speed.values)? * radius;
    let limit = FAST_RIM[usize::from(radius > SMALL)];
    (radius < LARGE && rim > limit).then(|| {
        format!(
            "`{}` makes a rim of radius {radius} m run at up to {rim:.2} m/s, fast for a carriage; if it is in rpm, write under [columns]: {}",
            speed.source,
            mend(&speed.source, "wheel_speed", "rpm")
        )
    })
}
