//! What the filter keeps: a Gaussian, and readings whose equations stay open.

use super::reading::{Deviations, Reading};
use crate::snapshot::Moving;
use nalgebra::{Matrix3, Vector3};

/// Units in which two readings are alike: of ln load and of slip.
const ALIKE: [f64; 2] = [0.2, 0.1];

/// Mean and covariance of (c, phi, ln K).
#[derive(Clone, Copy, Debug, PartialEq, Moving)]
pub(super) struct Gaussian {
    pub mean: Vector3<f64>,
    pub covariance: Matrix3<f64>,
}

/// A reading and its equation y = slope x + noise about the point `at`.
#[derive(Clone, Copy, Debug, PartialEq, Moving)]
pub(super) struct Held {
    pub reading: Reading,
    pub errors: Deviations,
    /// The inputs that the torque makes likely.
    pub guess: Reading,
    pub at: Vector3<f64>,
    pub slope: Vector3<f64>,
    pub y: f64,
    pub variance: f64,
    /// 1 when new; less where forgotten.
    pub weight: f64,
    /// Whether it has not been brought to its likely inputs yet.
    pub fresh: bool,
}

impl Gaussian {
    pub fn spread(&self, held: &Held) -> f64 {
        held.slope.dot(&(self.covariance * held.slope)) + held.variance / held.weight
    }

    /// Kalman update by one scalar equation, with the gain for K reduced to a share.
    pub fn updated(&self, held: &Held, gain_of_k: f64) -> Self {
        let mut gain = self.covariance * held.slope / self.spread(held);
        gain[2] *= gain_of_k;
        let rest = Matrix3::identity() - gain * held.slope.transpose();
        let noise = held.variance / held.weight;
        let covariance = rest * self.covariance * rest.transpose() + gain * gain.transpose() * noise; // Joseph
        Self {
            mean: self.mean + gain * (held.y - held.slope.dot(&self.mean)),
            covariance: (covariance + covariance.transpose()) * 0.5,
        }
    }

    pub fn is_finite(&self) -> bool {
        self.mean.iter().chain(self.covariance.iter()).all(|x| x.is_finite())
    }
}

impl Held {
    /// No reading yet.
    pub fn empty() -> Self {
        let reading = Reading { load: 1.0, torque: 0.0, sinkage: 0.0, slip: 0.0 };
        let errors = Deviations { load: 0.0, torque: 1.0, sinkage: 0.0, slip: 0.0 };
        let zero = Vector3::zeros();
        Self { reading, errors, guess: reading, at: zero, slope: zero, y: 0.0, variance: 1.0, weight: 1.0, fresh: true }
    }

    /// How unlike two readings are in load and slip, squared.
    pub fn unlike(&self, other: &Self) -> f64 {
        let load = (self.reading.load / other.reading.load).ln() / ALIKE[0];
        let slip = (self.reading.slip - other.reading.slip) / ALIKE[1];
        load * load + slip * slip
    }
}
