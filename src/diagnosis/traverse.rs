//! A rover on a profile: the recorded commands replayed through the simulation.
//!
//! The rover starts at rest, settled above `x0`, at the time of the first row. The commands of a row hold until the
//! next row's time; signals are compared at their rows, before the row's own command acts. Rows are met to half an inner
//! step (1 ms by default).

use super::free::Free;
use super::layout::Layout;
use super::prediction::{Predict, PredictionError};
use crate::measurement::{Experiment, Run as Recorded};
use crate::model::{ControlKind, Model, Run};
use crate::simulation::Status;
use crate::terrain::{Profile, Samples};
use bekker_modeldescription::{Lookup, Parameters};

/// Central differences over this share of a parameter's range or value, whichever is smaller: the error of the
/// integrator, about 1e-9, divided by it stays under 1e-4.
const DIFFERENCE: f64 = 1e-4;

/// Replays of all runs.
pub(crate) struct TraversePrediction<'a> {
    experiment: &'a Experiment,
    layout: &'a Layout,
    /// One a run, on that run's ground, commanded as it was.
    models: Vec<Model>,
    free: &'a [Free],
}

impl<'a> TraversePrediction<'a> {
    /// `models` has one model a run, with what is known of that run.
    pub fn new(
        experiment: &'a Experiment,
        layout: &'a Layout,
        models: Vec<Model>,
        free: &'a [Free],
    ) -> Result<Self, PredictionError> {
        let placed = models.into_iter().zip(&experiment.runs).map(|(model, run)| place(model, run));
        Ok(Self { experiment, layout, models: placed.collect::<Result<_, _>>()?, free })
    }

    fn replay(&self, k: usize, free: &[f64], values: &mut [f64]) -> Result<(), PredictionError> {
        let recorded = &self.experiment.runs[k];
        let mut model = self.models[k].clone();
        model.visit("", &mut |variable, value| {
            let own = recorded.parameters.contains_key(&variable.name);
            if let Some(at) = self.free.iter().position(|f| f.variable.name == variable.name).filter(|_| !own) {
                *value = free[at];
            }
        });
        let failed = |source| PredictionError::Simulation { run: recorded.name.clone(), source: Box::new(source) };
        let mut run = model.start().map_err(failed)?;
        let reader = Reader::new(&run, self.layout, k, recorded)?;
        let time = recorded.data.column("time").unwrap_or_default();
        let mut command = vec![0.0; recorded.inputs.len()];
        let mut done = 0;
        for row in 0..time.len() {
            let due = ((time[row] - time[0]) / run.step_size()).round() as u64;
            let status = run.advance(due - done).map_err(failed)?;
            done = due;
            if let Status::Ended(event) = status {
                return Err(PredictionError::Ended { run: recorded.name.clone(), time: time[row], event });
            }
            reader.read(&run, row, values);
            for (value, name) in command.iter_mut().zip(&self.command_names(k)) {
                *value = recorded.data.value(name, row).unwrap_or(0.0);
            }
            run.inputs_mut().set_all(&command).map_err(failed)?;
        }
        Ok(())
    }

    /// Names of the command columns, wheel 1 first, whatever their order in the file.
    fn command_names(&self, k: usize) -> Vec<String> {
        let torque = self.models[k].control.kind == ControlKind::Torque;
        let suffix = if torque { "torque_command" } else { "speed_command" };
        (1..=self.experiment.runs[k].inputs.len()).map(|wheel| format!("wheel[{wheel}].{suffix}")).collect()
    }
}

/// The model on a run's ground, commanded as the run was.
fn place(mut model: Model, run: &Recorded) -> Result<Model, PredictionError> {
    let (commands, wheels) = (run.inputs.len(), model.rover.wheels.len());
    if commands != wheels {
        return Err(PredictionError::Wheels { run: run.name.clone(), commands, wheels });
    }
    let speed = run.inputs.iter().any(|name| name.ends_with(".speed_command"));
    // Speed commands are followed exactly unless the model describes the drives' loop and limits.
    model.control.kind = match (speed, model.control.kind) {
        (true, ControlKind::SpeedLoop) => ControlKind::SpeedLoop,
        (true, _) => ControlKind::Speed,
        (false, _) => ControlKind::Torque,
    };
    model.rover.terrain.profile = match &run.terrain {
        None => Profile::Flat,
        Some(table) => {
            let column = |name| table.column(name).unwrap_or_default();
            let samples = Samples::new(column("x"), column("z"))
                .map_err(|source| PredictionError::Terrain { run: run.name.clone(), source })?;
            Profile::Samples(samples.into())
        }
    };
    if let Some(x0) = run.x0 {
        model.start.x0 = x0;
    }
    Ok(model)
}

/// Reads the measured signals of a run off the simulation.
struct Reader {
    /// For each signal of the vocabulary's order, where its values start in the layout.
    places: Vec<Option<usize>>,
}

impl Reader {
    fn new(run: &Run, layout: &Layout, k: usize, recorded: &Recorded) -> Result<Self, PredictionError> {
        let mut signals = run.signals().clone();
        let names: Vec<String> = signals.list().into_iter().map(|(variable, _)| variable.name).collect();
        if let Some(signal) = recorded.measured.iter().find(|signal| !names.contains(signal)) {
            return Err(PredictionError::Signal { run: recorded.name.clone(), signal: signal.clone() });
        }
        let start = |name: &String| layout.of_run(k).find(|block| block.signal == *name).map(|block| block.range.start);
        Ok(Self { places: names.iter().map(start).collect() })
    }

    fn read(&self, run: &Run, row: usize, values: &mut [f64]) {
        let mut places = self.places.iter();
        run.signals().values(&mut |value| {
            if let Some(Some(start)) = places.next() {
                values[start + row] = value;
            }
        });
    }
}

impl Predict for TraversePrediction<'_> {
    fn values(&self, free: &[f64]) -> Result<Vec<f64>, PredictionError> {
        let mut values = vec![f64::NAN; self.layout.len()];
        for k in 0..self.experiment.runs.len() {
            self.replay(k, free, &mut values)?;
        }
        Ok(values)
    }

    fn slopes(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        let values = self.values(free)?;
        let slopes = (0..free.len()).map(|k| {
            let variable = &self.free[k].variable;
            let step = DIFFERENCE * (variable.max - variable.min).min(free[k].abs().max(f64::MIN_POSITIVE));
            let step = if free[k] == 0.0 { DIFFERENCE * (variable.max - variable.min) } else { step };
            let at = |value: f64| {
                let mut shifted = free.to_vec();
                shifted[k] = value.clamp(variable.min, variable.max);
                self.values(&shifted).map(|values| (shifted[k], values))
            };
            let ((low, below), (high, above)) = (at(free[k] - step)?, at(free[k] + step)?);
            Ok(above.iter().zip(&below).map(|(a, b)| (a - b) / (high - low)).collect())
        });
        let slopes = slopes.collect::<Result<_, PredictionError>>()?;
        Ok((values, slopes))
    }
}
