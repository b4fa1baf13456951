//! The course of a diagnosis: noise, baseline, is it more than noise, candidates, choice, verdict, next experiment.

use super::choose::choose;
use super::control::Control;
use super::drive::{WholeDrive, whole_drive};
use super::evidence::Evidence;
use super::finished::Finished;
use super::judge::{Judged, judge};
use super::moved::MovedStarts;
use super::odd::odd;
use super::prepare::{Prepared, prepare, prepare_again, prepare_under};
use super::result::Diagnosis;
use super::search::{Search, sorted};
use super::spared::{WINDOWS, judge_by_spared};
use super::stage::{Stage, StageContext};
use super::untried::{Untried, lines, named};
use super::verdict::Judgement;
use super::watch::{Phase, Watch};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::given::Given;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::MAY_BE_UNANSWERED;
use crate::diagnosis::unanswered::UnansweredRows;
use crate::measurement::Experiment;

/// How to diagnose.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagnoseOptions {
    /// Candidate effects; `None` for all that the model has.
    pub candidates: Option<Vec<String>>,
    /// Effects that are part of the baseline, with free parameters.
    pub added: Vec<String>,
    /// Most effects that are added.
    pub max_effects: usize,
    /// Bootstrap draws; p-values are not below 1/(draws + 1), so that fewer than 100 can never name an effect.
    pub draws: usize,
    /// Different windows of a drive that take part in the fits, evenly spread; the others judge the final model.
    pub windows: usize,
}

impl Default for DiagnoseOptions {
    fn default() -> Self {
        Self { candidates: None, added: Vec::new(), max_effects: 3, draws: 399, windows: WINDOWS }
    }
}

impl DiagnoseOptions {
    /// What is diagnosed, with the candidates that are asked for.
    pub(crate) fn problem<'a>(
        &self,
        given: impl Into<Given>,
        experiment: &'a Experiment,
    ) -> Result<Problem<'a>, CompareError> {
        Ok(self.problems(given, experiment)?.0)
    }

    /// The same, and the same problem over the windows that take no part in the fits.
    fn problems<'a>(
        &self,
        given: impl Into<Given>,
        experiment: &'a Experiment,
    ) -> Result<(Problem<'a>, Option<Problem<'a>>), CompareError> {
        let mut problem = Problem::new(given, experiment, &self.added)?;
        if let Some(candidates) = &self.candidates {
            problem.keep_candidates(candidates)?;
        }
        problem.coarsen();
        problem.cut();
        let others = problem.spare(self.windows);
        Ok((problem, others))
    }
}

/// Compares the model with an experiment and looks for the effect that is missing.
///
/// Where values come from is said at [`Given`]; a plain model is one that is named. An effect that the model has switched on
/// is part of the baseline, held at its value.
///
/// Without a budget of time the result depends neither on the number of threads nor on the clock. Once `control.stop` says
/// yes, the work in hand is cut short and what is known by then is returned, marked as interrupted. What was not tried for
/// that reason, or because `control.budget` had no time for it, is listed in [`Diagnosis::not_tried`].
///
/// # Errors
/// [`CompareError`] where the experiment does not fit the model, or the model cannot compute it;
/// [`CompareError::Interrupted`] where there was a stop before the baseline and its noise were known.
pub fn diagnose(
    given: impl Into<Given>,
    experiment: &Experiment,
    options: &DiagnoseOptions,
    control: &Control,
) -> Result<Diagnosis, CompareError> {
    let (mut problem, others) = options.problems(given, experiment)?;
    let watch = Watch::new(control, problem.strategy());
    problem.halt = watch.halt();
    let nothing_yet = |error: CompareError| if watch.stopped() { CompareError::Interrupted } else { error };

    // The noise, and the baseline calibrated under it.
    watch.begin(Phase::Baseline, &problem.names_of_base());
    let mut prepared = prepare(&mut problem).map_err(nothing_yet)?;
    // What is wrong in a few places only is left out, and said.
    if let Some(found) = odd(&problem, &prepared).map_err(nothing_yet)? {
        problem.layout.unsettle(found.rows.iter().copied());
        prepared = prepare_again(&mut problem, &prepared).map_err(nothing_yet)?;
        prepared.noise.odd = found.rows;
        prepared.cautions.extend(found.words);
    }
    let course =
        Course { problem: &problem, others: others.as_ref(), prepared: &prepared, options, control, watch: &watch };
    course.run(None)
}

