//! Units in which people record, and what they are in SI.

use crate::Unit;
use std::fmt;

/// A unit that is not SI, by one or more spellings.
struct RecordedUnit {
    /// The SI unit that it is converted to.
    si: Unit,
    /// Spellings, the usual one first.
    symbols: &'static [&'static str],
    /// One of this unit in SI.
    factor: f64,
}

const fn recorded(si: Unit, symbols: &'static [&'static str], factor: f64) -> RecordedUnit {
    RecordedUnit { si, symbols, factor }
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// Revolution a minute, rad/s.
const RPM: f64 = std::f64::consts::PI / 30.0;
/// Standard gravity, m/s2, by which the units of force that are named after masses are defined.
pub const STANDARD_GRAVITY: f64 = 9.80665;
/// Pound (avoirdupois), kg.
const POUND: f64 = 0.453_592_37;
const INCH: f64 = 0.0254;

/// All units beside those of [`Unit`] in which a column or a parameter may be given.
const RECORDED_UNITS: &[RecordedUnit] = &[
    recorded(Unit::ONE, &["%", "percent", "per cent", "pct"], 1e-2),
    recorded(Unit::SECOND, &["ms", "msec"], 1e-3),
    recorded(Unit::SECOND, &["us"], 1e-6),
    recorded(Unit::SECOND, &["ns"], 1e-9),
    recorded(Unit::SECOND, &["min"], 60.0),
    recorded(Unit::SECOND, &["h"], 3600.0),
    recorded(Unit::METRE, &["mm"], 1e-3),
    recorded(Unit::METRE, &["cm"], 1e-2),
    recorded(Unit::METRE, &["um"], 1e-6),
    recorded(Unit::METRE, &["km"], 1e3),
    recorded(Unit::METRE, &["in", "inch"], INCH),
    recorded(Unit::METRE, &["ft"], 12.0 * INCH),
    recorded(Unit::PER_METRE, &["1/mm"], 1e3),
    recorded(Unit::PER_METRE, &["1/cm"], 1e2),
    recorded(Unit::METRE_PER_SECOND, &["cm/s"], 1e-2),
    recorded(Unit::METRE_PER_SECOND, &["mm/s"], 1e-3),
    recorded(Unit::METRE_PER_SECOND, &["km/h", "kph", "kmh"], 1.0 / 3.6),
    recorded(Unit::METRE_PER_SECOND, &["m/min"], 1.0 / 60.0),
    recorded(Unit::METRE_PER_SECOND, &["mph"], 0.44704),
    recorded(Unit::METRE_PER_SECOND2, &["cm/s2"], 1e-2),
    recorded(Unit::METRE_PER_SECOND2, &["mm/s2"], 1e-3),
    recorded(Unit::RADIAN, &["deg", "°", "degree", "degrees"], DEGREE),
    recorded(Unit::RADIAN, &["mrad"], 1e-3),
    recorded(Unit::RADIAN_PER_SECOND, &["rpm", "1/min", "rev/min", "r/min", "U/min"], RPM),
    recorded(Unit::RADIAN_PER_SECOND, &["deg/s", "°/s", "dps"], DEGREE),
    recorded(Unit::RADIAN_PER_SECOND, &["rev/s", "rps"], 60.0 * RPM),
    recorded(Unit::KILOGRAM, &["g"], 1e-3),
    recorded(Unit::KILOGRAM, &["t"], 1e3),
    recorded(Unit::KILOGRAM, &["lb", "lbs"], POUND),
    recorded(Unit::KILOGRAM_METRE2, &["kg.cm2"], 1e-4),
    recorded(Unit::KILOGRAM_METRE2, &["g.cm2"], 1e-7),
    recorded(Unit::NEWTON, &["kN"], 1e3),
    recorded(Unit::NEWTON, &["mN"], 1e-3),
    recorded(Unit::NEWTON, &["daN"], 10.0),
    recorded(Unit::NEWTON, &["kgf", "kp"], STANDARD_GRAVITY),
    recorded(Unit::NEWTON, &["gf"], 1e-3 * STANDARD_GRAVITY),
    recorded(Unit::NEWTON, &["lbf"], POUND * STANDARD_GRAVITY),
    recorded(Unit::NEWTON_PER_METRE, &["N/mm"], 1e3),
    recorded(Unit::NEWTON_PER_METRE, &["N/cm"], 1e2),
    recorded(Unit::NEWTON_PER_METRE, &["kN/m"], 1e3),
    recorded(Unit::NEWTON_PER_METRE3, &["kN/m3"], 1e3),
    recorded(Unit::NEWTON_METRE, &["mN.m", "mNm"], 1e-3),
    recorded(Unit::NEWTON_METRE, &["kN.m", "kNm"], 1e3),
    recorded(Unit::NEWTON_METRE, &["N.mm", "Nmm"], 1e-3),
    recorded(Unit::NEWTON_METRE, &["N.cm", "Ncm"], 1e-2),
    recorded(Unit::NEWTON_METRE, &["kgf.cm"], 1e-2 * STANDARD_GRAVITY),
    recorded(Unit::NEWTON_METRE, &["lbf.ft", "ft.lbf"], 12.0 * INCH * POUND * STANDARD_GRAVITY),
    recorded(Unit::NEWTON_METRE, &["lbf.in", "in.lbf"], INCH * POUND * STANDARD_GRAVITY),
    recorded(Unit::NEWTON_METRE, &["Nm"], 1.0),
    recorded(Unit::PASCAL, &["kPa"], 1e3),
    recorded(Unit::PASCAL, &["MPa", "N/mm2"], 1e6),
    recorded(Unit::PASCAL, &["hPa", "mbar"], 1e2),
    recorded(Unit::PASCAL, &["bar"], 1e5),
    recorded(Unit::PASCAL, &["N/cm2"], 1e4),
    recorded(Unit::PASCAL, &["psi"], POUND * STANDARD_GRAVITY / (INCH * INCH)),
    recorded(Unit::COHESIVE_MODULUS, &["kN/m^(n+1)"], 1e3),
    recorded(Unit::FRICTIONAL_MODULUS, &["kN/m^(n+2)", "kPa/m^n"], 1e3),
    recorded(Unit::WATT, &["mW"], 1e-3),
    recorded(Unit::WATT, &["kW"], 1e3),
    recorded(Unit::JOULE, &["kJ"], 1e3),
    recorded(Unit::JOULE, &["Wh"], 3600.0),
    recorded(Unit::AMPERE, &["mA"], 1e-3),
    recorded(Unit::VOLT, &["mV"], 1e-3),
    recorded(Unit::OHM, &["mOhm"], 1e-3),
    recorded(Unit::NEWTON_METRE_PER_AMPERE, &["mN.m/A", "mNm/A"], 1e-3),
    recorded(Unit::NEWTON_METRE_PER_AMPERE, &["Nm/A"], 1.0),
    recorded(Unit::NEWTON_METRE_PER_AMPERE, &["N.cm/A"], 1e-2),
];

/// Why a unit does not fit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitError {
    /// The unit as it was written.
    pub symbol: String,
    /// The SI unit that it was to be converted to.
    pub si: &'static str,
    /// The SI unit that it would be converted to; `None` where the unit is unknown.
    pub other: Option<&'static str>,
    /// Units that fit, SI first.
    pub fits: Vec<&'static str>,
}

