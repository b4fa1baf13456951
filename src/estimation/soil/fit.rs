//! All readings at once: the most likely strength under the filter's prior and its covariance, for reference.

use super::super::EstimationError;
use super::super::error::within_bounds;
use super::directions::{Direction, directions};
use super::equation::Linearised;
use super::parameters::SoilIdentification;
use super::reading::{Deviations, Reading, StrengthParameters};
use crate::soil::Soil;
use crate::wheel::Wheel;
use nalgebra::{Matrix3, Vector3};

/// Most steps of Gauss-Newton; 3 to 6 are needed.
const STEPS: usize = 60;

/// Steps by which each reading's inputs are brought to their likely values; the third moves them by under 1e-6.
const INPUT_STEPS: usize = 4;

/// Step in prior standard deviations at which the search ends.
const SETTLED: f64 = 1e-9;

/// The most likely strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// c (Pa), phi (rad), ln K, without bounds.
    pub mean: [f64; 3],
    /// Their covariance.
    pub covariance: [[f64; 3]; 3],
    /// Sum of squared residuals, each over its variance; about the number of readings where all is consistent.
    pub chi_squared: f64,
    /// Combinations of c, phi and ln K, the best settled first.
    pub directions: [Direction; 3],
}

impl Fit {
    /// The strength.
    #[must_use]
    pub fn strength(&self) -> StrengthParameters {
        StrengthParameters::from_coordinates(self.mean)
    }
}

/// The most likely strength for `readings` with their error deviations, by damped Gauss-Newton. The prior is that of
/// [`StrengthFilter::new`](super::StrengthFilter::new); K is estimated where its prior deviation is not 0.
///
/// # Errors
/// [`EstimationError`] where a reading or a parameter makes no sense or the search does not end.
pub fn fit(
    wheel: &Wheel,
    soil: &Soil,
    parameters: &SoilIdentification,
    readings: &[(Reading, Deviations)],
) -> Result<Fit, EstimationError> {
    within_bounds("soil_identification", *parameters)?;
    readings.iter().try_for_each(|(reading, _)| reading.check(wheel))?;
    let prior = Vector3::from(StrengthParameters::of(soil).coordinates());
    let scale = Vector3::new(
        parameters.cohesion_deviation,
        parameters.friction_angle_deviation,
        parameters.shear_modulus_deviation,
    );
    // Unknowns u in prior deviations: x = prior + scale u, so that a known one has no column.
    let at = |u: &Vector3<f64>| prior + scale.component_mul(u);
    let normal = |u: &Vector3<f64>| {
        let (mut information, mut slope, mut chi_squared) = (Matrix3::identity(), -*u, 0.0);
        for (reading, errors) in readings {
            let mut seen = Linearised::new(wheel, soil, at(u).into(), reading, reading, errors);
            for _ in 0..INPUT_STEPS {
                let guess = seen.likely(wheel, reading, errors, seen.innovation / seen.variance);
                seen = Linearised::new(wheel, soil, at(u).into(), &guess, reading, errors);
            }
            let row = Vector3::from(seen.prediction.by_strength).component_mul(&scale);
            let (residual, variance) = (seen.innovation, seen.variance);
            information += row * row.transpose() / variance;
            slope += row * (residual / variance);
            chi_squared += residual * residual / variance;
        }
        (information, slope, chi_squared)
    };
    let mut u = Vector3::zeros();
    for _ in 0..STEPS {
        let (information, slope, chi_squared) = normal(&u);
        let inverse = information.try_inverse().ok_or(EstimationError::Undetermined { what: "strength" })?;
        let step = inverse * slope;
        // At most two prior deviations a step keep the first steps where the model means something.
        let shorter = (2.0 / step.amax()).min(1.0);
        u += step * shorter;
        if step.amax() <= SETTLED {
            let covariance = Matrix3::from_fn(|i, j| scale[i] * inverse[(i, j)] * scale[j]);
            return Ok(Fit {
                mean: at(&u).into(),
                covariance: covariance.transpose().into(),
                chi_squared,
                directions: directions(&covariance, &scale.into()),
            });
        }
    }
    Err(EstimationError::Undetermined { what: "strength" })
}
