//! The hooks of an effect on a soil test.

use super::{ShearBox, SoilBox};
use crate::effects::Facts;
use crate::scalar::Scalar;

/// A plate on its way down, as the effects change it.
#[derive(Clone, Copy, Debug)]
pub struct Pressing<S> {
    /// Sinkage, m.
    pub sinkage: S,
    /// Bekker's b, m.
    pub width: S,
    /// Diameter or shorter side, m.
    pub size: S,
    /// Factor on the pressure.
    pub factor: S,
}

/// A sheared surface, as the effects change it.
#[derive(Clone, Copy, Debug)]
pub struct Shearing<S> {
    /// Displacement of the soil, m.
    pub displacement: S,
    /// Factor on the soil's shear stress.
    pub factor: S,
    /// Stress that is measured beside the soil's, Pa.
    pub added: S,
}

/// An effect on a soil test: its hooks do nothing at its neutral value.
pub trait TestEffect<S: Scalar> {
    /// What others need to know of it.
    fn facts(&self) -> Facts;

    /// Changes a plate test.
    fn press(&self, _soil_box: &SoilBox<S>, _at: &mut Pressing<S>) {}

    /// Changes a shear test.
    fn shear(&self, _shear_box: &ShearBox<S>, _at: &mut Shearing<S>) {}
}
