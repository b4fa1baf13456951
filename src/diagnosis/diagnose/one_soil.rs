//! Whether the experiments of a set stand on one soil at all: what two soils differ in may look like an effect in one of them.

use super::fits::run;
use super::search::Search;
use crate::diagnosis::calibrate::{CalibratedParameter, Calibration};
use crate::diagnosis::thresholds::{PRICE, PRIOR_CONTRADICTED, REACH};
use crate::parallel::map_in_order;

/// A soil of its own in one experiment, without any effect, that accounts for as much as the effects do on one soil.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OwnSoil {
    /// The experiment.
    part: String,
    /// What it leaves, and its free parameters.
    chi_square: f64,
    parameters: usize,
    /// The same of the effects on one soil.
    of_effects: (f64, usize),
}

impl OwnSoil {
    pub fn words(&self) -> String {
        let Self { part, chi_square, parameters, of_effects: (with, count) } = self;
        format!(
            "the experiments may not stand on one soil: with a soil of its own in {part} and no effect chi-square is {chi_square:.0} with \
             {parameters} parameters, with the effects and one soil {with:.0} with {count}; diagnose {part} by itself, or say what it shares"
        )
    }
}

/// Whether a soil of its own in one of the experiments is as good an answer as `effects`, each parameter at its price: better by more than a
/// rival may be behind, or, where beds would have to differ by more than beds are taken to do, within what a rival may be behind.
pub(crate) fn own_soil(search: &Search, effects: &[String], fit: &Calibration) -> Option<OwnSoil> {
    let (problem, parts) = (search.problem, &search.problem.experiment.parts);
    let beds_moved =
        problem.base.iter().zip(&fit.parameters).filter(|(free, _)| free.is_factor()).any(|(_, bed)| moved(bed));
    let price = |chi_square: f64, parameters: usize| chi_square + PRICE * parameters as f64;
    let most = price(fit.chi_square, fit.parameters.len()) + if beds_moved { REACH } else { -REACH };
    // Of two it is the same which of them has a soil of its own.
    let places: Vec<usize> = (0..if parts.len() == 2 { 1 } else { parts.len() }).collect();
    let apart = |k: &usize| {
        let apart = problem.with_own_soil(*k)?;
        let start = |set: &[String]| {
            let values = search.fits.get(set)?.values();
            Some(problem.as_own_soil(&apart, *k, &problem.free(set), &values))
        };
        let task = apart.task(&[], [start(&[]), start(effects)].into_iter().flatten().collect());
        Some((*k, run(&apart, search.noise, &task)?))
    };
    let found = map_in_order(&places, apart).into_iter().flatten();
    let (k, best) = found.min_by(|a, b| a.1.chi_square.total_cmp(&b.1.chi_square))?;
    (price(best.chi_square, best.parameters.len()) < most).then(|| OwnSoil {
        part: parts[k].name.clone(),
        chi_square: best.chi_square,
        parameters: best.parameters.len(),
        of_effects: (fit.chi_square, fit.parameters.len()),
    })
}

fn moved(bed: &CalibratedParameter) -> bool {
    bed.prior_shift().is_some_and(|shift| shift.abs() > PRIOR_CONTRADICTED)
}
