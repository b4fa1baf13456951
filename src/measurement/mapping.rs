//! `[columns]`: which column of a file is which signal, in which unit.

use super::experiment::Kind;
use super::vocabulary::{self, numbered};
use super::written::{Written, parameter_factor};
use crate::effects::EffectDefinition;
use bekker_modeldescription::Unit;
use serde::{Deserialize, Serialize};

/// An entry of `[columns]` as it is written: the name of a signal, or a table.
pub(super) type ColumnEntry = Written<String, ColumnTable>;

/// `{ signal = "drawbar_pull", unit = "kN", sign = -1 }` and its like.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ColumnTable {
    signal: Option<String>,
    parameter: Option<String>,
    /// Cells are dates, times of day or counts since 1970.
    #[serde(default)]
    time_stamp: bool,
    /// Rows with equal cells form a run.
    #[serde(default)]
    run: bool,
    unit: Option<String>,
    sign: Option<f64>,
    scale: Option<f64>,
    offset: Option<f64>,
    wheels: Option<Vec<usize>>,
    side: Option<Side>,
    #[serde(default)]
    magnitude: bool,
}

/// Side of a vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// The left one, seen as it drives forward.
    Left,
    /// The right one.
    Right,
}

impl Side {
    /// The name in `experiment.toml`.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }
}

/// What a recorder did to a signal beside its scale.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Recorded {
    /// It is of one side of the vehicle; the planar model has the mean of both.
    pub side: Option<Side>,
    /// It has lost its sign, which is that of the wheel's speed.
    pub magnitude: bool,
}

/// What a column becomes.
#[derive(Clone, Debug)]
pub(super) enum Target {
    /// One signal, or a command or measured speed that goes to several wheels.
    Signals(Vec<String>, Scale, Recorded),
    /// A parameter of the model: rows with equal values form a run.
    Parameter(String, Scale),
    /// Seconds since the first row.
    TimeStamp,
    /// A label: rows with equal ones form a run.
    Run,
}

/// SI value = multiplier * unit * cell + offset.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    /// Sign times scale.
    pub multiplier: f64,
    pub unit: Factor,
    /// In SI.
    pub offset: f64,
    /// The unit as it is written; `None` where SI is meant.
    pub symbol: Option<String>,
}

/// A unit as a factor to SI.
#[derive(Clone, Copy, Debug)]
pub(super) enum Factor {
    Fixed(f64),
    /// A mass that stands for its weight: kilograms in one of it, to be multiplied by gravity.
    Weight(f64),
}

impl Factor {
    /// The factor for a signal in the SI unit `unit` that is written in `symbol`.
    ///
    /// # Errors
    /// A message with the units that fit.
    pub fn of_signal(unit: Unit, symbol: Option<&str>) -> Result<Self, String> {
        let Some(symbol) = symbol else { return Ok(Self::Fixed(1.0)) };
        let force = unit.symbol == Unit::NEWTON.symbol;
        match (unit.factor_of(symbol), Unit::KILOGRAM.factor_of(symbol)) {
            (Ok(factor), _) => Ok(Self::Fixed(factor)),
            (Err(_), Ok(mass)) if force => Ok(Self::Weight(mass)),
            (Err(error), _) if force => Err(format!("{error}, or kg, g, t, lb as a mass whose weight is meant")),
            (Err(error), _) => Err(error.to_string()),
        }
    }

    /// As a plain factor, where gravity (m/s2) is known.
    pub fn value(self, gravity: f64) -> f64 {
        match self {
            Self::Fixed(factor) => factor,
            Self::Weight(mass) => mass * gravity,
        }
    }
}

impl Scale {
    /// SI as it stands.
    pub fn si() -> Self {
        Self { multiplier: 1.0, unit: Factor::Fixed(1.0), offset: 0.0, symbol: None }
    }

    pub fn apply(&self, cell: f64, gravity: f64) -> f64 {
        self.multiplier * self.unit.value(gravity) * cell + self.offset
    }
}

impl Target {
    /// What an entry of `[columns]` says.
    ///
    /// # Errors
    /// A message that names the key.
    pub fn of(entry: &ColumnEntry, kind: Kind, effects: &[EffectDefinition]) -> Result<Self, String> {
        let table = match entry {
            Written::Plain(signal) => &ColumnTable { signal: Some(signal.clone()), ..ColumnTable::default() },
            Written::Table(table) => table,
        };
        let scaled = table.unit.is_some() || table.sign.is_some() || table.scale.is_some() || table.offset.is_some();
        if scaled && (table.time_stamp || table.run) {
            return Err("a time stamp or a label of a run has no `unit`, `sign`, `scale` or `offset`".to_owned());
        }
        if table.signal.is_none() && (table.wheels.is_some() || table.side.is_some() || table.magnitude) {
            return Err("`wheels`, `side` and `magnitude` are for a `signal`".to_owned());
        }
        if table.side.is_some() && !kind.format().has_course() {
            return Err("`side` is for a `traverse`: the side of the vehicle".to_owned());
        }
        match (&table.signal, &table.parameter, table.time_stamp, table.run) {
            (Some(signal), None, false, false) => table.signal(signal, kind),
            (None, Some(name), false, false) => {
                let factor = parameter_factor(name, table.unit.as_deref(), effects)?;
                Ok(Self::Parameter(name.clone(), table.scale(Factor::Fixed(factor))?))
            }
            (None, None, true, false) if kind.format().has_course() => Ok(Self::TimeStamp),
            (None, None, true, false) => Err("only a `traverse` has time".to_owned()),
            (None, None, false, true) => Ok(Self::Run),
            _ => {
                Err("expected one of `signal = \"..\"`, `parameter = \"..\"`, `time_stamp = true`, `run = true`"
                    .to_owned())
            }
        }
    }
}