/// The course of a diagnosis once noise and baseline are known.
struct Course<'a> {
    problem: &'a Problem<'a>,
    /// The same over the windows that take no part in the fits.
    others: Option<&'a Problem<'a>>,
    prepared: &'a Prepared,
    options: &'a DiagnoseOptions,
    control: &'a Control<'a>,
    watch: &'a Watch<'a>,
}

impl Course<'_> {
    /// From the baseline to the verdict. `moved` is there in the second search: the effects under which the starts of the windows were found, and
    /// what the first search had fitted.
    fn run(&self, moved: Option<MovedStarts>) -> Result<Diagnosis, CompareError> {
        let Self { problem, prepared, options, watch, .. } = self;
        let whitening = prepared.noise.whitening(problem, &|_, _| true).ok_or(CompareError::NoFit)?;
        let context = StageContext::new(problem, prepared, &whitening, options.draws);
        let mut search = Search::new(context, prepared.baseline.clone(), self.control, watch);
        let under = moved.as_ref().map(|moved| moved.effects.clone());
        let stage = self.candidates(&mut search, moved)?;

        // The choice: the effects that gain more than noise alone.
        watch.begin(Phase::Sets, "");
        let chosen = choose(&mut search, &stage, options)?;
        if under.is_none()
            && let Some(moved) = search.moved_starts(&stage, &chosen)
        {
            match self.over(moved)? {
                Some(diagnosis) => return Ok(diagnosis),
                None => watch.leave([Untried::Again(chosen.clone())]),
            }
        }

        // The verdict: what left-out data, rivals and doubts say, limited by what is not known.
        watch.begin(Phase::LeftOut, "");
        let mut evidence = Evidence::new(&search, &chosen);
        watch.begin(Phase::Rivals, "");
        let Judged { mut judgement, chosen } = judge(&mut search, &stage, prepared, &mut evidence, chosen)?;
        limit(&mut judgement, &search, &stage, prepared);
        judgement.cautions.extend(under.and_then(|under| starts_of_another_set(&under, &chosen)));
        let values = search.fits.get(&chosen).unwrap_or(&prepared.baseline).values();
        let whole = whole_drive(problem, &prepared.noise, &chosen, &values)?;
        if let Some(whole) = &whole {
            last_check(&mut judgement, whole, &problem.experiment);
        }
        if let Some(mut others) = self.others.cloned() {
            let found = (chosen.as_slice(), values.as_slice());
            others.halt = watch.halt();
            judge_by_spared(
                &mut judgement,
                &mut others,
                (problem, &prepared.noise),
                &prepared.baseline.values(),
                found,
            )?;
        }
        if let Some(words) = search.beside(&stage, &mut judgement)? {
            // Among the first, which a page shows unfolded.
            judgement.cautions.insert(0, words);
        }
        let finished = Finished { search: &search, stage: &stage, prepared, evidence: &evidence };
        let mut diagnosis = finished.diagnosis(&judgement, &chosen, options)?;
        diagnosis.whole_drive = whole;

        // The next experiment.
        watch.begin(Phase::Next, "");
        diagnosis.suggestions = finished.next_experiment(&judgement, &chosen, &diagnosis.failures_left);
        diagnosis.interrupted = watch.stopped();
        diagnosis.not_tried = lines(&watch.untried());
        watch.begin(Phase::Done, "");
        Ok(diagnosis)
    }

    /// The same once more, over windows that begin where the chosen effects bring them nearest to the measurements. `None` where the baseline
    /// has no answer from there, and after a stop: the first search has come further then.
    fn over(&self, moved: MovedStarts) -> Result<Option<Diagnosis>, CompareError> {
        let mut problem = self.problem.clone();
        let Ok(prepared) = prepare_under(&mut problem, self.prepared, &moved) else { return Ok(None) };
        match (Course { problem: &problem, prepared: &prepared, ..*self }).run(Some(moved)) {
            Err(CompareError::Interrupted) => Ok(None),
            diagnosis => Ok(Some(diagnosis?).filter(|diagnosis| !diagnosis.interrupted)),
        }
    }

    /// Fits the candidates; returns what the baseline leaves.
    fn candidates(&self, search: &mut Search, moved: Option<MovedStarts>) -> Result<Stage, CompareError> {
        let (watch, first) = (self.watch, moved.is_none());
        // Is what the baseline misses more than noise? What noise alone would give around it.
        match moved {
            Some(moved) => search.go_on_from(moved.fitted),
            None => watch.begin(Phase::Noise, ""),
        }
        let nothing_yet = |error: CompareError| if watch.stopped() { CompareError::Interrupted } else { error };
        let stage = search.stage(&[])?.ok_or(CompareError::NoFit).map_err(nothing_yet)?;

        // Each refitted together with the calibration.
        if first {
            watch.begin(Phase::Singles, "");
        }
        Ok(search.candidates(stage)?)
    }
}

