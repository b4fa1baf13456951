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
/// Time at the start of a run in motion that no fit counts, s.
const UNKNOWN_START: f64 = 0.5;
/// Turn of each wheel by which a contact that begins at rest has broken loose, rad: its shear grows to its full size within a turn of
/// less than its angle. How it breaks loose, and how deep a standing wheel sinks, are assumptions of the model. The first window begins
/// there, and its rows count [`LEAD`] later.
const ROLLED_IN: f64 = 1.0;
/// Largest share of the rows of a run that these may be.
const BREAKING_LOOSE_SHARE: f64 = 0.2;

/// How far the ground counts as passed behind a rover that already moves, m.
const CAME_FROM: f64 = 100.0;

/// Largest distance of the first place of a measured path from the stated `x0`, m, at which the run counts as beginning at `x0`. A log that
/// begins farther off measures x from another origin.
const SAME_START: f64 = 0.1;

/// The windows of all runs; `models` has what is known of each.
pub(crate) fn cut(experiment: &Experiment, models: &[Model]) -> Windows {
    let paths: Vec<Option<Path>> = experiment.runs.iter().zip(models).map(|(run, model)| of_run(run, model)).collect();
    let paths = shared(experiment, paths);
    let cut_one = |((run, model), path): ((&Run, &Model), &Option<Path>)| {
        windows(run, path.as_ref(), run.x0.unwrap_or(model.start.x0))
    };
    experiment.runs.iter().zip(models).zip(&paths).map(cut_one).collect()
}

/// Number of rows at the start of a run that no fit counts: how contacts break loose is an assumption of the model.
pub(crate) fn uncounted(run: &Run) -> usize {
    let Some(time) = run.data.column("time") else { return 0 };
    let until = if starts_in_motion(run) { time[0] + UNKNOWN_START } else { rolled_in(time, &commanded(run)) + LEAD };
    let early = time.partition_point(|t| *t < until);
    early.min((BREAKING_LOOSE_SHARE * time.len() as f64) as usize)
}

/// Whether a run begins in motion, as far as its measurements tell.
pub(crate) fn starts_in_motion(run: &Run) -> bool {
    // Neither the radius nor the place decides on whether a run begins at rest.
    path(run, 1.0, 0.0, &commanded(run)).is_some_and(|path| !begins_at_rest(run, &path))
}

/// Time by which every wheel has turned far enough from the start; the start itself where speeds are unknown.
fn rolled_in(time: &[f64], speeds: &[Vec<f64>]) -> f64 {
    let mut turned = vec![0.0; speeds.first().map_or(0, Vec::len)];
    for row in 0..time.len() - 1 {
        if turned.iter().all(|angle| *angle >= ROLLED_IN) {
            return time[row];
        }
        let pairs = turned.iter_mut().zip(&speeds[row]);
        pairs.for_each(|(angle, speed)| *angle += speed.abs() * (time[row + 1] - time[row]));
    }
    time[time.len() - 1]
}

