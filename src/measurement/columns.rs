//! Which columns an experiment may have, and which values their units allow.

use super::experiment::Kind;
use super::vocabulary::{numbered, signal_unit};
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
    /// Other signals follow from it.
    Intermediate,
}

/// One column that may be there.
pub(super) struct Column {
    pub name: String,
    pub used: Use,
    pub limits: Option<Limits>,
}

/// Values that a unit allows.
pub(super) struct Limits {
    range: RangeInclusive<f64>,
    words: String,
    /// The unit in which values outside are likely to be.
    likely: Option<&'static str>,
}

impl Limits {
    pub fn allow(&self, value: f64) -> bool {
        self.range.contains(&value)
    }

    /// What was expected of a column, with the line that would mend it.
    pub fn expected(&self, source: &str, signal: &str) -> String {
        match self.likely {
            Some(unit) => format!("{}; if so, write under [columns]: {}", self.words, mend(source, signal, unit)),
            None => self.words.clone(),
        }
    }
}

/// What gives a column another unit: the whole line of `[columns]`, or a key for the entry that is there already.
pub(super) fn mend(source: &str, signal: &str, unit: &str) -> String {
    mend_by(source, signal, &format!("unit = \"{unit}\""))
}

/// What turns the sign of a column.
pub(super) fn mend_sign(source: &str, signal: &str) -> String {
    mend_by(source, signal, "sign = -1")
}

fn mend_by(source: &str, signal: &str, key: &str) -> String {
    if source == signal {
        format!("{} = {{ signal = \"{signal}\", {key} }}", quoted(source))
    } else {
        format!("`{key}` in the entry of {}", quoted(source))
    }
}

/// A key of TOML in quotes.
pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn column(name: impl Into<String>, used: Use, limits: Option<Limits>) -> Column {
    Column { name: name.into(), used, limits }
}

fn within(size: f64, words: &str, likely: Option<&'static str>) -> Option<Limits> {
    Some(Limits { range: -size..=size, words: words.to_owned(), likely })
}

/// Columns of an experiment of this kind; `names` tell how many wheels a rover has, `radius` is the wheel's, m.
pub(super) fn known(kind: Kind, names: &[String], radius: f64) -> Vec<Column> {
    match kind {
        Kind::SingleWheel => single_wheel(radius),
        Kind::Traverse => traverse(names, radius),
    }
}

fn single_wheel(radius: f64) -> Vec<Column> {
    let load = Limits { range: f64::MIN_POSITIVE..=f64::MAX, words: "a positive load in N".to_owned(), likely: None };
    vec![
        column("condition", Use::Condition, None),
        column("load", Use::Input, Some(load)),
        column("slip", Use::Input, slip()),
        column("wheel_speed", Use::Input, wheel_speed(radius)),
        column("drawbar_pull", Use::Measured, None),
        column("torque", Use::Measured, None),
        column("sinkage", Use::Measured, sinkage(radius)),
        column("carriage_speed", Use::Intermediate, velocity()),
        column("rim_speed", Use::Intermediate, velocity()),
    ]
}

fn traverse(names: &[String], radius: f64) -> Vec<Column> {
    let (wheels, links) = (wheels(names), links(names));
    let mut columns = vec![column("time", Use::Time, None)];
    for k in 1..=wheels {
        columns.push(column(format!("wheel[{k}].speed_command"), Use::Input, wheel_speed(radius)));
        columns.push(column(format!("wheel[{k}].torque_command"), Use::Input, None));
        columns.push(column(format!("wheel[{k}].rim_speed_command"), Use::Intermediate, velocity()));
    }
    let mut signals = Signals::<f64>::of(wheels, links);
    for (variable, _) in signals.list() {
        let field = variable.name.rsplit('.').next().unwrap_or_default();
        let limits = match field {
            "slip" => slip(),
            "sinkage" => sinkage(radius),
            "speed" => wheel_speed(radius),
            "pitch" | "contact_angle" | "angle" => {
                within(PI, "an angle in rad within -pi .. pi (degrees?)", Some("deg"))
            }
            "velocity" => velocity(),
            _ => None,
        };
        columns.push(column(variable.name, Use::Measured, limits));
    }
    // Missing rim speeds are missing wheel speeds, which may be.
    columns.extend((1..=wheels).map(|k| column(format!("wheel[{k}].rim_speed"), Use::Measured, velocity())));
    let sums = names.iter().filter(|name| {
        let several = numbered(name).is_some_and(|(_, _, n)| n.len() > 1 && n.iter().all(|k| *k <= wheels));
        several && signal_unit(Kind::Traverse, name).is_some()
    });
    columns.extend(sums.map(|name| column(name, Use::Measured, None)));
    columns
}

fn slip() -> Option<Limits> {
    within(1.0, "a slip within -1 .. 1 (per cent?)", Some("%"))
}

fn velocity() -> Option<Limits> {
    within(FASTEST_ROVER, "a speed in m/s (cm/s or mm/s?)", Some("mm/s"))
}

fn wheel_speed(radius: f64) -> Option<Limits> {
    within(FASTEST_RIM / radius, "a wheel speed in rad/s (rpm or deg/s?)", Some("rpm"))
}

fn sinkage(radius: f64) -> Option<Limits> {
    within(radius, &format!("a sinkage in m, at most the wheel's radius {radius} m (millimetres?)"), Some("mm"))
}

/// Limits of a force or torque measured under a load (N).
pub(super) fn under_load(name: &str, load: f64, radius: f64) -> Option<Limits> {
    match name {
        "drawbar_pull" => within(
            LARGEST_FORCE_RATIO * load,
            &format!("a force in N of the order of the load {load} N (is one of them in kN or kg?)"),
            None,
        ),
        "torque" => within(
            LARGEST_FORCE_RATIO * load * radius,
            &format!("a torque in N m of the order of load times radius, {} N m (N mm?)", load * radius),
            Some("N mm"),
        ),
        _ => None,
    }
}

/// How many wheels the commands of a traverse name: wheels are numbered from 1 without a gap.
fn wheels(names: &[String]) -> usize {
    let commands = |k: usize| {
        let own = |what: &str| names.iter().any(|n| *n == format!("wheel[{k}].{what}"));
        own("speed_command") || own("torque_command") || own("rim_speed_command")
    };
    (1..).take_while(|k| commands(*k)).count()
}

/// How many links a traverse measures: as many as the highest number that a column names, no more than a rover may have.
fn links(names: &[String]) -> usize {
    let has = |k: usize| names.iter().any(|n| *n == format!("link[{k}].angle") || *n == format!("link[{k}].rate"));
    (1..=MAX_COORDINATES - 3).rev().find(|k| has(*k)).unwrap_or(0)
}
