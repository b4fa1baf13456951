//! What is not known exactly of the sensor of a signal: how late it records, in what proportion, and from which zero.
//!
//! ```text
//! recorded(t) = gain * signal(t - delay) + bias
//! ```

use super::checker::Checker;
use super::error::ExperimentError;
use super::experiment::{Experiment, Prior};
use super::written::PriorEntry;
use bekker_modeldescription::{Role, Unit, Variable};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use toml::Spanned;

/// Beginning of the names of parameters that are errors of sensors.
const PREFIX: &str = "sensors.";

/// Standard deviations of its prior within which an error of a sensor is sought: beyond them the prior is wrong.
const WITHIN: f64 = 6.0;

/// An error of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorError {
    /// Time by which the record is behind the signal, s.
    Delay,
    /// Recorded over true changes.
    Gain,
    /// What a true zero is recorded as, in the signal's unit.
    Bias,
}

impl SensorError {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Delay, Self::Gain, Self::Bias];

    /// The key in `experiment.toml`, and the end of the parameter's name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Delay => "delay",
            Self::Gain => "gain",
            Self::Bias => "bias",
        }
    }

    /// The value of a perfect sensor.
    #[must_use]
    pub fn neutral(self) -> f64 {
        match self {
            Self::Delay | Self::Bias => 0.0,
            Self::Gain => 1.0,
        }
    }

    /// Its unit, for a signal in `signal`.
    #[must_use]
    pub fn unit(self, signal: Unit) -> Unit {
        match self {
            Self::Delay => Unit::SECOND,
            Self::Gain => Unit::ONE,
            Self::Bias => signal,
        }
    }

    /// Name of the parameter that this error of the sensor of `signal` is: `sensors.velocity.delay`.
    #[must_use]
    pub fn parameter(self, signal: &str) -> String {
        format!("{PREFIX}{signal}.{}", self.name())
    }

    /// Whether a parameter is an error of a sensor, by its name.
    #[must_use]
    pub fn is_named(parameter: &str) -> bool {
        parameter.starts_with(PREFIX)
    }

    /// Values that are believed: clocks farther apart are to be aligned first, and a larger gain is a wrong unit.
    pub(super) fn range(self) -> RangeInclusive<f64> {
        match self {
            Self::Delay => -1.0..=1.0,
            Self::Gain => 0.1..=10.0,
            Self::Bias => -f64::MAX..=f64::MAX,
        }
    }

    fn doc(self) -> &'static str {
        match self {
            Self::Delay => "Time by which the record of the signal is behind it.",
            Self::Gain => "Recorded over true changes of the signal.",
            Self::Bias => "What is recorded of the signal where it is zero.",
        }
    }
}

/// What is known of the errors of a signal's sensor; a perfect one where nothing is stated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Sensor {
    /// Of [`SensorError::Delay`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay: Option<Prior>,
    /// Of [`SensorError::Gain`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain: Option<Prior>,
    /// Of [`SensorError::Bias`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bias: Option<Prior>,
}

impl Sensor {
    /// What is known of an error; `None` where the sensor has none of it.
    #[must_use]
    pub fn prior(&self, error: SensorError) -> Option<Prior> {
        match error {
            SensorError::Delay => self.delay,
            SensorError::Gain => self.gain,
            SensorError::Bias => self.bias,
        }
    }
}

impl Experiment {
    /// Errors of sensors that are to be found, as parameters with their priors.
    #[must_use]
    pub fn sensor_parameters(&self) -> Vec<(Variable, Prior)> {
        let of_signal = |(signal, sensor): (&String, &Sensor)| {
            let unit = self.kind.format().signal_unit(signal).unwrap_or(Unit::ONE);
            let known = SensorError::ALL.map(|error| (error, sensor.prior(error)));
            let known = known.into_iter().filter_map(|(error, prior)| Some((error, prior?)));
            known.map(|(error, prior)| (variable(signal, unit, error, prior), prior)).collect::<Vec<_>>()
        };
        self.sensors.iter().flat_map(of_signal).collect()
    }
}

