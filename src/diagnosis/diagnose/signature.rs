//! Signatures: what an effect would change in the measurements, per unit of its parameters, around a fit.

use super::views::{Place, Rounding, View, views};
use crate::diagnosis::free::Free;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::problem::{Candidate, Problem};

/// An effect with its views: derivatives at its neutral value and, where some parameter is without influence there
/// (the place of a patch of no softness), finite changes at seeded draws.
#[derive(Clone, Debug)]
pub(crate) struct Signature {
    pub id: String,
    pub views: Vec<View>,
}

/// Sensitivities of a fit: the fitted values and one raw column (layout order, by search coordinate) a base parameter.
#[derive(Clone, Debug)]
pub(crate) struct Sensitivities {
    pub modelled: Vec<f64>,
    pub base: Vec<Vec<f64>>,
    pub signatures: Vec<Signature>,
}

/// Sensitivities to the parameters `fitted` (free, at their values) and to every candidate not among `effects`.
///
/// # Errors
/// [`PredictionError`] where the model has no answer at the fit.
pub(crate) fn sensitivities(
    problem: &Problem,
    effects: &[String],
    values: &[f64],
) -> Result<Sensitivities, PredictionError> {
    if let Some(known) = problem.known_sensitivities(effects, values) {
        return Ok(known.clone());
    }
    let candidates: Vec<&Candidate> = problem.library.iter().filter(|c| !effects.contains(&c.id)).collect();
    let mut free = problem.free(effects);
    free.extend(candidates.iter().flat_map(|candidate| candidate.free.iter().cloned()));
    let mut all = values.to_vec();
    all.extend(free[values.len()..].iter().map(|free| free.start));
    let (modelled, slopes) = problem.predict(&free, |predict| predict.slopes(&all))??;
    let columns = by_coordinate(slopes, &free, &all);
    with_views(problem, effects, &candidates, values, modelled, columns)
}

/// Derivatives in the search's coordinates.
fn by_coordinate(mut slopes: Vec<Vec<f64>>, free: &[Free], values: &[f64]) -> Vec<Vec<f64>> {
    for (column, (free, value)) in slopes.iter_mut().zip(free.iter().zip(values)) {
        let slope = free.slope(*value);
        column.iter_mut().for_each(|x| *x *= slope);
    }
    slopes
}

/// Sensitivities from columns of the fitted parameters and, behind them, of the candidates' at their neutral values.
fn with_views(
    problem: &Problem,
    effects: &[String],
    candidates: &[&Candidate],
    values: &[f64],
    modelled: Vec<f64>,
    mut columns: Vec<Vec<f64>>,
) -> Result<Sensitivities, PredictionError> {
    let mut rest = columns.split_off(values.len()).into_iter();
    let rounding = Rounding::of(&problem.layout, &modelled);
    let mut signatures = Vec::new();
    for candidate in candidates {
        let own: Vec<Vec<f64>> = rest.by_ref().take(candidate.free.len()).collect();
        let views =
            views(&Place { problem, effects, values, modelled: &modelled, rounding: &rounding }, candidate, own)?;
        signatures.push(Signature { id: candidate.id.clone(), views });
    }
    Ok(Sensitivities { modelled, base: columns, signatures })
}

/// Marks as alive those parameters of a candidate that change something measured between a quarter and half of their ranges, all
/// others being at a quarter of theirs. None is where the model has no answer at these quarters.
fn felt_inside(
    problem: &Problem,
    values: &[f64],
    candidate: &Candidate,
    rounding: &Rounding,
    alive: &mut [bool],
) -> Result<(), PredictionError> {
    let at = |free: &Free, share: f64| free.variable.min + share * (free.variable.max - free.variable.min);
    let quarters: Vec<f64> = values.iter().copied().chain(candidate.free.iter().map(|free| at(free, 0.25))).collect();
    let with = problem.free(std::slice::from_ref(&candidate.id));
    problem.predict(&with, |predict| {
        let Ok(there) = predict.values(&quarters) else { return };
        for (k, alive) in alive.iter_mut().enumerate().filter(|(_, alive)| !**alive) {
            let mut moved = quarters.clone();
            moved[values.len() + k] = at(&candidate.free[k], 0.5);
            let change = |moved: Vec<f64>| moved.iter().zip(&there).map(|(a, b)| a - b).collect::<Vec<f64>>();
            *alive = predict.values(&moved).is_ok_and(|moved| !rounding.hides(&change(moved)));
        }
    })
}

/// Takes parameters out of the library that change nothing measured, neither at the neutral values nor from a quarter to half of
/// their ranges: an odometer's scale on a carriage. Candidates without any other parameter leave the library; their ids
/// are returned. The problem keeps the sensitivities at the baseline, which the first stage and the plans ask for.
///
/// # Errors
/// [`PredictionError`] where the model has no answer at `values`, those of the baseline.
pub(crate) fn prune(problem: &mut Problem, values: &[f64]) -> Result<Vec<String>, PredictionError> {
    let mut free = problem.base.clone();
    free.extend(problem.library.iter().flat_map(|candidate| candidate.free.iter().cloned()));
    let all: Vec<f64> = values.iter().copied().chain(free[values.len()..].iter().map(|free| free.start)).collect();
    let (modelled, slopes) = problem.predict(&free, |predict| predict.slopes(&all))??;
    let mut rest = by_coordinate(slopes, &free, &all);
    let mut columns: Vec<Vec<f64>> = rest.drain(..values.len()).collect();
    let mut rest = rest.into_iter();
    let rounding = Rounding::of(&problem.layout, &modelled);
    let mut gone = Vec::new();
    let mut kept = Vec::new();
    for mut candidate in problem.library.clone() {
        let own: Vec<Vec<f64>> = rest.by_ref().take(candidate.free.len()).collect();
        let mut alive: Vec<bool> = own.iter().map(|column| !rounding.hides(column)).collect();
        if !alive.iter().all(|alive| *alive) {
            felt_inside(problem, values, &candidate, &rounding, &mut alive)?;
        }
        let seen =
            own.into_iter().zip(&alive).filter(|(_, alive)| **alive).map(|(column, _)| column).collect::<Vec<_>>();
        let mut alive = alive.into_iter();
        candidate.free.retain(|_| alive.next().unwrap_or(false));
        if candidate.free.is_empty() { gone.push(candidate.id) } else { kept.push((candidate, seen)) }
    }
    problem.in_visible_parts(&mut kept, &mut gone);
    let (library, seen): (Vec<Candidate>, Vec<Vec<Vec<f64>>>) = kept.into_iter().unzip();
    columns.extend(seen.into_iter().flatten());
    problem.library = library;
    let candidates: Vec<&Candidate> = problem.library.iter().collect();
    let sensitivities = with_views(problem, &[], &candidates, values, modelled, columns)?;
    problem.know_sensitivities(values, sensitivities);
    Ok(gone)
}
