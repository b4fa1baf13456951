//! The error falling step by step.

use super::figure::{COLOURS, Figure, Mark, Scale, Trace};
use crate::diagnosis::Diagnosis;
use crate::report::units::spoken;

/// More signals than this would make the legend larger than the figure.
const MOST_SIGNALS: usize = 6;

/// RMS error of every signal over its noise floor, by step, in the fit and on what was left out. Signals without a noise
/// floor are divided by the baseline's error. `names` are those of the model as given and of the steps.
pub(in crate::report) fn steps(diagnosis: &Diagnosis, names: &[String]) -> Figure {
    let baseline = diagnosis.baseline();
    let scale = |signal: &String| {
        let floor = diagnosis.noise_floor.get(signal).and_then(|floor| floor.value());
        floor.filter(|floor| *floor > 0.0).or_else(|| baseline.rmse.get(signal).copied()).unwrap_or(1.0)
    };
    let mut signals: Vec<(&String, f64)> =
        baseline.rmse.iter().map(|(signal, rmse)| (signal, rmse / scale(signal))).collect();
    signals.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut traces = Vec::new();
    for (k, (signal, _)) in signals.into_iter().take(MOST_SIGNALS).enumerate() {
        for held_out in [false, true] {
            let mut points: Vec<(f64, f64)> = Vec::new();
            if let (false, Some(rmse)) = (held_out, diagnosis.given.as_ref().and_then(|fit| fit.rmse.get(signal))) {
                points.push((0.0, rmse / scale(signal)));
            }
            for (at, step) in diagnosis.steps.iter().enumerate() {
                let rmse = if held_out { &step.heldout_rmse } else { &step.rmse };
                points.extend(rmse.get(signal).map(|rmse| ((at + 1) as f64, rmse / scale(signal))));
            }
            let (x, y) = points.into_iter().unzip();
            let (name, mark) = if held_out {
                (format!("{}, left out", spoken(signal)), Mark::Dashed)
            } else {
                (spoken(signal), Mark::Joined)
            };
            traces.push(Trace::new(&name, mark, COLOURS[k % COLOURS.len()], x, y));
        }
    }
    let x = Scale { names: names.to_vec(), ..Scale::default() };
    let y = Scale { logarithmic: true, ..Scale::numbers("error / noise floor") };
    Figure { level: Some(1.0), ..Figure::new(x, y, traces) }
}
