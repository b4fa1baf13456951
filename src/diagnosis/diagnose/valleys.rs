//! Fits that another fit shows to be no least.
//!
//! A search ends in the nearest valley of chi-square. The searches of other sets of effects began with another effect and may have
//! ended in a lower one. So each set is looked at where others ended - with their soil, and with the strengths of the effects that both
//! have - and is fitted once more from there where that leaves less than its own search did. Without this, the soil that a further
//! effect helped to find counts as a gain of that effect.

use super::far::costs;
use super::fits::Task;
use super::search::{SAME_FIT, Search};
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::gauss_newton::same_end;

/// Other sets of the same size at whose values a set is looked at: the best ones.
const BEST_OTHERS: usize = 3;

impl Search<'_> {
    /// Fits the baseline and the fitted sets of up to `count` effects once more, each from where another set ended if that
    /// leaves less than the set's own search. Returns whether the baseline has changed.
    pub(super) fn lower_valleys(&mut self, count: usize) -> bool {
        if !self.problem.strategy().budget().refits_from_larger {
            return false;
        }
        let before = self.fits.get(&[]).cloned();
        let sets: Vec<Vec<String>> = (0..=count).flat_map(|n| self.fits.of(n)).map(|(set, _)| set.clone()).collect();
        let looks: Vec<Task> = sets.iter().map(|set| self.problem.task(set, self.places(set))).collect();
        let lower: Vec<Task> = looks.into_iter().filter_map(|look| self.lowest(look)).collect();
        self.settle_all(&lower);
        let (Some(before), Some(after)) = (before, self.fits.get(&[])) else { return false };
        before.chi_square - after.chi_square > self.same_end(&before)
    }

    /// Values of a set where others ended: those with one more effect, and the best of its own size.
    fn places(&self, set: &[String]) -> Vec<Vec<f64>> {
        let Some(own) = self.fits.get(set).map(Calibration::values) else { return Vec::new() };
        let holds = |other: &Vec<String>| set.iter().all(|id| other.contains(id));
        let larger = self.fits.of(set.len() + 1).filter(|(other, _)| holds(other));
        let mut alike: Vec<_> = self.fits.of(set.len()).filter(|(other, _)| other.as_slice() != set).collect();
        alike.sort_by(|a, b| a.1.chi_square.total_cmp(&b.1.chi_square));
        let at = |(other, fit): (&Vec<String>, &Calibration)| {
            let values = fit.values();
            let part = |id: &String| {
                let (of, all) = if other.contains(id) { (other.as_slice(), &values) } else { (set, &own) };
                self.problem.part(of, all, id).to_vec()
            };
            let parts: Vec<(&str, Vec<f64>)> = set.iter().map(|id| (id.as_str(), part(id))).collect();
            let parts: Vec<(&str, &[f64])> = parts.iter().map(|(id, part)| (*id, part.as_slice())).collect();
            self.problem.assemble(&values, &parts)
        };
        larger.chain(alike.into_iter().take(BEST_OTHERS)).map(at).collect()
    }

    /// The start of a look with the least chi-square, where that is less than what the set's own search has left.
    fn lowest(&self, look: Task) -> Option<Task> {
        let known = self.fits.get(&look.effects)?;
        let (left, _) = costs(self.problem, self.noise, &look)?;
        let least = (0..left.len()).min_by(|a, b| left[*a].total_cmp(&left[*b]))?;
        let lower = known.chi_square - left[least] > self.same_end(known);
        lower.then(|| Task { starts: vec![look.starts[least].clone()], ..look })
    }

    /// By how much chi-square may differ between searches that have ended in the place of this fit.
    fn same_end(&self, fit: &Calibration) -> f64 {
        let pace = self.problem.strategy().budget().calibration.pace;
        match pace.gauss_newton {
            true => same_end(fit.chi_square, fit.degrees_of_freedom as f64, pace.least_promise),
            false => SAME_FIT * fit.chi_square,
        }
    }
}
