//! Which controller drives the rover.

use super::Model;
use super::estimating::{ContactAngleSource, EstimatingRtc, SoilSource};
use super::soil_map::SoilMap;
use crate::control::registered::RegisteredController;
use crate::control::{
    ControlError, Controller, Criterion, EqualTorque, EqualTorqueController, Nominal, NominalLink, RoughTerrainControl,
    Rtc, SlipControl, SlipController, Solver, SpeedRoughTerrainControl, SpeedRtc, Strength, TunedVelocity,
    VelocityControl, VelocityController,
};
use crate::estimation::ContactAngleEstimation;
use crate::estimation::soil::SoilIdentification;
use crate::rover::{Link, LinkParameters, Rover};
use crate::signals::{Command, Measurement, Reference, Signals};
use crate::snapshot::{Moving, Reader, SnapshotError, Writer};
use crate::soil::Soil;
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
    /// The same with gains that follow from the plant: input `velocity_command`.
    VelocityTuned,
    /// Rough-terrain control: input `velocity_command`.
    Rtc,
    /// Rough-terrain control with wheel-speed loops, which have the gains of velocity control: input `velocity_command`.
    RtcSpeed,
    /// The same slip at all wheels, by a controller that receives the true slip: input `velocity_command`.
    Slip,
    /// The same torque for all wheels, from the body's speed: input `velocity_command`.
    EqualTorque,
    /// A control law of another crate, see [`Model::drive_by`]: input `velocity_command`.
    Registered,
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
    /// Rough-terrain control with wheel-speed loops.
    pub rtc_speed: SpeedRoughTerrainControl,
    /// Which shear limit rough-terrain control keeps.
    pub strength: Strength,
    /// Who solves rough-terrain control's optimisation.
    pub solver: Solver,
    /// What it optimises; `None` goes by the ground (4.11, 4.12).
    pub criterion: Option<Criterion>,
    /// Individual-wheel velocity control with gains from the plant.
    pub velocity_tuned: TunedVelocity,
    /// Slip control that receives the true slip.
    pub slip: SlipControl,
    /// The same torque for all wheels.
    pub equal_torque: EqualTorque,
    /// Where rough-terrain control has its contact angles from.
    pub contact_angles: ContactAngleSource,
    /// Where rough-terrain control has the soil's strength from.
    pub soil: SoilSource,
    /// Settings of the estimator of contact angles: its model of ground and sensors.
    pub contact_angle_estimation: ContactAngleEstimation,
    /// Settings of the identification of the soil: priors and noise.
    pub soil_identification: SoilIdentification,
    /// The soil parameters that controllers assume; `None` for the true ones, which a real rover does not have.
    pub nominal_soil: Option<Soil>,
}

impl Control {
    /// Sets the gains of velocity control for the wheels of a 3 kg rover side; the default ones are for the 10 kg rover's.
    pub fn lighten(&mut self) {
        (self.velocity.kp, self.velocity.ki) = (0.1, 5.0);
    }

    /// Control period where a controller of this crate decides, s; `None` where commands come from outside or from a
    /// registered law, see [`Model::control_period`].
    #[must_use]
    pub fn period(&self) -> Option<f64> {
        match self.kind {
            ControlKind::Torque | ControlKind::Speed | ControlKind::Registered => None,
            ControlKind::SpeedLoop | ControlKind::Velocity | ControlKind::Slip | ControlKind::RtcSpeed => {
                Some(self.velocity.period)
            }
            ControlKind::VelocityTuned => Some(self.velocity_tuned.period),
            ControlKind::Rtc => Some(self.rtc_timing.period),
            ControlKind::EqualTorque => Some(self.equal_torque.period),
        }
    }
}

/// A controller at work.
#[derive(Clone)]
pub(super) enum ActiveController {
    Velocity(VelocityController),
    Rtc(Box<EstimatingRtc>),
    Slip(Box<SlipController>),
    EqualTorque(EqualTorqueController),
    Registered(RegisteredController),
}

impl Moving for ActiveController {
    fn save(&self, to: &mut Writer) {
        match self {
            Self::Velocity(controller) => controller.save(to),
            Self::Rtc(controller) => controller.save(to),
            Self::Slip(controller) => controller.save(to),
            Self::EqualTorque(controller) => controller.save(to),
            Self::Registered(controller) => controller.save(to),
        }
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        match self {
            Self::Velocity(controller) => controller.load(from),
            Self::Rtc(controller) => controller.load(from),
            Self::Slip(controller) => controller.load(from),
            Self::EqualTorque(controller) => controller.load(from),
            Self::Registered(controller) => controller.load(from),
        }
    }
}

impl fmt::Debug for ActiveController {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Velocity(_) => "individual-wheel velocity control",
            Self::Rtc(controller) if controller.speed_rtc().is_some() => "rough-terrain control with wheel-speed loops",
            Self::Rtc(_) => "rough-terrain control",
            Self::Slip(_) => "slip control that receives the true slip",
            Self::EqualTorque(_) => "equal torque",
            Self::Registered(_) => "a registered control law",
        })
    }
}

