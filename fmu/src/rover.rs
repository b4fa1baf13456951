//! A rover as a [`Model`].

use crate::model::{Failure, Model, Outcome};
use bekker::model::{Model as RoverModel, Run};
use bekker::simulation::{Event, Status};
use bekker_modeldescription::xml::{Description, Entry, Experiment, Item, identifier};
use bekker_modeldescription::{Lookup, Parameters, Role, Unit, Variable};
use std::path::Path;
use std::sync::Arc;

/// Name of the model file in the resources.
pub const MODEL_FILE: &str = "model.toml";

/// Communication step that is offered, s, as near as whole inner steps come to it.
const USUAL_STEP: f64 = 0.01;

/// Values of the output `event`.
const EVENTS: &[Item] = &[
    Item { name: "running", value: 0, doc: "The simulation goes on." },
    Item { name: "stuck", value: 1, doc: "The wheels turn, the rover does not move." },
    Item { name: "tipped_over", value: 2, doc: "The pitch is beyond 80 degrees." },
    Item { name: "belly_contact", value: 3, doc: "The chassis touches the ground." },
    Item { name: "left_terrain", value: 4, doc: "A wheel is beyond the known ground." },
    Item { name: "sunk_to_axle", value: 5, doc: "A wheel has sunk to its axle." },
];

/// The value of the output `event`, a number of [`EVENTS`].
fn number(status: Status) -> f64 {
    match status {
        Status::Running => 0.0,
        Status::Ended(Event::Stuck) => 1.0,
        Status::Ended(Event::TippedOver) => 2.0,
        Status::Ended(Event::BellyContact) => 3.0,
        Status::Ended(Event::LeftTerrain) => 4.0,
        Status::Ended(Event::SunkToAxle) => 5.0,
    }
}

/// Reads the model from an FMU's resources.
///
/// # Errors
/// A sentence where the file cannot be read, or is no valid model.
pub fn load(folder: &Path) -> Result<Box<dyn Model>, String> {
    let file = folder.join(MODEL_FILE);
    let text = std::fs::read_to_string(&file).map_err(|error| format!("cannot read `{}`: {error}", file.display()))?;
    let rover = Rover::parse(&text).map_err(|error| format!("`{}`: {error}", file.display()))?;
    Ok(Box::new(rover))
}

/// The model that a model file holds.
///
/// # Errors
/// A sentence where it is no valid model.
pub fn parse(text: &str) -> Result<Box<dyn Model>, String> {
    Ok(Box::new(Rover::parse(text)?))
}

/// Model file and description of a model's FMU, found in the way in which the library will find them again.
///
/// # Errors
/// A sentence where the model does not start.
pub fn describe(model: &RoverModel) -> Result<(String, Description), String> {
    let text = model.to_toml().map_err(|error| error.to_string())?;
    let mut rover = Rover::parse(&text)?;
    if rover.model.list() != model.clone().list() || rover.model.control.kind != model.control.kind {
        return Err("its TOML does not read back as the same model".to_owned());
    }
    Ok((text, Description::clone(&rover.description)))
}

/// A rover, at its start or on its way.
#[derive(Clone)]
struct Rover {
    description: Arc<Description>,
    model: RoverModel,
    run: Run,
    /// Values by reference; that of time is not used.
    values: Vec<f64>,
    /// First references: parameters are `1..inputs`, inputs `inputs..outputs`, then come the signals and
    /// last the event.
    inputs: usize,
    outputs: usize,
}

impl Rover {
    fn parse(text: &str) -> Result<Self, String> {
        let mut model = RoverModel::from_toml(text, None).map_err(|error| error.to_string())?;
        let run = model.start().map_err(|error| error.to_string())?;
        let mut entries = vec![Entry::time()];
        entries.extend(model.list().into_iter().map(|(variable, value)| Entry::parameter(variable, value)));
        let inputs = entries.len();
        entries.extend(model.inputs().list().into_iter().map(|(variable, value)| Entry::input(variable, value)));
        let outputs = entries.len();
        entries.extend(run.signals().clone().list().into_iter().map(|(variable, _)| Entry::output(variable)));
        entries.push(Entry::enumeration(event(), "Event", EVENTS));
        let values = entries.iter().map(|entry| entry.start).collect();
        let description = Arc::new(description(&model, run.step_size(), text, entries));
        Ok(Self { description, model, run, values, inputs, outputs })
    }

    /// Takes signals and event from the run.
    fn read_outputs(&mut self, status: Status) {
        let mut places = self.values[self.outputs..].iter_mut();
        self.run.signals().values(&mut |value| {
            if let Some(place) = places.next() {
                *place = value;
            }
        });
        if let Some(place) = places.next() {
            *place = number(status);
        }
    }

    fn write_inputs(&mut self) -> Result<(), Failure> {
        let values = &self.values[self.inputs..self.outputs];
        self.run.inputs_mut().set_all(values).map_err(|error| Failure(error.to_string()))
    }
}

fn description(model: &RoverModel, inner_step: f64, text: &str, entries: Vec<Entry>) -> Description {
    let step = (USUAL_STEP / inner_step).round().max(1.0) * inner_step;
    Description {
        name: model.name.clone(),
        identifier: identifier(&model.name),
        description: format!("{}: a rover on deformable soil", model.name),
        version: env!("CARGO_PKG_VERSION").into(),
        license: env!("CARGO_PKG_LICENSE").into(),
        generation_tool: concat!("Bekker ", env!("CARGO_PKG_VERSION")).into(),
        date: None,
        experiment: Experiment { start: 0.0, stop: model.stepping.duration, step },
        inner_step,
        log_categories: crate::LOG_CATEGORIES,
        content: text.to_owned(),
        entries,
    }
}

/// The output that says why a simulation ended.
fn event() -> Variable {
    Variable {
        name: "event".into(),
        doc: "Why the simulation ended.".into(),
        unit: Unit::ONE,
        default: 0.0,
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
        role: Role::Signal,
        source: "physics".into(),
    }
}

impl Model for Rover {
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
        let mut values = self.values[1..self.inputs].iter();
        self.model.visit("", &mut |_, place| {
            if let Some(value) = values.next() {
                *place = *value;
            }
        });
        self.run = self.model.start().map_err(|error| Failure(error.to_string()))?;
        self.write_inputs()?;
        self.read_outputs(Status::Running);
        Ok(())
    }

    fn inner_step(&self) -> f64 {
        self.run.step_size()
    }

    fn elapsed(&self) -> f64 {
        self.run.time()
    }

    fn advance(&mut self, steps: u64) -> Result<Outcome, Failure> {
        self.write_inputs()?;
        let status = self.run.advance(steps).map_err(|error| Failure(error.to_string()))?;
        self.read_outputs(status);
        Ok(match status {
            Status::Running => Outcome::Running,
            Status::Ended(event) => Outcome::Ended { reason: event.to_string() },
        })
    }

    fn reset(&mut self) {
        for (place, entry) in self.values.iter_mut().zip(&self.description.entries) {
            *place = entry.start;
        }
    }

    fn duplicate(&self) -> Box<dyn Model> {
        Box::new(self.clone())
    }
}
