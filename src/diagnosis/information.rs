//! What is known of the parameters of a calibrated baseline, as precisions of the search coordinates.

use nalgebra::DMatrix;

/// Variance of a uniform distribution over a width of 1 is one twelfth.
const UNIFORM: f64 = 12.0;

/// What the measurements tell, and what was known before.
#[derive(Clone, Debug)]
pub(crate) struct Information {
    /// From the measurements, whose noise is taken to be larger where the residuals scatter more.
    pub measured: DMatrix<f64>,
    /// From priors.
    pub known: DMatrix<f64>,
    /// Widths of the bounds.
    pub widths: Vec<f64>,
}

impl Information {
    /// By priors and bounds.
    pub fn before(&self) -> DMatrix<f64> {
        self.bounded(self.known.clone())
    }

    /// By the measurements too.
    pub fn after(&self) -> DMatrix<f64> {
        self.bounded(&self.measured + &self.known)
    }

    /// Within its bounds alone a parameter is distributed uniformly.
    fn bounded(&self, mut precision: DMatrix<f64>) -> DMatrix<f64> {
        for (k, width) in self.widths.iter().enumerate() {
            precision[(k, k)] += UNIFORM / width.powi(2);
        }
        precision
    }
}
