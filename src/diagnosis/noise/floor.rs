//! The noise floor: how well any model could do.
//!
//! Noise comes from repeats, not from residuals: the residuals of samples that repeat one set-point share the model's
//! error there, so their scatter about their own mean contains none of it. Where the recorded inputs of repeats differ
//! a little, the residual has already subtracted the modelled effect of that difference. That helps where the inputs
//! really differed, and adds scatter where only their recording did; either way what remains is an upper bound, so the
//! smaller of the two scatters, of the residuals and of the plain measurements, is taken.

use crate::diagnosis::layout::Layout;
use crate::measurement::{Experiment, Sample};
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// Standard deviation pooled over sets of repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pooled {
    /// Standard deviation of one sample, in the signal's unit.
    pub deviation: f64,
    /// Samples less sets: how much the number rests on.
    pub degrees_of_freedom: usize,
    /// Whether the model's sensitivity to differences of the recorded inputs was taken off.
    pub corrected: bool,
}

/// What is known of a signal's noise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoiseFloor {
    /// Standard deviation of one sample as the experiment states it.
    pub stated: Option<f64>,
    /// As the repeats show it.
    pub replicates: Option<Pooled>,
    /// Whether the repeats contradict what is stated, and are taken.
    pub contradicted: bool,
}

/// Where a noise floor comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FloorSource {
    /// `[noise]` in `experiment.toml`.
    Stated,
    /// The scatter between repeats.
    Replicates,
    /// Neither: the floor is unknown.
    Unknown,
}

impl FloorSource {
    /// The word for reports and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Stated => "stated",
            Self::Replicates => "replicates",
            Self::Unknown => "unknown",
        }
    }
}

/// The value that holds, and where it comes from.
impl Serialize for NoiseFloor {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut fields = to.serialize_struct("NoiseFloor", 2)?;
        fields.serialize_field("value", &self.value())?;
        fields.serialize_field("source", &self.source())?;
        fields.end()
    }
}

impl NoiseFloor {
    /// Standard deviation of one sample: stated unless the repeats contradict it, else from repeats, else unknown.
    #[must_use]
    pub fn value(&self) -> Option<f64> {
        let repeated = self.replicates.map(|pooled| pooled.deviation);
        match self.source() {
            FloorSource::Stated => self.stated,
            FloorSource::Replicates => repeated,
            FloorSource::Unknown => None,
        }
    }

    /// Where [`value`](NoiseFloor::value) comes from.
    #[must_use]
    pub fn source(&self) -> FloorSource {
        match (self.stated.filter(|_| !self.contradicted), self.replicates) {
            (Some(_), _) => FloorSource::Stated,
            (None, Some(_)) => FloorSource::Replicates,
            (None, None) => FloorSource::Unknown,
        }
    }
}

/// Noise floors of all measured signals, given the modelled values.
pub(crate) fn noise_floors(experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> BTreeMap<String, NoiseFloor> {
    let sets = experiment.replicates();
    let floor = |signal: &String| NoiseFloor {
        stated: experiment.noise.get(signal).copied(),
        replicates: pooled(&sets, layout, modelled, signal),
        contradicted: false,
    };
    experiment.signals().into_iter().map(|signal| (signal.clone(), floor(&signal))).collect()
}

/// The smaller of the scatters of measurements and residuals.
fn pooled(sets: &[Vec<Sample>], layout: &Layout, modelled: &[f64], signal: &str) -> Option<Pooled> {
    let place = |sample: &Sample| {
        let block = layout.of_run(sample.run).find(|block| block.signal == signal)?;
        Some(block.range.start + sample.row)
    };
    let plain = scatter(sets, false, &|s| place(s).map(|at| layout.measured[at]))?;
    let corrected = scatter(sets, true, &|s| place(s).map(|at| layout.measured[at] - modelled[at]));
    // The model may have no answer in some of them. Equal inputs leave a difference of rounding.
    let comparable = |corrected: &Pooled| corrected.degrees_of_freedom == plain.degrees_of_freedom;
    let smaller = |corrected: &Pooled| corrected.deviation < plain.deviation * (1.0 - 1e-9);
    Some(corrected.filter(|corrected| comparable(corrected) && smaller(corrected)).unwrap_or(plain))
}

/// Standard deviation of `value` about the mean of each set, pooled over the sets.
fn scatter(sets: &[Vec<Sample>], corrected: bool, value: &dyn Fn(&Sample) -> Option<f64>) -> Option<Pooled> {
    let (mut sum, mut freedom) = (0.0, 0);
    for set in sets {
        let values: Vec<f64> = set.iter().filter_map(value).filter(|v| !v.is_nan()).collect();
        if values.len() > 1 {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            sum += values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
            freedom += values.len() - 1;
        }
    }
    (freedom > 0).then(|| Pooled { deviation: (sum / freedom as f64).sqrt(), degrees_of_freedom: freedom, corrected })
}
