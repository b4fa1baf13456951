//! What a soil is tested with.

use crate::scalar::Scalar;
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// A plate: round where it has a diameter, else rectangular.
    pub struct Plate {
        /// Diameter of a round plate; 0 for a rectangular one.
        diameter: [Unit::METRE] = 0.0, 0.0..=5.0, Rig, "user";
        /// Shorter side of a rectangular plate; 0 for a round one.
        width: [Unit::METRE] = 0.0, 0.0..=5.0, Rig, "user";
        /// Longer side of a rectangular plate; 0 for a round one.
        length: [Unit::METRE] = 0.0, 0.0..=50.0, Rig, "user";
        /// Speed at which the plate is pressed down.
        speed: [Unit::METRE_PER_SECOND] = 0.01, 1e-7..=10.0, Rig, "assumption: a bevameter's plate, the reference of the rate effect";
    }
}

parameters! {
    /// The box that holds the soil. Walls and bottom are far away unless they are given.
    pub struct SoilBox {
        /// Smallest distance between opposite walls.
        width: [Unit::METRE] = 1000.0, 0.01..=1000.0, Rig, "assumption: walls far away";
        /// Depth of the soil.
        depth: [Unit::METRE] = 1000.0, 0.01..=1000.0, Rig, "assumption: bottom far away";
    }
}

parameters! {
    /// A shear ring or box.
    pub struct ShearBox {
        /// Speed of the displacement.
        speed: [Unit::METRE_PER_SECOND] = 0.001, 1e-8..=10.0, Rig, "assumption: the reference of the shear_rate effect";
    }
}

/// Why a plate is none.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlateError {
    /// Neither a diameter nor sides.
    #[error("the plate has no size: give `plate.diameter`, or `plate.width` and `plate.length`, in m")]
    NoSize,
    /// Both.
    #[error("the plate has a diameter and sides: give `plate.diameter`, or `plate.width` and `plate.length`, in m")]
    TwoSizes,
    /// The sides are the wrong way round.
    #[error("`plate.width` is the shorter side and `plate.length` the longer one")]
    Turned,
}

impl Plate {
    /// Whether the plate is round or rectangular.
    ///
    /// # Errors
    /// [`PlateError`] where it is neither.
    pub fn check(&self) -> Result<(), PlateError> {
        let Self { diameter, width, length, .. } = *self;
        match (diameter > 0.0, width > 0.0, length > 0.0) {
            (true, false, false) => Ok(()),
            (false, true, true) if width <= length => Ok(()),
            (false, true, true) => Err(PlateError::Turned),
            (true, ..) => Err(PlateError::TwoSizes),
            _ => Err(PlateError::NoSize),
        }
    }
}

impl<S: Scalar> Plate<S> {
    /// Whether it is round.
    fn is_round(&self) -> bool {
        self.diameter.value() > 0.0
    }

    /// Bekker's b, m: the radius of a round plate, the shorter side of a rectangular one.
    pub fn contact_width(&self) -> S {
        if self.is_round() { self.diameter * 0.5 } else { self.width }
    }

    /// Diameter, or shorter side, m: the size that walls and bottom have to be far from.
    pub fn size(&self) -> S {
        if self.is_round() { self.diameter } else { self.width }
    }

    /// Area, m2.
    pub fn area(&self) -> S {
        if self.is_round() {
            self.diameter * self.diameter * (0.25 * std::f64::consts::PI)
        } else {
            self.width * self.length
        }
    }
}
