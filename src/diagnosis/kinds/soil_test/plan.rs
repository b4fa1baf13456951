//! Plans for tests of a soil.

use crate::diagnosis::separate::plan::{PlanError, check, experiment, letter, sheet};
use crate::measurement::{Experiment, Kind, Run};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Rows of a planned run.
const ROWS: u32 = 20;
const REPEATS: usize = 3;

/// Round plates of some sizes, pressed down some times.
#[derive(Clone, Debug, PartialEq)]
pub struct PlatePlan {
    /// Name for people.
    pub name: String,
    /// Diameters, m.
    pub diameters: Vec<f64>,
    /// Deepest sinkage, m.
    pub sinkage: f64,
    /// How often each plate is pressed down.
    pub repeats: usize,
    /// What is measured: `force`, `pressure` or both.
    pub signals: Vec<String>,
}

impl Default for PlatePlan {
    /// Sizes a factor of two apart on both sides of a small wheel's contact.
    fn default() -> Self {
        Self {
            name: "plate tests".to_owned(),
            diameters: vec![0.05, 0.1, 0.2],
            sinkage: 0.03,
            repeats: REPEATS,
            signals: vec!["force".to_owned()],
        }
    }
}

impl PlatePlan {
    /// The experiment to be made: one run a plate and repeat.
    ///
    /// # Errors
    /// [`PlanError`] where a list is empty or a number impossible.
    pub fn experiment(&self) -> Result<Experiment, PlanError> {
        check("diameters", &self.diameters, "at least one positive diameter in m", |d| d > 0.0)?;
        check("sinkage", &[self.sinkage], "a positive sinkage in m", |z| z > 0.0)?;
        check("repeats", &[self.repeats as f64], "at least 1", |repeats| repeats >= 1.0)?;
        check("signals", &[self.signals.len() as f64], "at least one signal", |count| count >= 1.0)?;
        let rows: Vec<Vec<f64>> = course(self.sinkage).map(|z| vec![z]).collect();
        let mut runs = Vec::new();
        for diameter in &self.diameters {
            let group = format!("plate{}mm", 1e3 * diameter);
            let parameters = BTreeMap::from([("plate.diameter".to_owned(), *diameter)]);
            runs.extend(repeated(&group, &["sinkage"], &rows, &self.signals, &parameters, self.repeats)?);
        }
        Ok(experiment(&self.name, Kind::PlateSinkage, &BTreeMap::new(), runs))
    }
}

/// Shear tests under some normal stresses.
#[derive(Clone, Debug, PartialEq)]
pub struct ShearPlan {
    /// Name for people.
    pub name: String,
    /// Normal stresses, Pa.
    pub normal_stresses: Vec<f64>,
    /// Longest displacement, m.
    pub displacement: f64,
    /// How often each test is made.
    pub repeats: usize,
}

impl Default for ShearPlan {
    /// Stresses under a small wheel, and several times the displacement at which they are built up.
    fn default() -> Self {
        Self {
            name: "shear tests".to_owned(),
            normal_stresses: vec![2e3, 5e3, 10e3, 20e3],
            displacement: 0.1,
            repeats: REPEATS,
        }
    }
}

impl ShearPlan {
    /// The experiment to be made: one run a normal stress and repeat.
    ///
    /// # Errors
    /// [`PlanError`] where a list is empty or a number impossible.
    pub fn experiment(&self) -> Result<Experiment, PlanError> {
        check("normal stresses", &self.normal_stresses, "at least one stress in Pa", |sigma| sigma >= 0.0)?;
        check("displacement", &[self.displacement], "a positive displacement in m", |j| j > 0.0)?;
        check("repeats", &[self.repeats as f64], "at least 1", |repeats| repeats >= 1.0)?;
        let signals = ["shear_stress".to_owned()];
        let mut runs = Vec::new();
        for sigma in &self.normal_stresses {
            let rows: Vec<Vec<f64>> = course(self.displacement).map(|j| vec![j, *sigma]).collect();
            let group = format!("stress{sigma}");
            let inputs = ["displacement", "normal_stress"];
            runs.extend(repeated(&group, &inputs, &rows, &signals, &BTreeMap::new(), self.repeats)?);
        }
        Ok(experiment(&self.name, Kind::Shear, &BTreeMap::new(), runs))
    }
}

/// Values up to the largest, closer to each other at the beginning.
fn course(largest: f64) -> impl Iterator<Item = f64> {
    (1..=ROWS).map(move |k| largest * (f64::from(k) / f64::from(ROWS)).powi(2))
}

fn repeated(
    group: &str,
    inputs: &[&str],
    rows: &[Vec<f64>],
    signals: &[String],
    parameters: &BTreeMap<String, f64>,
    repeats: usize,
) -> Result<Vec<Run>, PlanError> {
    let inputs: Vec<String> = inputs.iter().map(|name| (*name).to_owned()).collect();
    let run = |repeat: usize| {
        let name = format!("runs/{group}_{}", letter(repeat));
        Ok(Run {
            file: PathBuf::from(format!("{name}.csv")),
            name,
            group: (repeats > 1).then(|| group.to_owned()),
            parameters: parameters.clone(),
            terrain: None,
            x0: None,
            data: sheet(&inputs, rows, signals)?,
            conditions: Vec::new(),
            inputs: inputs.clone(),
            measured: signals.to_vec(),
        })
    };
    (0..repeats).map(run).collect()
}
