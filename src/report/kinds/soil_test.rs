//! How a test of a soil is shown: along the sinkage of a plate, or the displacement of a shear box.

use super::Presentation;
use crate::measurement::Experiment;
use crate::report::plots::Condition;

/// The presentation of a test of a soil.
pub(super) struct SoilTest {
    what: &'static str,
    /// The input that takes its course, then others.
    inputs: &'static [&'static str],
}

/// A plate.
pub(super) static PLATE: SoilTest =
    SoilTest { what: "A plate that is pressed into the soil, every run one way down", inputs: &["sinkage"] };

/// A shear ring or box.
pub(super) static SHEAR: SoilTest = SoilTest {
    what: "A shear test, every run one displacement under a normal stress",
    inputs: &["displacement", "normal_stress"],
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

    fn how_drawn(&self, noise: &str) -> String {
        let bars = match noise {
            "" => "The noise of one sample is unknown.".to_owned(),
            known => format!("The noise grows with the stress; its usual size is {known}."),
        };
        format!("Points are measurements. {bars} Each line is the model at the rows of one run.")
    }
}
