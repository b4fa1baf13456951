//! How each kind of experiment is shown: one [`Presentation`] a kind, which [`of`] gives. All other
//! code of a report is the same for all kinds.

mod single_wheel;
mod traverse;

use super::plots::Condition;
use crate::measurement::{Experiment, Kind};

/// How an experiment is shown.
pub(super) fn of(experiment: &Experiment) -> &'static dyn Presentation {
    match experiment.kind {
        Kind::SingleWheel => &single_wheel::SingleWheel,
        Kind::Traverse => &traverse::Traverse,
    }
}

/// What depends on the kind of an experiment in a report.
pub(super) trait Presentation {
    /// What was done, the beginning of a sentence.
    fn what(&self) -> &'static str;

    /// Columns that every run was given.
    fn inputs(&self) -> &'static [&'static str];

    /// Columns against which the residuals of a comparison are drawn.
    fn residual_conditions(&self) -> &'static [&'static str];

    /// What the residuals of a diagnosis are held against; `wheel` is that of the signal, `radius` that of the wheels, m.
    fn conditions(&self, experiment: &Experiment, wheel: usize, radius: f64) -> Vec<Condition>;

    /// What points, lines, bars and bands of the plots are; `noise` is that of each signal in words, empty where it is not known.
    fn how_drawn(&self, noise: &str) -> String;
}
