//! Soil that a wheel pushes ahead.

use super::{Effect, Facts, Local, Place, SOIL_TEST};
use crate::scalar::{Mask, Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};
use std::f64::consts::FRAC_PI_4;

parameters! {
    /// The wheel pushes the soil ahead like a blade as deep as its sinkage: passive earth pressure
    /// R = s b (gamma z^2/2 K_p + 2 c z sqrt K_p), K_p = tan^2(pi/4 + phi/2), against the motion.
    pub struct Bulldozing {
        /// Share s of the passive pressure on a blade of the wheel's width; the soil's sides and heap may exceed 1.
        share: [Unit::ONE] = 0.0, 0.0..=3.0, Effect, "Hegedus 1960; Bekker 1969; Wong 2008, 2.2: 0-3 N on small wheels";
        /// Unit weight gamma of the soil.
        unit_weight: [Unit::NEWTON_PER_METRE3] = 16_000.0, 0.0..=40_000.0, Fixed, "dry sand on Earth: 14-17 kN/m3";
    }
}

#[lanes]
impl<S: Scalar> Bulldozing<S> {
    /// R on a wheel of width `width` at depth `depth`, N.
    fn resistance(&self, depth: S, width: S, cohesion: S, friction_angle: S) -> S {
        let root = (friction_angle * 0.5 + FRAC_PI_4).tan(); // sqrt K_p
        let weight = self.unit_weight * depth * depth * root * root * 0.5;
        self.share * width * (weight + cohesion * depth * root * 2.0)
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for Bulldozing<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["drawbar_pull"],
            seen_on_rover: &["wheel[1].torque", "wheel[1].sinkage"],
            advice: &[SOIL_TEST],
            ..Facts::USUAL
        }
    }

    fn surface(&self, place: &Place<S>, local: &mut Local<S>) {
        let sunk = place.sinkage.over(0.0);
        if self.share.is_exactly(0.0) || !sunk.any() {
            return;
        }
        let (soil, before) = (&local.soil, local.surface.resistance);
        let resistance = self.resistance(place.sinkage, local.wheel.width, soil.cohesion, soil.friction_angle);
        local.surface.resistance = S::select(sunk, before + resistance, before);
    }
}
