//! Seeded variation of a model by the vocabulary's names: for trials over soils, grounds and vehicles.

use super::Model;
use bekker_modeldescription::{Lookup, ParameterError};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

/// How a parameter scatters from trial to trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Evenly between two values, SI.
    Uniform {
        /// Smallest value.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// The model's value times a factor that is even in its logarithm between two values.
    Factor {
        /// Smallest factor, more than 0.
        low: f64,
        /// Largest factor.
        high: f64,
    },
    /// The model's value plus a normal deviate of this standard deviation, SI; kept within the parameter's bounds.
    Normal {
        /// Standard deviation.
        deviation: f64,
    },
}

/// A parameter that scatters.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// Its name in the vocabulary, `soil.cohesion`.
    pub name: String,
    /// How it scatters.
    pub distribution: Distribution,
}

/// Why a model cannot be varied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VariationError {
    /// The parameter is unknown or the value drawn is out of its bounds.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The distribution makes no sense.
    #[error("variation of `{name}`: {found:?}; expected finite numbers, low <= high, factors and deviations over 0")]
    Distribution {
        /// The parameter.
        name: String,
        /// Its distribution.
        found: Distribution,
    },
}

impl Variation {
    /// The parameter `name` scatters by `distribution`.
    #[must_use]
    pub fn new(name: &str, distribution: Distribution) -> Self {
        Self { name: name.to_owned(), distribution }
    }

    /// A value drawn about `value`, within `bounds`. Every distribution takes one number from the stream of `noise`, so
    /// that changing one variation leaves those after it as they are.
    fn draw(&self, value: f64, bounds: (f64, f64), noise: &mut ChaCha8Rng) -> Result<f64, VariationError> {
        let refused = || VariationError::Distribution { name: self.name.clone(), found: self.distribution };
        let ordered = |low: f64, high: f64| low.is_finite() && high.is_finite() && low <= high;
        let mut own = ChaCha8Rng::seed_from_u64(noise.random::<u64>());
        match self.distribution {
            Distribution::Uniform { low, high } if ordered(low, high) => Ok(low + (high - low) * own.random::<f64>()),
            Distribution::Factor { low, high } if ordered(low, high) && low > 0.0 => {
                Ok(value * (low.ln() + (high / low).ln() * own.random::<f64>()).exp())
            }
            Distribution::Normal { deviation } if deviation.is_finite() && deviation >= 0.0 => {
                let unit: f64 = StandardNormal.sample(&mut own);
                Ok((value + deviation * unit).clamp(bounds.0, bounds.1))
            }
            _ => Err(refused()),
        }
    }
}

impl Model {
    /// This model with parameters drawn by `variations` from the stream of `seed`, and the values drawn.
    ///
    /// # Errors
    /// [`VariationError`] for an unknown parameter, a value out of its bounds or a distribution that makes no sense.
    pub fn varied(&self, variations: &[Variation], seed: u64) -> Result<(Self, Vec<f64>), VariationError> {
        let mut model = self.clone();
        let mut noise = ChaCha8Rng::seed_from_u64(seed);
        let mut drawn = Vec::with_capacity(variations.len());
        for variation in variations {
            let value = model.get(&variation.name)?;
            let value = variation.draw(value, model.bounds(&variation.name), &mut noise)?;
            model.set(&variation.name, value)?;
            drawn.push(value);
        }
        Ok((model, drawn))
    }

    /// Bounds of the parameter `name`; none where there is no such parameter.
    fn bounds(&mut self, name: &str) -> (f64, f64) {
        let known = self.list().into_iter().find(|(variable, _)| variable.name == name);
        known.map_or((f64::NEG_INFINITY, f64::INFINITY), |(variable, _)| (variable.min, variable.max))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Outcome = Result<(), Box<dyn std::error::Error>>;

    fn soils() -> [Variation; 3] {
        [
            Variation::new("soil.cohesion", Distribution::Uniform { low: 500.0, high: 1500.0 }),
            Variation::new("soil.k_phi", Distribution::Factor { low: 0.5, high: 2.0 }),
            Variation::new("soil.friction_angle", Distribution::Normal { deviation: 0.03 }),
        ]
    }

    #[test]
    fn property_the_same_seed_draws_the_same_model() -> Outcome {
        let model = Model::preset("two_wheeled")?;
        let (mut one, drawn) = model.varied(&soils(), 7)?;
        assert_eq!(model.varied(&soils(), 7)?.1, drawn);
        assert_ne!(model.varied(&soils(), 8)?.1, drawn);
        assert_eq!(one.get("soil.k_phi")?, drawn[1]);
        // Another distribution of the first leaves the others as they are.
        let mut other = soils();
        other[0].distribution = Distribution::Normal { deviation: 10.0 };
        assert_eq!(model.varied(&other, 7)?.1[1..], drawn[1..]);
        Ok(())
    }

    #[test]
    fn analytic_the_draws_have_the_moments_of_their_distributions() -> Outcome {
        let model = Model::preset("two_wheeled")?;
        let draws = (0..4000).map(|seed| model.varied(&soils(), seed).map(|(_, drawn)| drawn));
        let draws: Vec<Vec<f64>> = draws.collect::<Result<_, _>>()?;
        let mean = |k: usize, f: &dyn Fn(f64) -> f64| draws.iter().map(|d| f(d[k])).sum::<f64>() / draws.len() as f64;
        // Five standard errors of each mean.
        let within = |found: f64, expected: f64, deviation: f64| {
            assert!((found - expected).abs() < 5.0 * deviation / 4000.0_f64.sqrt(), "{found} {expected}");
        };
        within(mean(0, &|c| c), 1000.0, 1000.0 / 12.0_f64.sqrt());
        within(mean(1, &f64::ln), 850_000.0_f64.ln(), 4.0_f64.ln() / 12.0_f64.sqrt());
        let phi = 29.0_f64.to_radians();
        within(mean(2, &|p| p), phi, 0.03);
        within(mean(2, &|p| (p - phi).powi(2)), 0.03 * 0.03, 0.03 * 0.03 * 2.0_f64.sqrt());
        Ok(())
    }

    #[test]
    fn property_nonsense_is_refused_by_name() -> Outcome {
        let model = Model::preset("two_wheeled")?;
        let refused =
            |name, distribution| model.varied(&[Variation::new(name, distribution)], 0).err().map(|e| e.to_string());
        let backwards = refused("soil.cohesion", Distribution::Uniform { low: 2.0, high: 1.0 });
        assert!(backwards.is_some_and(|text| text.contains("soil.cohesion")));
        let unknown = refused("soil.cohesoin", Distribution::Normal { deviation: 1.0 });
        assert!(unknown.is_some_and(|text| text.contains("soil.cohesion")));
        let beyond = refused("soil.cohesion", Distribution::Factor { low: 1e6, high: 1e6 });
        assert!(beyond.is_some_and(|text| text.contains("50000")));
        Ok(())
    }
}
