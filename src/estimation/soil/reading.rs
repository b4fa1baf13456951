//! Measured load, torque, sinkage and slip of one wheel at one instant, and the strength that is estimated from them.

use super::super::EstimationError;
use super::super::error::finite;
use crate::snapshot::Moving;
use crate::soil::Soil;
use crate::wheel::Wheel;

/// A driven wheel at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Moving)]
pub struct Reading {
    /// Load along the ground's normal W, N.
    pub load: f64,
    /// Torque T, N m.
    pub torque: f64,
    /// Sinkage z, m.
    pub sinkage: f64,
    /// Slip i = 1 - V/(r omega), 0..1.
    pub slip: f64,
}

/// Standard deviations of a reading's errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Moving)]
pub struct Deviations {
    /// Of the load, N.
    pub load: f64,
    /// Of the torque, N m.
    pub torque: f64,
    /// Of the sinkage, m.
    pub sinkage: f64,
    /// Of the slip.
    pub slip: f64,
}

/// What is estimated: cohesion, friction angle and the logarithm of the shear modulus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrengthParameters {
    /// Cohesion c, Pa.
    pub cohesion: f64,
    /// Friction angle phi, rad.
    pub friction_angle: f64,
    /// Shear modulus K, m.
    pub shear_modulus: f64,
}

impl StrengthParameters {
    /// That of a soil.
    #[must_use]
    pub fn of(soil: &Soil) -> Self {
        Self { cohesion: soil.cohesion, friction_angle: soil.friction_angle, shear_modulus: soil.shear_modulus }
    }

    /// `soil` with this strength.
    #[must_use]
    pub fn on(&self, soil: &Soil) -> Soil {
        let Self { cohesion, friction_angle, shear_modulus } = *self;
        Soil { cohesion, friction_angle, shear_modulus, ..*soil }
    }

    /// (c, phi, ln K), the coordinates in which the errors are Gaussian.
    pub(super) fn coordinates(&self) -> [f64; 3] {
        [self.cohesion, self.friction_angle, self.shear_modulus.ln()]
    }

    pub(super) fn from_coordinates([cohesion, friction_angle, ln_k]: [f64; 3]) -> Self {
        Self { cohesion, friction_angle, shear_modulus: ln_k.exp() }
    }
}

impl Reading {
    /// Refuses what is not a driven wheel in soil.
    ///
    /// # Errors
    /// [`EstimationError::NotFinite`] or [`EstimationError::Reading`], unless all is finite, the load is positive,
    /// 0 < z < r and 0 <= i <= 1.
    pub fn check(&self, wheel: &Wheel) -> Result<(), EstimationError> {
        let Self { load, torque, sinkage, slip } = *self;
        for (quantity, value) in [("load", load), ("torque", torque), ("sinkage", sinkage), ("slip", slip)] {
            finite(quantity, None, value)?;
        }
        let refuse = |quantity, value, expected| Err(EstimationError::Reading { quantity, value, expected });
        if load <= 0.0 {
            return refuse("load", load, "more than 0 N");
        }
        if !(sinkage > 0.0 && sinkage < wheel.radius) {
            return refuse("sinkage", sinkage, "more than 0 m and less than the radius");
        }
        if !(0.0..=1.0).contains(&slip) {
            return refuse("slip", slip, "0 .. 1");
        }
        Ok(())
    }
}
