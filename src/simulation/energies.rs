//! Energies over a run.

use crate::rover::dynamics::Powers;
use crate::scalar::{LaneAccess, MapScalar, Scalar, lanes};
use crate::snapshot::Moving;

/// Energies since the start, J.
#[derive(Clone, Copy, Debug, Moving, LaneAccess, MapScalar)]
pub(crate) struct Energies<S> {
    pub dissipated: S,
    pub electrical: S,
    pub drive: S,
    pub soil_loss: S,
    pub other_loss: S,
}

#[lanes]
impl<S: Scalar> Energies<S> {
    pub fn zero() -> Self {
        let zero = S::from(0.0);
        Self { dissipated: zero, electrical: zero, drive: zero, soil_loss: zero, other_loss: zero }
    }

    /// Trapezoidal rule over one step: the order of the integrator.
    pub fn add(&mut self, before: &Powers<S>, after: &Powers<S>, h: f64) {
        let mean = |a: S, b: S| (a + b) * (0.5 * h);
        self.dissipated += mean(before.dissipated, after.dissipated);
        self.electrical += mean(before.electrical, after.electrical);
        self.drive += mean(before.drive, after.drive);
        self.soil_loss += mean(before.soil_loss, after.soil_loss);
        self.other_loss += mean(before.other_loss, after.other_loss);
    }
}
