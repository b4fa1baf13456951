//! Fits of effect sets: self-contained tasks, so that they can be spread over threads or machines.

use super::engine::DiagnoseOptions;
use crate::diagnosis::calibrate::{Calibration, calibrate, calibrate_from, settled};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::effort::Effort;
use crate::diagnosis::given::Given;
use crate::diagnosis::least_squares::Pace;
use crate::diagnosis::noise::{NoiseModel, Whitening};
use crate::diagnosis::prediction::Predict;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::FAR;
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
    /// Values of the baseline's parameters around which the windows' starts are free.
    #[serde(default)]
    pub around: Vec<f64>,
    /// How often the inner step was refined, since it showed beside the noise.
    #[serde(default)]
    pub refined: usize,
}

impl Noise {
    /// Of so large noise, over runs that are not cut into windows.
    #[must_use]
    pub fn new(models: BTreeMap<String, NoiseModel>) -> Self {
        Self { models, robust: None, windows: Vec::new(), around: Vec::new(), refined: 0 }
    }

    pub(crate) fn whitening(&self, problem: &Problem, keep: &dyn Fn(usize, usize) -> bool) -> Option<Whitening> {
        Whitening::new(&problem.layout, &self.models, keep)
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
    /// Factor on the standard deviations of all priors: 1, or large to see what the data say by themselves.
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
    // From far away the way is found over a few windows; a fit that starts near its end needs none.
    let thin = task.left_out.is_empty().then(|| problem.thinned()).flatten();
    let rough = thin.and_then(|thin| way(&thin, noise, task));
    match rough {
        Some(rough) => {
            let near = Task { starts: vec![rough.values()], ..task.clone() };
            let fit = run_over(problem, noise, &near, whole)?;
            Some(Calibration { searches: rough.searches, agreeing: rough.agreeing, ..fit })
        }
        None => match faint_start(problem, noise, task) {
            Some(faint) => run_over(problem, noise, &faint, whole),
            None => run_over(problem, noise, task, whole),
        },
    }
}

/// The end of a search over few windows; `None` where it begins near the measurements and needs no such way. Effects that lead
/// nowhere from their start, with more misfit than next to nothing of them leaves, begin once more from there.
fn way(thin: &Problem, noise: &Noise, task: &Task) -> Option<Calibration> {
    if task.starts.is_empty() {
        return run_over(thin, noise, task, false);
    }
    let (chi_squares, freedom) = costs(thin, noise, task)?;
    if chi_squares.iter().any(|chi_square| *chi_square <= FAR * freedom) {
        return None;
    }
    let found = run_over(thin, noise, task, false);
    if task.effects.is_empty() {
        return found;
    }
    let weak = Task { starts: task.starts.iter().map(|start| weakened(thin, task, start)).collect(), ..task.clone() };
    let least = costs(thin, noise, &weak)?.0.into_iter().fold(f64::INFINITY, f64::min);
    let leads = found.as_ref().is_some_and(|found| found.chi_square <= least);
    if leads { found } else { run_over(thin, noise, &weak, false) }
}

/// The same task from next to nothing of its effects, where that leaves less misfit than all of its starts, which are far from the
/// measurements: sensitivities had promised more than the effect keeps. `None` where the starts serve, and where searches are cheap.
fn faint_start(problem: &Problem, noise: &Noise, task: &Task) -> Option<Task> {
    let dear = problem.strategy().budget().calibration.pace.gauss_newton;
    if !dear || task.effects.is_empty() || task.starts.is_empty() || !task.left_out.is_empty() {
        return None;
    }
    let least = |chi_squares: &[f64]| chi_squares.iter().copied().fold(f64::INFINITY, f64::min);
    let (chi_squares, freedom) = costs(problem, noise, task)?;
    if least(&chi_squares) <= FAR * freedom {
        return None;
    }
    let faint = task.starts.iter().map(|start| weakened(problem, task, start)).collect();
    let faint = Task { starts: faint, ..task.clone() };
    (least(&costs(problem, noise, &faint)?.0) < least(&chi_squares)).then_some(faint)
}

/// A start with next to nothing of its effects.
fn weakened(problem: &Problem, task: &Task, start: &[f64]) -> Vec<f64> {
    let own = problem.free(&task.effects).into_iter().skip(problem.base.len());
    let own = own.filter(|free| task.parameters.contains(&free.variable.name));
    start[..problem.base.len()].iter().copied().chain(own.map(|free| free.nearly_neutral())).collect()
}

/// Chi-square at each start of a task, infinite where the model has no answer, and the degrees of freedom.
fn costs(problem: &Problem, noise: &Noise, task: &Task) -> Option<(Vec<f64>, f64)> {
    with_problem(problem, noise, task, false, |weighted, _| {
        let square = |start: &Vec<f64>| weighted.residual(&weighted.coordinates(start)).iter().map(|r| r * r).sum();
        let freedom = weighted.freedom().saturating_sub(weighted.free.len());
        Some((task.starts.iter().map(square).collect(), freedom as f64))
    })
}

fn run_over(problem: &Problem, noise: &Noise, task: &Task, whole: bool) -> Option<Calibration> {
    let effort = problem.strategy().budget().calibration;
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

/// Calls `f` with the weighted least-squares problem of a task.
fn with_problem<R>(
    problem: &Problem,
    noise: &Noise,
    task: &Task,
    whole: bool,
    f: impl FnOnce(&Weighted, &BTreeMap<String, f64>) -> Option<R>,
) -> Option<R> {
    let mut free = problem.free(&task.effects);
    let of_base = |name: &str| problem.base.iter().any(|free| free.variable.name == name);
    free.retain(|free| of_base(&free.variable.name) || task.parameters.contains(&free.variable.name));
    for prior in free.iter_mut().filter_map(|free| free.prior.as_mut()) {
        prior.deviation *= task.prior_factor;
    }
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
            &Weighted { predict, layout: &problem.layout, free: &free, whitening: &whitening, robust, whole },
            &noise.deviations(),
        )
    };
    posed.predict(&free, fit).ok()?
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
    (0..noise.refined).for_each(|_| _ = problem.refine_step());
    if problem.is_cut() && !noise.windows.is_empty() {
        problem.begin_windows(noise.windows.clone(), &noise.around)?;
    }
    Ok(outcome(&problem, noise, task))
}

/// Runs a task for its values and cost alone.
pub(crate) fn outcome(problem: &Problem, noise: &Noise, task: &Task) -> Option<Outcome> {
    if task.scouting.is_some()
        && let Some(thin) = problem.thinned()
    {
        return look(problem, &thin, noise, task);
    }
    let fit = run(problem, noise, task)?;
    Some(Outcome { values: fit.values(), chi_square: fit.chi_square })
}

/// A first look is made over a few windows, and only its end is seen over all.
fn look(problem: &Problem, thin: &Problem, noise: &Noise, task: &Task) -> Option<Outcome> {
    let values = run_over(thin, noise, task, false)?.values();
    let there = Task { starts: vec![values.clone()], ..task.clone() };
    let chi_square = costs(problem, noise, &there)?.0[0];
    chi_square.is_finite().then_some(Outcome { values, chi_square })
}

/// What is known at given values without a search: cost, standard errors, which parameters sit on bounds.
pub(crate) fn settle(problem: &Problem, noise: &Noise, task: &Task) -> Option<Calibration> {
    with_problem(problem, noise, task, task.left_out.is_empty(), |weighted, weights| {
        settled(weighted, weights, task.starts.first()?, problem.strategy().budget().calibration.pace)
    })
}
