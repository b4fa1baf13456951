//! Quantities of units, from which declared types follow, and further units to read them in.

use super::{Description, Kind};
use crate::Unit;
use crate::unit::DisplayUnit;

/// Name of the physical quantity that a unit measures, after ISO 80000 and as a type name; `None` for units of
/// gains and moduli, which have none.
pub(super) fn quantity(unit: &Unit) -> Option<&'static str> {
    Some(match unit.symbol {
        "s" => "Time",
        "K" => "Temperature",
        "K/W" => "ThermalResistance",
        "m" => "Length",
        "1/m" => "Curvature",
        "rad" => "Angle",
        "m/s" => "Velocity",
        "m/s2" => "Acceleration",
        "rad/s" => "AngularVelocity",
        "kg" => "Mass",
        "kg.m2" => "MomentOfInertia",
        "N" => "Force",
        "N/m3" => "WeightDensity",
        "N.m" => "Torque",
        "Pa" => "Pressure",
        "W" => "Power",
        "J" => "Energy",
        "A" => "ElectricCurrent",
        "V" => "Voltage",
        "Ohm" => "Resistance",
        _ => return None,
    })
}

/// The units in which a unit can be shown; the first is the usual one.
pub(super) fn displays(unit: &Unit) -> Vec<DisplayUnit> {
    let mut displays: Vec<DisplayUnit> = unit.display.into_iter().collect();
    if *unit == Unit::METRE {
        displays.push(DisplayUnit { symbol: "cm", factor: 1e2, offset: 0.0 });
    }
    displays
}

/// Each of `units` once, in the order of first use.
pub(super) fn distinct(units: impl Iterator<Item = Unit>) -> Vec<Unit> {
    let mut seen: Vec<Unit> = Vec::new();
    for unit in units {
        if seen.iter().all(|other| other.symbol != unit.symbol) {
            seen.push(unit);
        }
    }
    seen
}

/// Each unit of the variables once, in the order of first use.
pub(super) fn units(description: &Description) -> Vec<Unit> {
    let numbers = description.entries.iter().filter(|entry| entry.kind == Kind::Real);
    let mut seen = distinct(numbers.map(|entry| entry.variable.unit));
    if seen.iter().all(|unit| unit.symbol != Unit::ONE.symbol) {
        seen.push(Unit::ONE);
    }
    seen
}
