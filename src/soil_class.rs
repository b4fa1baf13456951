//! Classes of soil: what is believable for a dry sand, a loam, a clay, snow, before anything is measured.
//!
//! A class has two things: priors (mean and standard deviation) for a calibration that has no plate and shear tests, and the
//! widest cohesion, friction angle and sinkage exponent that the class allows. Both come from published tables:
//!
//! * Wong, Theory of Ground Vehicles, table of terrain values: dry sand n 1.1, c 1.04 kPa, phi 28 deg; LETE sand 0.793, 1.3,
//!   31.1; sandy loam 0.2 to 1.1, 1.7 to 3.3, 29 to 33.7; clayey soil 0.5, 4.14, 13; lean and heavy clay 0.13 to 0.2, 69, 20
//!   to 34; snow 1.44 to 1.6, 1.0 to 6, 19.7 to 20.7;
//! * Ding et al. 2011, J. Terramechanics 48: planetary simulant n 1.1, c 0.25 kPa, phi 31.9 deg, K 9.7 to 13.1 mm;
//! * lunar regolith n 1, c 0.17 kPa, phi 35 deg, K 18 mm; Ishigami 2008: n 1, c 0.8 kPa, phi 37.2 deg;
//! * Wong and Reece 1967: c1 0.43, c2 0.32 in compact sand, 0.18 and 0.32 in loose sand; Ishigami 2008: 0.4 and 0.15.
//!
//! Plates on loose sands under small loads give exponents up to 1.5, which the limits of sand and regolith leave room for.
//! `k_phi` spans two decades within every class, so that no class has a prior for it.

use std::ops::RangeInclusive;

/// A class of soil, by what it allows.
#[derive(Debug, PartialEq)]
pub struct SoilClass {
    /// Name in `experiment.toml`: `soil.class = "dry sand"`.
    pub name: &'static str,
    /// Where its figures come from.
    pub source: &'static str,
    /// Parameter, mean and standard deviation, SI units.
    pub priors: &'static [(&'static str, f64, f64)],
    /// Parameter, lowest and highest value that the class allows, SI units.
    pub limits: [(&'static str, f64, f64); 3],
}

const COHESION: &str = "soil.cohesion";
const FRICTION: &str = "soil.friction_angle";
const EXPONENT: &str = "soil.exponent";
const MODULUS: &str = "soil.shear_modulus";
const C1: &str = "soil.c1";
const C2: &str = "soil.c2";

const fn degrees(angle: f64) -> f64 {
    angle * std::f64::consts::PI / 180.0
}

/// Position of the largest stress, the same in every class: few have measured it.
const STRESS: [(&str, f64, f64); 2] = [(C1, 0.35, 0.1), (C2, 0.25, 0.1)];

/// All classes.
pub const SOIL_CLASSES: [SoilClass; 5] = [
    SoilClass {
        name: "dry sand",
        source: "Wong (dry sand, LETE sand); Ding et al. 2011; Wong and Reece 1967",
        priors: &[
            (COHESION, 600.0, 500.0),
            (FRICTION, degrees(31.0), degrees(3.5)),
            (EXPONENT, 1.1, 0.2),
            (MODULUS, 0.015, 0.006),
            STRESS[0],
            STRESS[1],
        ],
        limits: [(COHESION, 0.0, 2500.0), (FRICTION, degrees(22.0), degrees(45.0)), (EXPONENT, 0.6, 1.7)],
    },
    SoilClass {
        name: "regolith simulant",
        source: "lunar regolith; Ishigami 2008; Ding et al. 2011",
        priors: &[
            (COHESION, 500.0, 400.0),
            (FRICTION, degrees(35.0), degrees(3.5)),
            (EXPONENT, 1.05, 0.15),
            (MODULUS, 0.018, 0.008),
            STRESS[0],
            STRESS[1],
        ],
        limits: [(COHESION, 0.0, 2500.0), (FRICTION, degrees(25.0), degrees(50.0)), (EXPONENT, 0.6, 1.7)],
    },
    SoilClass {
        name: "sandy loam",
        source: "Wong (sandy loams of several moistures)",
        priors: &[
            (COHESION, 2500.0, 1500.0),
            (FRICTION, degrees(30.0), degrees(3.0)),
            (EXPONENT, 0.75, 0.25),
            (MODULUS, 0.02, 0.01),
            STRESS[0],
            STRESS[1],
        ],
        limits: [(COHESION, 300.0, 15_000.0), (FRICTION, degrees(18.0), degrees(42.0)), (EXPONENT, 0.2, 1.3)],
    },
    SoilClass {
        name: "clay",
        source: "Wong (clayey soil, lean and heavy clay)",
        priors: &[
            (COHESION, 10_000.0, 8000.0),
            (FRICTION, degrees(15.0), degrees(6.0)),
            (EXPONENT, 0.5, 0.2),
            (MODULUS, 0.008, 0.004),
            STRESS[0],
            STRESS[1],
        ],
        limits: [(COHESION, 1500.0, 80_000.0), (FRICTION, degrees(2.0), degrees(35.0)), (EXPONENT, 0.1, 1.0)],
    },
    SoilClass {
        name: "snow",
        source: "Wong (snow)",
        priors: &[
            (COHESION, 2500.0, 2000.0),
            (FRICTION, degrees(20.0), degrees(3.0)),
            (EXPONENT, 1.5, 0.2),
            (MODULUS, 0.03, 0.01),
            STRESS[0],
            STRESS[1],
        ],
        limits: [(COHESION, 100.0, 10_000.0), (FRICTION, degrees(12.0), degrees(30.0)), (EXPONENT, 0.9, 1.9)],
    },
];

impl SoilClass {
    /// The class called `name`.
    #[must_use]
    pub fn find(name: &str) -> Option<&'static Self> {
        SOIL_CLASSES.iter().find(|class| class.name == name)
    }

    /// Names of all classes, for messages.
    #[must_use]
    pub fn names() -> String {
        SOIL_CLASSES.each_ref().map(|class| class.name).join(", ")
    }

    /// What the class allows for a parameter; `None` where it says nothing of it.
    #[must_use]
    pub fn allows(&self, parameter: &str) -> Option<RangeInclusive<f64>> {
        self.limits.iter().find(|(name, ..)| *name == parameter).map(|(_, low, high)| *low..=*high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_priors_lie_within_what_their_class_allows() {
        for class in &SOIL_CLASSES {
            for (name, mean, _) in class.priors {
                assert!(class.allows(name).is_none_or(|range| range.contains(mean)), "{}: {name}", class.name);
            }
        }
    }

    #[test]
    fn published_soils_are_allowed_by_their_classes() {
        // c, phi (deg), n of the tables named above.
        let published = [
            ("dry sand", 1040.0, 28.0, 1.1),
            ("dry sand", 1300.0, 31.1, 0.793),
            ("dry sand", 250.0, 31.9, 1.1),
            ("regolith simulant", 170.0, 35.0, 1.0),
            ("regolith simulant", 800.0, 37.2, 1.0),
            ("sandy loam", 1720.0, 29.0, 0.7),
            ("clay", 4140.0, 13.0, 0.5),
            ("snow", 1030.0, 19.7, 1.6),
        ];
        for (name, cohesion, angle, exponent) in published {
            let class = SoilClass::find(name).expect("a class of the table");
            for (parameter, value) in [(COHESION, cohesion), (FRICTION, f64::to_radians(angle)), (EXPONENT, exponent)] {
                assert!(class.allows(parameter).is_some_and(|range| range.contains(&value)), "{name}: {parameter}");
            }
        }
    }
}
