//! The core as a door.

use super::door::Door;
use super::read::Script;
use bekker::model::{Model, Run};
use bekker::modeldescription::{Lookup, Parameters};

/// The simulation itself.
pub struct Core {
    model: Model,
    /// Inner steps an interval.
    steps: u64,
    names: Vec<String>,
    run: Option<Run>,
    /// For each signal asked for, its place in the vocabulary.
    places: Vec<usize>,
    row: Vec<f64>,
}

impl Core {
    /// The core, about to drive the model of `script`.
    #[must_use]
    pub fn new(script: &Script) -> Self {
        let (model, names) = (script.model.clone(), script.signals.clone());
        Self { model, steps: script.steps, names, run: None, places: Vec::new(), row: Vec::new() }
    }

    fn run(&mut self) -> Result<&mut Run, String> {
        self.run.as_mut().ok_or_else(|| "the drive has not started".to_owned())
    }
}

impl Door for Core {
    fn name(&self) -> String {
        "core".to_owned()
    }

    fn reset(&mut self) -> Result<(), String> {
        let run = self.model.start().map_err(|refused| refused.to_string())?;
        let known: Vec<String> = run.signals().clone().list().into_iter().map(|(variable, _)| variable.name).collect();
        let place = |name: &String| {
            known.iter().position(|own| own == name).ok_or_else(|| format!("no signal is called `{name}`"))
        };
        self.places = self.names.iter().map(place).collect::<Result<_, _>>()?;
        self.run = Some(run);
        Ok(())
    }

    fn step(&mut self, inputs: &[f64]) -> Result<(), String> {
        let steps = self.steps;
        let run = self.run()?;
        run.inputs_mut().set_all(inputs).map_err(|refused| refused.to_string())?;
        run.advance(steps).map_err(|failed| failed.to_string())?;
        Ok(())
    }

    fn time(&self) -> f64 {
        self.run.as_ref().map_or(0.0, Run::time)
    }

    fn signals(&mut self, out: &mut [f64]) -> Result<(), String> {
        let mut row = std::mem::take(&mut self.row);
        row.clear();
        self.run()?.signals().values(&mut |value| row.push(value));
        for (value, place) in out.iter_mut().zip(&self.places) {
            *value = row.get(*place).copied().unwrap_or(f64::NAN);
        }
        self.row = row;
        Ok(())
    }

    fn status(&mut self) -> Result<String, String> {
        Ok(self.run()?.status().word().to_owned())
    }
}
