//! Rough-terrain control whose contact angles and soil may come from estimators, in the loop.

use super::soil_map::SoilMap;
use super::{Control, ControlKind};
use crate::control::{ControlError, Controller, Nominal, Rtc, RtcOptions, SpeedRtc};
use crate::estimation::ContactAngles;
use crate::estimation::soil::{SoilIdentifier, StrengthParameters};
use crate::signals::{Command, Measurement, Reference};
use crate::snapshot::{Moving, Reader, SnapshotError, Writer};
use crate::soil::Soil;

/// Where rough-terrain control has its contact angles from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactAngleSource {
    /// A sensor at every wheel, with the errors that the model gives it. No rover has one: a bound.
    #[default]
    Sensor,
    /// The Kalman filter of 2.5 on pitch, wheel speeds and joints, in the form that the rover's structure allows.
    Estimator,
}

/// Where rough-terrain control has the soil's strength from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SoilSource {
    /// The controllers' data sheet, for good.
    #[default]
    Nominal,
    /// The identification of 2.3, with the data sheet for its prior.
    Estimator,
    /// A map of the ground: the data sheet, changed along x as the ground's own soil is, at the places that dead reckoning
    /// gives. Rough-terrain control by torques takes the mean over its wheels.
    Map,
}

/// The two kinds of rough-terrain control.
#[derive(Clone)]
enum Law {
    Torques(Box<Rtc>),
    Speeds(Box<SpeedRtc>),
}

impl Law {
    fn nominal(&self) -> &Nominal {
        match self {
            Self::Torques(rtc) => rtc.nominal(),
            Self::Speeds(rtc) => rtc.nominal(),
        }
    }

    fn command(&mut self, seen: &Measurement, goal: &Reference, command: &mut Command) -> Result<(), ControlError> {
        match self {
            Self::Torques(rtc) => rtc.command(seen, goal, command),
            Self::Speeds(rtc) => rtc.command(seen, goal, command),
        }
    }

    /// Believes in the strength of `soil` under all wheels, within the vocabulary's bounds.
    fn set_strength(&mut self, soil: &StrengthParameters) -> Result<(), ControlError> {
        let StrengthParameters { cohesion, friction_angle, shear_modulus } = *soil;
        match self {
            Self::Torques(rtc) => rtc.set_soil(cohesion, friction_angle, shear_modulus)?,
            Self::Speeds(rtc) => {
                let soil = Soil { cohesion, friction_angle, shear_modulus, ..rtc.nominal().soil };
                (0..rtc.nominal().wheels()).for_each(|wheel| rtc.set_soil(wheel, soil));
            }
        }
        Ok(())
    }
}

/// Rough-terrain control behind its estimators, which are updated once a control period. Where the identification
/// runs on estimated contact angles, it gets those of the same instant.
#[derive(Clone)]
pub(super) struct EstimatingRtc {
    law: Law,
    contact_angles: Option<ContactAngles>,
    soil: Option<SoilIdentifier>,
    map: Option<SoilMap>,
    /// The measurement that the controller receives: with estimated contact angles in the place of measured ones.
    seen: Measurement,
}

impl Moving for EstimatingRtc {
    fn save(&self, to: &mut Writer) {
        // What is seen is put together anew for each command.
        let Self { law, contact_angles, soil, map, seen: _ } = self;
        match law {
            Law::Torques(rtc) => rtc.save(to),
            Law::Speeds(rtc) => rtc.save(to),
        }
        contact_angles.iter().for_each(|estimator| estimator.save(to));
        soil.iter().for_each(|identifier| identifier.save(to));
        map.iter().for_each(|map| map.save(to));
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        match &mut self.law {
            Law::Torques(rtc) => rtc.load(from)?,
            Law::Speeds(rtc) => rtc.load(from)?,
        }
        self.contact_angles.iter_mut().try_for_each(|estimator| estimator.load(from))?;
        self.soil.iter_mut().try_for_each(|identifier| identifier.load(from))?;
        self.map.iter_mut().try_for_each(|map| map.load(from))
    }
}

impl EstimatingRtc {
    /// The control of `nominal` that `control` describes; a soil map is that of `map`.
    pub fn new(nominal: Nominal, control: &Control, map: SoilMap) -> Result<Self, ControlError> {
        let contact_angles = match control.contact_angles {
            ContactAngleSource::Sensor => None,
            ContactAngleSource::Estimator => Some(ContactAngles::new(&nominal, control.contact_angle_estimation)?),
        };
        let (soil, map) = match control.soil {
            SoilSource::Nominal => (None, None),
            SoilSource::Estimator => (Some(SoilIdentifier::new(&nominal, control.soil_identification)?), None),
            SoilSource::Map => (None, Some(map)),
        };
        let Control { strength, solver, criterion, rtc_timing, .. } = *control;
        let options = RtcOptions { strength, solver, criterion, period: rtc_timing.period };
        let law = if control.kind == ControlKind::RtcSpeed {
            Law::Speeds(Box::new(SpeedRtc::new(nominal, control.rtc_speed, control.velocity, options)?))
        } else {
            Law::Torques(Box::new(Rtc::with_options(nominal, control.rtc, options)?))
        };
        Ok(Self { law, contact_angles, soil, map, seen: Measurement::default() })
    }

    /// The controller itself, where it commands torques.
    pub fn rtc(&self) -> Option<&Rtc> {
        match &self.law {
            Law::Torques(rtc) => Some(rtc),
            Law::Speeds(_) => None,
        }
    }

    /// The controller itself, where it holds wheel speeds.
    pub fn speed_rtc(&self) -> Option<&SpeedRtc> {
        match &self.law {
            Law::Torques(_) => None,
            Law::Speeds(rtc) => Some(rtc),
        }
    }

    /// The soil that it believes in.
    pub fn believed(&self) -> Soil {
        self.law.nominal().soil
    }

    /// Believes in `soil`, a checked one, unless it finds it out or has a map of it.
    pub fn believe(&mut self, soil: Soil) {
        if self.soil.is_none() && self.map.is_none() {
            let Soil { cohesion, friction_angle, shear_modulus, .. } = soil;
            // Within the bounds, as every parameter of a model: it is not refused.
            let _ = self.law.set_strength(&StrengthParameters { cohesion, friction_angle, shear_modulus });
        }
    }

    pub fn command(
        &mut self,
        measured: &Measurement,
        goal: &Reference,
        command: &mut Command,
    ) -> Result<(), ControlError> {
        if let Some(map) = &mut self.map {
            match &mut self.law {
                Law::Torques(rtc) => {
                    let soil = map.mean(rtc.problem().distribution.feet());
                    rtc.set_soil(soil.cohesion, soil.friction_angle, soil.shear_modulus)?;
                }
                Law::Speeds(rtc) => {
                    for wheel in 0..rtc.nominal().wheels() {
                        let soil = map.at(rtc.problem().distribution.foot(wheel));
                        rtc.set_soil(wheel, soil);
                    }
                }
            }
            map.travel(measured)?;
        }
        if self.contact_angles.is_none() && self.soil.is_none() {
            return self.law.command(measured, goal, command);
        }
        self.seen.take_over(measured);
        if let Some(estimator) = &mut self.contact_angles {
            estimator.update(measured)?;
            let angles = self.seen.wheels.iter_mut().zip(estimator.angles());
            angles.for_each(|(wheel, &angle)| wheel.contact_angle = angle);
        }
        if let Some(identifier) = &mut self.soil {
            identifier.update(&self.seen)?;
            self.law.set_strength(&identifier.strength())?;
        }
        self.law.command(&self.seen, goal, command)
    }
}
