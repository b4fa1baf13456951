//! Which combinations of cohesion, friction angle and shear modulus readings have settled.

use nalgebra::{Matrix3, Vector3};

/// A combination of the unknowns and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// Parts of c, phi and ln K, each in its prior standard deviation; of length 1.
    pub parts: [f64; 3],
    /// Standard deviation of this combination over its prior one: 1 where the readings say nothing of it.
    pub left: f64,
}

/// The principal directions of `covariance` in units of the prior `deviations`, the best settled first; what is known
/// beforehand (deviation 0) has `left` 0 and comes first.
pub(super) fn directions(covariance: &Matrix3<f64>, deviations: &[f64; 3]) -> [Direction; 3] {
    let inverse = Vector3::from_fn(|i, _| if deviations[i] > 0.0 { 1.0 / deviations[i] } else { 0.0 });
    let scaled = Matrix3::from_fn(|i, j| inverse[i] * covariance[(i, j)] * inverse[j]);
    let eigen = scaled.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_unstable_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    order.map(|k| {
        let column = eigen.eigenvectors.column(k);
        // The sign that makes the largest part positive: an eigenvector has none of its own.
        let sign = if column[column.iamax()] < 0.0 { -1.0 } else { 1.0 };
        Direction { parts: [0, 1, 2].map(|i| sign * column[i]), left: eigen.eigenvalues[k].max(0.0).sqrt() }
    })
}
