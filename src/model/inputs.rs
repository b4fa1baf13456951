//! What a run takes in.

use super::{ControlKind, Model, ModelKind, RunError};
use crate::carriage::SetPoint;
use bekker_modeldescription::{Lookup, Parameters, Unit, Variable, join, parameters};

/// Commands of wheels within this are taken, in SI units.
const ANY: std::ops::RangeInclusive<f64> = -1e4..=1e4;

/// Speeds of a rover within this are taken, m/s.
const VELOCITIES: std::ops::RangeInclusive<f64> = -10.0..=10.0;

parameters! {
    /// Command of one wheel's torque.
    pub struct TorqueCommand {
        /// Commanded motor torque, wheel side of the gear.
        torque_command: [Unit::NEWTON_METRE] = 0.0, ANY, Signal, "input";
    }
}

parameters! {
    /// Command of one wheel's speed.
    pub struct SpeedCommand {
        /// Commanded wheel speed relative to the carrying body.
        speed_command: [Unit::RADIAN_PER_SECOND] = 0.0, ANY, Signal, "input";
    }
}

parameters! {
    /// Command of the rover's speed.
    pub struct VelocityCommand {
        /// Desired speed of the body along its path.
        velocity_command: [Unit::METRE_PER_SECOND] = 0.25, VELOCITIES, Signal, "input; 25 cm/s in Iagnemma 2001, 4.4.1";
    }
}

/// Inputs of a run, by the vocabulary's names.
#[derive(Clone, Debug, PartialEq)]
pub enum Inputs {
    /// `wheel[k].torque_command`, N m.
    Torque(Vec<TorqueCommand>),
    /// `wheel[k].speed_command`, rad/s.
    Speed(Vec<SpeedCommand>),
    /// `velocity_command`, m/s.
    Velocity(VelocityCommand),
    /// `load` (N), `slip` and `wheel_speed` (rad/s) of a wheel on a carriage.
    Carriage(SetPoint),
}

impl Inputs {
    pub(super) fn new(model: &Model) -> Self {
        if model.kind == ModelKind::Carriage {
            return Self::Carriage(SetPoint::default());
        }
        // A test of the soil has no inputs of its own: an experiment gives them.
        let wheels = if model.kind == ModelKind::SoilTest { 0 } else { model.rover.wheels.len() };
        match model.control.kind {
            ControlKind::Torque => Self::Torque(vec![TorqueCommand::default(); wheels]),
            ControlKind::Speed | ControlKind::SpeedLoop => Self::Speed(vec![SpeedCommand::default(); wheels]),
            ControlKind::Velocity
            | ControlKind::VelocityTuned
            | ControlKind::Rtc
            | ControlKind::RtcSpeed
            | ControlKind::Slip
            | ControlKind::EqualTorque
            | ControlKind::Registered => Self::Velocity(VelocityCommand::default()),
        }
    }

    /// Sets the inputs from values in the vocabulary's order; after an error they are as before.
    ///
    /// # Errors
    /// [`RunError::InputLength`] for a wrong number of values, [`RunError::Parameter`] for one that is not
    /// finite or out of range.
    pub fn set_all(&mut self, values: &[f64]) -> Result<(), RunError> {
        self.check_all(values)?;
        self.put_all(values);
        Ok(())
    }

    /// Whether [`Inputs::set_all`] takes these values.
    pub(crate) fn check_all(&self, values: &[f64]) -> Result<(), RunError> {
        let mut expected = 0;
        self.values(&mut |_| expected += 1);
        if values.len() != expected {
            return Err(RunError::InputLength { got: values.len(), expected });
        }
        // Every step of every run comes here: the names, which only an error needs, cost more than the check.
        let largest = match self {
            Self::Torque(_) | Self::Speed(_) => Some(*ANY.end()),
            Self::Velocity(_) => Some(*VELOCITIES.end()),
            Self::Carriage(_) => None,
        };
        // NaN is not below a bound either.
        if largest.is_some_and(|largest| values.iter().all(|value| value.abs() <= largest)) {
            return Ok(());
        }
        let mut changed = self.clone();
        changed.put_all(values);
        Ok(changed.check()?)
    }

    /// Sets the inputs from as many values, which [`Inputs::check_all`] has found good.
    pub(crate) fn put_all(&mut self, values: &[f64]) {
        let mut next = values.iter();
        let mut put = |place: &mut f64| {
            if let Some(value) = next.next() {
                *place = *value;
            }
        };
        match self {
            Self::Torque(wheels) => wheels.iter_mut().for_each(|w| put(&mut w.torque_command)),
            Self::Speed(wheels) => wheels.iter_mut().for_each(|w| put(&mut w.speed_command)),
            Self::Velocity(command) => put(&mut command.velocity_command),
            Self::Carriage(set) => set.visit("", &mut |_, place| put(place)),
        }
    }
}

impl Inputs {
    /// The command of wheel `k`, where the inputs name one for each wheel.
    pub(super) fn of_wheel(&self, k: usize) -> Option<f64> {
        match self {
            Self::Torque(wheels) => wheels.get(k).map(|wheel| wheel.torque_command),
            Self::Speed(wheels) => wheels.get(k).map(|wheel| wheel.speed_command),
            Self::Velocity(_) | Self::Carriage(_) => None,
        }
    }
}

impl Parameters<f64> for Inputs {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut f64)) {
        let wheel = |k: usize| join(prefix, &format!("wheel[{}]", k + 1));
        match self {
            Self::Torque(wheels) => wheels.iter_mut().enumerate().for_each(|(k, w)| w.visit(&wheel(k), f)),
            Self::Speed(wheels) => wheels.iter_mut().enumerate().for_each(|(k, w)| w.visit(&wheel(k), f)),
            Self::Velocity(command) => command.visit(prefix, f),
            Self::Carriage(set) => set.visit(prefix, f),
        }
    }

    fn values(&self, f: &mut dyn FnMut(f64)) {
        match self {
            Self::Torque(wheels) => wheels.iter().for_each(|w| w.values(f)),
            Self::Speed(wheels) => wheels.iter().for_each(|w| w.values(f)),
            Self::Velocity(command) => command.values(f),
            Self::Carriage(set) => set.values(f),
        }
    }
}
