//! Nonnegative least squares (Lawson and Hanson 1974), to certify optima by their multipliers.

use nalgebra::{DMatrix, DVector};

/// Distance of `target` from the cone that `rays` span with nonnegative factors.
pub fn cone_distance(rays: &[DVector<f64>], target: &DVector<f64>) -> f64 {
    let e = DMatrix::from_columns(rays);
    let mut factors = DVector::zeros(rays.len());
    let mut passive: Vec<usize> = Vec::new();
    for _ in 0..10 * rays.len() {
        let gradient = e.transpose() * (target - &e * &factors);
        let outside = (0..rays.len()).filter(|k| !passive.contains(k));
        let Some(enter) = outside.max_by(|&i, &j| gradient[i].total_cmp(&gradient[j])) else { break };
        if gradient[enter] <= 1e-12 * target.norm() {
            break;
        }
        passive.push(enter);
        settle(&e, target, &mut factors, &mut passive);
    }
    (target - &e * factors).norm()
}

/// Moves to the least-squares point of the passive set, dropping the factors that would turn negative.
fn settle(e: &DMatrix<f64>, target: &DVector<f64>, factors: &mut DVector<f64>, passive: &mut Vec<usize>) {
    while !passive.is_empty() {
        let columns = e.select_columns(passive.iter());
        let wanted = columns.pseudo_inverse(1e-12).expect("a pseudo-inverse exists") * target;
        let step =
            |(place, &k): (usize, &usize)| (wanted[place] <= 0.0).then(|| factors[k] / (factors[k] - wanted[place]));
        let share = passive.iter().enumerate().filter_map(step).fold(1.0, f64::min);
        for (place, &k) in passive.iter().enumerate() {
            factors[k] += share * (wanted[place] - factors[k]);
        }
        if share >= 1.0 {
            return;
        }
        passive.retain(|&k| factors[k] > 1e-13);
        for k in 0..factors.len() {
            if !passive.contains(&k) {
                factors[k] = 0.0;
            }
        }
    }
}
