//! Rough-terrain control whose contact angles and soil may come from estimators, in the loop.

use super::Control;
use crate::control::{ControlError, Controller, Nominal, Rtc, RtcOptions};
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
}

/// Rough-terrain control behind its estimators, which are updated once a control period. Where the identification
/// runs on estimated contact angles, it gets those of the same instant.
#[derive(Clone)]
pub(super) struct EstimatingRtc {
    rtc: Rtc,
    contact_angles: Option<ContactAngles>,
    soil: Option<SoilIdentifier>,
    /// The measurement that the controller receives: with estimated contact angles in the place of measured ones.
    seen: Measurement,
}

impl Moving for EstimatingRtc {
    fn save(&self, to: &mut Writer) {
        // What is seen is put together anew for each command.
        let Self { rtc, contact_angles, soil, seen: _ } = self;
        rtc.save(to);
        contact_angles.iter().for_each(|estimator| estimator.save(to));
        soil.iter().for_each(|identifier| identifier.save(to));
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        self.rtc.load(from)?;
        self.contact_angles.iter_mut().try_for_each(|estimator| estimator.load(from))?;
        self.soil.iter_mut().try_for_each(|identifier| identifier.load(from))
    }
}

impl EstimatingRtc {
    pub fn new(nominal: Nominal, control: &Control) -> Result<Self, ControlError> {
        let contact_angles = match control.contact_angles {
            ContactAngleSource::Sensor => None,
            ContactAngleSource::Estimator => Some(ContactAngles::new(&nominal, control.contact_angle_estimation)?),
        };
        let soil = match control.soil {
            SoilSource::Nominal => None,
            SoilSource::Estimator => Some(SoilIdentifier::new(&nominal, control.soil_identification)?),
        };
        let Control { strength, solver, criterion, rtc_timing, .. } = *control;
        let options = RtcOptions { strength, solver, criterion, period: rtc_timing.period };
        let rtc = Rtc::with_options(nominal, control.rtc, options)?;
        Ok(Self { rtc, contact_angles, soil, seen: Measurement::default() })
    }

    /// The controller itself.
    pub fn rtc(&self) -> &Rtc {
        &self.rtc
    }

    /// Believes in `soil`, a checked one, unless an estimator finds it out.
    pub fn believe(&mut self, soil: Soil) {
        if self.soil.is_none() {
            // Within the bounds, as every parameter of a model: it is not refused.
            let _ = self.rtc.set_soil(soil.cohesion, soil.friction_angle, soil.shear_modulus);
        }
    }

    pub fn command(
        &mut self,
        measured: &Measurement,
        goal: &Reference,
        command: &mut Command,
    ) -> Result<(), ControlError> {
        if self.contact_angles.is_none() && self.soil.is_none() {
            return self.rtc.command(measured, goal, command);
        }
        self.seen.take_over(measured);
        if let Some(estimator) = &mut self.contact_angles {
            estimator.update(measured)?;
            let angles = self.seen.wheels.iter_mut().zip(estimator.angles());
            angles.for_each(|(wheel, &angle)| wheel.contact_angle = angle);
        }
        if let Some(identifier) = &mut self.soil {
            identifier.update(&self.seen)?;
            let StrengthParameters { cohesion, friction_angle, shear_modulus } = identifier.strength();
            self.rtc.set_soil(cohesion, friction_angle, shear_modulus)?;
        }
        self.rtc.command(&self.seen, goal, command)
    }
}