/// Whether a run begins at rest: by its first velocity, or by the mean over the first half second, which noise moves less but a quick
/// start raises. A run in motion that is taken for one at rest loses a second or two, one at rest that is taken for one in motion
/// begins at a wrong slip. Where neither place nor velocity was measured, measured wheel speeds tell; commands do not.
fn begins_at_rest(run: &Run, path: &Path) -> bool {
    let fastest = path.velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let slow = |velocity: Option<&f64>| velocity.is_none_or(|v| v.abs() <= AT_REST * fastest);
    let recorded = run.data.column("velocity").and_then(|column| column.iter().find(|v| !v.is_nan()));
    let tells = path.measured || run.follows_measured_speeds();
    !tells || slow(path.velocity.first()) || (recorded.is_some() && slow(recorded))
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

/// Whether a run is recorded in several pieces, with gaps between them.
pub(crate) fn has_gap(run: &Run) -> bool {
    run.data.column("time").is_some_and(|time| pieces(time).len() > 1)
}

/// Path of a run whose commands are followed as they are.
fn of_run(run: &Run, model: &Model) -> Option<Path> {
    let speeds = commanded(run);
    if model.control.kind == ControlKind::SpeedLoop && !run.follows_measured_speeds() {
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

/// The windows of a run, which is said to begin at `x0`, m.
fn windows(run: &Run, path: Option<&Path>, x0: f64) -> Vec<Window> {
    let (Some(time), Some(path)) = (run.data.column("time"), path) else { return Vec::new() };
    let speeds = commanded(run);
    let mut pieces = pieces(time);
    let at_rest = begins_at_rest(run, path);
    let length = time[time.len() - 1] - time[0];
    if pieces.len() == 1 && at_rest && length < LONG * LENGTH {
        return Vec::new();
    }
    // The path is a straight line through the rows around each, which at the first row of a start from rest lies behind the start.
    let origin = if at_rest && (path.x[0] - x0).abs() < SAME_START { x0 } else { path.x[0] };
    let before = if at_rest { origin } else { origin - CAME_FROM * path.velocity[0].signum() };
    let mut covered = [before.min(origin), before.max(origin)];
    let mut windows = Vec::new();
    let loose = uncounted(run).min(pieces[0].end - 1);
    let mut seen = if at_rest { loose } else { 0 };
    if at_rest && loose > 0 {
        // How it breaks loose is shown and not counted; what counts begins in motion.
        windows.push(Window { begin: 0, rows: 0..loose, start: None, ends_when_stuck: false });
        pieces[0].start = loose;
    }
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
            let lead = time[..rows.start].partition_point(|t| *t <= time[rows.start] - LEAD).saturating_sub(1);
            // Behind a gap nothing is known.
            let begin = if rows.start == loose { lead } else { lead.max(piece.start) };
            for x in path.x.get(seen..=begin).unwrap_or_default().iter().chain([&path.x[begin]]) {
                covered = [covered[0].min(*x), covered[1].max(*x)];
            }
            seen = begin.max(seen);
            let start = Moving {
                x: path.x[begin],
                velocity: path.velocity[begin],
                speeds: speeds[begin].clone(),
                covered,
                origin,
            };
            let start = (rows.start > 0 || !at_rest).then_some(start);
            windows.push(Window { begin, rows, start, ends_when_stuck: false });
        }
    }
    windows
}

/// Stretches without a gap.
pub(crate) fn pieces(time: &[f64]) -> Vec<std::ops::Range<usize>> {
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

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
mod tests {
    use super::*;
    use crate::measurement::Table;

    /// A run of `rows` rows at 10 Hz whose wheel turns at `speed` (rad/s) and which begins at `velocity` (m/s) and reaches 0.2 m/s.
    fn run(rows: usize, speed: f64, velocity: f64) -> Run {
        let mut data = Table::new(["time", "wheel[1].speed_command", "velocity"]).unwrap();
        for row in 0..rows {
            let share = (row as f64 / 10.0).min(1.0);
            data.push(&[row as f64 * 0.1, speed, velocity + share * (0.2 - velocity)]).unwrap();
        }
        Run {
            name: "run".to_owned(),
            file: "run.csv".into(),
            group: None,
            parameters: [].into(),
            terrain: None,
            x0: None,
            data,
            conditions: Vec::new(),
            inputs: vec!["wheel[1].speed_command".to_owned()],
            measured: vec!["velocity".to_owned()],
        }
    }

    #[test]
    fn analytic_a_run_from_rest_counts_once_each_wheel_has_rolled_in() {
        // 1 rad at 0.8 rad/s takes 1.25 s, so that row 13 begins a window, which counts half a second later.
        assert_eq!(uncounted(&run(200, 0.8, 0.0)), 18);
        assert_eq!(uncounted(&run(200, 8.0, 0.0)), 7);
        // A wheel that hardly turns costs a fifth of the rows, not all of them.
        assert_eq!(uncounted(&run(200, 1e-3, 0.0)), 40);
        // In motion nothing has to break loose.
        assert_eq!(uncounted(&run(200, 0.8, 0.2)), 5);
    }

    #[test]
    fn property_windows_of_a_run_from_rest_begin_in_motion_behind_its_start() {
        let run = run(200, 0.8, 0.0);
        let path = path(&run, 0.25, 0.0, &commanded(&run)).unwrap();
        let windows = windows(&run, Some(&path), 0.0);
        assert_eq!((windows[0].rows.clone(), &windows[0].start), (0..18, &None));
        for pair in windows.windows(2) {
            assert_eq!(pair[0].rows.end, pair[1].rows.start);
            assert!(pair[1].start.is_some() && pair[1].begin < pair[1].rows.start && pair[1].begin > 0);
        }
        assert_eq!(windows.last().unwrap().rows.end, 200);
    }
}
