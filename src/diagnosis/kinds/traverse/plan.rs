//! A plan for a rover on a profile.

use crate::diagnosis::separate::plan::{PlanError, check, experiment, handy, letter, sheet};
use crate::measurement::{Experiment, Kind, Run, Table};
use crate::model::Model;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Speeds of a default plan, m/s, and its slope, rad: beside level ground, a hill that most rovers climb.
const SPEEDS: [f64; 2] = [0.05, 0.15];
const SLOPE: f64 = 6.0 * std::f64::consts::PI / 180.0;
/// A second mass, as a share of the first: an added weight.
const HEAVIER: f64 = 1.25;
const DURATION: f64 = 20.0;
const EVERY: f64 = 0.1;
const REPEATS: usize = 3;

/// Share of the slowest rim's way over which the hill rises, and falls again; soil slip eats part of the way.
const RISE: f64 = 0.3;
/// Length over which a slope sets in, as a share of the rise.
const ROUNDING: f64 = 0.15;

/// Every speed on every slope with every mass, some times over.
#[derive(Clone, Debug, PartialEq)]
pub struct TraversePlan {
    /// Name for people.
    pub name: String,
    /// Rim speeds, m/s; negative ones drive backward.
    pub speeds: Vec<f64>,
    /// Slopes, rad: each is a hill that is driven up and down again; 0 is level ground.
    pub slopes: Vec<f64>,
    /// Masses of the rover, kg; empty for the model's own.
    pub masses: Vec<f64>,
    /// Whether the second half of each run is driven back.
    pub and_back: bool,
    /// Length of a run, s.
    pub duration: f64,
    /// Time between rows, s.
    pub every: f64,
    /// How often each run is made.
    pub repeats: usize,
    /// What is measured, by the names of the rover's signals.
    pub signals: Vec<String>,
    /// What is known of the rover.
    pub parameters: BTreeMap<String, f64>,
    /// Number of wheels.
    pub wheels: usize,
    /// Their radius, m.
    pub radius: f64,
    /// Distance from the reference point to the foremost wheel and from it to the rearmost, m.
    pub reach: [f64; 2],
}

