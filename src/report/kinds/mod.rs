//! How each kind of experiment is shown: one [`Presentation`] a kind, which [`of`] gives. All other
//! code of a report is the same for all kinds.

mod single_wheel;
mod soil_test;
mod traverse;

use super::plots::{Condition, Panel, View};
use crate::measurement::{Experiment, Kind};

/// How an experiment is shown.
pub(super) fn of(experiment: &Experiment) -> &'static dyn Presentation {
    match experiment.kind {
        Kind::SingleWheel => &single_wheel::SingleWheel,
        Kind::Traverse => &traverse::Traverse,
        Kind::PlateSinkage => &soil_test::PLATE,
        Kind::Shear => &soil_test::SHEAR,
    }
}

/// Sentences that explain the overlays.
pub(super) struct HowDrawn {
    /// What error bars or bands are, `{noise}` where the noise of each signal stands.
    pub bars: &'static str,
    /// What the curves are; empty where there are none.
    pub curves: String,
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

    /// Pairs of columns over which mean residuals are mapped, the first that were recorded.
    fn maps(&self) -> [(&'static str, &'static str); 2];

    /// Measured beside modelled.
    fn overlays(&self, view: &View) -> Vec<Panel>;

    /// What chooses the parts of the overlays that are shown.
    fn controls(&self, view: &View) -> String;

    /// What the overlays consist of.
    fn how_drawn(&self, view: &View) -> HowDrawn;
}
