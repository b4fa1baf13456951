//! Numbers in the units in which people read them.

use crate::signals::{BodySignals, LinkSignals, WheelSignals};
use crate::soil_test::SoilTestSignals;
use bekker_modeldescription::{Lookup, Unit, Variable};

/// How a quantity is written for people: its name in words, and the factor from SI to the unit in which it is read.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ForPeople {
    /// `drawbar pull`, `torque of wheel 1`; the name itself for a parameter.
    pub name: String,
    /// Symbol of the unit; empty for a number without one.
    pub unit: &'static str,
    /// Factor from SI to that unit.
    pub factor: f64,
}

/// A column of an experiment for people.
#[must_use]
pub fn column_for_people(name: &str) -> ForPeople {
    let shown = of_column(name);
    ForPeople { name: spoken(name), unit: shown.symbol, factor: shown.factor }
}

/// A parameter for people.
#[must_use]
pub fn parameter_for_people(variable: &Variable) -> ForPeople {
    let shown = of_unit(variable.unit);
    ForPeople { name: variable.name.clone(), unit: shown.symbol, factor: shown.factor }
}

/// A display unit: symbol and factor from SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shown {
    pub symbol: &'static str,
    pub factor: f64,
}

impl Shown {
    fn of(unit: Unit) -> Self {
        match unit.display {
            Some(display) => Self { symbol: display.symbol, factor: display.factor },
            None => Self { symbol: if unit.symbol == "1" { "" } else { unit.symbol }, factor: 1.0 },
        }
    }

    /// `value` (SI) with its unit.
    pub fn number(&self, value: f64) -> String {
        format!("{} {}", digits(value * self.factor), self.symbol).trim_end().to_owned()
    }

    /// `value` (SI) with its unit, without trailing zeros: for set-points and bounds.
    pub fn plain(&self, value: f64) -> String {
        format!("{} {}", short(value * self.factor), self.symbol).trim_end().to_owned()
    }

    /// `name` with the unit, for an axis.
    pub fn axis(&self, name: &str) -> String {
        if self.symbol.is_empty() { name.to_owned() } else { format!("{name} ({})", self.symbol) }
    }
}

/// Display unit of a parameter.
pub(super) fn of_unit(unit: Unit) -> Shown {
    Shown::of(unit)
}

/// Display unit of a column of an experiment: a signal, an input or time. Speeds of wheels stay in rad/s, in which
/// they are commanded, and positions in m.
pub(super) fn of_column(name: &str) -> Shown {
    let field = name.rsplit('.').next().unwrap_or(name);
    let unit = match field {
        "time" => Unit::SECOND,
        "load" => Unit::NEWTON,
        "torque_command" => Unit::NEWTON_METRE,
        "speed" | "wheel_speed" | "speed_command" => return Shown { symbol: "rad/s", factor: 1.0 },
        "x" | "z" => return Shown { symbol: "m", factor: 1.0 },
        _ => {
            let (mut wheel, mut body, mut link) =
                (WheelSignals::default(), BodySignals::default(), LinkSignals::default());
            let mut test = SoilTestSignals::default();
            let mut listed = wheel.list().into_iter().chain(body.list()).chain(link.list()).chain(test.list());
            listed.find(|(variable, _)| variable.name == field).map_or(Unit::ONE, |(variable, _)| variable.unit)
        }
    };
    Shown::of(unit)
}

/// A name as people say it: `drawbar_pull` is drawbar pull, `wheel[1].torque` is torque of wheel 1.
pub(super) fn spoken(name: &str) -> String {
    match (name, wheel_and_field(name)) {
        ("x", _) => "position x".to_owned(),
        ("z", _) => "height z".to_owned(),
        (_, Some((wheel, field))) => format!("{} of wheel {wheel}", field.replace('_', " ")),
        _ => match numbered("link[", name) {
            Some((link, field)) => format!("{} of link {link}", field.replace('_', " ")),
            None => name.replace('_', " "),
        },
    }
}

/// Number and quantity of a wheel's signal.
pub(super) fn wheel_and_field(signal: &str) -> Option<(usize, &str)> {
    numbered("wheel[", signal)
}

/// Number and quantity of a signal such as `link[1].angle`; `opening` is `link[`.
fn numbered<'a>(opening: &str, signal: &'a str) -> Option<(usize, &'a str)> {
    let (number, field) = signal.strip_prefix(opening)?.split_once("].")?;
    Some((number.parse().ok()?, field))
}

/// Three significant digits, without an exponent where that is short.
pub(super) fn digits(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.2e}")
    }
}

/// Three significant digits without trailing zeros, without an exponent where that is short.
#[must_use]
pub fn short(value: f64) -> String {
    let text = digits(value);
    if text.contains('e') {
        text.replace(".00e", "e")
    } else if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}
