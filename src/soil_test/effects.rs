//! The ways in which a soil test fails: parameters, form and what a page says of each.

use super::{Pressing, ShearBox, Shearing, SoilBox, TestEffect};
use crate::effects::{Advice, Facts};
use crate::scalar::Scalar;
use bekker_modeldescription::{Unit, parameters};

/// Signals of a plate test.
const PRESSED: &[&str] = &["force", "pressure"];
/// Signals of a shear test.
const SHEARED: &[&str] = &["shear_stress"];

parameters! {
    /// p grows by (b/b_0)^m beside Bekker's k_c/b + k_phi, as resistance does that comes from the weight of the soil aside of
    /// the plate: the bearing capacity of a footing grows with its width (Terzaghi 1943). Plates of one size do not tell it
    /// from k_phi, and of two sizes not from k_c and k_phi.
    pub struct PlateSize {
        /// Exponent m of the contact's width.
        exponent: [Unit::ONE] = 0.0, -1.0..=3.0, Effect, "0: Bekker 1969; 1: a footing on sand without cohesion, Terzaghi 1943";
        /// Width b_0 at which the soil's moduli hold.
        reference_width: [Unit::METRE] = 0.05, 1e-3..=1.0, Fixed, "assumption: a plate of 10 cm";
    }
}

impl<S: Scalar> TestEffect<S> for PlateSize<S> {
    fn facts(&self) -> Facts {
        const ADVICE: &[Advice] =
            &[Advice::plate("press a plate of twice the size into the same soil, three times each")];
        Facts { seen_in_soil_test: PRESSED, typical: &[("exponent", 0.8)], advice: ADVICE, ..Facts::USUAL }
    }

    fn press(&self, _: &SoilBox<S>, at: &mut Pressing<S>) {
        if !self.exponent.is_exactly(0.0) {
            at.factor *= (at.width / self.reference_width).power(self.exponent);
        }
    }
}

parameters! {
    /// Walls hold back the soil that a plate pushes aside: p grows by 1 + a (d/W)^2, with the plate's size d and the distance W
    /// of the walls (`soil_box.width`). An empirical form without a standard source; the square makes walls of five
    /// plate sizes, the usual rule, a matter of a per cent for a = 0.25.
    pub struct BoxWalls {
        /// Strength a.
        strength: [Unit::ONE] = 0.0, 0.0..=50.0, Effect, "empirical";
    }
}

impl<S: Scalar> TestEffect<S> for BoxWalls<S> {
    fn facts(&self) -> Facts {
        const ADVICE: &[Advice] = &[Advice::plate("press the same plate in a box of twice the width")];
        Facts { seen_in_soil_test: PRESSED, typical: &[("strength", 5.0)], advice: ADVICE, ..Facts::USUAL }
    }

    fn press(&self, soil_box: &SoilBox<S>, at: &mut Pressing<S>) {
        if !self.strength.is_exactly(0.0) {
            let share = at.size / soil_box.width;
            at.factor *= self.strength * share * share + 1.0;
        }
    }
}

parameters! {
    /// A stiff bottom carries what the soil above it cannot spread: p grows by 1 + a (z/H)^g exp(-(H - z)/(l d)), with the depth
    /// H of the soil (`soil_box.depth`), the sinkage z and the plate's size d. An empirical form without a standard source;
    /// the stress under a plate falls to a tenth over about two of its sizes (Boussinesq 1885), which is l = 0.9. With g = 0 the
    /// bottom acts from the first touch on, as under a footing on an elastic layer; on a thin layer that is indented it acts
    /// the more the deeper the indentation, with its square root under a sphere (Dimitriadis et al. 2002, eq. 12).
    pub struct BoxBottom {
        /// Strength a.
        strength: [Unit::ONE] = 0.0, 0.0..=50.0, Effect, "empirical";
        /// Reach l of the bottom, in sizes of the plate.
        reach: [Unit::ONE] = 1.0, 0.3..=5.0, Effect, "empirical; 0.9: Boussinesq 1885";
        /// Exponent g by which the bottom acts more the deeper the plate sinks.
        growth: [Unit::ONE] = 0.0, 0.0..=2.0, Effect, "empirical; 0.5: Dimitriadis et al. 2002, eq. 12, a thin layer under a sphere";
    }
}

impl<S: Scalar> TestEffect<S> for BoxBottom<S> {
    fn facts(&self) -> Facts {
        const ADVICE: &[Advice] = &[Advice::plate("press the same plate into soil of twice the depth")];
        Facts { seen_in_soil_test: PRESSED, typical: &[("strength", 5.0)], advice: ADVICE, ..Facts::USUAL }
    }

    fn press(&self, soil_box: &SoilBox<S>, at: &mut Pressing<S>) {
        if !self.strength.is_exactly(0.0) {
            let reached = ((at.sinkage - soil_box.depth) / (self.reach * at.size)).exponential();
            at.factor *= self.strength * (at.sinkage / soil_box.depth).power(self.growth) * reached + 1.0;
        }
    }
}

parameters! {
    /// The sinkage counts from another place than where the plate meets the soil: z becomes z + z_0. A heap, a tilted plate or
    /// a late first touch have the same effect.
    pub struct Seating {
        /// Sinkage z_0 of the soil where the recorded one is 0.
        offset: [Unit::METRE] = 0.0, -0.02..=0.02, Effect, "play and settling of a press: 0.2-2 mm";
    }
}

impl<S: Scalar> TestEffect<S> for Seating<S> {
    fn facts(&self) -> Facts {
        const ADVICE: &[Advice] = &[Advice::plate(
            "find the first touch by the force on an unloaded plate, and level the soil before each test",
        )];
        Facts { seen_in_soil_test: PRESSED, typical: &[("offset", 0.001)], advice: ADVICE, ..Facts::USUAL }
    }

