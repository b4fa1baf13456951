//! How far a model is off in each window of each run.

use crate::diagnosis::{Fit, Motion, Uncounted};
use crate::report::plots::View;
use std::ops::Range;

/// Runs that are not cut are shown in parts of about this length, s, which is that of a window.
const LENGTH: f64 = 6.0;

/// A window, or a part of one whose rows do not count.
pub(super) struct Stretch {
    pub run: usize,
    pub rows: Range<usize>,
    /// Why its rows do not count; `None` where they do.
    pub why: Option<Uncounted>,
    /// First time, and the time at which the next stretch begins, s.
    pub seconds: [f64; 2],
    /// Root mean square of the residual over the noise of one sample by signal, the largest first.
    pub ratios: Vec<(String, f64)>,
}

impl Stretch {
    /// The largest of the ratios; NaN where nothing counts.
    pub fn worst(&self) -> f64 {
        self.ratios.first().map_or(f64::NAN, |(_, ratio)| *ratio)
    }
}

/// The stretches of all runs, in the order of the experiment.
pub(super) fn stretches(view: &View) -> Vec<Stretch> {
    let mut all = Vec::new();
    for (run, motion) in view.model.fit.motion.iter().enumerate() {
        let time = view.experiment.runs[run].data.column("time").unwrap_or_default();
        let (why, windows) = (reasons(view, run), numbers(motion, time));
        let rows: Vec<usize> = (0..time.len()).collect();
        for part in rows.chunk_by(|a, b| why[*a] == why[*b] && windows[*a] == windows[*b]) {
            let rows = part[0]..part[part.len() - 1] + 1;
            let end = if connected(time, rows.end) { time[rows.end] } else { time[rows.end - 1] };
            all.push(Stretch {
                run,
                why: why[rows.start],
                seconds: [time[rows.start], end],
                ratios: ratios(view, view.model.fit, run, rows.clone()),
                rows,
            });
        }
    }
    all
}

/// Why each row of a run does not count; `None` for one that counts.
fn reasons(view: &View, run: usize) -> Vec<Option<Uncounted>> {
    let run = &view.experiment.runs[run];
    let mut why = vec![None; run.data.rows()];
    for rows in view.uncounted.iter().filter(|rows| rows.run == run.name) {
        why[rows.rows.0 - 1..rows.rows.1].fill(Some(rows.why));
    }
    why
}

/// Whether a row follows the one before without a gap, which is over twice the usual time between rows and half a second.
fn connected(time: &[f64], row: usize) -> bool {
    let usual = (time[time.len() - 1] - time[0]) / (time.len() - 1).max(1) as f64;
    time.get(row).is_some_and(|next| next - time[row - 1] < (2.0 * usual).max(0.5))
}

/// Number of the window of each row, counted from 1.
fn numbers(motion: &Motion, time: &[f64]) -> Vec<usize> {
    let mut numbers = vec![1; time.len()];
    if motion.windows.len() < 2 {
        let parts = ((time[time.len() - 1] - time[0]) / LENGTH).round().max(1.0);
        let length = (time[time.len() - 1] - time[0]) / parts;
        for (number, t) in numbers.iter_mut().zip(time) {
            *number = 1 + ((t - time[0]) / length.max(f64::MIN_POSITIVE)).min(parts - 1.0) as usize;
        }
        return numbers;
    }
    for (number, window) in motion.windows.iter().enumerate() {
        numbers[window.clone()].fill(number + 1);
    }
    numbers
}

fn ratios(view: &View, fit: &Fit, run: usize, rows: Range<usize>) -> Vec<(String, f64)> {
    let Some(own) = fit.runs.get(run) else { return Vec::new() };
    let ratio = |signal: &crate::diagnosis::SignalFit| {
        let residual = signal.residual[rows.clone()].iter().filter(|residual| !residual.is_nan());
        let (sum, count) = residual.fold((0.0, 0), |(sum, count), residual| (sum + residual * residual, count + 1));
        let rms = (sum / f64::from(count)).sqrt() / view.scale(&signal.signal);
        (count > 0).then(|| (signal.signal.clone(), rms))
    };
    let mut ratios: Vec<(String, f64)> = own.signals.iter().filter_map(ratio).collect();
    ratios.sort_by(|a, b| b.1.total_cmp(&a.1));
    ratios
}
