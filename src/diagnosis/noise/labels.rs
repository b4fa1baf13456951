//! Repeats by label: a scatter from sample to sample, and one that all samples of a run have in common.
//!
//! Samples of a label in one run tell the scatter within a run, samples of the same labels in several runs (days, batches
//! of soil) what a run adds to all of them. With the means of the labels taken out, y = a_run + e has contrasts of covariance
//! s^2 (I + g M Z Z' M), where Z says which sample belongs to which run and what the scatter of the run counts in it, M takes the means out and g is the ratio of the
//! variances between and within runs: restricted likelihood (Patterson and Thompson 1971). Along the eigenvectors of Z' M Z,
//! with eigenvalues l, the variance is s^2 (1 + g l); in all other directions it is s^2.

use super::NoiseModel;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// An eigenvalue counts from this share of the largest; below it is rounding.
const RANK: f64 = 1e-9;

/// A sample with a label.
#[derive(Clone, Copy, Debug)]
pub(super) struct Labelled {
    pub run: usize,
    pub value: f64,
    /// What the scatter of the run counts in it.
    pub weight: f64,
}

/// Contrasts between samples of equal labels.
#[derive(Clone, Debug, Default)]
pub(super) struct LabelContrasts {
    /// Number of contrasts: samples less labels.
    count: usize,
    /// Sum of their squares.
    squares: f64,
    /// What runs add to contrasts: the eigenvalue, and the squared coefficient along its direction over the eigenvalue.
    between: Vec<(f64, f64)>,
}

impl LabelContrasts {
    /// From the samples of each label.
    pub fn new(labels: &[Vec<Labelled>]) -> Self {
        let labels: Vec<&Vec<Labelled>> = labels.iter().filter(|samples| samples.len() > 1).collect();
        let mut runs: Vec<usize> = labels.iter().flat_map(|samples| samples.iter().map(|sample| sample.run)).collect();
        runs.sort_unstable();
        runs.dedup();
        let place = |run: usize| runs.binary_search(&run).unwrap_or(0);
        let (mut within, mut along) = (DMatrix::zeros(runs.len(), runs.len()), DVector::zeros(runs.len()));
        let mut contrasts = Self::default();
        for samples in &labels {
            let size = samples.len() as f64;
            let mean = samples.iter().map(|sample| sample.value).sum::<f64>() / size;
            for sample in *samples {
                let own = place(sample.run);
                contrasts.squares += (sample.value - mean).powi(2);
                along[own] += sample.weight * (sample.value - mean);
                within[(own, own)] += sample.weight * sample.weight;
                for other in *samples {
                    within[(own, place(other.run))] -= sample.weight * other.weight / size;
                }
            }
            contrasts.count += samples.len() - 1;
        }
        // With one sample a run all contrasts see the same share of the runs.
        if runs.len() < labels.iter().map(|samples| samples.len()).sum::<usize>() {
            contrasts.between = between(within, &along);
        }
        contrasts
    }

    /// Number of independent contrasts.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Whether the share of the runs can be told from the scatter within them: some contrasts see more of it than others. It
    /// cannot where each label stays in one run, nor where each run has one sample. Then all scatter counts as that of
    /// single samples.
    pub fn tell_the_share(&self) -> bool {
        let (first, last) = (self.between.first(), self.between.last());
        let differ = |(a, b): (&(f64, f64), &(f64, f64))| (a.0 - b.0).abs() > RANK * a.0.max(b.0);
        !self.between.is_empty() && (self.between.len() < self.count || first.zip(last).is_some_and(differ))
    }

    /// Sum of squares.
    pub fn squares(&self) -> f64 {
        self.squares
    }

    /// Squared length of the contrasts under a noise model, times `deviation^2`, and ln det of their covariance over
    /// `deviation^2`.
    pub fn length_and_determinant(&self, noise: &NoiseModel) -> (f64, f64) {
        let own = 1.0 - noise.run_share;
        let ratio = noise.run_share / own;
        let (mut length, mut determinant) = (self.squares, self.count as f64 * own.ln());
        for (eigenvalue, square) in &self.between {
            length -= square * ratio * eigenvalue / (1.0 + ratio * eigenvalue);
            determinant += (ratio * eigenvalue).ln_1p();
        }
        (length / own, determinant)
    }
}

/// Eigenvalues of Z' M Z in falling order, and the squared coefficients of the contrasts along their directions.
fn between(within: DMatrix<f64>, along: &DVector<f64>) -> Vec<(f64, f64)> {
    let eigen = SymmetricEigen::new(within);
    let largest = eigen.eigenvalues.max();
    let columns = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
    let kept = columns.filter(|(value, _)| **value > RANK * largest.max(1.0));
    let mut all: Vec<(f64, f64)> = kept.map(|(value, vector)| (*value, vector.dot(along).powi(2) / value)).collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    all
}
