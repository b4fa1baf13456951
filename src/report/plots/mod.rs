//! The figures of the reports, and the models that a report is about.

mod candidates;
mod conditions;
mod figure;
mod lines;
mod profile;
mod residuals;
mod steps;

pub(super) use candidates::{probabilities, visible_shares};
pub(super) use conditions::{Condition, Samples, conditions};
pub(super) use figure::Figure;
pub(super) use lines::lines;
pub use lines::{LinePlot, Series};
pub(super) use profile::profile;
pub(super) use residuals::residuals;
pub(super) use steps::steps;

use crate::diagnosis::{Fit, UncountedRows};
use crate::measurement::Experiment;
use std::collections::BTreeMap;

/// A model beside the measurements.
pub(super) struct DrawnModel<'a> {
    /// Name for people, in a sentence.
    pub name: &'static str,
    pub fit: &'a Fit,
}

/// An experiment and the model whose failures the text tells.
pub(super) struct View<'a> {
    pub experiment: &'a Experiment,
    /// Standard deviation of one sample by signal, as it is in force; a signal of unknown noise is missing.
    pub noise: BTreeMap<String, f64>,
    /// Rows that no fit counts.
    pub uncounted: &'a [UncountedRows],
    pub model: DrawnModel<'a>,
}

impl View<'_> {
    /// Standard deviation of one sample of a signal, or where it is unknown the error of the model.
    pub fn scale(&self, signal: &str) -> f64 {
        let rmse = || self.model.fit.rmse.get(signal).copied();
        self.noise.get(signal).copied().or_else(rmse).filter(|scale| *scale > 0.0).unwrap_or(1.0)
    }

    /// What [`scale`](Self::scale) is, in a word or two: the noise, or the usual error where no noise is known.
    pub fn measure(&self) -> &'static str {
        let unknown = self.experiment.signals().iter().filter(|signal| !self.noise.contains_key(*signal)).count();
        match unknown {
            0 => "noise",
            n if n == self.experiment.signals().len() => "usual error",
            _ => "noise or usual error",
        }
    }
}