impl ColumnTable {
    fn signal(&self, signal: &str, kind: Kind) -> Result<Target, String> {
        let names = self.names(signal, kind)?;
        let unit = names.first().and_then(|name| kind.format().signal_unit(name)).unwrap_or(Unit::ONE);
        let scale = self.scale(Factor::of_signal(unit, self.unit.as_deref())?)?;
        let is_driven =
            |name: &String| numbered(name).is_some_and(|(_, field, _)| field == "current" || field == "torque");
        if self.magnitude && !names.iter().all(is_driven) {
            return Err(
                "`magnitude` is for the current or torque of a rover's wheels, which takes the sign of their speed"
                    .to_owned(),
            );
        }
        if self.magnitude && self.sign == Some(-1.0) {
            return Err("a `magnitude` has no `sign`: it takes that of the wheel's speed".to_owned());
        }
        Ok(Target::Signals(names, scale, Recorded { side: self.side, magnitude: self.magnitude }))
    }

    fn scale(&self, unit: Factor) -> Result<Scale, String> {
        let sign = self.sign.unwrap_or(1.0);
        if sign.abs() != 1.0 {
            return Err(format!("`sign` is 1 or -1, not {sign}; other factors are a `scale`"));
        }
        let (scale, offset) = (self.scale.unwrap_or(1.0), self.offset.unwrap_or(0.0));
        if !scale.is_finite() || scale == 0.0 || !offset.is_finite() {
            return Err(format!("`scale` ({scale}) and `offset` ({offset}) are finite, and `scale` is not 0"));
        }
        Ok(Scale { multiplier: sign * scale, unit, offset, symbol: self.unit.clone() })
    }

    /// Names of the signals that the column gives.
    fn names(&self, signal: &str, kind: Kind) -> Result<Vec<String>, String> {
        let Some(wheels) = &self.wheels else {
            return match kind.format().signal_unit(signal) {
                Some(_) => Ok(vec![signal.to_owned()]),
                None if kind.format().signal_unit(&of_wheel(&[1], signal)).is_some() => {
                    Err(format!("`{signal}` belongs to a wheel: write `wheel[1].{signal}`, or give `wheels = [..]`"))
                }
                None => Err(unknown(signal, kind)),
            };
        };
        if kind.format().signal_unit(&of_wheel(&[1], signal)).is_none() {
            let none = kind.format().no_wheels().map(str::to_owned);
            return Err(none.unwrap_or_else(|| unknown(&of_wheel(&[1], signal), kind)));
        }
        let mut sorted = wheels.clone();
        sorted.sort_unstable();
        sorted.dedup();
        if sorted.len() != wheels.len() || sorted.first().is_none_or(|first| *first == 0) {
            return Err(format!("`wheels` = {wheels:?}: expected different numbers from 1 on"));
        }
        let sum = of_wheel(&sorted, signal);
        if signal.ends_with("command") || signal == "speed" || signal == "rim_speed" {
            Ok(sorted.iter().map(|wheel| of_wheel(&[*wheel], signal)).collect())
        } else if kind.format().signal_unit(&sum).is_some() {
            Ok(vec![sum])
        } else {
            Err(format!(
                "no meaning is known for the sum of `{signal}` over wheels; `wheels` sums current, torque, normal_force and drawbar_pull, and hands one command, or one speed that drives, to several wheels"
            ))
        }
    }
}

/// `wheel[1+2].current`, a sum where there are several numbers.
fn of_wheel(wheels: &[usize], field: &str) -> String {
    let numbers: Vec<String> = wheels.iter().map(ToString::to_string).collect();
    format!("wheel[{}].{field}", numbers.join("+"))
}

fn unknown(signal: &str, kind: Kind) -> String {
    let near = vocabulary::alike(kind, signal);
    let near = if near.is_empty() { String::new() } else { format!("did you mean {}? ", near.join(", ")) };
    let known = kind.format().signal_names().join(", ");
    format!("`{signal}` is no signal of a `{}` experiment; {near}known are {known}", kind.name())
}
