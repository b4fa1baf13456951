//! What the windows of a long drive that took no part in any fit say of the final model.

use super::far::costs;
use super::fits::{NO_PRIORS, Noise, Task};
use super::result::Verdict;
use super::verdict::Judgement;
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::ODD;

/// Different windows that take part in the fits, where nothing else is asked for: some six minutes of driving. More of them make every fit
/// longer; the others judge what was found.
pub(crate) const WINDOWS: usize = 64;

/// Misfit over the windows that took no part, and over the others.
pub(crate) struct Spared {
    /// Mean square of the whitened residuals over the spared windows: of the calibrated baseline and of the final model.
    baseline: f64,
    model: f64,
    /// The same of the final model over the windows of the fits.
    fitted: f64,
    /// How many windows are spared, and how many there are in all.
    windows: [usize; 2],
}

impl Spared {
    /// Over the windows of `others`, which are spared by `problem`: for the baseline at `baseline` and for `effects` at `values`.
    ///
    /// # Errors
    /// [`CompareError`] where the model has no answer at the baseline.
    pub fn new(
        others: &mut Problem,
        problem: &Problem,
        noise: &Noise,
        baseline: &[f64],
        (effects, values): (&[String], &[f64]),
    ) -> Result<Self, CompareError> {
        (0..noise.refined).for_each(|_| _ = others.refine_step());
        // Parameters without influence are no longer free.
        others.library.clone_from(&problem.library);
        let mean_square = |problem: &Problem, effects: &[String], values: &[f64]| {
            let task = Task { prior_factor: NO_PRIORS, ..problem.task(effects, vec![values.to_vec()]) };
            let (chi_squares, freedom) = costs(problem, noise, &task).ok_or(CompareError::NoFit)?;
            Ok::<f64, CompareError>(chi_squares[0] / freedom.max(1.0))
        };
        let count = |problem: &Problem| {
            let runs = (0..problem.windows.len()).filter(|run| !problem.layout.is_left_out(*run));
            // The start of a run is no window that counts.
            let counting =
                |run: usize| problem.windows[run].iter().filter(move |cut| cut.rows.end > problem.layout.starts[run]);
            runs.map(|run| counting(run).count()).sum::<usize>()
        };
        others.refine_starts(noise, (&[], baseline))?;
        let of_baseline = mean_square(others, &[], baseline)?;
        begin_as_in_fits(others, noise)?;
        Ok(Self {
            baseline: of_baseline,
            model: mean_square(others, effects, values)?,
            fitted: mean_square(problem, effects, values)?,
            windows: [count(others), count(others) + count(problem)],
        })
    }

    /// Limits a verdict: a name has to predict better than the baseline where no fit has looked, and what is told of the fits has to hold
    /// there.
    pub fn limit(&self, judgement: &mut Judgement, has_effects: bool) {
        judgement.cautions.push(self.words(has_effects));
        // An infinite misfit is no better either.
        let better = self.model < self.baseline;
        if judgement.names() && !better {
            judgement.open(
                "over the windows that took no part in the fits the final model is no better than the baseline"
                    .to_owned(),
            );
        }
        let settled = judgement.names() || judgement.verdict == Verdict::Explained;
        let alike = self.model <= ODD * self.fitted.max(1.0);
        if settled && !alike {
            judgement.open(
                "the windows that took no part in the fits differ from those that did: what is missing there is not known; let more \
                 windows take part"
                    .to_owned(),
            );
        }
        judgement.cautions.extend(self.hint(&judgement.tied));
    }

    /// Where a tie stays, the rest of the drive may tell more.
    fn hint(&self, tied: &[String]) -> Option<String> {
        let [spared, all] = self.windows;
        (tied.len() > 1).then(|| {
            let more = all.min(2 * (all - spared));
            format!("more windows may decide between {}: let {more} take part (option `windows`)", tied.join(", "))
        })
    }

    /// What a reader is told.
    fn words(&self, has_effects: bool) -> String {
        let [spared, all] = self.windows;
        let (baseline, model, fitted) = (self.baseline.sqrt(), self.model.sqrt(), self.fitted.sqrt());
        let misfit = if has_effects {
            format!(
                "the baseline misses them by {baseline:.2} times the noise, the final model by {model:.2} times, and the windows of the \
                 fits by {fitted:.2} times"
            )
        } else {
            format!(
                "the baseline misses them by {baseline:.2} times the noise, and the windows of the fits by {fitted:.2} times"
            )
        };
        format!("{spared} of the {all} windows of this long drive took no part in the fits, evenly spread: {misfit}")
    }
}

/// Finds the starts of the spared windows as those of the fits were found where that was under a model with effects. Where it has no answer
/// there, the starts stay.
fn begin_as_in_fits(others: &mut Problem, noise: &Noise) -> Result<(), PredictionError> {
    if noise.around_effects.is_empty() {
        return Ok(());
    }
    match others.refine_starts(noise, (&noise.around_effects, &noise.around)) {
        Err(PredictionError::Interrupted) => Err(PredictionError::Interrupted),
        _ => Ok(()),
    }
}

/// Lets the windows that took no part judge what was found. After a stop nothing is said of them.
///
/// # Errors
/// [`CompareError`] where the model has no answer at the baseline.
pub(super) fn judge_by_spared(
    judgement: &mut Judgement,
    others: &mut Problem,
    (problem, noise): (&Problem, &Noise),
    baseline: &[f64],
    found: (&[String], &[f64]),
) -> Result<(), CompareError> {
    match Spared::new(others, problem, noise, baseline, found) {
        Ok(spared) => spared.limit(judgement, !found.0.is_empty()),
        Err(CompareError::Prediction(PredictionError::Interrupted)) => {}
        Err(error) => return Err(error),
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
mod tests {
    use super::*;

    fn judged(verdict: Verdict, spared: &Spared) -> Verdict {
        let (effects, tied, rivals) = (vec!["drag".to_owned()], Vec::new(), Vec::new());
        let mut judgement = Judgement { verdict, effects, tied, rivals, beside: Vec::new(), cautions: Vec::new() };
        spared.limit(&mut judgement, true);
        judgement.verdict
    }

    #[test]
    fn property_windows_of_no_fit_open_what_they_contradict() {
        let spared = |baseline, model| Spared { baseline, model, fitted: 1.1, windows: [10, 30] };
        for verdict in [Verdict::Explained, Verdict::EffectMissing] {
            assert_eq!(judged(verdict, &spared(2.0, 1.2)), verdict, "better there, and as good as in the fits");
            assert_eq!(judged(verdict, &spared(9.0, 3.4)), Verdict::Undetermined, "much is missing there");
            assert_eq!(judged(verdict, &spared(9.0, f64::INFINITY)), Verdict::Undetermined);
        }
        assert_eq!(judged(Verdict::EffectMissing, &spared(1.2, 1.2)), Verdict::Undetermined, "no better there");
        assert_eq!(judged(Verdict::Explained, &spared(1.2, 1.2)), Verdict::Explained);
        assert_eq!(judged(Verdict::Unexplained, &spared(9.0, 9.0)), Verdict::Unexplained);
    }

    #[test]
    fn property_a_tie_is_told_how_many_windows_may_decide() {
        let spared = |windows| Spared { baseline: 2.0, model: 1.0, fitted: 1.0, windows };
        let tied = ["drag".to_owned(), "payload".to_owned()];
        assert!(spared([344, 400]).hint(&tied).unwrap().contains("let 112 take part"));
        assert!(spared([44, 100]).hint(&tied).unwrap().contains("let 100 take part"));
        assert_eq!(spared([44, 100]).hint(&tied[..1]), None);
    }
}
