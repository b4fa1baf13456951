//! Strength of the soil that differs with its moisture, its place and its slope.

use super::{Effect, Local, Place};
use crate::scalar::Scalar;
use bekker_modeldescription::{Unit, parameters};

/// Slope over which |gamma| is rounded, rad: sqrt(gamma^2 + e^2) - e has a derivative everywhere.
const ROUNDED_SLOPE: f64 = 0.02;

parameters! {
    /// Water binds the grains: c grows by s w, with the water content w measured for each run. A straight line stands
    /// for the rising branch, up to about half of saturation (Fredlund and Rahardjo 1993 for the cause).
    pub struct Moisture {
        /// Water content w, mass of water over mass of grains; a measurement, set for each run.
        content: [Unit::ONE] = 0.0, 0.0..=0.6, Fixed, "measured";
        /// Growth s of the cohesion with the water content.
        cohesion_slope: [Unit::PASCAL] = 0.0, 0.0..=50_000.0, Effect, "sand from dry to moist: 0.2 to 2.4 kPa over 0.1-0.2";
    }
}

parameters! {
    /// Softer ground around one place: k_c and k_phi times 1 - s/(1 + ((x - x_c)/l)^4). The window has a derivative in
    /// its place and width everywhere, so a search finds them. Any empirical window would do; it has no standard source.
    pub struct SoftPatch {
        /// Share s of the moduli that is missing at the centre.
        softening: [Unit::ONE] = 0.0, 0.0..=0.9, Effect, "assumption: up to a tenth of the moduli left";
        /// Centre x_c along x.
        centre: [Unit::METRE] = 1.0, -50.0..=50.0, Effect, "somewhere on the way";
        /// Half-width l, where half of the softening is reached.
        half_width: [Unit::METRE] = 0.3, 0.05..=3.0, Effect, "from a contact's length to a few rover lengths";
    }
}

parameters! {
    /// Soil on a slope is weaker: phi - beta |gamma|. Empirical: loosening by the slope and the wheel, no standard source.
    pub struct SlopeStrength {
        /// Loss beta of the friction angle with the slope.
        beta: [Unit::ONE] = 0.0, 0.0..=0.4, Effect, "assumption: 1-3 degrees at 10-20 degrees of slope";
    }
}

impl<S: Scalar> Effect<S> for Moisture<S> {
    #[cfg_attr(feature = "batch", inline(always))]
    fn contact(&self, _place: &Place<S>, local: &mut Local<S>) {
        if !self.cohesion_slope.is_exactly(0.0) {
            local.soil.cohesion += self.cohesion_slope * self.content;
        }
    }
}

impl<S: Scalar> Effect<S> for SoftPatch<S> {
    #[cfg_attr(feature = "batch", inline(always))]
    fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        let Some(x) = place.x else { return };
        if self.softening.is_exactly(0.0) {
            return;
        }
        let squared = ((x - self.centre) / self.half_width).powi(2);
        local.soil.scale_moduli(-(self.softening / (squared * squared + 1.0)) + 1.0);
    }
}

impl<S: Scalar> Effect<S> for SlopeStrength<S> {
    #[cfg_attr(feature = "batch", inline(always))]
    fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        if self.beta.is_exactly(0.0) {
            return;
        }
        let angle = place.contact_angle;
        let slope = (angle * angle + ROUNDED_SLOPE * ROUNDED_SLOPE).sqrt() - ROUNDED_SLOPE;
        local.soil.friction_angle = (local.soil.friction_angle - self.beta * slope).larger(S::from(0.0));
    }
}
