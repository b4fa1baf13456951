//! The recursive estimator: an iterated extended Kalman filter on the full stress integrals.
//!
//! State (c, phi, ln K) with a Gaussian prior; each reading is one scalar equation, its torque. The errors of load,
//! sinkage and slip enter the variance through the exact slopes of the torque. A gain for K below 1 leaves K where
//! it is and counts its uncertainty only (Schmidt 1966); the covariance is updated in Joseph's form, which holds for
//! any gain. Forgetting draws mean and covariance back to the prior with distance (an Ornstein-Uhlenbeck process), so
//! that a soil that changes is followed and no direction without information winds up.
//!
//! The mean is kept without bounds, so that noise about c = 0 averages out; [`StrengthFilter::strength`] reports
//! the most likely strength within the soil's bounds.

use super::super::EstimationError;
use super::super::error::{finite, within_bounds};
use super::directions::{Direction, directions};
use super::equation::predict_at;
use super::parameters::SoilIdentification;
use super::reading::{Deviations, Reading, Strength};
use crate::soil::Soil;
use crate::wheel::Wheel;
use nalgebra::{Matrix3, Vector3};

/// Most iterations of one update; two are the rule after the first readings.
const ITERATIONS: usize = 8;

/// Share of a standard deviation by which the mean may still move when the iterations end.
const SETTLED: f64 = 1e-4;

/// Where the mean is kept, as far as the formulas can be trusted: c in Pa, phi in rad, ln K from its prior.
const REACH: [(f64, f64); 3] = [(-20_000.0, 50_000.0), (0.02, 1.2), (-3.0, 3.0)];

/// Bounds within which a strength is reported: those of the soil's parameters.
const COHESION_BOUNDS: (f64, f64) = (0.0, 50_000.0);
const FRICTION_BOUNDS: (f64, f64) = (0.0, 1.0);

/// What became of a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Update {
    /// It was used; innovation squared over its variance (NIS).
    Used {
        /// Normalised innovation squared: of mean 1 where the filter is consistent.
        nis: f64,
    },
    /// It missed its prediction by more than the gate and changed nothing.
    Refused {
        /// Normalised innovation squared.
        nis: f64,
    },
}

/// Recursive estimate of the soil's strength from readings of driven wheels.
#[derive(Clone, Debug, PartialEq)]
pub struct StrengthFilter {
    wheel: Wheel,
    soil: Soil,
    parameters: SoilIdentification,
    deviations: [f64; 3],
    prior: Vector3<f64>,
    mean: Vector3<f64>,
    covariance: Matrix3<f64>,
}

impl StrengthFilter {
    /// A filter whose prior has the strength of `soil` as its mean; of `soil` also the exponent and c1, c2 are used.
    ///
    /// # Errors
    /// [`EstimationError::Parameter`] where a parameter is out of its bounds.
    pub fn new(wheel: &Wheel, soil: &Soil, parameters: SoilIdentification) -> Result<Self, EstimationError> {
        within_bounds("wheel", *wheel)?;
        within_bounds("soil", *soil)?;
        within_bounds("soil_identification", parameters)?;
        let prior = Vector3::from(Strength::of(soil).coordinates());
        let deviations =
            [parameters.cohesion_deviation, parameters.friction_angle_deviation, parameters.shear_modulus_deviation];
        let covariance = Matrix3::from_diagonal(&Vector3::from(deviations.map(|d| d * d)));
        Ok(Self { wheel: *wheel, soil: *soil, parameters, deviations, prior, mean: prior, covariance })
    }

