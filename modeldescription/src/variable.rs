//! One entry of the vocabulary.

use crate::Unit;
use std::borrow::Cow;

/// What a calibration may do with a parameter by default.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Taken as known unless the user frees it.
    Fixed,
    /// A dimension or mass of the rig or vehicle, or gravity: taken as known, and what an experiment states of it holds
    /// against a model.
    Rig,
    /// Free in a default calibration.
    Calibrated,
    /// Of an effect: neutral unless the effect is switched on, and free where a diagnosis tries the effect.
    Effect,
    /// Not a parameter: a signal that the model computes.
    Signal,
}

/// Name, meaning, unit, default, bounds and source of a parameter or signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Full name, for example `wheel[2].slip`: the same in Rust, TOML, FMU, Python and CSV headers.
    pub name: String,
    /// One line of meaning.
    pub doc: Cow<'static, str>,
    /// SI unit.
    pub unit: Unit,
    /// Default; for a parameter of an effect this is the neutral value, at which nothing changes.
    pub default: f64,
    /// Smallest allowed value.
    pub min: f64,
    /// Largest allowed value.
    pub max: f64,
    /// Whether a default calibration may move it.
    pub role: Role,
    /// Where the default, the bounds or the equation come from.
    pub source: Cow<'static, str>,
}

impl Variable {
    /// Whether `value` is finite and within the bounds.
    #[must_use]
    pub fn allows(&self, value: f64) -> bool {
        value.is_finite() && value >= self.min && value <= self.max
    }

    /// The allowed range in words, for error messages: `0 .. 50000 Pa`.
    #[must_use]
    pub fn range(&self) -> String {
        format!("{} .. {} {}", self.min, self.max, self.unit.symbol)
    }
}
