//! Whether the inner step with which a diagnosis simulates is exact enough.

use super::fits::Noise;
use super::prepare::{minus, modelled};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::noise::NoiseModel;
use crate::diagnosis::problem::Problem;

/// Share of a signal's noise by which the inner step may change it, RMS: chi-square grows by less than half a per cent.
const SHOWS: f64 = 0.06;

/// Whether the inner step shows beside the noise: the next finer one changes some signal by more than a share of its noise. Where there
/// are many windows some of them, evenly spread, tell.
///
/// # Errors
/// [`CompareError`] where the model has no answer at `values`.
pub(super) fn is_coarse(problem: &Problem, noise: &Noise, values: &[f64]) -> Result<bool, CompareError> {
    let thinned = problem.thinned();
    let problem = thinned.as_ref().unwrap_or(problem);
    let mut finer = problem.clone();
    if !finer.refine_step() {
        return Ok(false);
    }
    let (ours, theirs) = (modelled(problem, values)?.values, modelled(&finer, values)?.values);
    let changed = minus(&ours, &theirs);
    let layout = &problem.layout;
    let shows = |signal: &String, model: &NoiseModel| {
        let mut present = Vec::new();
        for block in layout.blocks.iter().filter(|block| block.signal == *signal) {
            let rows = (0..block.range.len()).filter(|row| layout.is_fitted(block, *row));
            present.extend(rows.map(|row| changed[block.range.start + row]).filter(|x| !x.is_nan()));
        }
        let square = present.iter().map(|x| x * x).sum::<f64>() / present.len().max(1) as f64;
        square.sqrt() > SHOWS * model.deviation
    };
    Ok(noise.models.iter().any(|(signal, model)| shows(signal, model)))
}
