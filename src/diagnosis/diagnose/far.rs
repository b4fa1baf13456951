//! How a fit that begins far from the measurements finds its way.
//!
//! The baseline has bent its soil to stand in for what it lacks: from there a search often ends in a soil in which the rover gets
//! stuck. So a search begins in two ways over a few windows, and the best end is where the fit over all windows begins:
//! from its starts as they are, and from next to nothing of its effects.

use super::fits::{Noise, Outcome, Task, run_roughly, with_problem};
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::least_squares::Pace;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::FAR;

/// Where a search over a few windows ends; `None` where the experiment has few, or where the task begins near the measurements.
pub(super) fn rough(problem: &Problem, noise: &Noise, task: &Task) -> Option<Calibration> {
    if !task.left_out.is_empty() {
        return None;
    }
    let thin = problem.thinned()?;
    if !task.starts.is_empty() && !is_far(&thin, noise, task)? {
        return None;
    }
    best_way(&thin, noise, task)
}

/// A first look is made over a few windows where there are many, and only its end is seen over all; `None` where nothing is found.
pub(super) fn look(problem: &Problem, noise: &Noise, task: &Task) -> Option<Outcome> {
    let thinned = problem.thinned();
    let thin = thinned.as_ref().unwrap_or(problem);
    let found = if is_far(thin, noise, task)? { best_way(thin, noise, task)? } else { run_roughly(thin, noise, task)? };
    let there = Task { starts: vec![found.values()], ..task.clone() };
    let chi_square = costs(problem, noise, &there)?.0[0];
    chi_square.is_finite().then(|| Outcome { values: found.values(), chi_square })
}

/// The end with the least misfit.
fn best_way(thin: &Problem, noise: &Noise, task: &Task) -> Option<Calibration> {
    let mut ends = vec![run_roughly(thin, noise, task)];
    if !task.effects.is_empty() && !task.starts.is_empty() {
        ends.push(run_roughly(thin, noise, &weakened(thin, task)));
    }
    ends.into_iter().flatten().min_by(|a, b| a.chi_square.total_cmp(&b.chi_square))
}

/// The same task from next to nothing of its effects, where that leaves less misfit than all of its starts, which are far from the
/// measurements: sensitivities had promised more than the effect keeps. `None` where the starts serve, and where searches are cheap.
pub(super) fn faint_start(problem: &Problem, noise: &Noise, task: &Task) -> Option<Task> {
    let dear = problem.strategy().budget().calibration.pace == Pace::BRISK;
    if !dear || task.effects.is_empty() || task.starts.is_empty() || !task.left_out.is_empty() {
        return None;
    }
    let least = |chi_squares: &[f64]| chi_squares.iter().copied().fold(f64::INFINITY, f64::min);
    let (chi_squares, freedom) = costs(problem, noise, task)?;
    if least(&chi_squares) <= FAR * freedom {
        return None;
    }
    let faint = weakened(problem, task);
    (least(&costs(problem, noise, &faint)?.0) < least(&chi_squares)).then_some(faint)
}

/// The task from starts with next to nothing of its effects.
pub(super) fn weakened(problem: &Problem, task: &Task) -> Task {
    let faint = |start: &Vec<f64>| {
        let own = problem.free(&task.effects).into_iter().skip(problem.base.len());
        let own = own.filter(|free| task.parameters.contains(&free.variable.name));
        start[..problem.base.len()].iter().copied().chain(own.map(|free| free.nearly_neutral())).collect()
    };
    let mut starts: Vec<Vec<f64>> = task.starts.iter().map(faint).collect();
    starts.dedup();
    Task { starts, ..task.clone() }
}

/// Whether no start of a task comes near the measurements.
fn is_far(problem: &Problem, noise: &Noise, task: &Task) -> Option<bool> {
    let (chi_squares, freedom) = costs(problem, noise, task)?;
    Some(!chi_squares.iter().any(|chi_square| *chi_square <= FAR * freedom))
}

/// Chi-square at each start of a task, infinite where the model has no answer, and the degrees of freedom.
pub(super) fn costs(problem: &Problem, noise: &Noise, task: &Task) -> Option<(Vec<f64>, f64)> {
    with_problem(problem, noise, task, false, |weighted, _| {
        let square = |start: &Vec<f64>| weighted.residual(&weighted.coordinates(start)).iter().map(|r| r * r).sum();
        let freedom = weighted.freedom().saturating_sub(weighted.free.len());
        Some((task.starts.iter().map(square).collect(), freedom as f64))
    })
}
