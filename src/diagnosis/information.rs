//! What is known of the parameters of a calibrated baseline, as precisions of the search coordinates.

use super::noise::Whitening;
use super::problem::Problem;
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
    /// Of sensitivities `base` to the free parameters at these values, with the noise as it is stated.
    pub fn of(problem: &Problem, values: &[f64], whitening: &Whitening, base: &[Vec<f64>]) -> Self {
        let gram = |columns: &[Vec<f64>]| {
            let dot = |i: usize, j: usize| columns[i].iter().zip(&columns[j]).map(|(a, b)| a * b).sum::<f64>();
            DMatrix::from_fn(columns.len(), columns.len(), dot)
        };
        let white: Vec<Vec<f64>> = base.iter().map(|column| whitening.apply(column)).collect();
        let rows = problem.prior_rows(&problem.base);
        let known: Vec<Vec<f64>> = (0..base.len()).map(|k| rows.column(&problem.base, values, k).collect()).collect();
        Self { measured: gram(&white), known: gram(&known), widths: Self::widths(problem) }
    }

    /// Widths of the bounds of a problem's free parameters.
    pub fn widths(problem: &Problem) -> Vec<f64> {
        let width = |free: &super::free::Free| {
            let (lower, upper) = free.bounds();
            upper - lower
        };
        problem.base.iter().map(width).collect()
    }

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