impl fmt::Display for UnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.other {
            None => write!(f, "unknown unit `{}`", self.symbol)?,
            Some(other) => write!(f, "the unit `{}` is a multiple of {other}, not of {}", self.symbol, self.si)?,
        }
        write!(f, "; expected one of {}", self.fits.join(", "))
    }
}

impl std::error::Error for UnitError {}

impl Unit {
    /// What one of the unit written as `symbol` is in this unit: 0.001 for `mm` in metres.
    ///
    /// A space, a dot or an asterisk joins factors (`N m`, `N.m`, `N*m`); square or round brackets around the symbol are
    /// left out; capitals count only where two units differ in nothing else.
    ///
    /// # Errors
    /// [`UnitError`] for an unknown unit and for one that measures something else, with those that fit.
    pub fn factor_of(self, symbol: &str) -> Result<f64, UnitError> {
        let plain = normal(symbol);
        let here = || self.recorded().flat_map(|unit| unit.symbols.iter().map(move |known| (*known, unit.factor)));
        let all = || std::iter::once((self.symbol, 1.0)).chain(here());
        let exact = all().find(|(known, _)| normal(known) == plain);
        let found = exact.or_else(|| all().find(|(known, _)| normal(known).eq_ignore_ascii_case(&plain)));
        found.map(|(_, factor)| factor).ok_or_else(|| UnitError {
            symbol: symbol.to_owned(),
            si: self.symbol,
            other: Unit::spelled(symbol).map(|(unit, _)| unit.symbol),
            fits: self.symbols(),
        })
    }