impl ActiveController {
    /// The controller of `model`, `None` where commands come from outside.
    pub fn new(model: &Model) -> Result<Option<Self>, ControlError> {
        let control = &model.control;
        let mut nominal = nominal(&model.rover);
        if let Some(soil) = control.nominal_soil {
            nominal.soil = soil;
        }
        Ok(match control.kind {
            ControlKind::Torque | ControlKind::Speed => None,
            ControlKind::SpeedLoop | ControlKind::Velocity => {
                Some(Self::Velocity(VelocityController::new(&nominal, control.velocity)?))
            }
            ControlKind::VelocityTuned => {
                let gains = control.velocity_tuned.gains(&nominal)?;
                Some(Self::Velocity(VelocityController::new(&nominal, gains)?))
            }
            ControlKind::Rtc | ControlKind::RtcSpeed => {
                let map = SoilMap::new(model, &nominal);
                Some(Self::Rtc(Box::new(EstimatingRtc::new(nominal, control, map)?)))
            }
            ControlKind::Slip => {
                Some(Self::Slip(Box::new(SlipController::new(nominal, control.slip, control.velocity)?)))
            }
            ControlKind::EqualTorque => {
                Some(Self::EqualTorque(EqualTorqueController::new(&nominal, control.equal_torque)?))
            }
            ControlKind::Registered => match &model.registered_law {
                Some(law) => Some(Self::Registered(law.controller(&nominal)?)),
                None => return Err(ControlError::NoLaw),
            },
        })
    }

    /// Takes the history of `old` over, which controls the same rover with other numbers.
    ///
    /// # Errors
    /// [`SnapshotError`] where it is another controller.
    pub fn resume(&mut self, old: &Self) -> Result<(), SnapshotError> {
        let believed = match self {
            Self::Rtc(controller) => Some(controller.believed()),
            _ => None,
        };
        let mut history = Writer::default();
        old.save(&mut history);
        let bytes = history.finish();
        let mut from = Reader::new(&bytes);
        self.load(&mut from)?;
        from.end()?;
        if let (Self::Rtc(controller), Some(soil)) = (self, believed) {
            controller.believe(soil);
        }
        Ok(())
    }

    /// Rough-terrain control, where it is at work.
    pub fn rtc(&self) -> Option<&Rtc> {
        match self {
            Self::Rtc(controller) => controller.rtc(),
            _ => None,
        }
    }

    /// Rough-terrain control with wheel-speed loops, where it is at work.
    pub fn speed_rtc(&self) -> Option<&SpeedRtc> {
        match self {
            Self::Rtc(controller) => controller.speed_rtc(),
            _ => None,
        }
    }

    /// The command for the next period. `truth` is for the one kind that is allowed to know it.
    pub fn command(
        &mut self,
        measured: &Measurement,
        truth: &Signals,
        goal: &Reference,
        command: &mut Command,
    ) -> Result<(), ControlError> {
        match self {
            Self::Velocity(controller) => controller.command(measured, goal, command),
            Self::Rtc(controller) => controller.command(measured, goal, command),
            Self::Slip(controller) => {
                controller.reveal(truth.wheels.iter().map(|wheel| wheel.slip));
                controller.command(measured, goal, command)
            }
            Self::EqualTorque(controller) => controller.command(measured, goal, command),
            Self::Registered(controller) => controller.command(measured, goal, command),
        }
    }
}

/// The rover that a controller assumes: its data-sheet geometry and masses, without any effect, on the true soil.
#[must_use]
pub fn nominal(rover: &Rover) -> Nominal {
    let mass = rover.total_mass();
    let mut moment = [rover.body.mass * rover.body.centre_of_mass_x, rover.body.mass * rover.body.centre_of_mass_z];
    for link in &rover.links {
        moment[0] += link.parameters.mass * link.parameters.centre_of_mass_x;
        moment[1] += link.parameters.mass * link.parameters.centre_of_mass_z;
    }
    Nominal {
        gravity: rover.environment.gravity,
        mass,
        centre_of_mass: [moment[0] / mass, moment[1] / mass],
        wheel_centres: rover.wheels.iter().map(|wheel| [wheel.mount.x, wheel.mount.z]).collect(),
        wheel_bodies: rover.wheels.iter().map(|wheel| wheel.body).collect(),
        links: rover.links.iter().map(nominal_link).collect(),
        wheel: rover.wheel,
        motor: rover.motor,
        soil: rover.soil,
    }
}

fn nominal_link(link: &Link) -> NominalLink {
    let LinkParameters { x, z, mass, centre_of_mass_x, centre_of_mass_z, .. } = link.parameters;
    NominalLink { parent: link.parent, x, z, mass, centre_of_mass_x, centre_of_mass_z }
}
