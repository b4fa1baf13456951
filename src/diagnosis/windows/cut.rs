//! How runs are cut into windows.

use super::path::{Path, path};
use super::{Moving, Window, Windows};
use crate::measurement::{Experiment, Run};
use crate::model::{ControlKind, Model};

/// Length of a window, s. Longer ones let the errors of a wrong soil add up, shorter ones tell less of the slip.
pub(crate) const LENGTH: f64 = 6.0;
/// A run is cut where it is longer than this many windows.
const LONG: f64 = 1.4;
/// Time before a window's first row at which its simulation begins, s: contacts, heave and pitch settle within a third of it.
pub(crate) const LEAD: f64 = 0.5;
/// Time between rows, in usual times between rows, from which on it is a gap, and the least that is one, s.
const GAP: f64 = 3.5;
const LEAST_GAP: f64 = 0.5;
/// Share of the largest velocity of a run below which it begins at rest.
const AT_REST: f64 = 0.15;
/// Paths of runs that repeat each other begin alike where they are this near, m.
const ALIKE: f64 = 0.25;
/// How far the ground counts as passed behind a rover that already moves, m.
const CAME_FROM: f64 = 100.0;

/// The windows of all runs; `models` has what is known of each.
pub(crate) fn cut(experiment: &Experiment, models: &[Model]) -> Windows {
    let paths: Vec<Option<Path>> = experiment.runs.iter().zip(models).map(|(run, model)| of_run(run, model)).collect();
    let paths = shared(experiment, paths);
    experiment.runs.iter().zip(&paths).map(|(run, path)| windows(run, path.as_ref())).collect()
}

/// Rows after gaps in which the motion that a window begins with is not settled yet.
pub(crate) fn unsettled(experiment: &Experiment, windows: &Windows) -> Vec<(usize, usize)> {
    let mut rows = Vec::new();
    for (k, (run, windows)) in experiment.runs.iter().zip(windows).enumerate() {
        let time = run.data.column("time").unwrap_or_default();
        for window in windows.iter().filter(|window| window.start.is_some() && window.begin == window.rows.start) {
            let early = window.rows.clone().filter(|row| time[*row] < time[window.begin] + LEAD);
            rows.extend(early.map(|row| (k, row)));
        }
    }
    rows
}

/// Path of a run whose commands are followed as they are.
fn of_run(run: &Run, model: &Model) -> Option<Path> {
    let speeds = commanded(run);
    if model.control.kind == ControlKind::SpeedLoop {
        return None;
    }
    path(run, model.rover.wheel.radius, run.x0.unwrap_or(model.start.x0), &speeds)
}

/// Commanded speeds of the wheels, row by row; where torques were commanded the measured ones, none where these are missing.
fn commanded(run: &Run) -> Vec<Vec<f64>> {
    let wheels = run.inputs.len();
    let column = |k: usize| {
        let named = |what: &str| run.data.column(&format!("wheel[{k}].{what}"));
        named("speed_command").or_else(|| named("speed"))
    };
    let columns: Option<Vec<&[f64]>> = (1..=wheels).map(column).collect();
    let Some(columns) = columns else { return vec![Vec::new(); run.data.rows()] };
    let value = |x: f64| if x.is_nan() { 0.0 } else { x };
    (0..run.data.rows()).map(|row| columns.iter().map(|values| value(values[row])).collect()).collect()
}

/// Runs that repeat each other begin their windows at the mean of their paths, so that they are simulated once, and what
/// differs between them is noise alone.
fn shared(experiment: &Experiment, paths: Vec<Option<Path>>) -> Vec<Option<Path>> {
    let same = |a: &Run, b: &Run| {
        let inputs = |run: &Run| -> Vec<Option<Vec<u64>>> {
            let names = run.inputs.iter().map(String::as_str).chain(["time"]);
            names.map(|name| Some(run.data.column(name)?.iter().map(|x| x.to_bits()).collect())).collect()
        };
        a.parameters == b.parameters && a.x0 == b.x0 && a.terrain == b.terrain && inputs(a) == inputs(b)
    };
    let near = |a: &Path, b: &Path| {
        let apart: f64 = a.x.iter().zip(&b.x).map(|(a, b)| (a - b).abs()).sum();
        a.placed == b.placed && apart < ALIKE * a.x.len() as f64
    };
    let mut all = paths.clone();
    for (k, run) in experiment.runs.iter().enumerate() {
        let Some(own) = &paths[k] else { continue };
        let alike: Vec<&Path> = (0..paths.len())
            .filter(|j| same(run, &experiment.runs[*j]))
            .filter_map(|j| paths[j].as_ref())
            .filter(|other| near(own, other))
            .collect();
        let mean =
            |value: &dyn Fn(&Path) -> f64| alike.iter().map(|path| value(path)).sum::<f64>() / alike.len() as f64;
        all[k] = Some(Path {
            x: (0..own.x.len()).map(|row| mean(&|path| path.x[row])).collect(),
            velocity: (0..own.x.len()).map(|row| mean(&|path| path.velocity[row])).collect(),
            ..own.clone()
        });
    }
    all
}

fn windows(run: &Run, path: Option<&Path>) -> Vec<Window> {
    let (Some(time), Some(path)) = (run.data.column("time"), path) else { return Vec::new() };
    let speeds = commanded(run);
    let pieces = pieces(time);
    let fastest = path.velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let at_rest = !path.measured || path.velocity[0].abs() <= AT_REST * fastest;
    let length = time[time.len() - 1] - time[0];
    if pieces.len() == 1 && at_rest && length < LONG * LENGTH {
        return Vec::new();
    }
    let mut covered = [f64::INFINITY, f64::NEG_INFINITY];
    if !at_rest {
        let behind = path.x[0] - CAME_FROM * path.velocity[0].signum();
        covered = [behind.min(path.x[0]), behind.max(path.x[0])];
    }
    let (mut windows, mut seen) = (Vec::new(), 0);
    for piece in pieces {
        let count = ((time[piece.end - 1] - time[piece.start]) / LENGTH).round().max(1.0) as usize;
        let row_at = |k: usize| {
            let due = time[piece.start] + (time[piece.end - 1] - time[piece.start]) * k as f64 / count as f64;
            if k == count { piece.end } else { piece.start + time[piece.clone()].partition_point(|t| *t < due - 1e-9) }
        };
        for k in 0..count {
            let rows = row_at(k)..row_at(k + 1);
            if rows.is_empty() {
                continue;
            }
            let lead = time[piece.clone()].partition_point(|t| *t <= time[rows.start] - LEAD);
            let begin = if k == 0 { rows.start } else { piece.start + lead.saturating_sub(1) };
            for x in &path.x[seen..=begin.max(seen)] {
                covered = [covered[0].min(*x), covered[1].max(*x)];
            }
            seen = begin.max(seen);
            let rests = rows.start == 0 && at_rest;
            let start = (!rests).then(|| Moving {
                x: path.x[begin],
                velocity: path.velocity[begin],
                speeds: speeds[begin].clone(),
                covered,
                origin: path.x[0],
            });
            windows.push(Window { begin, rows, start });
        }
    }
    windows
}

/// Stretches without a gap.
fn pieces(time: &[f64]) -> Vec<std::ops::Range<usize>> {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut sorted = steps.clone();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let gap = LEAST_GAP.max(GAP * usual);
    steps.push(f64::INFINITY);
    let mut pieces = Vec::new();
    let mut from = 0;
    for (row, step) in steps.iter().enumerate() {
        if *step > gap {
            pieces.push(from..row + 1);
            from = row + 1;
        }
    }
    pieces
}
