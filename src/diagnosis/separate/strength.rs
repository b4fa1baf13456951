//! The smallest strength of an effect that an experiment would show.

use super::look::Look;
use crate::diagnosis::problem::{Candidate, Problem};
use crate::diagnosis::thresholds::DETECTABLE;
use bekker_modeldescription::Variable;

/// Steps towards a change of the detectable size, and the share to which it is met.
const STEPS: usize = 8;
const CLOSE: f64 = 0.01;

/// Share of the range from which the search starts where the derivative says nothing.
const START: f64 = 0.1;

/// The smallest value of one parameter of an effect that an experiment would show.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallestStrength {
    /// The parameter, its unit and bounds.
    pub variable: Variable,
    /// Its value without the effect.
    pub neutral: f64,
    /// The smallest value that would be found (80 % power at p = 0.01, corrected for the number of candidates: a change of
    /// 5 standard deviations beyond the calibration); `None` where it cannot be seen within its bounds.
    pub value: Option<f64>,
}

/// The smallest detectable value of parameter number `k` of a candidate, the others being neutral; `slope` is the
/// whitened size over the parameter's whole range, to first order.
pub(crate) fn smallest(
    problem: &Problem,
    look: &Look,
    values: &[f64],
    candidate: &Candidate,
    k: usize,
    slope: f64,
) -> SmallestStrength {
    let free = &candidate.free[k];
    let (variable, neutral) = (free.variable.clone(), free.start);
    let ends = [variable.max, variable.min].into_iter().filter(|end| *end != neutral);
    let found = ends.filter_map(|end| towards(problem, look, values, candidate, k, end, slope));
    let value = found.min_by(|a, b| (a - neutral).abs().total_cmp(&(b - neutral).abs()));
    SmallestStrength { variable, neutral, value }
}

/// The same on one side of neutral. The size grows about as a power of the strength, so the strength is scaled by the
/// size that it misses.
fn towards(
    problem: &Problem,
    look: &Look,
    values: &[f64],
    candidate: &Candidate,
    k: usize,
    end: f64,
    slope: f64,
) -> Option<f64> {
    let neutral = candidate.free[k].start;
    let reach = end - neutral;
    let size = |share: f64| -> Option<f64> {
        let mut own: Vec<f64> = candidate.free.iter().map(|free| free.start).collect();
        own[k] = if share >= 1.0 { end } else { neutral + share * reach };
        let all: Vec<f64> = values.iter().copied().chain(own).collect();
        let free = problem.free(std::slice::from_ref(&candidate.id));
        let changed = problem.predict(&free, |predict| predict.values(&all)).ok()?.ok()?;
        let change: Vec<f64> = changed.iter().zip(&look.sensitivities.modelled).map(|(a, b)| a - b).collect();
        Some(look.size_of_change(&change)).filter(|size| size.is_finite())
    };
    let range = candidate.free[k].variable.max - candidate.free[k].variable.min;
    let linear = DETECTABLE * range / (slope * reach.abs());
    let mut share = if linear.is_finite() && linear > 0.0 { linear.min(1.0) } else { START };
    for _ in 0..STEPS {
        let Some(size) = size(share) else {
            // The model has no answer there: the effect is so strong that the wheel sinks. Nearer to neutral it has.
            share *= 0.5;
            continue;
        };
        if share >= 1.0 && size < DETECTABLE {
            return None;
        }
        let factor = DETECTABLE / size;
        if (factor - 1.0).abs() < CLOSE {
            return Some(neutral + share * reach);
        }
        share = (share * factor.clamp(0.01, 100.0)).min(1.0);
    }
    (share < 1.0).then_some(neutral + share * reach)
}
