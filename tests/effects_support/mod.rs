//! Experiments in which effects show: a wheel on a carriage, and drives over ground with a reversal.

#![allow(clippy::unwrap_used, dead_code, reason = "a test may fail by panicking; not every test uses all of this")]

use bekker::diagnosis::{Rig, SteadyError, steady_point};
use bekker::effects::{EFFECTS, Effects};
use bekker::model::{ControlKind, Model, RunError};
use bekker::modeldescription::{Lookup, Parameters, Role, Variable};
use bekker::rover::Rover;
use bekker::simulation::{Event, Status};
use bekker::terrain::{Profile, Terrain, Waves};

/// Parameters by name.
pub type Settings = Vec<(String, f64)>;

/// All parameters of an effect.
pub fn parameters_of(id: &str) -> Vec<Variable> {
    let prefix = format!("{id}.");
    let all = Rover::two_wheeled().list().into_iter().map(|(variable, _)| variable);
    let own: Vec<Variable> = all.filter(|variable| variable.name.starts_with(&prefix)).collect();
    assert!(!own.is_empty(), "{id} has no parameters");
    own
}

/// The parameters that a diagnosis frees, of all effects.
pub fn free_parameters() -> Vec<Variable> {
    let all = EFFECTS.iter().flat_map(|(id, _)| parameters_of(id));
    all.filter(|variable| variable.role == Role::Effect).collect()
}

/// An effect at work: typical values, or a quarter of the way to the farther bound.
pub fn switched_on(id: &str) -> Settings {
    let facts = Effects::<f64>::default().facts_of(id).unwrap();
    let typical = |variable: &Variable| {
        let own = facts.typical.iter().find(|(name, _)| variable.name.strip_prefix(id) == Some(&format!(".{name}")));
        own.map(|(_, value)| *value)
    };
    let value = |variable: &Variable| {
        let farther = if variable.max - variable.default >= variable.default - variable.min {
            variable.max
        } else {
            variable.min
        };
        match typical(variable) {
            Some(typical) => typical,
            None if variable.role == Role::Effect => variable.default + 0.25 * (farther - variable.default),
            None => variable.default,
        }
    };
    parameters_of(id).into_iter().map(|variable| (variable.name.clone(), value(&variable))).collect()
}

/// Named columns of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    pub signals: Vec<(String, Vec<f64>)>,
    pub event: Option<Event>,
}

impl Record {
    pub fn signal(&self, name: &str) -> &[f64] {
        &self.signals.iter().find(|(own, _)| own == name).unwrap_or_else(|| panic!("no signal {name}")).1
    }

    pub fn all_finite(&self) -> bool {
        self.signals.iter().all(|(_, values)| values.iter().all(|value| value.is_finite()))
    }

    /// Bits of all values, in order.
    pub fn bits(&self) -> Vec<u64> {
        self.signals.iter().flat_map(|(_, values)| values.iter().map(|value| value.to_bits())).collect()
    }

    /// Largest size of a signal, and no less than rounding can make it.
    fn size(&self, name: &str) -> f64 {
        self.signal(name).iter().fold(1e-6_f64, |most, value| most.max(value.abs()))
    }

    /// Root mean square of the change of a signal.
    fn distance(&self, other: &Self, name: &str) -> f64 {
        let (a, b) = (self.signal(name), other.signal(name));
        let rows = a.len().min(b.len());
        let squares: f64 = a[..rows].iter().zip(&b[..rows]).map(|(a, b)| (a - b).powi(2)).sum();
        (squares / rows as f64).sqrt()
    }

    /// The change of a signal over its size in `self`.
    pub fn change(&self, other: &Self, name: &str) -> f64 {
        self.distance(other, name) / self.size(name)
    }

