//! One line of a proposed `[columns]`.

use super::super::columns::quoted;
use super::super::mapping::Side;

/// What a column becomes, and why.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::measurement) struct Entry {
    pub target: To,
    /// Its unit; `None` for SI.
    pub unit: Option<String>,
    pub turned: bool,
    /// The side of the vehicle whose other side has a column too.
    pub side: Option<Side>,
    /// Why this is a guess; empty where the name says it all.
    pub guesses: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub(in crate::measurement) enum To {
    Signal(String),
    /// A field of these wheels.
    Wheels(String, Vec<usize>),
    Parameter(String),
    TimeStamp,
    Run,
}

impl Entry {
    pub fn to(target: To) -> Self {
        Self { target, unit: None, turned: false, side: None, guesses: Vec::new() }
    }

    /// The signal, or the field of wheels.
    pub fn signal(&self) -> Option<&str> {
        match &self.target {
            To::Signal(name) | To::Wheels(name, _) => Some(name),
            To::TimeStamp => Some("time"),
            To::Parameter(_) | To::Run => None,
        }
    }

    /// The line of `[columns]`; `None` where the column's own name says it.
    pub fn line(&self, column: &str) -> Option<String> {
        let mut keys = match &self.target {
            To::Signal(name) if name == column && self.unit.is_none() && !self.turned && self.side.is_none() => {
                return None;
            }
            To::Signal(name) => vec![format!("signal = {}", quoted(name))],
            To::Wheels(name, wheels) => vec![format!("signal = {}", quoted(name)), format!("wheels = {wheels:?}")],
            To::Parameter(name) => vec![format!("parameter = {}", quoted(name))],
            To::TimeStamp => vec!["time_stamp = true".to_owned()],
            To::Run => vec!["run = true".to_owned()],
        };
        keys.extend(self.unit.iter().map(|unit| format!("unit = {}", quoted(unit))));
        keys.extend(self.turned.then(|| "sign = -1".to_owned()));
        keys.extend(self.side.map(|side| format!("side = \"{}\"", side.name())));
        Some(format!("{} = {{ {} }}", quoted(column), keys.join(", ")))
    }
}
