//! Fits of effect sets: self-contained tasks, so that they can be spread over threads or machines.

use super::engine::DiagnoseOptions;
use super::far;
use crate::diagnosis::calibrate::{Calibration, calibrate, calibrate_from, settled};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::effort::Effort;
use crate::diagnosis::given::Given;
use crate::diagnosis::information::Information;
use crate::diagnosis::least_squares::Pace;
use crate::diagnosis::noise::{NoiseModel, Scale, Whitening};
use crate::diagnosis::prediction::Predict;
use crate::diagnosis::prior_rows::PriorRows;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::weighted::Weighted;
use crate::diagnosis::windows::Window;
use crate::measurement::Experiment;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Noise as a diagnosis uses it: one model a signal, and the size of a whitened residual from which it counts as bad.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// Noise model of each signal.
    pub models: BTreeMap<String, NoiseModel>,
    /// Threshold of Huber's loss, in standard deviations; `None` for plain least squares.
    pub robust: Option<f64>,
    /// Windows of each run with the starts that were found; none where runs are replayed as a whole.
    #[serde(default)]
    pub windows: Vec<Vec<Window>>,
    /// Effects beside the baseline with which the windows' starts were found.
    #[serde(default)]
    pub around_effects: Vec<String>,
    /// Their parameters that are free.
    #[serde(default)]
    pub around_parameters: Vec<String>,
    /// Values of all free parameters around which the windows' starts were found and are free.
    #[serde(default)]
    pub around: Vec<f64>,
    /// How often the inner step was refined, since it showed beside the noise.
    #[serde(default)]
    pub refined: usize,
    /// Runs and rows that no fit counts, since they are odd.
    #[serde(default)]
    pub odd: Vec<(usize, usize)>,
    /// Size of the noise of each value, relative to that of a usual one; none where all have the same.
    #[serde(default)]
    pub scale: Vec<Scale>,
}

impl Noise {
    /// Of so large noise, over runs that are not cut into windows.
    #[must_use]
    pub fn new(models: BTreeMap<String, NoiseModel>) -> Self {
        Self {
            models,
            robust: None,
            windows: Vec::new(),
            around_effects: Vec::new(),
            around_parameters: Vec::new(),
            around: Vec::new(),
            refined: 0,
            odd: Vec::new(),
            scale: Vec::new(),
        }
    }

    pub(crate) fn whitening(&self, problem: &Problem, keep: &dyn Fn(usize, usize) -> bool) -> Option<Whitening> {
        Whitening::new(&problem.layout, &self.models, keep)
    }

    /// Keeps the windows of a problem, whose starts were found with `effects` at `values`.
    pub(super) fn begin_at(&mut self, problem: &Problem, (effects, values): (&[String], &[f64])) {
        self.windows.clone_from(&problem.windows);
        self.around_effects = effects.to_vec();
        let own = problem.free(effects).into_iter().skip(problem.base.len());
        self.around_parameters = own.map(|free| free.variable.name).collect();
        self.around = values.to_vec();
    }

    pub(crate) fn deviations(&self) -> BTreeMap<String, f64> {
        self.models.iter().map(|(signal, noise)| (signal.clone(), noise.deviation)).collect()
    }
}

/// A fit to be made: the baseline's free parameters and those of `effects`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// Effects added to the baseline.
    pub effects: Vec<String>,
    /// Their parameters that are free; those without influence in this experiment stay neutral.
    pub parameters: Vec<String>,
    /// Values of all free parameters to start from; where there are none, seeded draws are used.
    pub starts: Vec<Vec<f64>>,
    /// For a first look, a few steps from each start: how many seeded draws are searched from besides.
    pub scouting: Option<usize>,
    /// Whether rovers are led at the measured velocity, so that they do not get stuck: for a first look.
    pub guided: bool,
    /// Runs and rows that are left out.
    pub left_out: Vec<(usize, usize)>,
    /// Runs and rows that no fit of the diagnosis counts, since its calibrated baseline has no answer there.
    #[serde(default)]
    pub unanswered: Vec<(usize, usize)>,
    /// Factor on the standard deviations of all priors of the model: 1, or large to see what the data say by themselves.
    pub prior_factor: f64,
}

/// What a fit gave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Values of the free parameters.
    pub values: Vec<f64>,
    /// Sum of squared whitened residuals.
    pub chi_square: f64,
}

/// Runs a task; `None` where no start leads to a fit that answers every row that counts. Where rows are left out of the fit,
/// it need not answer them.
pub(crate) fn run(problem: &Problem, noise: &Noise, task: &Task) -> Option<Calibration> {
    run_for(problem, noise, task, task.left_out.is_empty())
}

/// The same where the fit need not answer every row; those without an answer count as missed.
pub(crate) fn run_open(problem: &Problem, noise: &Noise, task: &Task) -> Option<Calibration> {
    run_for(problem, noise, task, false)
}

fn run_for(problem: &Problem, noise: &Noise, task: &Task, whole: bool) -> Option<Calibration> {
    if let Some(rough) = far::rough(problem, noise, task) {
        let near = Task { starts: vec![rough.values()], ..task.clone() };
        let fit = run_over(problem, noise, &near, whole)?;
        return Some(Calibration { searches: rough.searches, agreeing: rough.agreeing, ..fit });
    }
    let faint = far::faint_start(problem, noise, task);
    run_over(problem, noise, faint.as_ref().unwrap_or(task), whole)
}

