//! How a test of a soil is shown: along the sinkage of a plate, or the displacement of a shear box.

use super::{HowDrawn, Presentation};
use crate::measurement::Experiment;
use crate::report::plots::{Condition, Panel, View, along};

/// The presentation of a test of a soil.
pub(super) struct SoilTest {
    what: &'static str,
    /// The input that takes its course, then others.
    inputs: &'static [&'static str],
    /// Columns over which residuals are mapped; a plate has one input and no map.
    map: (&'static str, &'static str),
}

/// A plate.
pub(super) static PLATE: SoilTest = SoilTest {
    what: "A plate that is pressed into the soil, every run one way down",
    inputs: &["sinkage"],
    map: ("sinkage", "normal_stress"),
};

/// A shear ring or box.
pub(super) static SHEAR: SoilTest = SoilTest {
    what: "A shear test, every run one displacement under a normal stress",
    inputs: &["displacement", "normal_stress"],
    map: ("displacement", "normal_stress"),
};

impl Presentation for SoilTest {
    fn what(&self) -> &'static str {
        self.what
    }

    fn inputs(&self) -> &'static [&'static str] {
        self.inputs
    }

    fn residual_conditions(&self) -> &'static [&'static str] {
        self.inputs
    }

    fn conditions(&self, _: &Experiment, _: usize, _: f64) -> Vec<Condition> {
        let mut all: Vec<Condition> = self.inputs.iter().map(|name| Condition::column(name)).collect();
        all.push(Condition::Run);
        all
    }

    fn maps(&self) -> [(&'static str, &'static str); 2] {
        [self.map, self.map]
    }

    fn overlays(&self, view: &View) -> Vec<Panel> {
        along::panels(view, self.inputs[0])
    }

    fn controls(&self, view: &View) -> String {
        along::controls(view)
    }

    fn how_drawn(&self, _: &View) -> HowDrawn {
        HowDrawn {
            bars: "The noise grows with the stress; its usual size is {noise}.",
            curves: "Each curve is the model at the rows of the first of the runs that repeat each other.".to_owned(),
        }
    }
}