/// A caution where the starts of the windows were found under another set of effects than the final one.
fn starts_of_another_set(under: &[String], chosen: &[String]) -> Option<String> {
    (sorted(under) != sorted(chosen)).then(|| {
        format!(
            "the starts of the windows were found with {}, not with what is in the final model ({}), whose error may be a little larger \
             for that",
            named(under),
            named(chosen)
        )
    })
}

/// What is not known limits a verdict: a noise, answers of the model, and work that was not done.
fn limit(judgement: &mut Judgement, search: &Search, stage: &Stage, prepared: &Prepared) {
    if !prepared.noise_is_known {
        judgement.undecided();
    }
    judgement.with_unanswered(share_unanswered(&search.problem.experiment, prepared));
    if search.watch.stopped() && judgement.names() {
        judgement.open("interrupted: not all that may speak against the name was looked for".to_owned());
    }
    incomplete(judgement, &search.watch.untried(), stage.draws.len(), search.context.draws);
}

/// A named model has to drive the whole log, as the measured rover did.
fn last_check(judgement: &mut Judgement, whole: &WholeDrive, experiment: &Experiment) {
    judgement.cautions.extend(whole.starts.clone());
    let Some(first) = whole.unanswered.first() else { return };
    let words = format!("over the whole drive, not cut into windows, the final model fails: {first}");
    if judgement.names() && whole.share_missed(experiment) > MAY_BE_UNANSWERED {
        judgement.open(words);
    } else {
        judgement.cautions.push(words);
    }
}

/// Share of an experiment's rows that the calibrated baseline cannot answer.
fn share_unanswered(experiment: &Experiment, prepared: &Prepared) -> f64 {
    let all: usize = experiment.runs.iter().map(|run| run.data.rows()).sum();
    let without: usize = prepared.unanswered.iter().map(UnansweredRows::count).sum();
    without as f64 / all.max(1) as f64
}

/// What was not tried limits the verdict: nothing is named while an effect that could stand in its place is untried, and
/// unless all effects were tried, neither `explained` nor `unexplained` can be concluded.
fn incomplete(judgement: &mut Judgement, untried: &[Untried], draws: usize, asked: usize) {
    if draws < asked {
        judgement.open(format!("interrupted: p-values rest on {draws} of {asked} bootstrap draws"));
    }
    let named = judgement.effects.clone();
    let names_them = judgement.names();
    let rivals = |set: &[String]| {
        !names_them || (set.len() == named.len() && set.iter().filter(|id| !named.contains(id)).count() == 1)
    };
    if untried.iter().filter_map(Untried::unknown).any(rivals) {
        judgement.open("some effects were not tried: the verdict is open".to_owned());
    }
}
