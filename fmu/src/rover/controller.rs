//! A rover's controller by itself, as a [`Model`]: measurements in, torques out.

use super::outputs::{measurements, readings};
use super::place::Place;
use super::state::{read_list, write_list};
use super::{Kind, description};
use crate::model::{Failure, Model, Outcome};
use bekker::control::Criterion;
use bekker::model::{ControlKind, ControllerRun, Model as RoverModel};
use bekker::snapshot::{Fingerprint, Reader, SnapshotError, Writer, close, open};
use bekker_modeldescription::xml::{Description, Entry, Item, Kind as Type};
use bekker_modeldescription::{Lookup, Parameters, Role, Unit, Variable};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// What the bytes of a state are, and the version of their format.
const KIND: [u8; 4] = *b"BKFC";
const VERSION: u32 = 1;

/// Values of the parameter `mode`.
const MODES: &[Item] = &[
    Item { name: "velocity", value: 0, doc: "Every wheel holds its own speed." },
    Item { name: "traction", value: 1, doc: "Rough-terrain control for the most traction (4.5)." },
    Item { name: "power", value: 2, doc: "Rough-terrain control for the least power (4.10)." },
    Item { name: "dual", value: 3, doc: "Rough-terrain control for whichever the ground asks for (4.11)." },
];

/// Reference of the mode.
const MODE: usize = 1;

/// First parts of names that a controller reads.
const READ: [&str; 9] = [
    "gravity",
    "motor",
    "soil",
    "nominal",
    "velocity_control",
    "velocity_tuned",
    "rtc",
    "contact_angle_estimation",
    "soil_identification",
];
/// What it reads of a vehicle's numbers: those of a data sheet at rest.
const READ_OF_VEHICLE: [&str; 7] = ["x", "z", "mass", "centre_of_mass_x", "centre_of_mass_z", "radius", "width"];

/// A controller, at its start or on its way.
#[derive(Clone)]
pub(super) struct Controller {
    description: Arc<Description>,
    /// As it was read; its parameters are those that the run was started with.
    model: RoverModel,
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
    pub fn new(model: RoverModel, text: &str) -> Result<Self, String> {
        let mode = usual_mode(&model);
        let run = in_mode(&model, mode).start_controller().map_err(|error| error.to_string())?;
        let mut entries = vec![Entry::time(), mode_entry(mode)];
        entries.extend(list(&model).into_iter().map(|(variable, value)| Entry::parameter(variable, value)));
        let parameters = MODE + 1..entries.len();
        let (wheels, links) = (model.rover.wheels.len(), model.rover.links.len());
        let named = measurements("", wheels, links).into_iter().map(|variable| Entry::input(variable, 0.0));
        entries.extend(named);
        let goal = in_mode(&model, 0.0).inputs().list();
        entries.extend(goal.into_iter().map(|(variable, value)| Entry::input(variable, value)));
        let inputs = parameters.end..entries.len();
        let mut torques = model.clone();
        torques.control.kind = ControlKind::Torque;
        entries.extend(torques.inputs().list().into_iter().map(|(variable, _)| Entry::output(variable)));
        let outputs = inputs.end..entries.len();
        let values = entries.iter().map(|entry| entry.start).collect();
        let description = Arc::new(description(&model, Kind::Controller, run.period(), text, entries));
        Ok(Self { description, model, run, mode, values, parameters, inputs, outputs, time: 0.0 })
    }

    /// Makes a controller with these parameters in this mode.
    fn restart(&mut self, parameters: &[f64], mode: f64) -> Result<(), Failure> {
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
        self.run = in_mode(&model, mode).start_controller().map_err(|error| Failure(error.to_string()))?;
        (self.model, self.mode) = (model, mode);
        Ok(())
    }

