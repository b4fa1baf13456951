//! The recursive estimator: Gauss-Newton on the full stress integrals in bounded memory.
//!
//! State (c, phi, ln K) with a Gaussian prior; each reading is one scalar equation, its torque. The errors of load,
//! sinkage and slip enter its variance through the exact slopes of the torque, taken where the torque makes the inputs
//! likely (errors in variables).
//!
//! An extended Kalman filter would fix the slopes of its first readings for good, while the estimate still lies far off
//! along the valley of c, phi and K that they leave open: measured, 0.6 standard deviations off the batch fit. Here the
//! [`Held`] readings keep their slopes open and are taken anew wherever the estimate moves; when they are full, the
//! older of the two most alike is absorbed into the Gaussian that stands for all before (fixed-lag smoothing that keeps
//! the readings most unlike), with what its slopes may miss along the widest axis of the estimate added to its variance.
//! While the estimate stays, an update costs the equations of one reading, and of the one absorbed.
//!
//! A gain for K below 1 leaves K where it is and counts its uncertainty only (Schmidt 1966); covariances are updated in
//! Joseph's form, which holds for any gain. Forgetting draws back to the prior with distance and takes weight from the
//! held readings, so that a soil that changes is followed and no direction without information winds up.
//!
//! The mean is kept without bounds, so that noise about c = 0 averages out; [`StrengthFilter::strength`] reports
//! the most likely strength within the soil's bounds.

use super::super::EstimationError;
use super::super::error::{finite, within_bounds};
use super::directions::{Direction, directions};
use super::equation::{Linearised, predict_at};
use super::held::{Gaussian, Held};
use super::parameters::SoilIdentification;
use super::reading::{Deviations, Reading, StrengthParameters};
use crate::snapshot::Moving;
use crate::soil::Soil;
use crate::wheel::Wheel;
use nalgebra::{Matrix3, Vector3};

/// Most passes over the held readings in one update; one is the rule once the estimate has settled.
const PASSES: usize = 6;

/// Prior standard deviations by which the estimate may leave the point of a reading's slopes.
const MOVED: f64 = 0.01;

/// Readings whose slopes stay open.
const HELD: usize = 32;

