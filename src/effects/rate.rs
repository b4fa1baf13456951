//! Resistance of the soil that grows with the speed of penetration.

use super::{Advice, Effect, Facts, Local, Place};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// p = (k_c/b + k_phi) z^n (v/v_0)^m (Grahn 1991). Under a rolling wheel the ground is pressed down by z over the
    /// contact's front, so v = |V| z/(r sin theta_1) = |V| tan(theta_1/2).
    pub struct Rate {
        /// Exponent m of the speed of penetration.
        exponent: [Unit::ONE] = 0.0, 0.0..=0.4, Effect, "Grahn 1991, J. Terramechanics 28: 0.05-0.2";
        /// Speed v_0 of penetration at which the soil's moduli hold.
        reference_speed: [Unit::METRE_PER_SECOND] = 0.01, 1e-4..=1.0, Fixed, "assumption: a bevameter's plate, about 1 cm/s";
        /// Speed below which the soil gets no softer: v becomes sqrt(v^2 + v_s^2).
        slowest_speed: [Unit::METRE_PER_SECOND] = 0.001, 1e-6..=0.1, Fixed, "assumption: a tenth of the plate's speed";
    }
}

#[lanes]
impl<S: Scalar> Rate<S> {
    /// (v/v_0)^m under a plate that is pressed down at the speed v, m/s.
    pub(crate) fn factor_of(&self, penetration: S) -> S {
        if self.exponent.is_exactly(0.0) {
            return S::from(1.0);
        }
        self.factor_of_square(penetration * penetration)
    }

    /// (v/v_0)^m under a wheel.
    fn factor(&self, speed: S, sinkage: S, radius: S) -> S {
        // tan^2(theta_1/2) = z/(2 r - z); a wheel sunk to its axle is an event, not a formula.
        let sinkage = sinkage.smaller(radius).larger(S::from(0.0));
        self.factor_of_square(speed * speed * sinkage / (radius * 2.0 - sinkage))
    }

    /// (v/v_0)^m, of v^2.
    fn factor_of_square(&self, penetration: S) -> S {
        let ratio =
            (penetration + self.slowest_speed * self.slowest_speed) / (self.reference_speed * self.reference_speed);
        ratio.power(self.exponent * 0.5)
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for Rate<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["sinkage"],
            seen_on_rover: &["wheel[1].sinkage"],
            seen_in_soil_test: &["force", "pressure"],
            advice: const {
                &[
                    Advice::carriage("repeat a steady point at three wheel speeds that span a factor of ten"),
                    Advice::rover("repeat a level run at three speeds that span a factor of ten"),
                    Advice::plate("press the same plate at three speeds that span a factor of ten"),
                ]
            },
            ..Facts::USUAL
        }
    }

    fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        if !self.exponent.is_exactly(0.0) {
            local.soil.scale_moduli(self.factor(place.velocity, place.sinkage, local.wheel.radius));
        }
    }
}