    fn press(&self, _: &SoilBox<S>, at: &mut Pressing<S>) {
        if !self.offset.is_exactly(0.0) {
            at.sinkage += self.offset;
        }
    }
}

parameters! {
    /// tau grows by (v/v_0)^m with the speed v of the displacement (`shear_box.speed`).
    pub struct ShearRate {
        /// Exponent m of the speed.
        exponent: [Unit::ONE] = 0.0, 0.0..=0.4, Effect, "clay gains about 10 % over a decade of speed, m = 0.04: Kulhawy and Mayne 1990";
        /// Speed v_0 at which the soil's strength holds.
        reference_speed: [Unit::METRE_PER_SECOND] = 0.001, 1e-7..=1.0, Fixed, "assumption: a slow shear box";
    }
}

impl<S: Scalar> TestEffect<S> for ShearRate<S> {
    fn facts(&self) -> Facts {
        const ADVICE: &[Advice] = &[Advice::shear("repeat a test at three speeds that span a factor of a hundred")];
        Facts { seen_in_soil_test: SHEARED, typical: &[("exponent", 0.05)], advice: ADVICE, ..Facts::USUAL }
    }

    fn shear(&self, shear_box: &ShearBox<S>, at: &mut Shearing<S>) {
        if !self.exponent.is_exactly(0.0) {
            at.factor *= (shear_box.speed / self.reference_speed).power(self.exponent);
        }
    }
}

parameters! {
    /// The rig resists by itself: tau grows by tau_f from the first displacement on, whereas the soil's own stress builds up
    /// over K.
    pub struct BoxFriction {
        /// Stress tau_f.
        stress: [Unit::PASCAL] = 0.0, 0.0..=20_000.0, Effect, "friction of an empty box: measure it";
    }
}

impl<S: Scalar> TestEffect<S> for BoxFriction<S> {
    fn facts(&self) -> Facts {
        const ADVICE: &[Advice] =
            &[Advice::shear("shear once without soil: what is measured then is friction of the box")];
        Facts { seen_in_soil_test: SHEARED, typical: &[("stress", 500.0)], advice: ADVICE, ..Facts::USUAL }
    }

    fn shear(&self, _: &ShearBox<S>, at: &mut Shearing<S>) {
        if !self.stress.is_exactly(0.0) {
            at.added += self.stress;
        }
    }
}

parameters! {
    /// The first displacement j_0 closes gaps and shears nothing: j becomes j - j_0, not below 0. Gaps that close one after the other round
    /// the corner: j becomes q(j) - q(0) with q = (j - j_0 + sqrt((j - j_0)^2 + (w j_0)^2))/2, an empirical form.
    pub struct ShearPlay {
        /// Displacement j_0.
        displacement: [Unit::METRE] = 0.0, 0.0..=0.02, Effect, "play of a ring or box: 0.1-2 mm";
        /// Width w of the rounded corner, over j_0.
        rounding: [Unit::ONE] = 0.0, 0.0..=2.0, Effect, "empirical; 0: one gap";
    }
}

impl<S: Scalar> TestEffect<S> for ShearPlay<S> {
    fn facts(&self) -> Facts {
        const ADVICE: &[Advice] =
            &[Advice::shear("record the displacement at the soil, or from the first rise of the stress on")];
        Facts { seen_in_soil_test: SHEARED, typical: &[("displacement", 0.001)], advice: ADVICE, ..Facts::USUAL }
    }

    fn shear(&self, _: &ShearBox<S>, at: &mut Shearing<S>) {
        if !self.displacement.is_exactly(0.0) {
            let beyond = at.displacement - self.displacement;
            at.displacement = if self.rounding.is_exactly(0.0) {
                beyond
            } else {
                let width = self.rounding * self.displacement;
                let squared = beyond * beyond + width * width;
                let there = squared.over(0.0);
                // The root has no slope at 0.
                let root = S::select(there, S::select(there, squared, S::from(1.0)).sqrt(), S::from(0.0));
                let at_rest = self.displacement * ((self.rounding * self.rounding + 1.0).sqrt() - 1.0);
                (beyond + root - at_rest) * 0.5
            };
        }
    }
}

parameters! {
    /// Dense soil loosens as it is sheared, and the stress falls behind its peak: tau is multiplied by
    /// 1 - s (1 - exp(-(j/L)^2)). An empirical form; Wong 2008, 2.4.3 shows curves of this shape.
    pub struct ShearSoftening {
        /// Share s of the strength that is lost in the end.
        drop: [Unit::ONE] = 0.0, 0.0..=0.9, Effect, "empirical: dense sand 0.1-0.3";
        /// Displacement L over which it is lost.
        displacement: [Unit::METRE] = 0.03, 0.001..=0.3, Effect, "empirical: a few K";
    }
}

impl<S: Scalar> TestEffect<S> for ShearSoftening<S> {
    fn facts(&self) -> Facts {
        const ADVICE: &[Advice] = &[Advice::shear("shear to ten times the displacement at which the stress peaks")];
        const TYPICAL: &[(&str, f64)] = &[("drop", 0.2), ("displacement", 0.03)];
        Facts { seen_in_soil_test: SHEARED, typical: TYPICAL, advice: ADVICE, ..Facts::USUAL }
    }

    fn shear(&self, _: &ShearBox<S>, at: &mut Shearing<S>) {
        if !self.drop.is_exactly(0.0) {
            let ratio = at.displacement / self.displacement;
            at.factor *= -self.drop * (-(-ratio * ratio).exponential() + 1.0) + 1.0;
        }
    }
}
