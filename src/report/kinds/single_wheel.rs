//! How a wheel on a carriage is shown: over slip, load or wheel speed.

use super::{HowDrawn, Presentation};
use crate::measurement::Experiment;
use crate::report::plots::{Condition, MOST_NAMED, Panel, View, steady};

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

    fn maps(&self) -> [(&'static str, &'static str); 2] {
        [("slip", "load"), ("slip", "wheel_speed")]
    }

    fn overlays(&self, view: &View) -> Vec<Panel> {
        steady::panels(view)
    }

    fn controls(&self, view: &View) -> String {
        steady::controls(view)
    }

    fn how_drawn(&self, view: &View) -> HowDrawn {
        let curves = if view.curves.is_empty() {
            "No input was varied, so there is no curve."
        } else {
            "Each curve is the model at the typical inputs of its group of rows: their mean, or their own course where an input \
             follows the axis, as the wheel's speed does where the carriage's is held. Its band, where it is wider than the line, \
             is the model over the lowest and highest load and speed in the group: differences that count as accidental. Open \
             diamonds are the model at a point's own inputs."
        };
        let many = view.curves.iter().any(|curves| curves.groups.len() > MOST_NAMED);
        let order = if many {
            " Where groups are too many for a legend their colours follow their order, from blue to red."
        } else {
            ""
        };
        HowDrawn {
            bars: "Error bars are two standard deviations of the noise of one sample ({noise}).",
            curves: format!("{curves}{order}"),
        }
    }
}
