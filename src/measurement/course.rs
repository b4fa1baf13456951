//! Runs whose rows follow an input on its course: a plate on its way down, a shear box on its way.
//!
//! A recorder takes hundreds of rows there, at other places in every test, and neighbouring rows tell the same. Such rows are
//! averaged over steps of the input; tests that repeat each other get the same steps, so that their rows pair. The steps are
//! finer at the beginning, where stresses build up. What is averaged is said among the doubts.

use super::doubts::Doubts;
use super::error::{ExperimentError, Problem};
use super::experiment::Run;
use super::grid::Grid;
use super::settings::Settings;
use super::table::Table;
use std::collections::BTreeMap;

/// Most rows of a run: shapes of stresses over a displacement have a few parameters.
const MOST_ROWS: usize = 40;

/// Fewest steps that tests which repeat each other have in common.
const LEAST_STEPS: usize = 5;

/// Share of the largest value by which an input may go back: play and resolution of a sensor.
const GOES_BACK: f64 = 0.02;

/// Share of its range by which the input of rows that pair may differ: the model's own slope is taken off such differences.
const PAIRS: f64 = 0.05;

/// Share of the largest by which other inputs of tests that repeat each other may differ.
const SAME: f64 = 0.02;

/// An input whose course the rows of a run follow.
pub(super) struct Course {
    /// The input that rises from row to row.
    pub input: &'static str,
    /// An input that stays the same over a run, where there is one.
    pub held: Option<&'static str>,
    /// What a run is, for people.
    pub what: &'static str,
}

impl Course {
    /// Fails where the input goes back: the way back of a plate or a box is another test.
    pub fn check(&self, grid: &Grid) -> Result<(), ExperimentError> {
        let Some(column) = grid.column(self.input) else { return Ok(()) };
        let largest = column.values.iter().copied().fold(0.0_f64, f64::max);
        let mut reached = f64::NEG_INFINITY;
        for (row, value) in column.values.iter().enumerate() {
            if reached - value > GOES_BACK * largest {
                let problem = Problem::Implausible {
                    value: *value,
                    expected: format!(
                        "a {} of no less than the {reached} m reached before: {} is one way, without the way back; give each way a run of its own and leave the others out",
                        self.input, self.what
                    ),
                };
                return Err(grid.error_at(row, column, problem));
            }
            reached = reached.max(*value);
        }
        Ok(())
    }
}

/// Makes groups of runs that were made alike, where the settings say nothing of repeats: equal parameters, and an equal held input.
pub(super) fn repeats_of_equal_rigs(settings: &Settings, course: &Course, runs: &mut [Run], doubts: &mut Doubts) {
    if runs.iter().any(|run| run.group.is_some() || !run.conditions.is_empty()) {
        return;
    }
    let held = |run: &Run| course.held.and_then(|name| mean(run.data.column(name)?)).unwrap_or(0.0);
    let largest = runs.iter().map(|run| held(run).abs()).fold(0.0, f64::max);
    let alike = |a: &Run, b: &Run| a.parameters == b.parameters && (held(a) - held(b)).abs() <= SAME * largest;
    let first: Vec<usize> = (0..runs.len()).map(|k| (0..k).find(|j| alike(&runs[*j], &runs[k])).unwrap_or(k)).collect();
    if first.iter().enumerate().all(|(k, first)| k == *first) {
        return;
    }
    for (run, first) in runs.iter_mut().zip(&first) {
        run.group = Some(format!("alike {}", first + 1));
    }
    doubts.add(
        &settings.file,
        "runs with equal parameters are taken for repeats of each other; give each [[run]] a `group` where they are not".to_owned(),
    );
}