    /// Takes one reading.
    ///
    /// # Errors
    /// [`EstimationError`] where the reading is no driven wheel in soil or not finite; nothing has changed then.
    pub fn update(&mut self, reading: &Reading, errors: &Deviations) -> Result<Update, EstimationError> {
        reading.check(&self.wheel)?;
        for (quantity, value) in [
            ("deviation of the load", errors.load),
            ("deviation of the torque", errors.torque),
            ("deviation of the sinkage", errors.sinkage),
            ("deviation of the slip", errors.slip),
        ] {
            finite(quantity, None, value)?;
        }
        let mut at = self.mean;
        let mut nis = 0.0;
        let mut gain = Vector3::zeros();
        let (mut slope, mut variance) = (Vector3::zeros(), 0.0);
        for iteration in 0..ITERATIONS {
            let seen = predict_at(&self.wheel, &self.soil, at.into(), reading);
            slope = Vector3::from(seen.by_strength);
            variance = seen.variance(errors);
            let spread = slope.dot(&(self.covariance * slope)) + variance;
            // Linearised at `at`, but about the mean before the reading.
            let innovation = reading.torque - seen.torque - slope.dot(&(self.mean - at));
            if iteration == 0 {
                nis = innovation * innovation / spread;
                if nis > self.parameters.gate * self.parameters.gate {
                    return Ok(Update::Refused { nis });
                }
            }
            gain = self.covariance * slope / spread;
            gain[2] *= self.parameters.shear_modulus_gain;
            let next = self.within_reach(self.mean + gain * innovation);
            let moved = (next - at).component_div(&self.spread_of_prior());
            at = next;
            if moved.amax() <= SETTLED {
                break;
            }
        }
        let rest = Matrix3::identity() - gain * slope.transpose();
        let covariance = rest * self.covariance * rest.transpose() + gain * gain.transpose() * variance;
        if !(at.iter().all(|x| x.is_finite()) && covariance.iter().all(|x| x.is_finite())) {
            return Err(EstimationError::Undetermined { what: "finite strength" });
        }
        self.mean = at;
        self.covariance = (covariance + covariance.transpose()) * 0.5;
        Ok(Update::Used { nis })
    }

    /// Forgets over `distance` metres travelled; nothing where the parameter `forgetting` is 0.
    pub fn forget(&mut self, distance: f64) {
        let exponent = self.parameters.forgetting * distance.abs();
        if exponent > 0.0 {
            let kept = (-exponent).exp();
            let prior = Matrix3::from_diagonal(&Vector3::from(self.deviations.map(|d| d * d)));
            self.mean = self.prior + (self.mean - self.prior) * kept;
            self.covariance = self.covariance * (kept * kept) + prior * (1.0 - kept * kept);
        }
    }

    /// The most likely strength within the soil's bounds.
    #[must_use]
    pub fn strength(&self) -> Strength {
        let mut at = self.mean;
        for (k, (low, high)) in [(0, COHESION_BOUNDS), (1, FRICTION_BOUNDS)] {
            let inside = at[k].clamp(low, high);
            if inside != at[k] && self.covariance[(k, k)] > 0.0 {
                at += self.covariance.column(k) * ((inside - at[k]) / self.covariance[(k, k)]);
            }
        }
        at[0] = at[0].clamp(COHESION_BOUNDS.0, COHESION_BOUNDS.1);
        at[1] = at[1].clamp(FRICTION_BOUNDS.0, FRICTION_BOUNDS.1);
        Strength::from_coordinates(at.into())
    }

    /// The mean (c in Pa, phi in rad, ln K with K in m) without bounds, to which the covariance belongs.
    #[must_use]
    pub fn mean(&self) -> [f64; 3] {
        self.mean.into()
    }

    /// Covariance of c (Pa), phi (rad) and ln K.
    #[must_use]
    pub fn covariance(&self) -> [[f64; 3]; 3] {
        self.covariance.transpose().into()
    }

    /// Combinations of c, phi and ln K, the best settled first.
    #[must_use]
    pub fn directions(&self) -> [Direction; 3] {
        directions(&self.covariance, &self.deviations)
    }

    /// What the filter takes for granted.
    #[must_use]
    pub fn parameters(&self) -> &SoilIdentification {
        &self.parameters
    }

    /// The soil of which exponent, c1, c2 and the moduli are taken, with the strength of the prior.
    #[must_use]
    pub fn nominal_soil(&self) -> &Soil {
        &self.soil
    }

    fn within_reach(&self, at: Vector3<f64>) -> Vector3<f64> {
        let origin = [0.0, 0.0, self.prior[2]];
        Vector3::from_fn(|k, _| at[k].clamp(origin[k] + REACH[k].0, origin[k] + REACH[k].1))
    }

    /// Scale of the unknowns, 1 where the prior knows them.
    fn spread_of_prior(&self) -> Vector3<f64> {
        Vector3::from(self.deviations.map(|d| if d > 0.0 { d } else { 1.0 }))
    }
}