impl TraversePlan {
    /// A plan for the model's rover: two speeds, level ground and a hill, two masses.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        let rover = &model.rover;
        let radius = rover.wheel.radius;
        let known = [("wheel.radius", radius), ("wheel.width", rover.wheel.width)];
        let mass = rover.body.mass;
        Self {
            name: format!("{}, traverse", model.name),
            speeds: SPEEDS.to_vec(),
            slopes: vec![0.0, SLOPE],
            masses: vec![mass, handy(HEAVIER * mass)],
            and_back: false,
            duration: DURATION,
            every: EVERY,
            repeats: REPEATS,
            signals: all_signals(rover.wheels.len()),
            parameters: known.map(|(name, value)| (name.to_owned(), value)).into(),
            wheels: rover.wheels.len(),
            radius,
            reach: reach(model),
        }
    }

    /// The experiment to be made: one run a slope, speed, mass and repeat.
    ///
    /// # Errors
    /// [`PlanError`] where a list is empty or a number impossible.
    pub fn experiment(&self) -> Result<Experiment, PlanError> {
        check("speeds", &self.speeds, "at least one speed in m/s, not 0", |speed| speed != 0.0)?;
        check("slopes", &self.slopes, "at least one slope under 45 degrees", |slope| {
            slope.abs() < std::f64::consts::FRAC_PI_4
        })?;
        check("duration and time between rows", &[self.duration, self.every], "positive seconds", |time| time > 0.0)?;
        check("rows", &[self.duration / self.every], "10 to 100000 rows a run", |rows| (10.0..=1e5).contains(&rows))?;
        check("repeats", &[self.repeats as f64], "at least 1", |repeats| repeats >= 1.0)?;
        check("signals", &[self.signals.len() as f64], "at least one signal", |count| count >= 1.0)?;
        if !self.masses.is_empty() {
            check("masses", &self.masses, "positive masses in kg", |mass| mass > 0.0)?;
        }
        let own: Vec<Option<f64>> = match self.masses.as_slice() {
            [] => vec![None],
            masses => masses.iter().copied().map(Some).collect(),
        };
        let mut runs = Vec::new();
        for slope in &self.slopes {
            for speed in &self.speeds {
                for mass in &own {
                    self.add_runs(*slope, *speed, *mass, &mut runs)?;
                }
            }
        }
        Ok(experiment(&self.name, Kind::Traverse, &self.parameters, runs))
    }

    fn add_runs(&self, slope: f64, speed: f64, mass: Option<f64>, runs: &mut Vec<Run>) -> Result<(), PlanError> {
        let mut inputs = vec!["time".to_owned()];
        inputs.extend((1..=self.wheels).map(|k| format!("wheel[{k}].speed_command")));
        let steps = (self.duration / self.every).round() as usize;
        let row = |k: usize| {
            let turned = self.and_back && 2 * k >= steps;
            let rate = if turned { -speed } else { speed } / self.radius;
            // Whole multiples, not sums: the rows of all runs meet to the bit.
            let mut row = vec![handy_time(k, self.every)];
            row.extend(std::iter::repeat_n(rate, self.wheels));
            row
        };
        let rows: Vec<Vec<f64>> = (0..=steps).map(row).collect();
        let degrees = handy(slope.to_degrees());
        let load = mass.map_or_else(String::new, |mass| format!("_mass{mass}"));
        let group = format!("slope{degrees}_speed{speed}{load}");
        for repeat in 0..self.repeats {
            let name = format!("runs/{group}_{}", letter(repeat));
            runs.push(Run {
                file: PathBuf::from(format!("{name}.csv")),
                name,
                group: (self.repeats > 1).then(|| group.clone()),
                parameters: mass.map(|mass| ("rover.mass".to_owned(), mass)).into_iter().collect(),
                terrain: (slope != 0.0).then(|| self.hill(slope, speed < 0.0)).transpose()?,
                x0: Some(0.0),
                data: sheet(&inputs, &rows, &self.signals)?,
                conditions: Vec::new(),
                inputs: inputs[1..].to_vec(),
                measured: self.signals.clone(),
            });
        }
        Ok(())
    }

    /// A hill before the rover: level, up, down, level, its corners rounded.
    fn hill(&self, slope: f64, backward: bool) -> Result<Table, PlanError> {
        let slowest = self.speeds.iter().fold(f64::INFINITY, |least, speed| least.min(speed.abs()));
        let rise = RISE * slowest * self.duration * if self.and_back { 0.5 } else { 1.0 };
        let foot = if backward { self.reach[1] } else { self.reach[0] } + 2.0 * self.radius;
        let steep = slope.tan();
        // The height of a slope that sets in over a length w about a corner: s^2 / 2 w in between.
        let w = ROUNDING * rise;
        let bent = |s: f64| (s + 0.5 * w).clamp(0.0, w).powi(2) / (2.0 * w) + (s - 0.5 * w).max(0.0);
        let height = |s: f64| steep * (bent(s) - 2.0 * bent(s - rise) + bent(s - 2.0 * rise));
        let mut corners = vec![-100.0 - foot];
        for corner in [0.0, rise, 2.0 * rise] {
            corners.extend((0..=8).map(|k| corner + w * (f64::from(k) / 8.0 - 0.5)));
        }
        corners.push(2.0 * rise + 100.0);
        let mut points: Vec<(f64, f64)> = corners.iter().map(|s| (foot + s, height(*s))).collect();
        if backward {
            points = points.into_iter().rev().map(|(x, z)| (-x, z)).collect();
        }
        let mut table = Table::new(["x", "z"])?;
        for (x, z) in points {
            table.push(&[x, z])?;
        }
        Ok(table)
    }
}

fn handy_time(row: usize, every: f64) -> f64 {
    let time = row as f64 * every;
    format!("{time:.9}").parse().unwrap_or(time)
}

/// What a well-equipped rover measures.
pub(crate) fn all_signals(wheels: usize) -> Vec<String> {
    let mut signals: Vec<String> = ["x", "pitch"].map(str::to_owned).to_vec();
    for k in 1..=wheels {
        signals.extend(["torque", "current", "sinkage"].map(|field| format!("wheel[{k}].{field}")));
    }
    signals
}

/// How far the wheels stand before and behind the reference point, m.
pub(crate) fn reach(model: &Model) -> [f64; 2] {
    let x = model.rover.wheels.iter().map(|wheel| wheel.mount.x);
    let (low, high) = x.fold((0.0_f64, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    [high, -low]
}