    fn decide(&mut self) -> Result<(), Failure> {
        let mut inputs = self.values[self.inputs.clone()].iter();
        readings(self.run.measurement_mut(), |place| inputs.next().into_iter().for_each(|value| *place = *value));
        inputs.next().into_iter().for_each(|value| self.run.goal_mut().velocity_command = *value);
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

/// The mode that a model has of itself.
fn usual_mode(model: &RoverModel) -> f64 {
    match (model.control.kind, model.control.criterion) {
        (ControlKind::Velocity | ControlKind::VelocityTuned | ControlKind::SpeedLoop, _) => 0.0,
        (_, Some(Criterion::Traction)) => 1.0,
        (_, Some(Criterion::Power)) => 2.0,
        (_, None) => 3.0,
    }
}

/// The kind of control of a mode, for a model that has `usual` of itself.
fn kind_of(usual: ControlKind, mode: f64) -> ControlKind {
    match usual {
        _ if mode > 0.0 => ControlKind::Rtc,
        ControlKind::VelocityTuned => ControlKind::VelocityTuned,
        _ => ControlKind::Velocity,
    }
}

fn in_mode(model: &RoverModel, mode: f64) -> RoverModel {
    let mut model = model.clone();
    model.control.kind = kind_of(model.control.kind, mode);
    model.control.criterion = match mode {
        1.0 => Some(Criterion::Traction),
        2.0 => Some(Criterion::Power),
        _ => None,
    };
    model
}

fn mode_entry(mode: f64) -> Entry {
    let variable = Variable {
        name: "mode".into(),
        doc: "What the controller goes by.".into(),
        unit: Unit::ONE,
        default: 3.0,
        min: 0.0,
        max: 3.0,
        role: Role::Fixed,
        source: "Iagnemma 2001, chapter 4".into(),
    };
    Entry { kind: Type::Enumeration { name: "Mode", items: MODES }, ..Entry::parameter(variable, mode) }
}

/// Everything that the controller reads in any mode, once.
fn list(model: &RoverModel) -> Vec<(Variable, f64)> {
    let mut all: Vec<(Variable, f64)> = Vec::new();
    for mode in 0..MODES.len() {
        for (variable, value) in in_mode(model, mode as f64).list() {
            let known = all.iter().any(|(other, _)| other.name == variable.name);
            if !known && reads(model, &variable.name) {
                all.push((variable, value));
            }
        }
    }
    all
}

fn reads(model: &RoverModel, name: &str) -> bool {
    let group = name.split(['.', '[']).next().unwrap_or(name);
    let last = name.rsplit('.').next().unwrap_or(name);
    match group {
        "rover" | "link" | "wheel" => READ_OF_VEHICLE.contains(&last),
        // Its own belief of the soil takes the place of the rover's.
        "soil" => model.control.nominal_soil.is_none(),
        _ => READ.contains(&group),
    }
}

impl Model for Controller {
    fn description(&self) -> &Description {
        &self.description
    }

    fn get(&self, reference: usize) -> f64 {
        self.values[reference]
    }

    fn set(&mut self, reference: usize, value: f64) {
        self.values[reference] = value;
    }

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

    fn elapsed(&self) -> f64 {
        self.time
    }

    fn advance(&mut self, steps: u64) -> Result<Outcome, Failure> {
        let place = Place::of(self.time, self.run.period())?;
        self.advance_to((place.end() + steps) as f64 * self.run.period())
    }

    /// Every decision that is due before `time` is made on the present inputs; its torques are the outputs from then on.
    fn advance_to(&mut self, time: f64) -> Result<Outcome, Failure> {
        let place = Place::of(time, self.run.period())?;
        if time < self.time && Place::of(self.time, self.run.period())? != place {
            return Err(Failure(format!(
                "the communication point {time} s lies before the present time, {} s",
                self.time
            )));
        }
        while self.run.decisions() < place.end() {
            self.decide()?;
        }
        self.read_outputs();
        self.time = if place.share == 0.0 { self.run.time() } else { time };
        Ok(Outcome::Running)
    }

    fn reset(&mut self) {
        for (place, entry) in self.values.iter_mut().zip(&self.description.entries) {
            *place = entry.start;
        }
        self.time = 0.0;
    }

    fn duplicate(&self) -> Box<dyn Model> {
        Box::new(self.clone())
    }

    fn serialise(&self) -> Result<Vec<u8>, Failure> {
        let mut body = Writer::default();
        write_list(&self.values, &mut body);
        let started: HashMap<String, f64> =
            list(&self.model).into_iter().map(|(variable, value)| (variable.name, value)).collect();
        let names = self.description.entries[self.parameters.clone()].iter().map(|entry| &entry.variable.name);
        write_list(&names.filter_map(|name| started.get(name).copied()).collect::<Vec<f64>>(), &mut body);
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
        let mode = from.real()?;
        there.restart(&parameters, mode)?;
        there.run.restore(from.bytes()?)?;
        there.time = from.real()?;
        from.end()?;
        *self = there;
        Ok(())
    }
}
