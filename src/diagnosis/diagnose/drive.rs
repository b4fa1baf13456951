//! Whether a found model drives the whole of a log that was judged window by window.

use super::fits::Noise;
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::fit::Fit;
use crate::diagnosis::halt::Halt;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::ODD;
use crate::diagnosis::unanswered::{UnansweredRows, listed};
use crate::diagnosis::windows::Window;
use crate::diagnosis::windows::cut::has_gap;
use crate::measurement::{Experiment, Kind};
use serde::Serialize;
use std::collections::BTreeMap;
use std::ops::Range;

/// The final model driven from the first row that counts to the end of each run, on its own: errors of the velocity add up here, so that
/// the place is off by more than in any window. Only runs without a gap can be driven so. How a rover breaks loose does not count:
/// where two states are steady, climbing and spinning, it decides between them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WholeDrive {
    /// Number of windows that take part in the fits.
    pub windows: usize,
    /// Runs that were driven as a whole.
    pub runs: Vec<String>,
    /// Root mean square of the residual by signal, over the rows that the replay reaches.
    pub rmse: BTreeMap<String, f64>,
    /// Rows that it does not reach.
    pub unanswered: Vec<UnansweredRows>,
    /// Words on runs whose start, which is not counted, differs from the model though the rest does not.
    #[serde(skip)]
    pub(crate) starts: Option<String>,
}

/// Drives the whole log; `None` where it was not cut.
///
/// # Errors
/// [`CompareError`] where the model cannot be placed on a run.
pub(crate) fn whole_drive(
    problem: &Problem,
    noise: &Noise,
    effects: &[String],
    values: &[f64],
) -> Result<Option<WholeDrive>, CompareError> {
    if !problem.is_cut() {
        return Ok(None);
    }
    let without_gap = |run: &usize| !has_gap(&problem.experiment.runs[*run]);
    let takes_part = |run: &usize| !problem.layout.is_left_out(*run);
    // Of several experiments some may have been no drives.
    let drives = |run: &usize| problem.experiment.kind_of_run(*run) == Kind::Traverse;
    let runs: Vec<usize> =
        (0..problem.experiment.runs.len()).filter(drives).filter(without_gap).filter(takes_part).collect();
    let mut whole = problem.only(&runs);
    whole.windows = runs.iter().map(|run| joined(&problem.windows[*run])).collect();
    whole.halt = Halt::default();
    let answers = whole.predict(&whole.free(effects), |predict| predict.answers(values))??;
    let rmse = Fit::new(&whole.experiment, &whole.layout, &answers.values).rmse;
    let unanswered = listed(answers.missing(&whole.layout));
    let starts = of_starts(&whole, noise, &answers.values);
    let runs = whole.experiment.runs.iter().map(|run| run.name.clone()).collect();
    Ok(Some(WholeDrive { windows: problem.windows.iter().map(Vec::len).sum(), runs, rmse, unanswered, starts }))
}

/// Windows of a run with all that follow each other made one.
fn joined(windows: &[Window]) -> Vec<Window> {
    let mut joined: Vec<Window> = Vec::new();
    for window in windows {
        match joined.last_mut().filter(|last| last.start.is_some()) {
            Some(last) => last.rows.end = window.rows.end,
            None => joined.push(Window { ends_when_stuck: window.start.is_some(), ..window.clone() }),
        }
    }
    joined
}

/// What is said of runs that miss the model at their start, by [`ODD`] times more squares than elsewhere; `None` where none does.
fn of_starts(whole: &Problem, noise: &Noise, modelled: &[f64]) -> Option<String> {
    let (layout, deviations) = (&whole.layout, noise.deviations());
    let time = |run: usize| whole.experiment.runs[run].data.column("time").unwrap_or_default();
    let mean = |run: usize, rows: Range<usize>| {
        let squares = layout.of_run(run).flat_map(|block| {
            let deviation = deviations.get(&block.signal).copied().unwrap_or(f64::INFINITY);
            let at = block.range.start + rows.start..block.range.start + rows.end;
            at.map(move |at| ((modelled[at] - layout.recorded[at]) / deviation).powi(2))
        });
        let (sum, count) = squares.filter(|square| !square.is_nan()).fold((0.0, 0.0), |(s, n), x| (s + x, n + 1.0));
        sum / f64::max(count, 1.0)
    };
    let differs = |run: &usize| {
        let (start, all) = (layout.starts[*run], time(*run).len());
        mean(*run, 0..start) > ODD * mean(*run, start..all).max(1.0)
    };
    let runs = whole.experiment.runs.len();
    let differing: Vec<usize> = (0..runs).filter(differs).collect();
    let longest = differing.iter().map(|run| time(*run)[layout.starts[*run]] - time(*run)[0]).reduce(f64::max)?;
    Some(format!(
        "the first {longest:.1} s of {} of {runs} runs differ from the rest: contact at the start; not counted",
        differing.len()
    ))
}

impl WholeDrive {
    /// Share of the rows of the runs that were driven as a whole that the model does not reach.
    pub(crate) fn share_missed(&self, experiment: &Experiment) -> f64 {
        let driven = experiment.runs.iter().filter(|run| self.runs.contains(&run.name));
        let rows: usize = driven.map(|run| run.data.rows()).sum();
        self.unanswered.iter().map(UnansweredRows::count).sum::<usize>() as f64 / rows.max(1) as f64
    }
}
