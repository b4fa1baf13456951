//! Which columns an experiment may have, and which values their units allow.

use super::experiment::Kind;
use crate::rover::MAX_COORDINATES;
use crate::signals::Signals;
use bekker_modeldescription::Lookup;
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// Fastest rim, m/s, that a wheel on soil is believed to have: beyond it the speed is not in rad/s.
const FASTEST_RIM: f64 = 50.0;

/// Tangential force over load beyond which the unit is wrong: soil gives a wheel 1 or 2 at most, kN for N or
/// N mm for N m give hundreds.
const LARGEST_FORCE_RATIO: f64 = 50.0;

/// Fastest rover, m/s, on soft soil.
const FASTEST_ROVER: f64 = 50.0;

/// What a column is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// Time, increasing.
    Time,
    /// A label of the set-point that a row repeats.
    Condition,
    /// Given to the model.
    Input,
    /// Compared with the model.
    Measured,
}

/// One column that may be there.
pub(super) struct Column {
    pub name: String,
    pub used: Use,
    /// Values that the unit allows, and how to say so.
    pub limits: Option<(RangeInclusive<f64>, String)>,
}

fn column(name: impl Into<String>, used: Use, limits: Option<(RangeInclusive<f64>, String)>) -> Column {
    Column { name: name.into(), used, limits }
}

fn within(size: f64, words: &str) -> Option<(RangeInclusive<f64>, String)> {
    Some((-size..=size, words.to_owned()))
}

/// Columns of an experiment of this kind; `header` tells how many wheels a rover has, `radius` is the wheel's, m.
pub(super) fn known(kind: Kind, header: &[String], radius: f64) -> Vec<Column> {
    match kind {
        Kind::SingleWheel => single_wheel(radius),
        Kind::Traverse => traverse(wheels(header), links(header), radius),
    }
}

fn single_wheel(radius: f64) -> Vec<Column> {
    vec![
        column("condition", Use::Condition, None),
        column("load", Use::Input, Some((f64::MIN_POSITIVE..=f64::MAX, "a positive load in N".to_owned()))),
        column("slip", Use::Input, slip()),
        column("wheel_speed", Use::Input, wheel_speed(radius)),
        column("drawbar_pull", Use::Measured, None),
        column("torque", Use::Measured, None),
        column("sinkage", Use::Measured, sinkage(radius)),
    ]
}

fn traverse(wheels: usize, links: usize, radius: f64) -> Vec<Column> {
    let mut columns = vec![column("time", Use::Time, None)];
    for k in 1..=wheels {
        columns.push(column(format!("wheel[{k}].speed_command"), Use::Input, wheel_speed(radius)));
        columns.push(column(format!("wheel[{k}].torque_command"), Use::Input, None));
    }
    let mut signals = Signals::<f64>::of(wheels, links);
    for (variable, _) in signals.list() {
        let field = variable.name.rsplit('.').next().unwrap_or_default();
        let limits = match field {
            "slip" => slip(),
            "sinkage" => sinkage(radius),
            "speed" => wheel_speed(radius),
            "pitch" | "contact_angle" | "angle" => within(PI, "an angle in rad within -pi .. pi (degrees?)"),
            "velocity" => within(FASTEST_ROVER, "a speed in m/s (cm/s or mm/s?)"),
            _ => None,
        };
        columns.push(column(variable.name, Use::Measured, limits));
    }
    columns
}

fn slip() -> Option<(RangeInclusive<f64>, String)> {
    within(1.0, "a slip within -1 .. 1 (per cent?)")
}

fn wheel_speed(radius: f64) -> Option<(RangeInclusive<f64>, String)> {
    within(FASTEST_RIM / radius, "a wheel speed in rad/s (rpm or deg/s?)")
}

fn sinkage(radius: f64) -> Option<(RangeInclusive<f64>, String)> {
    within(radius, &format!("a sinkage in m, at most the wheel's radius {radius} m (millimetres?)"))
}

/// Limits of a force or torque measured under a load (N).
pub(super) fn under_load(name: &str, load: f64, radius: f64) -> Option<(RangeInclusive<f64>, String)> {
    match name {
        "drawbar_pull" => within(
            LARGEST_FORCE_RATIO * load,
            &format!("a force in N of the order of the load {load} N (is one of them in kN or kg?)"),
        ),
        "torque" => within(
            LARGEST_FORCE_RATIO * load * radius,
            &format!("a torque in N m of the order of load times radius, {} N m (N mm?)", load * radius),
        ),
        _ => None,
    }
}

/// How many wheels the commands of a traverse name: wheels are numbered from 1 without a gap.
fn wheels(header: &[String]) -> usize {
    let commands = |k: usize| {
        header.iter().any(|n| *n == format!("wheel[{k}].speed_command") || *n == format!("wheel[{k}].torque_command"))
    };
    (1..).take_while(|k| commands(*k)).count()
}

/// How many links a traverse measures: as many as the highest number that a column names, no more than a rover may have.
fn links(header: &[String]) -> usize {
    let names = |k: usize| header.iter().any(|n| *n == format!("link[{k}].angle") || *n == format!("link[{k}].rate"));
    (1..=MAX_COORDINATES - 3).rev().find(|k| names(*k)).unwrap_or(0)
}
