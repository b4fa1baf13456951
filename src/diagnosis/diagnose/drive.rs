//! Whether a found model drives the whole of a log that was judged window by window.

use crate::diagnosis::compare::CompareError;
use crate::diagnosis::fit::Fit;
use crate::diagnosis::halt::Halt;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::unanswered::{UnansweredRows, listed};
use crate::diagnosis::windows::Windows;
use crate::measurement::Experiment;
use serde::Serialize;
use std::collections::BTreeMap;

/// The final model replayed from the start of each run to its end, on its own: errors of the velocity add up here, so that the place
/// is off by more than in any window. Only runs that begin at rest and have no gap can be driven so.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WholeDrive {
    /// Number of windows into which the runs were cut.
    pub windows: usize,
    /// Runs that were driven as a whole.
    pub runs: Vec<String>,
    /// Root mean square of the residual by signal, over the rows that the replay reaches.
    pub rmse: BTreeMap<String, f64>,
    /// Rows that it does not reach.
    pub unanswered: Vec<UnansweredRows>,
}

/// Drives the whole log; `None` where it was not cut.
///
/// # Errors
/// [`CompareError`] where the model cannot be placed on a run.
pub(crate) fn whole_drive(
    problem: &Problem,
    effects: &[String],
    values: &[f64],
) -> Result<Option<WholeDrive>, CompareError> {
    if !problem.is_cut() {
        return Ok(None);
    }
    let begins_at_rest = |run: &usize| {
        let windows = &problem.windows[*run];
        windows
            .iter()
            .enumerate()
            .all(|(k, window)| if k == 0 { window.start.is_none() } else { window.begin < window.rows.start })
    };
    let runs: Vec<usize> = (0..problem.experiment.runs.len()).filter(begins_at_rest).collect();
    let mut whole = problem.only(&runs);
    whole.windows = Windows::new();
    whole.halt = Halt::default();
    let answers = whole.predict(&whole.free(effects), |predict| predict.answers(values))??;
    let rmse = Fit::new(&whole.experiment, &whole.layout, &answers.values).rmse;
    let unanswered = listed(answers.missing(&whole.layout));
    let runs = whole.experiment.runs.iter().map(|run| run.name.clone()).collect();
    Ok(Some(WholeDrive { windows: problem.windows.iter().map(Vec::len).sum(), runs, rmse, unanswered }))
}

impl WholeDrive {
    /// Share of the rows of the runs that were driven as a whole that the model does not reach.
    pub(crate) fn share_missed(&self, experiment: &Experiment) -> f64 {
        let driven = experiment.runs.iter().filter(|run| self.runs.contains(&run.name));
        let rows: usize = driven.map(|run| run.data.rows()).sum();
        self.unanswered.iter().map(UnansweredRows::count).sum::<usize>() as f64 / rows.max(1) as f64
    }
}
