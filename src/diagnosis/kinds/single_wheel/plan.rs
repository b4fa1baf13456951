//! A plan for a wheel on a carriage.

use crate::carriage::{Rig, steady_point};
use crate::diagnosis::separate::plan::{PlanError, check, experiment, handy, letter, sheet};
use crate::measurement::{Experiment, Kind, Run};
use crate::model::Model;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Loads of a default plan, as shares of the load that the wheel carries on its rover.
const LOADS: [f64; 3] = [0.5, 1.0, 1.6];
/// Slips of a default plan: towed, and driven to where slip-sinkage shows.
const SLIPS: [f64; 10] = [-0.2, -0.1, 0.0, 0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 0.75];
/// Rim speeds of a default plan, m/s: what carriages run at, and what shows viscous friction and the rate of sinking.
const RIM_SPEEDS: [f64; 2] = [0.02, 0.1];
const REPEATS: usize = 3;
/// A load that the soil hardly carries at some slip is lowered by this factor, this often.
const LIGHTER: f64 = 0.8;
const TRIES: usize = 20;

/// Every load with every slip and wheel speed, some times over.
#[derive(Clone, Debug, PartialEq)]
pub struct SingleWheelPlan {
    /// Name for people.
    pub name: String,
    /// Loads, N.
    pub loads: Vec<f64>,
    /// Slips.
    pub slips: Vec<f64>,
    /// Wheel speeds, rad/s; negative ones drive backward.
    pub wheel_speeds: Vec<f64>,
    /// How often each run is made.
    pub repeats: usize,
    /// What is measured: any of `drawbar_pull`, `torque`, `sinkage`.
    pub signals: Vec<String>,
    /// What is known of the rig.
    pub parameters: BTreeMap<String, f64>,
}

impl SingleWheelPlan {
    /// A plan for a wheel of the model: three loads about what it carries on its rover, as far as the soil carries them.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        let rover = &model.rover;
        let (radius, wheels) = (rover.wheel.radius, rover.wheels.len().max(1) as f64);
        let weight = rover.total_mass() * rover.environment.gravity / wheels;
        let rig = Rig::of(rover);
        let wheel_speeds: Vec<f64> = RIM_SPEEDS.iter().map(|speed| handy(speed / radius)).collect();
        let largest = LOADS[LOADS.len() - 1] * weight;
        let ratio = carried(&rig, largest, &SLIPS, &wheel_speeds) / largest;
        let loads = LOADS.iter().map(|share| handy(share * weight * ratio)).collect();
        let known = [("wheel.radius", radius), ("wheel.width", rover.wheel.width)];
        Self {
            name: format!("{}, one wheel", model.name),
            loads,
            slips: SLIPS.to_vec(),
            wheel_speeds,
            repeats: REPEATS,
            signals: ["drawbar_pull", "torque", "sinkage"].map(str::to_owned).to_vec(),
            parameters: known.map(|(name, value)| (name.to_owned(), value)).into(),
        }
    }

    /// The experiment to be made: one run a load, speed and repeat.
    ///
    /// # Errors
    /// [`PlanError`] where a list is empty or a number impossible.
    pub fn experiment(&self) -> Result<Experiment, PlanError> {
        check("loads", &self.loads, "at least one positive load in N", |load| load > 0.0)?;
        check("slips", &self.slips, "at least one slip between -1 and 1", |slip| slip > -1.0 && slip <= 1.0)?;
        check("wheel speeds", &self.wheel_speeds, "at least one speed in rad/s, not 0", |speed| speed != 0.0)?;
        check("repeats", &[self.repeats as f64], "at least 1", |repeats| repeats >= 1.0)?;
        check("signals", &[self.signals.len() as f64], "at least one signal", |count| count >= 1.0)?;
        let inputs = ["load", "slip", "wheel_speed"].map(str::to_owned);
        let mut runs = Vec::new();
        for load in &self.loads {
            for speed in &self.wheel_speeds {
                let rows: Vec<Vec<f64>> = self.slips.iter().map(|slip| vec![*load, *slip, *speed]).collect();
                let group = format!("load{load}_speed{speed}");
                for repeat in 0..self.repeats {
                    let name = format!("runs/{group}_{}", letter(repeat));
                    runs.push(Run {
                        file: PathBuf::from(format!("{name}.csv")),
                        name,
                        group: (self.repeats > 1).then(|| group.clone()),
                        parameters: BTreeMap::new(),
                        terrain: None,
                        x0: None,
                        data: sheet(&inputs, &rows, &self.signals)?,
                        conditions: Vec::new(),
                        inputs: inputs.to_vec(),
                        measured: self.signals.clone(),
                    });
                }
            }
        }
        Ok(experiment(&self.name, Kind::SingleWheel, &self.parameters, runs))
    }
}

/// The largest load, at most `load`, that the soil carries at every slip.
pub(crate) fn carried(rig: &Rig, load: f64, slips: &[f64], speeds: &[f64]) -> f64 {
    let holds =
        |load: f64| speeds.iter().all(|speed| slips.iter().all(|slip| steady_point(rig, load, *slip, *speed).is_ok()));
    let mut load = load;
    for _ in 0..TRIES {
        if holds(load) {
            break;
        }
        load *= LIGHTER;
    }
    load
}
