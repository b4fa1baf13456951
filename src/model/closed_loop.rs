//! Which controller drives the rover.

use super::Model;
use crate::control::{
    ControlError, Controller, Nominal, NominalLink, RoughTerrainControl, Rtc, VelocityControl, VelocityController,
};
use crate::rover::{Link, LinkParameters, Rover};
use crate::signals::{Command, Measurement, Reference};
use bekker_modeldescription::{Unit, parameters};
use std::fmt;

/// What drives the wheels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ControlKind {
    /// Torques from outside: inputs `wheel[k].torque_command`.
    #[default]
    Torque,
    /// Wheel speeds from outside, followed exactly: inputs `wheel[k].speed_command`.
    Speed,
    /// Wheel speeds from outside, held by each wheel's own loop (the gains of velocity control) within the
    /// drives' limits: inputs `wheel[k].speed_command`.
    SpeedLoop,
    /// Individual-wheel velocity control: input `velocity_command`.
    Velocity,
    /// Rough-terrain control: input `velocity_command`.
    Rtc,
}

parameters! {
    /// How often rough-terrain control decides.
    pub struct RtcTiming {
        /// Control period, over which the torques are held.
        period: [Unit::SECOND] = 0.01, 1e-4..=1.0, Fixed, "assumption: 100 Hz, as velocity control";
    }
}

/// The control of a model; only the part that `kind` names is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Control {
    /// What drives the wheels.
    pub kind: ControlKind,
    /// Individual-wheel velocity control.
    pub velocity: VelocityControl,
    /// Rough-terrain control.
    pub rtc: RoughTerrainControl,
    /// How often rough-terrain control decides.
    pub rtc_timing: RtcTiming,
}

/// A controller at work.
#[derive(Clone)]
pub(super) enum AtWork {
    Velocity(VelocityController),
    Rtc(Box<Rtc>),
}

impl fmt::Debug for AtWork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Velocity(_) => "individual-wheel velocity control",
            Self::Rtc(_) => "rough-terrain control",
        })
    }
}

impl AtWork {
    /// The controller of `model`, `None` where commands come from outside.
    pub fn new(model: &Model) -> Result<Option<Self>, ControlError> {
        let nominal = || nominal(&model.rover);
        Ok(match model.control.kind {
            ControlKind::Torque | ControlKind::Speed => None,
            ControlKind::SpeedLoop | ControlKind::Velocity => {
                Some(Self::Velocity(VelocityController::new(&nominal(), model.control.velocity)?))
            }
            ControlKind::Rtc => Some(Self::Rtc(Box::new(Rtc::new(nominal(), model.control.rtc)?))),
        })
    }

    pub fn command(
        &mut self,
        measured: &Measurement,
        goal: &Reference,
        command: &mut Command,
    ) -> Result<(), ControlError> {
        match self {
            Self::Velocity(controller) => controller.command(measured, goal, command),
            Self::Rtc(controller) => controller.command(measured, goal, command),
        }
    }
}

/// What a controller believes of the rover: its data sheet, with joints at zero and without any effect.
#[must_use]
pub fn nominal(rover: &Rover) -> Nominal {
    let mass = rover.total_mass();
    let mut moment = [rover.body.mass * rover.body.centre_of_mass_x, rover.body.mass * rover.body.centre_of_mass_z];
    for link in &rover.links {
        moment[0] += link.parameters.mass * link.parameters.centre_of_mass_x;
        moment[1] += link.parameters.mass * link.parameters.centre_of_mass_z;
    }
    let link = |link: &Link| {
        let LinkParameters { x, z, mass, centre_of_mass_x, centre_of_mass_z, .. } = link.parameters;
        NominalLink { parent: link.parent, x, z, mass, centre_of_mass_x, centre_of_mass_z }
    };
    Nominal {
        gravity: rover.environment.gravity,
        mass,
        centre_of_mass: [moment[0] / mass, moment[1] / mass],
        wheel_centres: rover.wheels.iter().map(|wheel| [wheel.mount.x, wheel.mount.z]).collect(),
        wheel: rover.wheel,
        motor: rover.motor,
        soil: rover.soil,
        links: rover.links.iter().map(link).collect(),
        wheel_bodies: rover.wheels.iter().map(|wheel| wheel.body).collect(),
    }
}