    /// The largest change of all signals, each over its size in `self` or `on`: an energy may be nothing without the
    /// effect.
    pub fn largest_change(&self, other: &Self, on: &Self) -> f64 {
        let change = |name: &str| self.distance(other, name) / self.size(name).max(on.size(name));
        self.signals.iter().fold(0.0, |most, (name, _)| most.max(change(name)))
    }
}

/// Steady points of a wheel on a carriage over loads, slips and speeds.
pub fn carriage(settings: &Settings) -> Result<Record, SteadyError> {
    let mut rover = Rover::two_wheeled();
    rover.soil.shear_modulus = 0.01;
    let mut rig = Rig::of(&rover);
    settings.iter().for_each(|(name, value)| rig.set(name, *value).unwrap());
    carriage_with(&rig)
}

/// The same of a rig that is made already.
pub fn carriage_with(rig: &Rig) -> Result<Record, SteadyError> {
    let mut columns = ["drawbar_pull", "torque", "sinkage"].map(|name| (name.to_owned(), Vec::new()));
    for load in [20.0, 40.0] {
        for (slip, speed) in [(-0.2, 0.5), (0.05, 0.5), (0.3, 0.5), (0.3, 2.0), (0.7, 1.0), (-0.6, 0.5), (0.3, -0.5)] {
            let point = steady_point(rig, load, slip, speed)?;
            let values = [point.drawbar_pull, point.torque, point.sinkage];
            columns.iter_mut().zip(values).for_each(|((_, column), value)| column.push(value));
        }
    }
    Ok(Record { signals: columns.into(), event: None })
}

/// A drive forward and back over waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// The rigid rover of two wheels, their speeds imposed.
    Imposed,
    /// The same with torques commanded.
    Torque,
    /// A rocker-bogie, speeds imposed.
    Linked,
}

pub const DRIVES: [Drive; 3] = [Drive::Imposed, Drive::Torque, Drive::Linked];

/// Time between rows, s, and rows forward and back: the rear wheel drives over the front one's track, and both over
/// their own.
const PERIOD: f64 = 0.1;
const FORWARD: usize = 60;
const BACK: usize = 30;

pub fn model(drive: Drive, settings: &Settings) -> Model {
    let linked = drive == Drive::Linked;
    let mut model = Model::preset(if linked { "rocker_bogie" } else { "two_wheeled" }).unwrap();
    model.control.kind = if drive == Drive::Torque { ControlKind::Torque } else { ControlKind::Speed };
    model.rover.soil.shear_modulus = 0.01;
    let waves = Waves { amplitude: 0.015, wavelength: 1.3, start: -5.0 };
    model.rover.terrain = Terrain::new(Profile::Waves(waves));
    settings.iter().for_each(|(name, value)| model.rover.set(name, *value).unwrap());
    model
}

/// All signals of a drive, row by row, until its end or an event.
pub fn drive(kind: Drive, settings: &Settings) -> Result<Record, RunError> {
    drive_model(kind, &model(kind, settings))
}

/// The same of a model that is made already.
pub fn drive_model(kind: Drive, model: &Model) -> Result<Record, RunError> {
    let mut run = model.start()?;
    let names = run.signals().clone().list().into_iter().map(|(variable, _)| variable.name);
    let mut record = Record { signals: names.map(|name| (name, Vec::new())).collect(), event: None };
    let steps = (PERIOD / run.step_size()).round() as u64;
    for row in 0..FORWARD + BACK {
        let command = match (kind, row < FORWARD) {
            (Drive::Torque, true) => 1.4,
            (Drive::Torque, false) => -1.4,
            (_, true) => 2.5,
            (_, false) => -2.5,
        };
        run.inputs_mut().set_all(&vec![command; model.rover.wheels.len()])?;
        let status = run.advance(steps)?;
        let mut columns = record.signals.iter_mut();
        run.signals().values(&mut |value| columns.next().unwrap().1.push(value));
        if let Status::Ended(event) = status {
            record.event = Some(event);
            break;
        }
    }
    Ok(record)
}
