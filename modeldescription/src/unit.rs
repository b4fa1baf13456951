//! Units: a symbol, its SI exponents, and the unit in which people like to read it.

/// Powers of the SI base units (and of the radian) of which a unit consists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Exponents {
    /// Kilogram.
    pub kg: i8,
    /// Metre.
    pub m: i8,
    /// Second.
    pub s: i8,
    /// Ampere.
    pub a: i8,
    /// Kelvin.
    pub k: i8,
    /// Radian.
    pub rad: i8,
}

/// A unit for displays: `shown = factor * si + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplayUnit {
    /// Symbol, for example `deg`.
    pub symbol: &'static str,
    /// Factor from SI to this unit.
    pub factor: f64,
    /// Offset from SI to this unit.
    pub offset: f64,
}

/// A coherent SI unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Symbol, for example `N.m`.
    pub symbol: &'static str,
    /// SI exponents; `None` where they depend on another parameter (Bekker's moduli, whose length
    /// exponent is the sinkage exponent plus one or two).
    pub exponents: Option<Exponents>,
    /// How people like to read it.
    pub display: Option<DisplayUnit>,
}

const NONE: Exponents = Exponents { kg: 0, m: 0, s: 0, a: 0, k: 0, rad: 0 };

const fn display(symbol: &'static str, factor: f64) -> Option<DisplayUnit> {
    Some(DisplayUnit { symbol, factor, offset: 0.0 })
}

const fn unit(symbol: &'static str, exponents: Exponents) -> Unit {
    Unit { symbol, exponents: Some(exponents), display: None }
}

impl Unit {
    /// Dimensionless.
    pub const ONE: Unit = unit("1", NONE);
    /// Second.
    pub const SECOND: Unit = unit("s", Exponents { s: 1, ..NONE });
    /// Kelvin.
    pub const KELVIN: Unit = unit("K", Exponents { k: 1, ..NONE });
    /// Kelvin a second.
    pub const KELVIN_PER_SECOND: Unit = unit("K/s", Exponents { k: 1, s: -1, ..NONE });
    /// Kelvin a watt: thermal resistance.
    pub const KELVIN_PER_WATT: Unit = unit("K/W", Exponents { kg: -1, m: -2, s: 3, k: 1, ..NONE });
    /// Metre, shown in millimetres.
    pub const METRE: Unit = Unit { display: display("mm", 1e3), ..unit("m", Exponents { m: 1, ..NONE }) };
    /// One per metre.
    pub const PER_METRE: Unit = unit("1/m", Exponents { m: -1, ..NONE });
    /// Radian, shown in degrees.
    pub const RADIAN: Unit =
        Unit { display: display("deg", 180.0 / std::f64::consts::PI), ..unit("rad", Exponents { rad: 1, ..NONE }) };
    /// Metre a second, shown in centimetres a second.
    pub const METRE_PER_SECOND: Unit =
        Unit { display: display("cm/s", 1e2), ..unit("m/s", Exponents { m: 1, s: -1, ..NONE }) };
    /// Metre a second squared.
    pub const METRE_PER_SECOND2: Unit = unit("m/s2", Exponents { m: 1, s: -2, ..NONE });
    /// Radian a second, shown in revolutions a minute.
    pub const RADIAN_PER_SECOND: Unit = Unit {
        display: display("rpm", 30.0 / std::f64::consts::PI),
        ..unit("rad/s", Exponents { rad: 1, s: -1, ..NONE })
    };
    /// Radian a second squared.
    pub const RADIAN_PER_SECOND2: Unit = unit("rad/s2", Exponents { rad: 1, s: -2, ..NONE });
    /// Kilogram.
    pub const KILOGRAM: Unit = unit("kg", Exponents { kg: 1, ..NONE });
    /// Kilogram metre squared.
    pub const KILOGRAM_METRE2: Unit = unit("kg.m2", Exponents { kg: 1, m: 2, ..NONE });
    /// Newton.
    pub const NEWTON: Unit = unit("N", Exponents { kg: 1, m: 1, s: -2, ..NONE });
    /// Newton a metre.
    pub const NEWTON_PER_METRE: Unit = unit("N/m", Exponents { kg: 1, s: -2, ..NONE });
    /// Newton a cubic metre, a unit weight.
    pub const NEWTON_PER_METRE3: Unit = unit("N/m3", Exponents { kg: 1, m: -2, s: -2, ..NONE });
    /// Metre a newton, a compliance.
    pub const METRE_PER_NEWTON: Unit = unit("m/N", Exponents { kg: -1, s: 2, ..NONE });
    /// Newton second a metre.
    pub const NEWTON_SECOND_PER_METRE: Unit = unit("N.s/m", Exponents { kg: 1, s: -1, ..NONE });
    /// Newton metre.
    pub const NEWTON_METRE: Unit = unit("N.m", Exponents { kg: 1, m: 2, s: -2, ..NONE });
    /// One per newton metre.
    pub const PER_NEWTON_METRE: Unit = unit("1/(N.m)", Exponents { kg: -1, m: -2, s: 2, ..NONE });
    /// Newton metre second a radian.
    pub const NEWTON_METRE_SECOND: Unit = unit("N.m.s/rad", Exponents { kg: 1, m: 2, s: -1, rad: -1, ..NONE });
    /// Newton metre second squared a radian, a derivative gain on wheel speed.
    pub const NEWTON_METRE_SECOND2_PER_RADIAN: Unit = unit("N.m.s2/rad", Exponents { kg: 1, m: 2, rad: -1, ..NONE });
    /// Newton metre a radian.
    pub const NEWTON_METRE_PER_RADIAN: Unit = unit("N.m/rad", Exponents { kg: 1, m: 2, s: -2, rad: -1, ..NONE });
    /// Pascal, shown in kilopascal.
    pub const PASCAL: Unit =
        Unit { display: display("kPa", 1e-3), ..unit("Pa", Exponents { kg: 1, m: -1, s: -2, ..NONE }) };
    /// Cohesive modulus of Bekker, N/m^(n+1).
    pub const COHESIVE_MODULUS: Unit = Unit { symbol: "N/m^(n+1)", exponents: None, display: None };
    /// Frictional modulus of Bekker, N/m^(n+2).
    pub const FRICTIONAL_MODULUS: Unit = Unit { symbol: "N/m^(n+2)", exponents: None, display: None };
    /// Watt.
    pub const WATT: Unit = unit("W", Exponents { kg: 1, m: 2, s: -3, ..NONE });
    /// Joule.
    pub const JOULE: Unit = unit("J", Exponents { kg: 1, m: 2, s: -2, ..NONE });
    /// Ampere.
    pub const AMPERE: Unit = unit("A", Exponents { a: 1, ..NONE });
    /// One per ampere.
    pub const PER_AMPERE: Unit = unit("1/A", Exponents { a: -1, ..NONE });
    /// Volt.
    pub const VOLT: Unit = unit("V", Exponents { kg: 1, m: 2, s: -3, a: -1, ..NONE });
    /// One per volt.
    pub const PER_VOLT: Unit = unit("1/V", Exponents { kg: -1, m: -2, s: 3, a: 1, ..NONE });
    /// Ohm.
    pub const OHM: Unit = unit("Ohm", Exponents { kg: 1, m: 2, s: -3, a: -2, ..NONE });
    /// Newton metre an ampere (torque constant).
    pub const NEWTON_METRE_PER_AMPERE: Unit = unit("N.m/A", Exponents { kg: 1, m: 2, s: -2, a: -1, ..NONE });
    /// Newton metre second a radian, as a controller's proportional gain on wheel speed; the same dimension.
    pub const SPEED_GAIN: Unit = Unit::NEWTON_METRE_SECOND;
    /// One per second.
    pub const PER_SECOND: Unit = unit("1/s", Exponents { s: -1, ..NONE });
    /// One per second squared.
    pub const PER_SECOND2: Unit = unit("1/s2", Exponents { s: -2, ..NONE });

