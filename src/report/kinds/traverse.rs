//! How a traverse is shown: over time.

use super::Presentation;
use crate::measurement::Experiment;
use crate::report::plots::Condition;

/// The presentation of a traverse.
pub(super) struct Traverse;

impl Presentation for Traverse {
    fn what(&self) -> &'static str {
        "A rover on a profile, its commands replayed through the model"
    }

    fn inputs(&self) -> &'static [&'static str] {
        &["time"]
    }

    fn residual_conditions(&self) -> &'static [&'static str] {
        &["time", "x", "pitch"]
    }

    /// Where slip or velocity were not recorded, they are computed from what drives the wheels.
    fn conditions(&self, experiment: &Experiment, wheel: usize, radius: f64) -> Vec<Condition> {
        let recorded = format!("wheel[{wheel}].slip");
        let knows = |name: &str| experiment.runs.iter().any(|run| run.data.column(name).is_some());
        let slip = if knows(&recorded) { Condition::column(&recorded) } else { Condition::Slip { wheel, radius } };
        let of_wheel = |field: &str| format!("wheel[{wheel}].{field}");
        let speeds = ["velocity".to_owned(), of_wheel("speed_command"), of_wheel("speed")];
        let speed = speeds.iter().find(|name| knows(name)).unwrap_or(&speeds[1]).clone();
        let mut all: Vec<Condition> = self.residual_conditions().iter().map(|name| Condition::column(name)).collect();
        all.extend([Condition::Slope, Condition::Load { wheel }, slip, Condition::column(&speed)]);
        all
    }

    fn how_drawn(&self, noise: &str) -> String {
        match noise {
            "" => "The noise of one sample is unknown, so there is no band about the measurements.".to_owned(),
            known => {
                format!(
                    "The band about the measurements is two standard deviations of the noise of one sample ({known})."
                )
            }
        }
    }
}
