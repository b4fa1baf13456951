//! Profiles by formula: slope, waves, ditch, step.

use super::curve::{Curve, Sample, cut_at};
use crate::scalar::{Mask, Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};
use std::f64::consts::TAU;

parameters! {
    /// An inclined plane through the origin: z = x tan(slope).
    pub struct Slope {
        /// Inclination of the plane, uphill along x positive.
        slope: [Unit::RADIAN] = 10.0_f64.to_radians(), -1.0..=1.0, Fixed, "preset; 20 degrees in Iagnemma 2001, 2.6";
    }
}

parameters! {
    /// Waves behind a level run-in: z = A (1 - cos(2 pi (x - start)/wavelength)) beyond `start`, 0 before it; C1 there.
    pub struct Waves {
        /// Amplitude A: half the height from trough to crest.
        amplitude: [Unit::METRE] = 0.05, 0.0..=2.0, Fixed, "preset";
        /// Distance from crest to crest.
        wavelength: [Unit::METRE] = 2.0, 0.1..=1000.0, Fixed, "preset";
        /// Where the waves begin; far behind the rover it only sets their phase.
        start: [Unit::METRE] = 0.5, -1e4..=1e4, Fixed, "preset";
    }
}

parameters! {
    /// A ditch with the shape of one period of a cosine, C1 at its rims.
    pub struct Ditch {
        /// Depth below the level ground; negative for a mound.
        depth: [Unit::METRE] = 0.1, -5.0..=5.0, Fixed, "preset; about one wheel diameter in Iagnemma 2001, 4.4";
        /// Distance from rim to rim.
        width: [Unit::METRE] = 0.6, 0.05..=100.0, Fixed, "preset; two to four wheel diameters";
        /// Position of the deepest place.
        position: [Unit::METRE] = 2.0, -1e4..=1e4, Fixed, "preset";
    }
}

parameters! {
    /// A step from the level z = 0 to another with a cubic face, C1 at both edges; its steepest slope is 1.5 height/length.
    pub struct Step {
        /// Height of the upper level; negative for a step down.
        height: [Unit::METRE] = 0.05, -5.0..=5.0, Fixed, "preset";
        /// Length of the face along x.
        length: [Unit::METRE] = 0.2, 0.005..=100.0, Fixed, "preset";
        /// Position where the face begins.
        position: [Unit::METRE] = 2.0, -1e4..=1e4, Fixed, "preset";
    }
}

fn level<S: Scalar>(height: S) -> Sample<S> {
    Sample { height, slope: S::from(0.0), curvature: S::from(0.0) }
}

#[lanes]
impl<S: Scalar> Sample<S> {
    /// `self`, or level ground at `height` where the mask says so.
    fn or_level(self, mask: S::Mask, height: S) -> Self {
        let choose = |level: S, own: S| S::select(mask, level, own);
        Self {
            height: choose(height, self.height),
            slope: choose(S::from(0.0), self.slope),
            curvature: choose(S::from(0.0), self.curvature),
        }
    }
}

/// Bound on the curvature within `half` of a place where it is `curvature`, given a bound on the third derivative.
pub(super) fn bend_nearby(curvature: f64, third: f64, half: f64, most: f64) -> f64 {
    (curvature + third * half).min(most)
}

impl<S: Scalar> Curve<S> for Slope<S> {
    fn at(&self, x: S) -> Sample<S> {
        let (sin, cos) = self.slope.sine_cosine();
        let slope = sin / cos;
        Sample { height: slope * x, slope, curvature: S::from(0.0) }
    }

    fn bend(&self, _: f64, _: f64, _: f64, _: &Sample<f64>) -> f64 {
        0.0
    }
}

#[lanes]
impl<S: Scalar> Curve<S> for Waves<S> {
    fn at(&self, x: S) -> Sample<S> {
        let along = x - self.start;
        let before = along.under(0.0);
        if before.all() {
            return level(S::from(0.0));
        }
        let k = S::from(TAU) / self.wavelength;
        let (sin, cos) = (along * k).sine_cosine();
        let rise = self.amplitude * k;
        let waves = Sample { height: self.amplitude * (-cos + 1.0), slope: rise * sin, curvature: rise * k * cos };
        waves.or_level(before, S::from(0.0))
    }

