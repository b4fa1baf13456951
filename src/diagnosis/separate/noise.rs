//! Which noise an experiment will have, or has.

use crate::diagnosis::noise::NoiseModel;
use crate::measurement::Experiment;

/// Noise of usual instruments: a force, a torque, a length and an angle; the rest by its share of the signal.
///
/// Force, torque, length (0.5 to 1 mm) and share are the figures that this project assumes for planned experiments; a
/// tenth of a degree is what a common inclinometer holds on a moving rover.
const FORCE: f64 = 0.3;
const TORQUE: f64 = 0.05;
const LENGTH: f64 = 0.001;
const ANGLE: f64 = 0.1 * std::f64::consts::PI / 180.0;
const SHARE: f64 = 0.01;

/// Where a noise figure comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseSource {
    /// The scatter between repeats.
    Replicates,
    /// `[noise]` in `experiment.toml`.
    Stated,
    /// The scatter of the measurements about a flexible curve, where there are no repeats.
    Scatter,
    /// Usual instruments.
    Default,
}

impl NoiseSource {
    /// The word for reports and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Replicates => "replicates",
            Self::Stated => "stated",
            Self::Scatter => "scatter",
            Self::Default => "default",
        }
    }
}

/// The noise that a separation counts with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AssumedNoise {
    /// The model; rows of a planned experiment are independent.
    pub model: NoiseModel,
    /// Where its size comes from.
    pub source: NoiseSource,
}

/// Noise of a signal that was not measured yet: stated, else usual. `largest` is the largest size of the signal.
pub(crate) fn planned(experiment: &Experiment, signal: &str, largest: f64) -> AssumedNoise {
    match experiment.noise.get(signal) {
        Some(stated) => AssumedNoise { model: NoiseModel::white(*stated), source: NoiseSource::Stated },
        None => AssumedNoise { model: NoiseModel::white(usual(signal, largest)), source: NoiseSource::Default },
    }
}

fn usual(signal: &str, largest: f64) -> f64 {
    let field = signal.rsplit('.').next().unwrap_or(signal);
    match field {
        "drawbar_pull" | "normal_force" => FORCE,
        "torque" => TORQUE,
        "sinkage" | "x" | "z" => LENGTH,
        "pitch" | "contact_angle" => ANGLE,
        "slip" => SHARE,
        // A signal that stays zero still needs a scale.
        _ if largest > 0.0 => SHARE * largest,
        _ => SHARE,
    }
}