    /// The SI unit that `symbol` is a multiple of, and the factor; `None` for an unknown unit. Capitals count here.
    #[must_use]
    pub fn spelled(symbol: &str) -> Option<(Unit, f64)> {
        let plain = normal(symbol);
        let recorded = RECORDED_UNITS.iter().find(|unit| unit.symbols.iter().any(|known| normal(known) == plain));
        recorded.map(|unit| (unit.si, unit.factor)).or_else(|| {
            let si = if plain.is_empty() { None } else { Unit::of_symbol(&plain) };
            si.map(|unit| (unit, 1.0))
        })
    }

    /// Symbols of the units in which this quantity may be given: SI first, each by its usual spelling.
    #[must_use]
    pub fn symbols(self) -> Vec<&'static str> {
        std::iter::once(self.symbol).chain(self.recorded().map(|unit| unit.symbols[0])).collect()
    }

    fn recorded(self) -> impl Iterator<Item = &'static RecordedUnit> {
        RECORDED_UNITS.iter().filter(move |unit| unit.si.symbol == self.symbol)
    }
}

/// A symbol in one spelling: without brackets around it, factors joined by dots.
fn normal(symbol: &str) -> String {
    let inner = symbol.trim();
    let bracketed = [('[', ']'), ('(', ')'), ('{', '}')]
        .iter()
        .find_map(|(open, close)| inner.strip_prefix(*open).and_then(|rest| rest.strip_suffix(*close)));
    let inner = bracketed.unwrap_or(inner).trim();
    inner.replace([' ', '*', '·', '×'], ".").replace('²', "2").replace('³', "3").replace(['µ', 'μ'], "u")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
    use super::*;

    /// The published factors have seven digits: half a unit of the last, where the first is 1.
    const SEVEN_DIGITS: f64 = 5e-7;

    #[test]
    fn agreement_display_units_are_recorded_units_too() {
        for unit in Unit::ALL {
            let Some(display) = unit.display else { continue };
            let factor = unit.factor_of(display.symbol).unwrap();
            assert!((factor * display.factor - 1.0).abs() < 1e-15, "{}", display.symbol);
        }
    }

    #[test]
    fn property_spellings_are_unambiguous() {
        for unit in RECORDED_UNITS {
            for symbol in unit.symbols {
                assert_eq!(unit.si.factor_of(symbol).unwrap(), unit.factor, "{symbol}");
                let alike = |other: &&RecordedUnit| other.symbols.iter().any(|s| s.eq_ignore_ascii_case(symbol));
                let same: Vec<_> =
                    RECORDED_UNITS.iter().filter(alike).filter(|o| o.si.symbol == unit.si.symbol).collect();
                assert_eq!(same.len(), 1, "capitals alone tell `{symbol}` from another unit of {}", unit.si.symbol);
            }
        }
    }

    #[test]
    fn published_factors() {
        // NIST special publication 811, appendix B.8.
        let cases = [
            (Unit::PASCAL, "psi", 6.894_757e3),
            (Unit::NEWTON, "lbf", 4.448_222),
            (Unit::NEWTON_METRE, "ft lbf", 1.355_818),
            (Unit::METRE_PER_SECOND, "km/h", 2.777_778e-1),
            (Unit::RADIAN_PER_SECOND, "[RPM]", 1.047_198e-1),
            (Unit::RADIAN, "°", 1.745_329e-2),
            (Unit::NEWTON_METRE, "N·mm", 1e-3),
        ];
        for (unit, symbol, factor) in cases {
            let found = unit.factor_of(symbol).unwrap();
            assert!((found / factor - 1.0).abs() < SEVEN_DIGITS, "{symbol}: {found}");
        }
    }

    #[test]
    fn property_what_does_not_fit_is_refused_with_what_does() {
        let unknown = Unit::METRE.factor_of("furlong").unwrap_err().to_string();
        assert_eq!(unknown, "unknown unit `furlong`; expected one of m, mm, cm, um, km, in, ft");
        let other = Unit::NEWTON.factor_of("kg").unwrap_err().to_string();
        assert!(other.starts_with("the unit `kg` is a multiple of kg, not of N"), "{other}");
    }
}
