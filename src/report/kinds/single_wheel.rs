//! How a wheel on a carriage is shown: over slip, load or wheel speed.

use super::Presentation;
use crate::measurement::Experiment;
use crate::report::plots::Condition;

/// The presentation of a wheel on a carriage.
pub(super) struct SingleWheel;

impl Presentation for SingleWheel {
    fn what(&self) -> &'static str {
        "A wheel on a carriage, every row a steady point"
    }

    fn inputs(&self) -> &'static [&'static str] {
        &["load", "slip", "wheel_speed"]
    }

    fn residual_conditions(&self) -> &'static [&'static str] {
        &["slip", "load", "wheel_speed"]
    }

    fn conditions(&self, _: &Experiment, _: usize, _: f64) -> Vec<Condition> {
        self.residual_conditions().iter().map(|name| Condition::column(name)).collect()
    }

    fn how_drawn(&self, noise: &str) -> String {
        let bars = match noise {
            "" => "The noise of one sample is unknown, so there are no error bars.".to_owned(),
            known => format!("Error bars are two standard deviations of the noise of one sample ({known})."),
        };
        format!(
            "Points are measurements. {bars} Each curve is the model at the typical inputs of its group of rows: their mean, or their own course \
             where an input follows the axis, as the wheel's speed does where the carriage's is held. Its band, where it is wider than the line, \
             is the model over the lowest and highest load and speed in the group: differences that count as accidental."
        )
    }
}
