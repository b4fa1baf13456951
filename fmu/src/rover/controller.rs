//! A rover's controller by itself, as a [`FmuModel`]: measurements in, torques out.

use super::by_reference::{by_reference, from_values, starts};
use super::modes::{MODES, check_kind, in_mode, kind_of, list, mode_entry, usual_mode};
use super::outputs::measurements;
use super::state::{read_list, write_list};
use super::step_position::StepPosition;
use super::tuning::wanted;
use super::{Packed, description};
use crate::model::{Failure, FmuModel, Outcome};
use bekker::model::{ControlKind, ControllerRun, Model as RoverModel};
use bekker::snapshot::{Fingerprint, Reader, SnapshotError, Writer, close, open};
use bekker_modeldescription::xml::Variability::{Fixed, Tunable};
use bekker_modeldescription::xml::{Description, Entry};
use bekker_modeldescription::{Lookup, Parameters};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// What the bytes of a state are, and the version of their format.
const KIND: [u8; 4] = *b"BKFC";
const VERSION: u32 = 1;

/// Reference of the mode.
const MODE: usize = 1;

/// A controller, at its start or on its way.
#[derive(Clone)]
pub(super) struct Controller {
    description: Arc<Description>,
    /// As it was read; its parameters are those that the run was started with. And with those that it has now.
    model: RoverModel,
    tuned: RoverModel,
    /// The values of the latter.
    applied: Vec<f64>,
    run: ControllerRun,
    /// The mode that the run was started with.
    mode: f64,
    /// Values by reference; that of time is not used.
    values: Vec<f64>,
    parameters: Range<usize>,
    inputs: Range<usize>,
    outputs: Range<usize>,
    time: f64,
}

impl Controller {
    /// The controller of a model file, before its first decision.
    ///
    /// # Errors
    /// A sentence where a parameter makes no sense to it.
    pub fn new(model: RoverModel, packed: Packed) -> Result<Self, String> {
        check_kind(&model)?;
        let mode = usual_mode(&model);
        let run = in_mode(&model, mode).start_controller().map_err(|error| error.to_string())?;
        let mut entries = vec![Entry::time(), mode_entry(mode)];
        entries.extend(list(&model).into_iter().map(|(variable, value)| {
            let variability = if model.is_tunable(&variable.name) { Tunable } else { Fixed };
            Entry { variability, ..Entry::parameter(variable, value) }
        }));
        let parameters = MODE + 1..entries.len();
        let (wheels, links) = (model.rover.wheels.len(), model.rover.links.len());
        let named = measurements("", wheels, links).into_iter().map(|variable| Entry::input(variable, 0.0));
        entries.extend(named);
        let goal = in_mode(&model, 0.0).inputs().list();
        entries.extend(goal.into_iter().map(|(variable, value)| Entry::input(variable, value)));
        let inputs = parameters.end..entries.len();
        let mut torques = model.clone();
        torques.control.kind = ControlKind::Torque;
        // A decision acts from the next step on, and before the first one the torques are zero.
        let torques = torques.inputs().list().into_iter();
        entries.extend(torques.map(|(variable, _)| Entry::output(variable).depending_on(vec![], vec![])));
        let outputs = inputs.end..entries.len();
        let description = Arc::new(description(&model, packed, run.period(), entries));
        let values = starts(&description);
        let (tuned, applied) = (model.clone(), values[parameters.clone()].to_vec());
        Ok(Self { description, model, tuned, applied, run, mode, values, parameters, inputs, outputs, time: 0.0 })
    }

    /// Makes a controller with these parameters in this mode.
    fn restart(&mut self, parameters: &[f64], mode: f64) -> Result<(), Failure> {
        let model = self.with(parameters);
        self.run = in_mode(&model, mode).start_controller().map_err(|error| Failure(error.to_string()))?;
        (self.tuned, self.model, self.mode) = (model.clone(), model, mode);
        self.applied = parameters.to_vec();
        Ok(())
    }

    /// The model with these parameters.
    fn with(&self, parameters: &[f64]) -> RoverModel {
        let names = self.description.entries[self.parameters.clone()].iter().map(|entry| entry.variable.name.as_str());
        let values: HashMap<&str, f64> = names.zip(parameters.iter().copied()).collect();
        let mut model = self.model.clone();
        let kind = model.control.kind;
        for mode in 0..MODES.len() {
            model.control.kind = kind_of(kind, mode as f64);
            model.visit("", &mut |variable, place| {
                values.get(variable.name.as_str()).into_iter().for_each(|value| *place = *value);
            });
        }
        model.control.kind = kind;
        model
    }