/// Runs a task from its starts as they are.
pub(super) fn run_over(problem: &Problem, noise: &Noise, task: &Task, whole: bool) -> Option<Calibration> {
    search_over(problem, noise, task, whole, problem.strategy().budget().calibration)
}

/// The same over a part of the measurements, to a place from which a search over all of them begins.
pub(super) fn run_roughly(part: &Problem, noise: &Noise, task: &Task) -> Option<Calibration> {
    search_over(part, noise, task, false, part.strategy().budget().calibration.roughly())
}

fn search_over(problem: &Problem, noise: &Noise, task: &Task, whole: bool, effort: Effort) -> Option<Calibration> {
    with_problem(problem, noise, task, whole, |weighted, weights| {
        if task.starts.is_empty() {
            calibrate(weighted, weights, effort)
        } else {
            let effort = task.scouting.map_or(effort.without_draws(), Effort::scouting);
            let effort = if task.guided { Effort { pace: Pace::MEDIUM, ..effort } } else { effort };
            calibrate_from(weighted, weights, &task.starts, effort)
        }
    })
}

/// Factor of the priors' deviations with which they say next to nothing.
pub(super) const NO_PRIORS: f64 = 1e3;

/// Calls `f` with the weighted least-squares problem of a task.
pub(super) fn with_problem<R>(
    problem: &Problem,
    noise: &Noise,
    task: &Task,
    whole: bool,
    f: impl FnOnce(&Weighted, &BTreeMap<String, f64>) -> Option<R>,
) -> Option<R> {
    let mut free = problem.free(&task.effects);
    let of_base = |name: &str| problem.base.iter().any(|free| free.variable.name == name);
    free.retain(|free| of_base(&free.variable.name) || task.parameters.contains(&free.variable.name));
    let of_model = free.iter_mut().filter(|free| !free.is_of_a_sensor());
    for prior in of_model.filter_map(|free| free.prior.as_mut()) {
        prior.deviation *= task.prior_factor;
    }
    let priors = &PriorRows::new(&free, problem.joint.as_ref(), task.prior_factor, None);
    let mut left_out = task.left_out.clone();
    left_out.sort_unstable();
    let whitening = noise.whitening(problem, &|run, row| left_out.binary_search(&(run, row)).is_err())?;
    let robust = noise.robust.unwrap_or(f64::INFINITY);
    let mut posed = Cow::Borrowed(problem);
    if task.guided {
        posed.to_mut().guided = true;
    }
    let fit = |predict: &dyn Predict| {
        f(
            &Weighted { predict, layout: &problem.layout, free: &free, whitening: &whitening, priors, robust, whole },
            &noise.deviations(),
        )
    };
    posed.predict(&free, fit).ok()?
}

/// What the measurements tell of the parameters of a calibrated baseline, and what was known before. `None` where the model gives nothing
/// there.
pub(crate) fn information(problem: &Problem, noise: &Noise, fit: &Calibration) -> Option<Information> {
    let values = fit.values();
    let task = problem.task(&[], vec![values.clone()]);
    let scatter = (fit.chi_square / fit.degrees_of_freedom.max(1) as f64).max(1.0);
    with_problem(problem, noise, &task, false, |weighted, _| {
        let linear = weighted.linear(&weighted.coordinates(&values));
        let columns = linear.columns(1, values.len());
        if columns.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let measured = weighted.whitening.len();
        let of = |from: usize, count: usize| columns.rows(from, count).tr_mul(&columns.rows(from, count));
        let known = of(measured, columns.nrows() - measured);
        Some(Information { measured: of(0, measured) / scatter, known, widths: Information::widths(problem) })
    })
}

/// Makes one fit of a diagnosis, for a [`Spread`](super::Spread) on other machines: with the same model, experiment and
/// options it gives the same bits as the diagnosis would by itself. `None` where no start has an answer.
///
/// # Errors
/// [`CompareError`] where the experiment does not fit the model.
pub fn fit_task(
    given: impl Into<Given>,
    experiment: &Experiment,
    options: &DiagnoseOptions,
    noise: &Noise,
    task: &Task,
) -> Result<Option<Outcome>, CompareError> {
    let mut problem = options.problem(given, experiment)?;
    problem.layout.leave_out(&task.unanswered);
    problem.layout.unsettle(noise.odd.iter().copied());
    problem.layout.scale.clone_from(&noise.scale);
    (0..noise.refined).for_each(|_| _ = problem.refine_step());
    if problem.is_cut() && !noise.windows.is_empty() {
        for candidate in problem.library.iter_mut().filter(|candidate| noise.around_effects.contains(&candidate.id)) {
            candidate.free.retain(|free| noise.around_parameters.contains(&free.variable.name));
        }
        problem.begin_windows(noise.windows.clone(), (&noise.around_effects, &noise.around))?;
    }
    Ok(outcome(&problem, noise, task))
}

/// Runs a task for its values and cost alone.
pub(crate) fn outcome(problem: &Problem, noise: &Noise, task: &Task) -> Option<Outcome> {
    if task.scouting.is_some() && problem.is_cut() {
        return far::look(problem, noise, task);
    }
    let fit = run(problem, noise, task)?;
    Some(Outcome { values: fit.values(), chi_square: fit.chi_square })
}

/// What is known at given values without a search: cost, standard errors, which parameters sit on bounds.
pub(crate) fn settle(problem: &Problem, noise: &Noise, task: &Task) -> Option<Calibration> {
    with_problem(problem, noise, task, task.left_out.is_empty(), |weighted, weights| {
        settled(weighted, weights, task.starts.first()?, problem.strategy().budget().calibration.pace)
    })
}
