//! Profile likelihood: how far a parameter can go before the fit, all others following, gets worse than noise allows.

use super::result::FinalParameter;
use super::search::Search;
use super::untried::Untried;
use crate::diagnosis::calibrate::calibrate_from;
use crate::diagnosis::free::Free;
use crate::diagnosis::prior_rows::PriorRows;
use crate::diagnosis::thresholds::CHI_SQUARE_95;
use crate::diagnosis::weighted::Weighted;

/// Shares of the range that stand in for the standard error: on a bound, and where it is not determined; the latter is the
/// widest step at all.
const FROM_BOUND: f64 = 0.05;
const WIDEST: f64 = 0.3;

/// What a profile costs, in single fits: up to eight refits from nearby on a carriage, where a fit has several starts.
const PROFILE: f64 = 1.0;

/// Standard errors at which the profile is taken, to either side.
const PLACES: [f64; 4] = [0.7, 1.4, 2.1, 3.0];

/// Profiles of the parameters of a fitted set, as far as there is time: of all or, where fits are dear, of those of the effects.
pub(crate) fn profiles(search: &Search, effects: &[String]) -> Vec<FinalParameter> {
    let problem = search.problem;
    let Some(fit) = search.fits.get(effects) else { return Vec::new() };
    let from = if problem.strategy().budget().profiles_of_calibrated { 0 } else { problem.base.len() };
    let free = problem.free(effects);
    let numbers: Vec<usize> = (from..fit.parameters.len()).filter(|k| has_profile(&free, *k)).collect();
    let name = |k: &usize| fit.parameters[*k].variable.name.clone();
    let profile = |k: &usize| profile(search, effects, *k);
    let untried = |k: &usize| Untried::Profile(name(k));
    search.watch.pieces(&numbers, PROFILE, name, untried, profile).into_iter().flatten().collect()
}

/// Whether a parameter can be held while all others follow: no factor on others, and no strength that adds to another one's.
fn has_profile(free: &[Free], k: usize) -> bool {
    let own = &free[k];
    let adds = |other: &Free| match (&own.within, &other.within) {
        (Some(own), Some(other)) => own.name == other.name && own.parts.iter().any(|part| other.parts.contains(part)),
        _ => false,
    };
    !own.is_factor() && !free.iter().enumerate().any(|(j, other)| j != k && adds(other))
}

fn profile(search: &Search, effects: &[String], k: usize) -> Option<FinalParameter> {
    let fit = search.fits.get(effects)?;
    let (values, parameter) = (fit.values(), &fit.parameters[k]);
    let free = search.problem.free(effects);
    let (low, high) = (free[k].variable.min, free[k].variable.max);
    let unknown = if parameter.at_bound { FROM_BOUND } else { WIDEST };
    let width = parameter.deviation.unwrap_or(unknown * (high - low)).min(WIDEST * (high - low));
    let mut points = vec![(values[k], 0.0)];
    for side in [-1.0, 1.0] {
        let mut start = values.clone();
        for place in PLACES {
            let at = (values[k] + side * place * width).clamp(low, high);
            if (at - points.last().map_or(f64::NAN, |(x, _)| *x)).abs() < 1e-9 * (high - low) {
                break;
            }
            let Some((cost, next)) = refit(search, &free, &start, k, at) else { break };
            points.push((at, (cost - fit.chi_square).max(0.0)));
            start = next;
            if cost - fit.chi_square > CHI_SQUARE_95[0] {
                break;
            }
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let interval = (crossing(&points, values[k], -1.0), crossing(&points, values[k], 1.0));
    Some(FinalParameter { name: parameter.variable.name.clone(), interval, profile: points })
}

/// The fit with parameter `k` held at a value: its cost, and all values.
fn refit(search: &Search, free: &[Free], start: &[f64], k: usize, at: f64) -> Option<(f64, Vec<f64>)> {
    let mut problem = search.problem.clone();
    problem.fix(&free[k].variable.name, at);
    let others: Vec<Free> = free.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, free)| free.clone()).collect();
    let mut start = start.to_vec();
    start.remove(k);
    let prior = free[k].prior.map_or(0.0, |prior| ((at - prior.mean) / prior.deviation).powi(2));
    let robust = search.noise.robust.unwrap_or(f64::INFINITY);
    let fit = problem
        .predict(&others, |predict| {
            let whitening = search.context.whitening;
            let held = Some((free[k].variable.name.as_str(), at));
            let priors = &PriorRows::new(&others, problem.joint.as_ref(), 1.0, held);
            let (layout, free) = (&problem.layout, others.as_slice());
            let weighted = Weighted { predict, layout, free, whitening, priors, robust, whole: true };
            calibrate_from(
                &weighted,
                &search.noise.deviations(),
                &[start],
                search.problem.strategy().budget().calibration.without_draws(),
            )
        })
        .ok()??;
    let mut values = fit.values();
    values.insert(k, at);
    Some((fit.chi_square + prior, values))
}

/// Where the rise crosses the limit on one side of the minimum, between two points; `None` where it does not.
fn crossing(points: &[(f64, f64)], minimum: f64, side: f64) -> Option<f64> {
    let mut outward: Vec<(f64, f64)> = points.iter().copied().filter(|(x, _)| side * (x - minimum) >= 0.0).collect();
    outward.sort_by(|a, b| (side * a.0).total_cmp(&(side * b.0)));
    let pair = outward.windows(2).find(|pair| pair[1].1 > CHI_SQUARE_95[0])?;
    // The root of the rise is nearly straight.
    let (a, b) = (pair[0].1.max(0.0).sqrt(), pair[1].1.sqrt());
    Some(pair[0].0 + (pair[1].0 - pair[0].0) * (CHI_SQUARE_95[0].sqrt() - a) / (b - a))
}
