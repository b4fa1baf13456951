//! Whether the experiments of a set stand on one soil at all: what two soils differ in may look like an effect in one of them.

use super::fits::run;
use super::search::Search;
use super::untried::Untried;
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::thresholds::{PRICE, PRIOR_CONTRADICTED, REACH};
use crate::parallel::map_in_order;

/// One experiment that may stand on another soil than the rest.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OwnSoil {
    /// The experiment, or both of two.
    parts: String,
    /// What is left with a soil of its own and no effect, and the number of free parameters.
    apart: (f64, usize),
    /// The same of `effects` on one soil.
    together: (f64, usize),
    effects: String,
    /// Whether beds would have to differ by more than they are taken to do.
    beds_moved: bool,
}

impl OwnSoil {
    /// The reason in a sentence.
    pub fn words(&self) -> String {
        let Self { parts, apart, together, effects, beds_moved } = self;
        let beds = if *beds_moved {
            ", and the beds would have to differ by over two standard deviations of what beds are taken to differ by"
        } else {
            ""
        };
        format!(
            "the experiments may not stand on one soil: with a soil of its own in {parts} and no added effect chi-square is {:.0} with {} free \
             parameters, with {effects} on one soil it is {:.0} with {}{beds}; diagnose the experiments one by one, or name the soil of each under \
             [shared]",
            apart.0, apart.1, together.0, together.1
        )
    }
}

/// Whether a soil of its own in one of the experiments speaks against `effects`. Each free parameter counts with its price, and then it has to be
/// better by more than a rival may be behind; where beds would have to differ by over two standard deviations it is enough that it is not that
/// much worse.
pub(crate) fn own_soil(search: &Search, effects: &[String], fit: &Calibration) -> Option<OwnSoil> {
    let (problem, parts) = (search.problem, &search.problem.experiment.parts);
    if !search.watch.has_time(parts.len() as f64) {
        search.watch.leave(parts.iter().map(|part| Untried::OwnSoil(part.name.clone())));
        return None;
    }
    let moved = |shift: f64| shift.abs() > PRIOR_CONTRADICTED;
    let beds = problem.base.iter().zip(&fit.parameters).filter(|(free, _)| free.is_factor());
    let beds_moved = beds.filter_map(|(_, bed)| bed.prior_shift()).any(moved);
    let price = |fit: &Calibration| fit.chi_square + PRICE * fit.parameters.len() as f64;
    let most = price(fit) + if beds_moved { REACH } else { -REACH };
    let places: Vec<usize> = (0..parts.len()).collect();
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
    let (k, best) = found.min_by(|a, b| price(&a.1).total_cmp(&price(&b.1)))?;
    let names: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
    (price(&best) < most).then(|| OwnSoil {
        // Of two it is hardly told which of them has the other soil.
        parts: if names.len() == 2 { names.join(" or ") } else { names[k].to_owned() },
        apart: (best.chi_square, best.parameters.len()),
        together: (fit.chi_square, fit.parameters.len()),
        effects: effects.join(" with "),
        beds_moved,
    })
}
