//! What a controller believes of the rover.

use super::error::{ControlError, finite, within_bounds};
use crate::motor::Motor;
use crate::soil::Soil;
use crate::vehicle::MAX_COORDINATES;
use crate::wheel::Wheel;

/// A link on a passive joint, as a controller knows it; places from the chassis reference point with all joints at zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NominalLink {
    /// Body that carries the joint: 0 the chassis, k link k (of a lower number).
    pub parent: usize,
    /// Joint along x, m.
    pub x: f64,
    /// Joint along z, m.
    pub z: f64,
    /// Mass of the link, its wheels included, kg.
    pub mass: f64,
    /// Centre of mass along x, m.
    pub centre_of_mass_x: f64,
    /// Centre of mass along z, m.
    pub centre_of_mass_z: f64,
}

/// A controller's model of a rover, its data sheet. A model file gives it the rover's own parameters (without
/// effects); whoever wants it to be wrong, or estimated, fills it in otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Nominal {
    /// Gravity g, m/s^2.
    pub gravity: f64,
    /// Mass m of the whole rover, kg.
    pub mass: f64,
    /// Centre of mass [x, z] of the whole rover from the chassis reference point, in the chassis frame, all joints at
    /// zero, m.
    pub centre_of_mass: [f64; 2],
    /// Wheel centres [x, z] from the chassis reference point, in the chassis frame, all joints at zero, rear to front, m.
    pub wheel_centres: Vec<[f64; 2]>,
    /// Body that carries each wheel, rear to front: 0 the chassis, k link k.
    pub wheel_bodies: Vec<usize>,
    /// Links on passive joints, parents before children.
    pub links: Vec<NominalLink>,
    /// Wheels, all the same.
    pub wheel: Wheel,
    /// Drives, all the same.
    pub motor: Motor,
    /// Estimated soil.
    pub soil: Soil,
}

impl Nominal {
    /// Number of wheels.
    #[must_use]
    pub fn wheels(&self) -> usize {
        self.wheel_centres.len()
    }

    /// Weight m g, N.
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.mass * self.gravity
    }

    /// Distance along x from the rearmost to the foremost wheel centre, m.
    #[must_use]
    pub fn base(&self) -> f64 {
        let along = |f: fn(f64, f64) -> f64, start| self.wheel_centres.iter().map(|c| c[0]).fold(start, f);
        along(f64::max, f64::NEG_INFINITY) - along(f64::min, f64::INFINITY)
    }

    /// Whether link `link` (counted from 0) carries `body`, itself or through other links.
    #[must_use]
    pub fn carries(&self, link: usize, body: usize) -> bool {
        let mut carrier = body;
        while carrier > link + 1 {
            carrier = self.links[carrier - 1].parent;
        }
        carrier == link + 1
    }

    /// Largest torque of one drive, wheel side, N m, from its torque and current limits; `None` without limit.
    #[must_use]
    pub fn torque_limit(&self) -> Option<f64> {
        let Motor { gear_ratio, torque_constant, inverse_torque_limit, inverse_current_limit, .. } = self.motor;
        let inverse = inverse_torque_limit.max(inverse_current_limit / (gear_ratio * torque_constant));
        (inverse > 0.0).then(|| 1.0 / inverse)
    }

    /// Power dissipated in one winding at a torque on the wheel side of the gear: R tau^2 (4.7, 4.8), W.
    #[must_use]
    pub fn winding_power(&self, torque: f64) -> f64 {
        let current = torque / (self.motor.gear_ratio * self.motor.torque_constant); // (4.7), (4.9)
        self.motor.resistance * current * current // (4.6)
    }

    /// Refuses a rover that no controller can work with.
    ///
    /// # Errors
    /// [`ControlError::Nominal`], [`ControlError::NotFinite`] or [`ControlError::Parameter`] naming the
    /// first dimension that makes no sense.
    pub fn check(&self) -> Result<(), ControlError> {
        positive("gravity", self.gravity, "over 0 m/s2")?;
        positive("mass", self.mass, "over 0 kg")?;
        for value in self.centre_of_mass {
            finite("nominal centre of mass", None, value)?;
        }
        for (index, centre) in self.wheel_centres.iter().enumerate() {
            finite("nominal centre x", Some(index), centre[0])?;
            finite("nominal centre z", Some(index), centre[1])?;
        }
        self.check_links()?;
        if self.wheels() < 2 {
            let value = self.wheels() as f64;
            return Err(ControlError::Nominal { quantity: "number of wheels", value, expected: "2 or more" });
        }
        positive("distance from rearmost to foremost wheel", self.base(), "over 0 m")?;
        within_bounds("wheel", self.wheel)?;
        within_bounds("motor", self.motor)?;
        within_bounds("soil", self.soil)
    }

    /// Refuses links that do not make a tree on the chassis.
    fn check_links(&self) -> Result<(), ControlError> {
        let refuse =
            |quantity, value: usize, expected| Err(ControlError::Nominal { quantity, value: value as f64, expected });
        if self.links.len() > MAX_COORDINATES - 3 {
            return refuse("number of links", self.links.len(), "5 or fewer");
        }
        if self.wheel_bodies.len() != self.wheels() {
            return refuse("number of wheels with a body", self.wheel_bodies.len(), "one a wheel");
        }
        if let Some(&body) = self.wheel_bodies.iter().find(|&&body| body > self.links.len()) {
            return refuse("body of a wheel", body, "0 (the chassis) to the number of links");
        }
        let mut carried = 0.0;
        for (index, link) in self.links.iter().enumerate() {
            if link.parent > index {
                return refuse("parent of a link", link.parent, "0 (the chassis) or a link of a lower number");
            }
            for value in [link.x, link.z, link.centre_of_mass_x, link.centre_of_mass_z] {
                finite("nominal place of a link", None, value)?;
            }
            positive("link mass", link.mass, "over 0 kg")?;
            carried += link.mass;
        }
        positive("mass of the chassis without its links", self.mass - carried, "over 0 kg")
    }
}

fn positive(quantity: &'static str, value: f64, expected: &'static str) -> Result<(), ControlError> {
    if value.is_finite() && value > 0.0 { Ok(()) } else { Err(ControlError::Nominal { quantity, value, expected }) }
}
