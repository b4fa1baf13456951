//! Signatures: what an effect would change in the measurements, per unit of its parameters, around a fit.

use crate::diagnosis::free::Free;
use crate::diagnosis::linear_algebra::Reach;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::problem::{Candidate, Problem};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Seed and number of the draws of an effect whose parameters cannot all be seen at its neutral value.
const SEED: u64 = 1969;
const DRAWS: usize = 6;

/// Share of a parameter's range that a start keeps from its bounds.
const MARGIN: f64 = 0.002;

/// Change of the modelled values, in the layout's order, with one coordinate.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    pub values: Vec<f64>,
    /// How far the coordinate may go from where the column was taken.
    pub reach: Reach,
}

/// One way of looking at an effect: columns that are fitted together.
#[derive(Clone, Debug)]
pub(crate) struct View {
    pub columns: Vec<Column>,
    way: Way,
}

#[derive(Clone, Debug)]
enum Way {
    /// Derivatives in some of the parameters, from the neutral values.
    Slopes { members: Vec<usize>, origin: Vec<f64> },
    /// A finite change to these values.
    Change(Vec<f64>),
}

/// An effect with its views: derivatives at its neutral value and, where some parameter is without influence there
/// (the place of a patch of no softness), finite changes at seeded draws.
#[derive(Clone, Debug)]
pub(crate) struct Signature {
    pub id: String,
    pub views: Vec<View>,
}

impl View {
    /// Parameters of the effect that the columns belong to, one each; `None` where the view is a finite change.
    pub fn members(&self) -> Option<&[usize]> {
        match &self.way {
            Way::Slopes { members, .. } => Some(members),
            Way::Change(_) => None,
        }
    }

    /// Parameter values of the effect for coefficients of the columns, to start a refit from.
    pub fn start(&self, free: &[Free], coefficients: &[f64]) -> Vec<f64> {
        let (members, origin) = match &self.way {
            Way::Change(draw) => return draw.clone(),
            Way::Slopes { members, origin } => (members, origin),
        };
        let mut values = origin.clone();
        for (k, d) in members.iter().zip(coefficients) {
            values[*k] += d * free[*k].slope(origin[*k]);
        }
        // Well inside the bounds: the linear guess may overshoot, and a search cannot leave a corner.
        let inside = |(value, free): (f64, &Free)| {
            let margin = MARGIN * (free.variable.max - free.variable.min);
            value.clamp(free.variable.min + margin, free.variable.max - margin)
        };
        values.into_iter().zip(free).map(inside).collect()
    }
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
    let mut signatures = Vec::new();
    for candidate in candidates {
        let own: Vec<Vec<f64>> = rest.by_ref().take(candidate.free.len()).collect();
        let views = views(problem, effects, values, &modelled, candidate, own)?;
        signatures.push(Signature { id: candidate.id.clone(), views });
    }
    Ok(Sensitivities { modelled, base: columns, signatures })
}

fn views(
    problem: &Problem,
    effects: &[String],
    values: &[f64],
    modelled: &[f64],
    candidate: &Candidate,
    columns: Vec<Vec<f64>>,
) -> Result<Vec<View>, PredictionError> {
    let members: Vec<usize> = (0..columns.len()).filter(|k| !is_still(&columns[*k])).collect();
    let still = members.len() < columns.len();
    let mut views = Vec::new();
    if !members.is_empty() {
        let column = |k: &usize| {
            let free = &candidate.free[*k];
            Column { values: columns[*k].clone(), reach: free.reach(free.start) }
        };
        let origin = candidate.free.iter().map(|free| free.start).collect();
        views.push(View { columns: members.iter().map(column).collect(), way: Way::Slopes { members, origin } });
    }
    if still {
        views.extend(finite_views(problem, effects, values, modelled, candidate)?);
    }
    Ok(views)
}

/// Whether nothing measured changes.
fn is_still(column: &[f64]) -> bool {
    column.iter().all(|x| x.is_nan() || *x == 0.0)
}

/// Finite changes at draws over the bounds, in a row that the model can compute.
fn finite_views(
    problem: &Problem,
    effects: &[String],
    values: &[f64],
    modelled: &[f64],
    candidate: &Candidate,
) -> Result<Vec<View>, PredictionError> {
    let mut with = effects.to_vec();
    with.push(candidate.id.clone());
    let free = problem.free(&with);
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut views = Vec::new();
    problem.predict(&free, |predict| {
        for k in 0..DRAWS {
            // Stratified in each coordinate, so that few draws cover the range.
            let draw: Vec<f64> = candidate
                .free
                .iter()
                .enumerate()
                .map(|(j, free)| {
                    let share = ((k * (2 * j + 1)) % DRAWS) as f64 + rng.random::<f64>();
                    free.variable.min + (free.variable.max - free.variable.min) * share / DRAWS as f64
                })
                .collect();
            let all: Vec<f64> = values.iter().chain(&draw).copied().collect();
            let Ok(changed) = predict.values(&all) else { continue };
            let change: Vec<f64> = changed.iter().zip(modelled).map(|(a, b)| a - b).collect();
            if !is_still(&change) {
                let columns =
                    vec![Column { values: change, reach: Reach { low: 0.0, high: room(&candidate.free, &draw) } }];
                views.push(View { columns, way: Way::Change(draw) });
            }
        }
    })?;
    Ok(views)
}

/// By what factor a draw can grow, all its parameters together, until one of them is on a bound.
fn room(free: &[Free], draw: &[f64]) -> f64 {
    let factor = |(free, value): (&Free, &f64)| {
        let end = if *value > free.start { free.variable.max } else { free.variable.min };
        if *value == free.start { f64::INFINITY } else { (end - free.start) / (value - free.start) }
    };
    free.iter().zip(draw).map(factor).fold(f64::INFINITY, f64::min)
}

/// Takes parameters out of the library that change nothing measured, neither at the neutral values nor at a quarter of
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
    let mut gone = Vec::new();
    let mut kept = Vec::new();
    for mut candidate in problem.library.clone() {
        let own: Vec<Vec<f64>> = rest.by_ref().take(candidate.free.len()).collect();
        let mut alive: Vec<bool> = own.iter().map(|column| !is_still(column)).collect();
        if !alive.iter().all(|alive| *alive) {
            let quarter = |free: &Free| free.variable.min + 0.25 * (free.variable.max - free.variable.min);
            let there: Vec<f64> = values.iter().copied().chain(candidate.free.iter().map(quarter)).collect();
            let with = problem.free(std::slice::from_ref(&candidate.id));
            if let Ok((_, slopes)) = problem.predict(&with, |predict| predict.slopes(&there))? {
                alive.iter_mut().zip(&slopes[values.len()..]).for_each(|(alive, column)| *alive |= !is_still(column));
            }
        }
        columns.extend(own.into_iter().zip(&alive).filter(|(_, alive)| **alive).map(|(column, _)| column));
        let mut alive = alive.into_iter();
        candidate.free.retain(|_| alive.next().unwrap_or(false));
        if candidate.free.is_empty() { gone.push(candidate.id) } else { kept.push(candidate) }
    }
    problem.library = kept;
    let candidates: Vec<&Candidate> = problem.library.iter().collect();
    let sensitivities = with_views(problem, &[], &candidates, values, modelled, columns)?;
    problem.know_sensitivities(values, sensitivities);
    Ok(gone)
}
