//! What an experiment would see of each effect, from sensitivities alone.

use crate::diagnosis::compare::CompareError;
use crate::diagnosis::diagnose::{Projected, Sensitivities, largest_cosine, sensitivities};
use crate::diagnosis::linear_algebra::norm;
use crate::diagnosis::noise::{NoiseModel, Whitening};
use crate::diagnosis::problem::Problem;
use std::collections::BTreeMap;

/// Signatures of all candidates of a problem, made white, with and without what the calibrated parameters absorb.
///
/// Every calibrated parameter may absorb, those on a bound too: where they will stand in an experiment to be made is
/// not known.
pub(crate) struct Look {
    pub sensitivities: Sensitivities,
    pub projected: Projected,
    pub whitening: Whitening,
    /// Rows that priors add to every whitened column.
    pub priors: usize,
}

impl Look {
    /// Looks from the baseline with its free parameters at `values`.
    pub fn new(problem: &Problem, values: &[f64], noise: &BTreeMap<String, NoiseModel>) -> Result<Self, CompareError> {
        let whitening = Whitening::new(&problem.layout, noise, &|_, _| true).ok_or(CompareError::NoFit)?;
        let sensitivities = sensitivities(problem, &[], values)?;
        let priors = problem.prior_rows(&problem.base);
        let rows = |k: usize| -> Vec<f64> { priors.column(&problem.base, values, k).collect() };
        let base: Vec<(Vec<f64>, Vec<f64>)> =
            sensitivities.base.iter().enumerate().map(|(k, column)| (column.clone(), rows(k))).collect();
        let projected = Projected::new(&whitening, &base, &sensitivities.signatures);
        Ok(Self { sensitivities, projected, whitening, priors: priors.len() })
    }

    fn index(&self, id: &str) -> Option<usize> {
        self.sensitivities.signatures.iter().position(|signature| signature.id == id)
    }

    /// Ids of the candidates, in the library's order.
    pub fn ids(&self) -> impl Iterator<Item = &str> {
        self.sensitivities.signatures.iter().map(|signature| signature.id.as_str())
    }

    /// Whitened size, in standard deviations, of what an effect changes beyond the calibration over the range of its
    /// parameters, to first order; 0 where it changes nothing.
    pub fn size(&self, id: &str) -> f64 {
        let columns = self.index(id).into_iter().flat_map(|k| self.projected.views[k].iter().flatten());
        columns.map(|column| norm(column)).fold(0.0, f64::max)
    }

    /// Share of an effect's signature that the calibrated parameters cannot absorb: of the view that shows it best.
    pub fn share(&self, id: &str) -> f64 {
        let Some(k) = self.index(id) else { return 0.0 };
        let views = self.sensitivities.signatures[k].views.iter().zip(&self.projected.views[k]);
        let share = |(view, outside): (&crate::diagnosis::diagnose::View, &Vec<Vec<f64>>)| {
            let whole: f64 = view.columns.iter().map(|c| norm(&self.whitening.apply(&c.values)).powi(2)).sum();
            let kept: f64 = outside.iter().map(|column| norm(column).powi(2)).sum();
            if whole > 0.0 { (kept / whole).sqrt().min(1.0) } else { 0.0 }
        };
        views.map(share).fold(0.0, f64::max)
    }

    /// Largest cosine between what two effects change beyond the calibration. An effect that can be told from another
    /// in one of its views only, a patch in one place, may still be in another.
    pub fn cosine(&self, a: &str, b: &str) -> f64 {
        let (Some(a), Some(b)) = (self.index(a), self.index(b)) else { return 0.0 };
        let mut largest = 0.0_f64;
        for a in &self.projected.views[a] {
            for b in &self.projected.views[b] {
                let (a, b): (Vec<_>, Vec<_>) = (a.iter().collect(), b.iter().collect());
                largest = largest.max(largest_cosine(&a, &b));
            }
        }
        largest
    }

    /// Whitened size of a finite change of the modelled values, beyond the calibration.
    pub fn size_of_change(&self, change: &[f64]) -> f64 {
        let mut white = self.whitening.apply(change);
        white.resize(white.len() + self.priors, 0.0);
        norm(&self.projected.base.outside(&white))
    }
}
