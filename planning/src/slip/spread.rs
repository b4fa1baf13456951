//! What is known of a soil's numbers beside their values.

use bekker::known_soil::KnownSoil;
use bekker::soil::Soil;
use bekker::soil_class::{SOIL_CLASSES, SoilClass};
use bekker_modeldescription::Lookup;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// How far a soil's numbers may be from those stated.
#[derive(Clone, Debug, PartialEq)]
pub enum SoilSpread {
    /// Standard deviations of a class of soil, around the soil's own values.
    Class {
        /// The class.
        class: &'static SoilClass,
        /// Whether nobody has named it: it is the class nearest to the soil.
        assumed: bool,
    },
    /// The covariance that experiments have found.
    Known(KnownSoil),
}

/// No class of soil has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no class of soil is called `{0}`; expected one of {classes}", classes = SoilClass::names())]
pub struct UnknownClass(pub String);

impl SoilSpread {
    /// The spread of a class of soil that is named.
    ///
    /// # Errors
    /// [`UnknownClass`] lists those that there are.
    pub fn of_class(name: &str) -> Result<Self, UnknownClass> {
        let class = SoilClass::find(name).ok_or_else(|| UnknownClass(name.to_owned()))?;
        Ok(Self::Class { class, assumed: false })
    }

    /// The class whose means of cohesion, friction angle and sinkage exponent are nearest to those of a soil, in the class's standard
    /// deviations.
    #[must_use]
    pub fn nearest(soil: &Soil) -> Self {
        let far = |class: &SoilClass| -> f64 {
            let priors = class.priors.iter().filter(|(name, ..)| class.allows(name).is_some());
            priors.map(|(name, mean, sd)| ((value(soil, name) - mean) / sd).powi(2)).sum()
        };
        let mut nearest = (&SOIL_CLASSES[0], f64::INFINITY);
        for class in &SOIL_CLASSES {
            let distance = far(class);
            if distance < nearest.1 {
                nearest = (class, distance);
            }
        }
        Self::Class { class: nearest.0, assumed: true }
    }

    /// Where the spread comes from, in words.
    #[must_use]
    pub fn told(&self) -> String {
        match self {
            Self::Class { class, assumed } => {
                let from = if *assumed {
                    "The soil has no stated uncertainty; assumed are the standard deviations of the class nearest to it,"
                } else {
                    "They have the standard deviations of the class"
                };
                let name = class.name;
                format!(
                    "{from} {name}, around the soil's own values: cohesion, friction angle, sinkage exponent, shear modulus, c1 and \
                     c2, independent of each other. The soil's pressure at the depth to which a wheel sinks stays as stated."
                )
            }
            Self::Known(known) => {
                format!("They have the values and the covariance found by experiments ({}).", known.name)
            }
        }
    }

    /// The soil that it is spread around: `soil`, with the values that experiments have found in place of its own. Parameters that no soil
    /// has are left out.
    #[must_use]
    pub fn around(&self, soil: &Soil) -> Soil {
        let mut around = *soil;
        if let Self::Known(known) = self {
            known.parameters.iter().for_each(|parameter| put(&mut around, &parameter.name, parameter.value));
        }
        around
    }

    /// A soil at random. Values are kept within what the class and the model allow. A class says nothing of k_c and k_phi, whose unit
    /// changes with the exponent; they are drawn with it such that the pressure at `depth` (m) stays.
    pub(super) fn drawn(&self, soil: &Soil, depth: f64, random: &mut ChaCha8Rng) -> Soil {
        let mut drawn = *soil;
        match self {
            Self::Class { class, .. } => {
                for (name, _, sd) in class.priors {
                    let stated = value(soil, name);
                    let (low, high) = class
                        .allows(name)
                        .map_or((f64::NEG_INFINITY, f64::INFINITY), |range| (*range.start(), *range.end()));
                    // A soil that is itself beyond its class stays allowed.
                    let at = (stated + sd * normal(random)).clamp(low.min(stated), high.max(stated));
                    put(&mut drawn, name, at);
                }
                let stiffer = depth.powf(soil.exponent - drawn.exponent);
                put(&mut drawn, "soil.k_c", soil.k_c * stiffer);
                put(&mut drawn, "soil.k_phi", soil.k_phi * stiffer);
            }
            Self::Known(known) => {
                let normal: Vec<f64> = known.parameters.iter().map(|_| normal(random)).collect();
                for (name, at) in known.drawn(&normal).unwrap_or_default() {
                    put(&mut drawn, &name, at);
                }
            }
        }
        drawn
    }
}

/// Value of a parameter of the soil by the model's name.
fn value(soil: &Soil, name: &str) -> f64 {
    let mut soil = *soil;
    name.strip_prefix("soil.").and_then(|name| soil.get(name).ok()).unwrap_or(f64::NAN)
}

/// Sets a parameter of the soil by the model's name, within its bounds.
fn put(soil: &mut Soil, name: &str, value: f64) {
    let Some(name) = name.strip_prefix("soil.") else { return };
    let bounds = soil.list().into_iter().find(|(variable, _)| variable.name == name);
    if let Some((variable, _)) = bounds {
        let within = value.clamp(variable.min, variable.max);
        // Within its bounds a value is not refused.
        let _ = soil.set(name, within);
    }
}

/// A standard normal number (Box and Muller 1958).
fn normal(random: &mut ChaCha8Rng) -> f64 {
    let [u, v]: [f64; 2] = [random.random(), random.random()];
    (-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos()
}
