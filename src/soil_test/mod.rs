//! Tests of a soil without a wheel: a plate that is pressed into it, and a shear ring or box.
//!
//! A **plate** sinks by z under the pressure p = (k_c/b + k_phi) z^n (Bekker 1969), where b is the smaller dimension of its
//! contact: the radius of a round plate, the shorter side of a rectangular one (Wong 2008, 2.4). It tells k_c, k_phi and n.
//!
//! A **shear test** displaces the soil by j under the normal stress sigma, which takes the shear stress
//! tau = (c + sigma tan phi)(1 - exp(-j/K)) (Janosi and Hanamoto 1961). It tells c, phi and K.
//!
//! Both have their own ways to fail: [`TestEffects`], each neutral by default, like the [`Effects`](crate::effects) of a wheel.
//! Effects of the soil itself, [`Rate`] and [`Moisture`], are those of the wheel.

mod effect;
mod effects;
mod rig;
mod table;

pub use effect::{Pressing, Shearing, TestEffect};
pub use effects::{BoxBottom, BoxFriction, BoxWalls, PlateSize, Seating, ShearPlay, ShearRate, ShearSoftening};
pub use rig::{Plate, PlateError, ShearBox, SoilBox};
pub use table::{TEST_EFFECTS, TestEffects};

use crate::effects::{Moisture, Rate};
use crate::rover::Rover;
use crate::scalar::{MapScalar, Scalar};
use crate::soil::Soil;
use bekker_modeldescription::{Parameters, Unit, Variable, join, parameters};

parameters! {
    /// What a soil test is set to and what it measures.
    pub struct SoilTestSignals {
        /// Sinkage of the plate from its first touch.
        sinkage: [Unit::METRE] = 0.0, 0.0..=10.0, Signal, "input of a plate test";
        /// Force on the plate, downward.
        force: [Unit::NEWTON] = 0.0, -1e9..=1e9, Signal, "plate test";
        /// Pressure under the plate.
        pressure: [Unit::PASCAL] = 0.0, -1e9..=1e9, Signal, "plate test";
        /// Shear displacement.
        displacement: [Unit::METRE] = 0.0, 0.0..=10.0, Signal, "input of a shear test";
        /// Normal stress on the sheared surface.
        normal_stress: [Unit::PASCAL] = 0.0, 0.0..=1e9, Signal, "input of a shear test";
        /// Shear stress on it.
        shear_stress: [Unit::PASCAL] = 0.0, -1e9..=1e9, Signal, "shear test";
    }
}

/// The rig of a soil test and what may be wrong with it.
#[derive(Clone, Debug, PartialEq, MapScalar)]
pub struct TestRig<S = f64> {
    /// The plate.
    pub plate: Plate<S>,
    /// The box that holds the soil.
    pub soil_box: SoilBox<S>,
    /// The shear ring or box.
    pub shear_box: ShearBox<S>,
    /// What the ideal test lacks, neutral by default.
    pub effects: TestEffects<S>,
}

impl<S: From<f64>> Default for TestRig<S> {
    fn default() -> Self {
        Self {
            plate: Plate::default(),
            soil_box: SoilBox::default(),
            shear_box: ShearBox::default(),
            effects: TestEffects::default(),
        }
    }
}

impl<S: Scalar> Parameters<S> for TestRig<S> {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
        self.plate.visit(&join(prefix, "plate"), f);
        self.soil_box.visit(&join(prefix, "soil_box"), f);
        self.shear_box.visit(&join(prefix, "shear_box"), f);
        self.effects.visit(prefix, f);
    }

    fn values(&self, f: &mut dyn FnMut(S)) {
        self.plate.values(f);
        self.soil_box.values(f);
        self.shear_box.values(f);
        self.effects.values(f);
    }
}

/// A soil in a test: all that decides what is measured.
#[derive(Clone, Debug, PartialEq, MapScalar)]
pub struct SoilTest<S = f64> {
    /// The soil.
    pub soil: Soil<S>,
    /// Its resistance to fast penetration.
    pub rate: Rate<S>,
    /// Its cohesion by its water.
    pub moisture: Moisture<S>,
    /// The rig.
    pub rig: TestRig<S>,
}

impl SoilTest {
    /// The soil of a rover, in this rig.
    #[must_use]
    pub fn of(rover: &Rover, rig: &TestRig) -> Self {
        Self { soil: rover.soil, rate: rover.effects.rate, moisture: rover.effects.moisture, rig: rig.clone() }
    }
}

impl<S: Scalar> SoilTest<S> {
    /// Pressure (Pa) under the plate at a sinkage (m) from the first touch.
    pub fn pressure(&self, sinkage: f64) -> S {
        let TestRig { plate, soil_box, effects, .. } = &self.rig;
        let mut at = Pressing {
            sinkage: S::from(sinkage),
            width: plate.contact_width(),
            size: plate.size(),
            factor: S::from(1.0),
        };
        effects.press(soil_box, &mut at);
        let depth = at.sinkage.larger(S::from(0.0));
        self.soil.pressure(depth, at.width) * at.factor * self.rate.factor_of(plate.speed)
    }

    /// Force (N) on the plate at a sinkage (m) from the first touch.
    pub fn force(&self, sinkage: f64) -> S {
        self.pressure(sinkage) * self.rig.plate.area()
    }

    /// Shear stress (Pa) at a displacement (m) under a normal stress (Pa).
    pub fn shear_stress(&self, displacement: f64, normal_stress: f64) -> S {
        let TestRig { shear_box, effects, .. } = &self.rig;
        let mut at = Shearing { displacement: S::from(displacement), factor: S::from(1.0), added: S::from(0.0) };
        effects.shear(shear_box, &mut at);
        let moved = at.displacement.larger(S::from(0.0));
        let cohesion = self.soil.cohesion + self.moisture.added_cohesion();
        let strength = cohesion + self.soil.friction_angle.tan() * normal_stress;
        let built_up = -(-moved / self.soil.shear_modulus).exponential() + 1.0;
        strength * built_up * at.factor + at.added
    }
}

impl<S: Scalar> Parameters<S> for SoilTest<S> {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
        self.soil.visit(&join(prefix, "soil"), f);
        self.rate.visit(&join(prefix, "rate"), f);
        self.moisture.visit(&join(prefix, "moisture"), f);
        self.rig.visit(prefix, f);
    }

    fn values(&self, f: &mut dyn FnMut(S)) {
        self.soil.values(f);
        self.rate.values(f);
        self.moisture.values(f);
        self.rig.values(f);
    }
}

#[cfg(test)]
mod tests;
