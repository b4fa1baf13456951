//! Energies over a run.

use crate::rover::dynamics::Powers;
use crate::scalar::{Scalar, always};
use crate::snapshot::moving_beside;

/// Energies since the start, J.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Energies<S> {
    pub dissipated: S,
    pub electrical: S,
    pub drive: S,
    pub soil_loss: S,
    pub other_loss: S,
}

moving_beside!(Energies<f64> { dissipated, electrical, drive, soil_loss, other_loss });

impl<S: Copy> Energies<S> {
    /// The same over another scalar.
    pub fn map<T>(&self, f: &dyn Fn(S) -> T) -> Energies<T> {
        let Self { dissipated, electrical, drive, soil_loss, other_loss } = *self;
        let [dissipated, electrical, drive] = [dissipated, electrical, drive].map(f);
        let [soil_loss, other_loss] = [soil_loss, other_loss].map(f);
        Energies { dissipated, electrical, drive, soil_loss, other_loss }
    }
}

impl<S: Scalar> Energies<S> {
    pub fn zero() -> Self {
        let zero = S::from(0.0);
        Self { dissipated: zero, electrical: zero, drive: zero, soil_loss: zero, other_loss: zero }
    }

    /// Trapezoidal rule over one step: the order of the integrator.
    #[cfg_attr(feature = "batch", inline(always))]
    pub fn add(&mut self, before: &Powers<S>, after: &Powers<S>, h: f64) {
        let mean = always(
            #[cfg_attr(feature = "batch", inline(always))]
            |a: S, b: S| (a + b) * (0.5 * h),
        );
        self.dissipated += mean(before.dissipated, after.dissipated);
        self.electrical += mean(before.electrical, after.electrical);
        self.drive += mean(before.drive, after.drive);
        self.soil_loss += mean(before.soil_loss, after.soil_loss);
        self.other_loss += mean(before.other_loss, after.other_loss);
    }
}