/// Averages runs of many rows over steps of their input, runs of a group over the same steps.
pub(super) fn average(runs: &mut [Run], course: &Course, doubts: &mut Doubts) -> Result<(), ExperimentError> {
    let mut groups: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (k, run) in runs.iter().enumerate().filter(|(_, run)| run.conditions.is_empty()) {
        groups.entry(run.group.clone().unwrap_or_else(|| format!("\0{k}"))).or_default().push(k);
    }
    for members in groups.into_values() {
        if pair(runs, &members, course.input) {
            continue;
        }
        let steps = steps(runs, &members, course.input)?;
        for k in &members {
            runs[*k].data = averaged(&runs[*k], course.input, &steps)?;
        }
        let (first, end) = (steps[0], steps[steps.len() - 1]);
        let text = format!(
            "rows are averaged over {} steps of {} between {:.2} and {:.2} mm{}",
            steps.len() - 1,
            course.input,
            1e3 * first,
            1e3 * end,
            if members.len() > 1 { ", the same for runs of one group" } else { "" }
        );
        doubts.add(&runs[members[0]].file, text);
    }
    Ok(())
}

/// Whether the rows of these runs are few and pair as they are.
fn pair(runs: &[Run], members: &[usize], input: &str) -> bool {
    let column = |k: &usize| runs[*k].data.column(input).unwrap_or_default();
    let first = column(&members[0]);
    let range = first.last().copied().unwrap_or(0.0) - first.first().copied().unwrap_or(0.0);
    let alike = |k: &usize| {
        let own = column(k);
        own.len() == first.len() && own.iter().zip(first).all(|(a, b)| (a - b).abs() <= PAIRS * range)
    };
    first.len() <= MOST_ROWS && members.iter().all(alike)
}

/// Ends of steps of which each holds rows of every run.
fn steps(runs: &[Run], members: &[usize], input: &str) -> Result<Vec<f64>, ExperimentError> {
    let columns: Vec<&[f64]> = members.iter().map(|k| runs[*k].data.column(input).unwrap_or_default()).collect();
    let low = columns.iter().map(|c| c.iter().copied().fold(f64::INFINITY, f64::min)).fold(f64::NEG_INFINITY, f64::max);
    let high =
        columns.iter().map(|c| c.iter().copied().fold(f64::NEG_INFINITY, f64::max)).fold(f64::INFINITY, f64::min);
    let mut ends = vec![low];
    for k in 1..=MOST_ROWS {
        let share = k as f64 / MOST_ROWS as f64;
        let end = low + (high - low) * share * share;
        let from = ends[ends.len() - 1];
        if columns.iter().all(|column| column.iter().any(|value| within(*value, from, end))) {
            ends.push(end);
        }
    }
    // Rows behind the last full step belong to it.
    let last = ends.len() - 1;
    ends[last] = high;
    if last < LEAST_STEPS.min(columns.iter().map(|column| column.len()).min().unwrap_or(0)) {
        let run = &runs[members[0]];
        let message = format!(
            "its group has {last} steps of {input} in common between {low} and {high} m, expected at least {LEAST_STEPS}: the runs of a group are made over the same range"
        );
        return Err(ExperimentError::in_file(&run.file, Problem::NotARepeat(message)));
    }
    Ok(ends)
}

/// Rows of the first step include its lower end.
fn within(value: f64, from: f64, end: f64) -> bool {
    value >= from && value < end || value == end
}

/// The means of all columns over each step.
fn averaged(run: &Run, input: &str, ends: &[f64]) -> Result<Table, ExperimentError> {
    let broken = |_| ExperimentError::in_file(&run.file, Problem::Header("the columns do not form a table"));
    let along = run.data.column(input).unwrap_or_default();
    let mut table = Table::new(run.data.names().to_vec()).map_err(broken)?;
    for step in ends.windows(2) {
        let rows: Vec<usize> = (0..along.len()).filter(|row| within(along[*row], step[0], step[1])).collect();
        let of = |name: &String| mean(&rows.iter().filter_map(|row| run.data.value(name, *row)).collect::<Vec<_>>());
        table.push_with_gaps(&run.data.names().iter().map(of).collect::<Vec<_>>()).map_err(broken)?;
    }
    Ok(table)
}

/// The mean; `None` of none.
fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}
