//! Values of `experiment.toml` that may be written short, or as a table with more to say.

use super::error::{ExperimentError, Problem};
use super::vocabulary;
use crate::effects::EffectDefinition;
use bekker_modeldescription::Unit;
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{Deserializer, Error, IntoDeserializer, MapAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;
use std::path::Path;

/// A plain value, or a table.
#[derive(Clone, Debug)]
pub(super) enum Written<P, T> {
    Plain(P),
    Table(T),
}

impl<'de, P: Deserialize<'de>, T: Deserialize<'de>> Deserialize<'de> for Written<P, T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Either(PhantomData))
    }
}

/// Decides by the type of what is there, so that errors stay those of the plain value or of the table.
struct Either<P, T>(PhantomData<(P, T)>);

impl<'de, P: Deserialize<'de>, T: Deserialize<'de>> Visitor<'de> for Either<P, T> {
    type Value = Written<P, T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a plain value or a table")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
        let plain: StrDeserializer<'_, E> = text.into_deserializer();
        P::deserialize(plain).map(Written::Plain)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Self::Value, E> {
        P::deserialize(number.into_deserializer()).map(Written::Plain)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Self::Value, E> {
        P::deserialize(number.into_deserializer()).map(Written::Plain)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(Written::Table)
    }
}

/// A number in SI, or with its unit.
pub(super) type Quantity = Written<f64, WithUnit>;

/// `{ value = 3.0, unit = "kPa" }`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WithUnit {
    pub value: f64,
    pub unit: String,
}

impl Quantity {
    /// Number as written, and its unit where it has one.
    pub fn parts(&self) -> (f64, Option<&str>) {
        match self {
            Self::Plain(number) => (*number, None),
            Self::Table(WithUnit { value, unit }) => (*value, Some(unit)),
        }
    }
}

/// A prior: a deviation alone, or a table.
pub(super) type PriorEntry = Written<f64, PriorTable>;

impl PriorEntry {
    /// Mean and standard deviation as written, and their unit where it is.
    ///
    /// # Errors
    /// A message where the standard deviation is none.
    pub fn parts(&self) -> Result<(Option<f64>, f64, Option<&str>), String> {
        let (mean, deviation, unit) = match self {
            Self::Plain(deviation) => (None, *deviation, None),
            Self::Table(table) => (table.mean, table.sd, table.unit.as_deref()),
        };
        if deviation.is_finite() && deviation > 0.0 {
            return Ok((mean, deviation, unit));
        }
        Err(format!("a standard deviation is positive and finite, not {deviation}"))
    }
}

/// `{ mean = 3.0, sd = 0.5, unit = "kPa" }`; without a mean it stands about the value in `[parameters]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PriorTable {
    pub mean: Option<f64>,
    pub sd: f64,
    pub unit: Option<String>,
}

/// Factor from a unit to SI for a parameter; 1 where no unit is written.
pub(super) fn parameter_factor(name: &str, unit: Option<&str>, effects: &[EffectDefinition]) -> Result<f64, String> {
    match unit {
        None => Ok(1.0),
        Some(unit) => {
            let si: Unit = vocabulary::parameter(name, effects)?.unit;
            si.factor_of(unit).map_err(|error| error.to_string())
        }
    }
}

/// The text of the settings, which turns byte offsets into lines; all errors of the settings are reported through it.
#[derive(Clone, Copy)]
pub(super) struct SettingsText<'a> {
    pub path: &'a Path,
    pub text: &'a str,
}

impl SettingsText<'_> {
    pub fn error(&self, key: &str, at: usize, message: String) -> ExperimentError {
        let error = ExperimentError::in_file(self.path, Problem::Setting(message));
        error.at_line(self.line(at)).at_column(key)
    }

    /// Line of a byte offset, counted from 1.
    pub fn line(&self, at: usize) -> u64 {
        self.text.as_bytes()[..at.min(self.text.len())].iter().filter(|byte| **byte == b'\n').count() as u64 + 1
    }
}
