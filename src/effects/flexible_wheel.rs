//! A wheel that flattens under its load.

use super::radius_scale::HARD_PLATE;
use super::{Effect, Facts, Local, Place};
use crate::scalar::{Mask, Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

/// Newton's method in the logarithm converges in 5 to 8 steps; this only bounds the loop.
const MAX_STEPS: usize = 50;
/// Relative step below which the sinkage is exact to rounding: convergence is quadratic.
const CONVERGED: f64 = 1e-12;

parameters! {
    /// The wheel deflects by f = C N under its load, and its contact is the arc of a larger circle (Schmid 1995). The
    /// circle here enters the soil where the undeformed outline does: r* = r (z + f)/z at the soil's sinkage z. Schmid's
    /// own circle adds the flattened half behind the axle, with sqrt(f/z), which has no derivative at f = 0. The load is
    /// Bekker's estimate N = b (k_c/b + k_phi) z^n sqrt(2 r z)/(1 + n/2), so that the force law stays explicit.
    pub struct FlexibleWheel {
        /// Radial compliance C of the wheel.
        compliance: [Unit::METRE_PER_NEWTON] = 0.0, 0.0..=3e-4, Effect, "Schmid 1995, J. Terramechanics 32; 5 mm at 50 N: 1e-4";
        /// Where the arm of the torque lies between the wheel's radius (0, as the axle's height demands) and the arc's (1, as
        /// where the wheel is replaced by a larger one in all formulas).
        arm_share: [Unit::ONE] = 0.0, 0.0..=1.0, Effect, "both are in use";
    }
}

#[lanes]
impl<S: Scalar> FlexibleWheel<S> {
    /// The part of `total`, the descent of the axle since touch-down, that is sinkage of the soil:
    /// z + C a z^p = total. In the logarithm of z the left side is convex, so Newton's method from `total` converges.
    fn sinkage(&self, total: S, local: &Local<S>) -> S {
        let (wheel, exponent) = (&local.wheel, local.soil.exponent);
        let power = exponent + 0.5;
        let scale =
            wheel.width * local.soil.modulus(wheel.width) * (wheel.radius * 2.0).sqrt() / (exponent * 0.5 + 1.0);
        let mut z = total;
        let mut goes_on = total.over(0.0);
        for _ in 0..MAX_STEPS {
            let deflection = self.compliance * scale * z.power(power);
            let step = (z + deflection - total) / (z + power * deflection);
            z = S::select(goes_on, z * (-step).exponential(), z);
            goes_on = goes_on & !step.abs().under(CONVERGED);
            if !goes_on.any() {
                break;
            }
        }
        z
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for FlexibleWheel<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["sinkage"],
            seen_on_rover: &["wheel[1].sinkage"],
            advice: &[HARD_PLATE],
            ..Facts::USUAL
        }
    }

    fn surface(&self, place: &Place<S>, local: &mut Local<S>) {
        let sunk = place.sinkage.over(0.0);
        if self.compliance.is_exactly(0.0) || !sunk.any() {
            return;
        }
        let total = S::select(sunk, place.sinkage, local.wheel.radius);
        let sinkage = self.sinkage(total, local);
        local.deflection = S::select(sunk, local.deflection + (total - sinkage), local.deflection);
        let growth = S::select(sunk, total / sinkage, S::from(1.0));
        local.surface.arc *= growth;
        if !self.arm_share.is_exactly(0.0) {
            local.surface.arm *= self.arm_share * (growth - 1.0) + 1.0;
        }
    }
}