fn variable(signal: &str, unit: Unit, error: SensorError, prior: Prior) -> Variable {
    let range = error.range();
    // Bounds are read by people; a prior says its width to a digit or two.
    let rounded = |bound: f64| format!("{bound:.3e}").parse().unwrap_or(bound);
    Variable {
        name: error.parameter(signal),
        doc: Cow::Borrowed(error.doc()),
        unit: error.unit(unit),
        default: error.neutral(),
        min: rounded(prior.mean - WITHIN * prior.deviation).max(*range.start()),
        max: rounded(prior.mean + WITHIN * prior.deviation).min(*range.end()),
        role: Role::Fixed,
        source: Cow::Borrowed("[sensors] of the experiment"),
    }
}

/// An entry of `[sensors]` as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SensorTable {
    delay: Option<Spanned<PriorEntry>>,
    gain: Option<Spanned<PriorEntry>>,
    bias: Option<Spanned<PriorEntry>>,
}

impl Checker<'_> {
    /// Sensors by signal, with the lines on which they stand.
    ///
    /// # Errors
    /// [`ExperimentError`] that names the key: for a name that is no signal, and for what is no prior of such an error.
    pub fn sensors(
        &self,
        sensors: &BTreeMap<String, Spanned<SensorTable>>,
    ) -> Result<BTreeMap<String, (Sensor, u64)>, ExperimentError> {
        let one = |(signal, entry): (&String, &Spanned<SensorTable>)| {
            let (key, at, table) = (format!("{PREFIX}{signal}"), entry.span().start, entry.get_ref());
            if !self.kind.format().has_course() {
                let message = format!("only a `traverse` has `[sensors]`; this is a `{}`", self.kind.name());
                return Err(self.text.error(&key, at, message));
            }
            let unit = self.signal(signal).ok_or_else(|| self.unknown_signal(&key, at, signal))?;
            let prior = |error: SensorError, entry: &Option<Spanned<PriorEntry>>| {
                entry.as_ref().map(|entry| self.sensor_prior(signal, unit, error, entry)).transpose()
            };
            let sensor = Sensor {
                delay: prior(SensorError::Delay, &table.delay)?,
                gain: prior(SensorError::Gain, &table.gain)?,
                bias: prior(SensorError::Bias, &table.bias)?,
            };
            if sensor == Sensor::default() {
                let message = "expected at least one of `delay`, `gain`, `bias`, each as { sd = .. }".to_owned();
                return Err(self.text.error(&key, at, message));
            }
            Ok((signal.clone(), (sensor, self.text.line(at))))
        };
        sensors.iter().map(one).collect()
    }

    /// The prior of one error; without a mean it stands about a perfect sensor.
    fn sensor_prior(
        &self,
        signal: &str,
        unit: Unit,
        error: SensorError,
        entry: &Spanned<PriorEntry>,
    ) -> Result<Prior, ExperimentError> {
        let key = error.parameter(signal);
        let refused = |message: String| self.text.error(&key, entry.span().start, message);
        let (mean, deviation, symbol) = entry.get_ref().parts().map_err(refused)?;
        let factor = symbol.map_or(Ok(1.0), |symbol| error.unit(unit).factor_of(symbol));
        let factor = factor.map_err(|unfit| refused(unfit.to_string()))?;
        let mean = mean.map_or(error.neutral(), |mean| mean * factor);
        let range = error.range();
        if !range.contains(&mean) {
            let (name, unit) = (error.name(), error.unit(unit).symbol);
            let expected = match error {
                SensorError::Bias => "a finite number".to_owned(),
                _ => format!("{} .. {} (unit {unit})", range.start(), range.end()),
            };
            return Err(refused(format!("a mean {name} of {mean} (unit {unit}) cannot be right: expected {expected}")));
        }
        Ok(Prior { mean, deviation: deviation * factor })
    }
}
