//! The oracle of a model: what its rover could do with the best slips, see [`Oracle`].

use super::{ControlKind, Model, RunError, nominal};
use crate::control::ControlError;
use crate::control::rtc::{Attainable, Oracle, SoilBelief};
use crate::effects::Place;
use crate::signals::Measurement;
use crate::simulation::{Status, StepError};
use crate::soil::Soil;

impl Model {
    /// The oracle of this rover on its own soil, where the ground says nothing else: the true wheel and rim, and Ding's slip-sinkage
    /// (`slip_sinkage.n1`). Other effects and other laws of slip-sinkage do not enter.
    ///
    /// # Errors
    /// [`RunError`] where the rover makes no sense to a controller or an effect of the user's own gives no number.
    pub fn oracle(&self) -> Result<Oracle, RunError> {
        let rover = &self.rover;
        let place = Place {
            wheel: 0,
            x: None,
            passes: 0.0,
            contact_angle: 0.0,
            slip: 0.0,
            dug_slip: 0.0,
            sinkage: 0.0,
            normal_velocity: 0.0,
            velocity: 0.0,
        };
        let wheel = rover.effects.wheel(&rover.wheel).unwrap_or(rover.wheel);
        let none = crate::contact::Forces::zero();
        let contact = rover.effects.contact(&place, wheel, rover.soil, |_| none);
        let (local, _) =
            contact.map_err(|failure| RunError::Step(StepError::Dynamics { time: 0.0, source: failure.into() }))?;
        let belief = SoilBelief {
            digging: rover.effects.slip_sinkage.n1,
            surface: local.surface,
            ..SoilBelief::new(local.wheel, local.soil)
        };
        Oracle::new(nominal(rover), belief).map_err(refused)
    }

    /// What the rover could do with the best slips at rest with its chassis reference point at `x` (m), would it move on at
    /// `speed` (m/s) from there; `oracle` is this model's. Where the rest is an event, a belly on the ground for example, nothing is.
    ///
    /// # Errors
    /// [`RunError`] where the rover finds no rest there or the oracle no answer.
    pub fn attainable(&self, oracle: &mut Oracle, x: f64, speed: f64) -> Result<Attainable, RunError> {
        let Some(rest) = self.rest_at(x)? else {
            return Ok(Attainable { balanced: false, electrical_power: f64::INFINITY });
        };
        oracle.at(&rest.pose, speed, |along| rest.soil(self, along)).map_err(refused)
    }

    /// The largest horizontal force that is left at any slips, N, at `x` and `speed` as in [`attainable`](Self::attainable); minus
    /// infinity where the rest is an event.
    ///
    /// # Errors
    /// As [`attainable`](Self::attainable).
    pub fn largest_pull(&self, oracle: &mut Oracle, x: f64, speed: f64) -> Result<f64, RunError> {
        let Some(rest) = self.rest_at(x)? else { return Ok(f64::NEG_INFINITY) };
        oracle.largest_pull(&rest.pose, speed, |along| rest.soil(self, along)).map_err(refused)
    }

    /// The pose at rest at `x` m; `None` where it is an event.
    fn rest_at(&self, x: f64) -> Result<Option<Rest>, RunError> {
        let mut there = self.clone();
        (there.start.x0, there.control.kind) = (x, ControlKind::Torque);
        let run = there.start()?;
        if run.status() != Status::Running {
            return Ok(None);
        }
        let signals = run.signals();
        let mut pose = Measurement::of(signals.wheels.len(), signals.links.len());
        pose.pitch = signals.body.pitch;
        pose.wheels.iter_mut().zip(&signals.wheels).for_each(|(seen, wheel)| seen.contact_angle = wheel.contact_angle);
        pose.links.iter_mut().zip(&signals.links).for_each(|(seen, link)| seen.angle = link.angle);
        Ok(Some(Rest { pose, x: signals.body.x }))
    }
}

/// A rover at rest.
struct Rest {
    pose: Measurement,
    /// Place of the chassis reference point, m.
    x: f64,
}

impl Rest {
    /// The soil `along` m ahead of the chassis reference point.
    fn soil(&self, model: &Model, along: f64) -> Soil {
        model.rover.terrain.soil(&model.rover.soil, self.x + along)
    }
}

fn refused(source: ControlError) -> RunError {
    RunError::Control { time: 0.0, source }
}
