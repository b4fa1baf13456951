//! The least of a quadratic form between bounds: one step of a Gauss-Newton search.

use nalgebra::{DMatrix, DVector};

/// Least of d'G d + 2 b'd for a positive definite G, each d between its ends, which hold 0 (Stark and Parker 1995).
pub(crate) fn within(gram: &DMatrix<f64>, along: &[f64], ends: &[(f64, f64)]) -> Vec<f64> {
    let n = along.len();
    let mut d = vec![0.0; n];
    let mut free = vec![false; n];
    // Each round frees one coordinate whose slope points inward, or ends; a coordinate is freed a few times at most.
    for _ in 0..10 * n {
        let slope = |k: usize| along[k] + (0..n).map(|j| gram[(k, j)] * d[j]).sum::<f64>();
        let inward = |k: &usize| {
            let slope = slope(*k) / gram[(*k, *k)].sqrt();
            if slope < 0.0 {
                if d[*k] < ends[*k].1 { -slope } else { 0.0 }
            } else if d[*k] > ends[*k].0 {
                slope
            } else {
                0.0
            }
        };
        let best = (0..n).filter(|k| !free[*k]).max_by(|a, b| inward(a).total_cmp(&inward(b)));
        let Some(new) = best.filter(|k| inward(k) > 1e-9 * (1.0 + along[*k].abs() / gram[(*k, *k)].sqrt())) else {
            break;
        };
        free[new] = true;
        while let Some(target) = solved(gram, along, &d, &free) {
            // As far towards the solution as the ends allow.
            let mut share = 1.0_f64;
            let mut hit = None;
            for k in (0..n).filter(|k| free[*k]) {
                let end = if target[k] > d[k] { ends[k].1 } else { ends[k].0 };
                if (target[k] - end) * (target[k] - d[k]) > 0.0 {
                    let own = ((end - d[k]) / (target[k] - d[k])).clamp(0.0, 1.0);
                    if own < share || hit.is_none() {
                        (share, hit) = (own, Some((k, end)));
                    }
                }
            }
            for k in (0..n).filter(|k| free[*k]) {
                d[k] += share * (target[k] - d[k]);
            }
            let Some((k, end)) = hit else { break };
            (d[k], free[k]) = (end, false);
        }
    }
    d
}

/// The least over the free coordinates, the others staying; `None` where none is free or the products are singular.
fn solved(gram: &DMatrix<f64>, along: &[f64], d: &[f64], free: &[bool]) -> Option<Vec<f64>> {
    let members: Vec<usize> = (0..free.len()).filter(|k| free[*k]).collect();
    if members.is_empty() {
        return None;
    }
    let rest = |i: usize| -along[i] - (0..d.len()).filter(|k| !free[*k]).map(|k| gram[(i, k)] * d[k]).sum::<f64>();
    let part = DMatrix::from_fn(members.len(), members.len(), |i, k| gram[(members[i], members[k])]);
    let right = DVector::from_iterator(members.len(), members.iter().map(|i| rest(*i)));
    let solution = part.cholesky()?.solve(&right);
    let mut all = d.to_vec();
    members.iter().zip(solution.iter()).for_each(|(k, x)| all[*k] = *x);
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a handful of products.
    const ROUNDING: f64 = 1e-9;

    /// A positive definite matrix and slopes that differ with `seed`.
    fn quadratic(n: usize, seed: usize) -> (DMatrix<f64>, Vec<f64>) {
        let entry = |i: usize, k: usize| ((7 * i + 3 * k * k + 11 * seed) as f64).sin();
        let root = DMatrix::from_fn(2 * n, n, entry);
        let gram = root.transpose() * &root + DMatrix::identity(n, n) * 1e-3;
        (gram, (0..n).map(|k| 4.0 * ((5 * k + 13 * seed) as f64).cos()).collect())
    }

    #[test]
    fn analytic_the_least_within_ends_meets_its_conditions() {
        for seed in 0..200 {
            let n = 1 + seed % 9;
            let (gram, along) = quadratic(n, seed);
            let ends: Vec<(f64, f64)> =
                (0..n).map(|k| (-0.3 * ((k + seed) % 4) as f64, 0.2 * ((2 * k + seed) % 5) as f64)).collect();
            let d = within(&gram, &along, &ends);
            for k in 0..n {
                let slope = along[k] + (0..n).map(|j| gram[(k, j)] * d[j]).sum::<f64>();
                assert!(d[k] >= ends[k].0 && d[k] <= ends[k].1, "seed {seed}, {k}");
                let scale = ROUNDING * (1.0 + gram.amax()) * 10.0;
                if d[k] > ends[k].0 {
                    assert!(slope <= scale, "seed {seed}, {k}: it could fall, slope {slope}");
                }
                if d[k] < ends[k].1 {
                    assert!(slope >= -scale, "seed {seed}, {k}: it could rise, slope {slope}");
                }
            }
        }
    }
}
