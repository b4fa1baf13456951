//! What columns are for, and which values their units allow. Which columns there are is said by the kind of the experiment,
//! in `kinds`.

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
    pub range: RangeInclusive<f64>,
    pub words: String,
    /// The unit in which values outside are likely to be.
    pub likely: Option<&'static str>,
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

/// What gives a column another key.
pub(super) fn mend_by(source: &str, signal: &str, key: &str) -> String {
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

pub(super) fn column(name: impl Into<String>, used: Use, limits: Option<Limits>) -> Column {
    Column { name: name.into(), used, limits }
}

pub(super) fn within(size: f64, words: &str, likely: Option<&'static str>) -> Option<Limits> {
    Some(Limits { range: -size..=size, words: words.to_owned(), likely })
}

pub(super) fn slip() -> Option<Limits> {
    within(1.0, "a slip within -1 .. 1 (per cent?)", Some("%"))
}

pub(super) fn velocity() -> Option<Limits> {
    within(FASTEST_ROVER, "a speed in m/s (cm/s or mm/s?)", Some("mm/s"))
}

pub(super) fn wheel_speed(radius: f64) -> Option<Limits> {
    within(FASTEST_RIM / radius, "a wheel speed in rad/s (rpm or deg/s?)", Some("rpm"))
}

pub(super) fn sinkage(radius: f64) -> Option<Limits> {
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