/// Weight of a reading that is as good as forgotten.
const FORGOTTEN: f64 = 1e-12;

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
#[derive(Clone, Debug, PartialEq, Moving)]
pub struct StrengthFilter {
    #[not_moving]
    wheel: Wheel,
    #[not_moving]
    soil: Soil,
    #[not_moving]
    parameters: SoilIdentification,
    #[not_moving]
    deviations: [f64; 3],
    #[not_moving]
    prior: Vector3<f64>,
    absorbed: Gaussian,
    held: [Held; HELD],
    count: usize,
    estimate: Gaussian,
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
        let prior = Vector3::from(StrengthParameters::of(soil).coordinates());
        let deviations =
            [parameters.cohesion_deviation, parameters.friction_angle_deviation, parameters.shear_modulus_deviation];
        let covariance = Matrix3::from_diagonal(&Vector3::from(deviations.map(|d| d * d)));
        let absorbed = Gaussian { mean: prior, covariance };
        let none = Held::empty();
        let (wheel, soil, held) = (*wheel, *soil, [none; HELD]);
        Ok(Self { wheel, soil, parameters, deviations, prior, absorbed, held, count: 0, estimate: absorbed })
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
        // At the measured inputs first: a far estimate would blame them for its own error.
        let new = Held { reading: *reading, errors: *errors, ..Held::empty() };
        let new = Held { fresh: true, ..self.about(&new, reading) };
        let innovation = new.y - new.slope.dot(&self.estimate.mean);
        let nis = innovation * innovation / self.estimate.spread(&new);
        if nis > self.parameters.gate * self.parameters.gate {
            return Ok(Update::Refused { nis });
        }
        let mut next = self.clone();
        next.hold(new);
        next.settle();
        if !(next.estimate.is_finite() && next.absorbed.is_finite() && nis.is_finite()) {
            return Err(EstimationError::Undetermined { what: "finite strength" });
        }
        *self = next;
        Ok(Update::Used { nis })
    }

    /// Takes a reading up; where there is no room, the older of the two most alike is absorbed.
    fn hold(&mut self, new: Held) {
        if self.count == HELD {
            let oldest = self.most_alike();
            let mut leaving = self.held[oldest];
            leaving.variance += self.curvature(&leaving).powi(2) * leaving.weight;
            self.absorbed = self.absorbed.updated(&leaving, self.parameters.shear_modulus_gain);
            self.held.copy_within(oldest + 1.., oldest);
            self.count -= 1;
        }
        self.held[self.count] = new;
        self.count += 1;
    }

    /// What the equation's slopes miss of the torque one standard deviation along the estimate's widest axis, N m: the
    /// error of fixing them now.
    fn curvature(&self, held: &Held) -> f64 {
        let scale = self.scale();
        let scaled = Matrix3::from_fn(|i, j| self.estimate.covariance[(i, j)] / (scale[i] * scale[j]));
        let eigen = scaled.symmetric_eigen();
        let widest = eigen.eigenvalues.imax();
        let length = eigen.eigenvalues[widest].max(0.0).sqrt();
        let axis = eigen.eigenvectors.column(widest).component_mul(&scale) * length;
        let torque = |at: Vector3<f64>| predict_at(&self.wheel, &self.soil, at.into(), &held.guess).torque;
        let here = torque(held.at);
        let missed = |axis: Vector3<f64>| (torque(held.at + axis) - here - held.slope.dot(&axis)).abs();
        missed(axis).max(missed(-axis))
    }

    fn most_alike(&self) -> usize {
        let held = &self.held[..self.count];
        let mut found = (f64::INFINITY, 0);
        for (i, a) in held.iter().enumerate() {
            for b in &held[i + 1..] {
                let distance = a.unlike(b);
                if distance < found.0 {
                    found = (distance, i);
                }
            }
        }
        found.1
    }

    /// Gauss-Newton over the held readings until none lies away from the point of its slopes.
    fn settle(&mut self) {
        for _ in 0..PASSES {
            let gain_of_k = self.parameters.shear_modulus_gain;
            let readings = self.held[..self.count].iter();
            self.estimate = readings.fold(self.absorbed, |sum, held| sum.updated(held, gain_of_k));
            self.estimate.mean = self.within_reach(self.estimate.mean);
            let mut settled = true;
            for k in 0..self.count {
                let moved = (self.estimate.mean - self.held[k].at).component_div(&self.scale());
                if moved.amax() > MOVED || self.held[k].fresh {
                    self.held[k] = self.equation(&self.held[k]);
                    settled = false;
                }
            }
            if settled {
                break;
            }
        }
    }

    /// The reading's equation about the present estimate, at the inputs that it makes likely.
    fn equation(&self, held: &Held) -> Held {
        let Held { reading, errors, guess, .. } = held;
        let at = self.estimate.mean.into();
        let seen = Linearised::new(&self.wheel, &self.soil, at, guess, reading, errors);
        let guess = seen.likely(&self.wheel, reading, errors, seen.innovation / seen.variance);
        self.about(held, &guess)
    }

    /// The reading's equation about the present estimate and these inputs.
    fn about(&self, held: &Held, guess: &Reading) -> Held {
        let at = self.estimate.mean;
        let Held { reading, errors, weight, .. } = *held;
        let seen = Linearised::new(&self.wheel, &self.soil, at.into(), guess, &reading, &errors);
        let slope = Vector3::from(seen.prediction.by_strength);
        let y = seen.innovation + slope.dot(&at);
        Held { reading, errors, guess: *guess, at, slope, y, variance: seen.variance, weight, fresh: false }
    }

    /// Forgets over `distance` metres travelled; nothing where the parameter `forgetting` is 0.
    pub fn forget(&mut self, distance: f64) {
        let exponent = self.parameters.forgetting * distance.abs();
        if exponent > 0.0 {
            let kept = (-exponent).exp();
            let prior = Matrix3::from_diagonal(&Vector3::from(self.deviations.map(|d| d * d)));
            self.absorbed.mean = self.prior + (self.absorbed.mean - self.prior) * kept;
            self.absorbed.covariance = self.absorbed.covariance * (kept * kept) + prior * (1.0 - kept * kept);
            for held in &mut self.held[..self.count] {
                held.weight = (held.weight * kept * kept).max(FORGOTTEN);
            }
            self.settle();
        }
    }

    /// The most likely strength within the soil's bounds.
    #[must_use]
    pub fn strength(&self) -> StrengthParameters {
        let mut at = self.estimate.mean;
        for (k, (low, high)) in [(0, COHESION_BOUNDS), (1, FRICTION_BOUNDS)] {
            let inside = at[k].clamp(low, high);
            if inside != at[k] && self.estimate.covariance[(k, k)] > 0.0 {
                at += self.estimate.covariance.column(k) * ((inside - at[k]) / self.estimate.covariance[(k, k)]);
            }
        }
        at[0] = at[0].clamp(COHESION_BOUNDS.0, COHESION_BOUNDS.1);
        at[1] = at[1].clamp(FRICTION_BOUNDS.0, FRICTION_BOUNDS.1);
        StrengthParameters::from_coordinates(at.into())
    }

    /// The mean (c in Pa, phi in rad, ln K with K in m) without bounds, to which the covariance belongs.
    #[must_use]
    pub fn mean(&self) -> [f64; 3] {
        self.estimate.mean.into()
    }

    /// Covariance of c (Pa), phi (rad) and ln K.
    #[must_use]
    pub fn covariance(&self) -> [[f64; 3]; 3] {
        self.estimate.covariance.transpose().into()
    }

    /// Combinations of c, phi and ln K, the best settled first.
    #[must_use]
    pub fn directions(&self) -> [Direction; 3] {
        directions(&self.estimate.covariance, &self.deviations)
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

    /// Scale of the unknowns, 1 where the prior's deviation is 0.
    fn scale(&self) -> Vector3<f64> {
        Vector3::from(self.deviations.map(|d| if d > 0.0 { d } else { 1.0 }))
    }
}
