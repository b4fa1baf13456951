//! Whether a filter's covariance is the one that its errors have (Bar-Shalom, Li and Kirubarajan 2001, 5.4).

use nalgebra::{Cholesky, SMatrix, SVector};

/// Normalised estimation error squared e^T P^-1 e: chi-square distributed with N degrees of freedom where P is the
/// covariance of e. `None` where P is not positive definite.
#[must_use]
pub fn nees<const N: usize>(error: &SVector<f64, N>, covariance: &SMatrix<f64, N, N>) -> Option<f64> {
    let factor = Cholesky::new(*covariance)?;
    let mut whitened = *error;
    factor.l_dirty().solve_lower_triangular_mut(&mut whitened).then(|| whitened.norm_squared())
}

/// Normalised innovation squared y^T S^-1 y of an innovation y with covariance S: the same form.
#[must_use]
pub fn nis<const N: usize>(innovation: &SVector<f64, N>, covariance: &SMatrix<f64, N, N>) -> Option<f64> {
    nees(innovation, covariance)
}

/// Two-sided 95 % interval of the mean of `samples` independent chi-square variables of `degrees` degrees of freedom, by
/// Wilson and Hilferty's cube (1931), good to 1 % from 3 degrees of freedom in all.
#[must_use]
pub fn chi_square_interval(degrees: usize, samples: usize) -> [f64; 2] {
    /// 97.5 % quantile of the standard normal distribution.
    const QUANTILE: f64 = 1.959_963_984_540_054;
    let total = (degrees * samples) as f64;
    let spread = 2.0 / (9.0 * total);
    [-QUANTILE, QUANTILE].map(|z| degrees as f64 * (1.0 - spread + z * spread.sqrt()).powi(3))
}