    /// Lets tunable parameters that have been set act from now on; others wait for the next start.
    fn tune(&mut self) -> Result<(), Failure> {
        let values = &self.values[self.parameters.clone()];
        if *values == *self.applied {
            return Ok(());
        }
        let entries = &self.description.entries[self.parameters.clone()];
        self.tune_to(wanted(entries, values, &self.applied))
    }

    fn tune_to(&mut self, wanted: Vec<f64>) -> Result<(), Failure> {
        if wanted == self.applied {
            return Ok(());
        }
        let model = self.with(&wanted);
        self.run.retune(&in_mode(&model, self.mode)).map_err(|error| Failure(error.to_string()))?;
        (self.tuned, self.applied) = (model, wanted);
        Ok(())
    }

    fn decide(&mut self) -> Result<(), Failure> {
        let mut take = from_values(&self.values[self.inputs.clone()]);
        self.run.measurement_mut().places(&mut take);
        take(&mut self.run.goal_mut().velocity_command);
        self.run.decide().map_err(|error| Failure(error.to_string()))?;
        Ok(())
    }

    fn read_outputs(&mut self) {
        let torques = self.run.command().values.iter();
        self.values[self.outputs.clone()].iter_mut().zip(torques).for_each(|(place, torque)| *place = *torque);
    }

    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::of(&self.description.content)
    }
}

impl FmuModel for Controller {
    by_reference!();

    fn start(&mut self) -> Result<(), Failure> {
        let parameters = self.values[self.parameters.clone()].to_vec();
        self.restart(&parameters, self.values[MODE])?;
        self.time = 0.0;
        self.read_outputs();
        Ok(())
    }

    fn inner_step(&self) -> f64 {
        self.run.period()
    }

    fn advance(&mut self, steps: u64) -> Result<Outcome, Failure> {
        let place = StepPosition::of(self.time, self.run.period())?;
        self.advance_to((place.end() + steps) as f64 * self.run.period())
    }

    /// Every decision that is due before `time` is made on the present inputs; its torques are the outputs from then on.
    fn advance_to(&mut self, time: f64) -> Result<Outcome, Failure> {
        let place = StepPosition::of(time, self.run.period())?;
        if time < self.time && StepPosition::of(self.time, self.run.period())? != place {
            return Err(Failure(format!(
                "the communication point {time} s lies before the present time, {} s",
                self.time
            )));
        }
        self.tune()?;
        while self.run.decisions() < place.end() {
            self.decide()?;
        }
        self.read_outputs();
        self.time = if place.share == 0.0 { self.run.time() } else { time };
        Ok(Outcome::Running)
    }

    fn reset(&mut self) {
        self.values = starts(&self.description);
        self.time = 0.0;
    }

    fn serialise(&self) -> Result<Vec<u8>, Failure> {
        let mut body = Writer::default();
        write_list(&self.values, &mut body);
        let started: HashMap<String, f64> =
            list(&self.model).into_iter().map(|(variable, value)| (variable.name, value)).collect();
        let names = self.description.entries[self.parameters.clone()].iter().map(|entry| &entry.variable.name);
        write_list(&names.filter_map(|name| started.get(name).copied()).collect::<Vec<f64>>(), &mut body);
        write_list(&self.applied, &mut body);
        body.real(self.mode);
        body.bytes(&self.run.snapshot());
        body.real(self.time);
        Ok(close(KIND, VERSION, self.fingerprint(), &body.finish()))
    }

    fn deserialise(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let body = open(KIND, VERSION, self.fingerprint(), bytes).map_err(SnapshotError::from)?;
        let mut from = Reader::new(body);
        let mut there = self.clone();
        read_list(&mut there.values, "values", &mut from)?;
        let mut parameters = vec![0.0; there.parameters.len()];
        read_list(&mut parameters, "parameters", &mut from)?;
        let mut applied = vec![0.0; there.parameters.len()];
        read_list(&mut applied, "parameters", &mut from)?;
        let mode = from.real()?;
        there.restart(&parameters, mode)?;
        there.tune_to(applied)?;
        there.run.restore(from.bytes()?)?;
        there.time = from.real()?;
        from.end()?;
        *self = there;
        Ok(())
    }
}
