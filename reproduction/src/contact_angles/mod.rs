//! Section 2.6: contact angles estimated in simulation (2.6.1) and on a rocker-bogie rover (2.6.2).

mod bound;
mod drive;
mod incline;
mod rock;
mod undulating;
mod wave;

pub use bound::Bound;
pub use incline::incline;
pub use rock::rock;
pub use undulating::undulating;
pub use wave::{Quality, Tracking, Wave};

use super::Spread;
use bekker::estimation::EstimationError;
use bekker::model::{ModelError, RunError};
use bekker::simulation::Event;

/// Why a result of section 2.6 cannot be computed.
#[derive(Debug, thiserror::Error)]
pub enum ContactAnglesError {
    /// The model cannot be built.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The simulation fails.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The estimator refuses rover or reading.
    #[error(transparent)]
    Estimation(#[from] EstimationError),
    /// The ground makes no profile.
    #[error(transparent)]
    Ground(#[from] bekker::terrain::SamplesError),
    /// The drive ends before its way is done.
    #[error("the drive ended after {x} m of its {way} m: {event}")]
    Ended {
        /// Way done, m.
        x: f64,
        /// Way to be done, m.
        way: f64,
        /// Why it ended.
        event: Event,
    },
    /// The drive takes too long.
    #[error("the rover is {x} m far after {time} s, expected {way} m")]
    Slow {
        /// Way done, m.
        x: f64,
        /// Way to be done, m.
        way: f64,
        /// Time, s.
        time: f64,
    },
    /// No trial has a value.
    #[error("no trial has a finite {quantity}; at least one trial was expected")]
    NoValue {
        /// What has no value.
        quantity: String,
    },
}

/// Spread over trials.
fn spread(quantity: &str, values: impl IntoIterator<Item = f64>) -> Result<Spread, ContactAnglesError> {
    Spread::of(values).ok_or_else(|| ContactAnglesError::NoValue { quantity: quantity.to_owned() })
}

/// Running mean of squares.
#[derive(Clone, Copy, Debug, Default)]
struct MeanSquare {
    sum: f64,
    count: usize,
}

impl MeanSquare {
    fn add(&mut self, value: f64) {
        self.sum += value * value;
        self.count += 1;
    }

    /// Mean of the squares; NaN of none.
    fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }

    fn root(&self) -> f64 {
        self.mean().sqrt()
    }
}