    fn bend(&self, side: f64, from: f64, to: f64, middle: &Sample<f64>) -> f64 {
        let start = self.start.value();
        let k = TAU / self.wavelength.value();
        let most = self.amplitude.value() * k * k;
        if to <= start {
            0.0
        } else if from < start {
            most
        } else {
            bend_nearby(side * middle.curvature, most * k, 0.5 * (to - from), most)
        }
    }

    fn most_bend(&self, _: S, _: S) -> S {
        let k = S::from(TAU) / self.wavelength;
        self.amplitude * k * k
    }

    fn cut(&self, from: f64, to: f64) -> f64 {
        let start = self.start.value();
        cut_at([start, start], from, to)
    }
}

impl<S: Scalar> Ditch<S> {
    fn rims(&self) -> [f64; 2] {
        let half = 0.5 * self.width.value();
        [self.position.value() - half, self.position.value() + half]
    }
}

#[lanes]
impl<S: Scalar> Curve<S> for Ditch<S> {
    fn at(&self, x: S) -> Sample<S> {
        let along = x - self.position;
        let outside = (self.width * 0.5).at_most(along.abs());
        if outside.all() {
            return level(S::from(0.0));
        }
        let k = S::from(TAU) / self.width;
        let (sin, cos) = (along * k).sine_cosine();
        let half = self.depth * 0.5;
        let ditch = Sample { height: -half * (cos + 1.0), slope: half * k * sin, curvature: half * k * k * cos };
        ditch.or_level(outside, S::from(0.0))
    }

    fn bend(&self, side: f64, from: f64, to: f64, middle: &Sample<f64>) -> f64 {
        let [left, right] = self.rims();
        let k = TAU / self.width.value();
        let most = 0.5 * self.depth.value().abs() * k * k;
        if to <= left || from >= right {
            0.0
        } else if from < left || to > right {
            most
        } else {
            bend_nearby(side * middle.curvature, most * k, 0.5 * (to - from), most)
        }
    }

    fn most_bend(&self, _: S, _: S) -> S {
        let k = S::from(TAU) / self.width;
        self.depth.abs() * 0.5 * k * k
    }

    fn cut(&self, from: f64, to: f64) -> f64 {
        cut_at(self.rims(), from, to)
    }
}

impl<S: Scalar> Step<S> {
    fn edges(&self) -> [f64; 2] {
        let start = self.position.value();
        [start, start + self.length.value()]
    }
}

#[lanes]
impl<S: Scalar> Curve<S> for Step<S> {
    fn at(&self, x: S) -> Sample<S> {
        let u = (x - self.position) / self.length;
        let (before, behind) = (u.at_most(S::from(0.0)), S::from(1.0).at_most(u));
        let rise = self.height / self.length;
        let face = Sample {
            height: self.height * u * u * (-u * 2.0 + 3.0),
            slope: rise * u * (-u + 1.0) * 6.0,
            curvature: rise / self.length * (-u * 12.0 + 6.0),
        };
        face.or_level(before, S::from(0.0)).or_level(behind, self.height)
    }

    fn bend(&self, side: f64, from: f64, to: f64, _: &Sample<f64>) -> f64 {
        let [left, right] = self.edges();
        if to <= left || from >= right {
            return 0.0;
        }
        // Linear on the face: largest at one end of the part that lies on it.
        let length = self.length.value();
        let at = |x: f64| side * self.height.value() / (length * length) * (6.0 - 12.0 * (x - left) / length);
        let face = at(from.max(left)).max(at(to.min(right)));
        if from < left || to > right { face.max(0.0) } else { face }
    }

    fn most_bend(&self, _: S, _: S) -> S {
        // At the ends of the face; a little more than rounding makes of it.
        self.height.abs() * 6.000_001 / (self.length * self.length)
    }

    fn cut(&self, from: f64, to: f64) -> f64 {
        cut_at(self.edges(), from, to)
    }
}