    /// All units of the vocabulary, each symbol once.
    pub const ALL: &[Unit] = &[
        Unit::ONE,
        Unit::SECOND,
        Unit::KELVIN,
        Unit::METRE,
        Unit::PER_METRE,
        Unit::RADIAN,
        Unit::METRE_PER_SECOND,
        Unit::METRE_PER_SECOND2,
        Unit::RADIAN_PER_SECOND,
        Unit::KILOGRAM,
        Unit::KILOGRAM_METRE2,
        Unit::NEWTON,
        Unit::NEWTON_PER_METRE,
        Unit::NEWTON_SECOND_PER_METRE,
        Unit::NEWTON_METRE,
        Unit::PER_NEWTON_METRE,
        Unit::NEWTON_METRE_SECOND,
        Unit::NEWTON_METRE_SECOND2_PER_RADIAN,
        Unit::NEWTON_METRE_PER_RADIAN,
        Unit::PASCAL,
        Unit::COHESIVE_MODULUS,
        Unit::FRICTIONAL_MODULUS,
        Unit::WATT,
        Unit::JOULE,
        Unit::AMPERE,
        Unit::PER_AMPERE,
        Unit::VOLT,
        Unit::PER_VOLT,
        Unit::OHM,
        Unit::NEWTON_METRE_PER_AMPERE,
        Unit::PER_SECOND,
        Unit::PER_SECOND2,
    ];

    /// The unit with this symbol; a space or an asterisk may stand for the dot, and nothing for `1`.
    #[must_use]
    pub fn of_symbol(symbol: &str) -> Option<Unit> {
        let plain = symbol.trim().replace([' ', '*'], ".");
        let wanted = if plain.is_empty() { Unit::ONE.symbol } else { plain.as_str() };
        Self::ALL.iter().copied().find(|unit| unit.symbol == wanted)
    }
}
