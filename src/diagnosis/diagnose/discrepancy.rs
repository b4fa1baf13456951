//! A flexible discrepancy: smooth functions of every recorded condition, for each signal, that stand for "something".
//!
//! It says how much of a misfit could be explained at all, and it competes as "something else" against the effects.

use crate::diagnosis::layout::{Block, Layout};
use crate::measurement::{Experiment, Kind, Run};

/// Most hat functions over one condition.
const HATS: usize = 8;

/// Values of a condition that differ by less than this share of its range are one level.
const SAME_LEVEL: f64 = 0.02;

/// A condition: one value a row of a run.
struct Condition {
    /// By run.
    values: Vec<Vec<f64>>,
    low: f64,
    high: f64,
}

impl Condition {
    /// `None` where the condition is not recorded everywhere or does not vary. A row that is left out is missing here too: a load
    /// that no soil carries would set the range for all others.
    fn new(experiment: &Experiment, layout: &Layout, value: &dyn Fn(usize, &Run) -> Option<Vec<f64>>) -> Option<Self> {
        let mut values: Vec<Vec<f64>> =
            experiment.runs.iter().enumerate().map(|(k, run)| value(k, run)).collect::<Option<_>>()?;
        layout.left_out().iter().for_each(|(run, row)| values[*run][*row] = f64::NAN);
        let finite = || values.iter().flatten().filter(|v| !v.is_nan());
        let low = finite().copied().fold(f64::INFINITY, f64::min);
        let high = finite().copied().fold(f64::NEG_INFINITY, f64::max);
        (high > low).then_some(Self { values, low, high })
    }

    /// Value between -1 and 1; 0 where missing.
    fn scaled(&self, run: usize, row: usize) -> f64 {
        let value = self.values[run][row];
        if value.is_nan() { 0.0 } else { 2.0 * (value - self.low) / (self.high - self.low) - 1.0 }
    }

    /// Knots of the hats: the levels where there are few, else quantiles.
    fn knots(&self) -> Vec<f64> {
        let mut all: Vec<f64> = self.values.iter().flatten().copied().filter(|v| !v.is_nan()).collect();
        all.sort_by(f64::total_cmp);
        let gap = SAME_LEVEL * (self.high - self.low);
        let levels: Vec<f64> = all.chunk_by(|a, b| b - a <= gap).map(|level| level[level.len() / 2]).collect();
        if (2..=HATS).contains(&levels.len()) {
            return levels;
        }
        let mut knots: Vec<f64> = (0..HATS).map(|k| all[k * (all.len() - 1) / (HATS - 1)]).collect();
        knots.dedup_by(|b, a| *b - *a <= gap);
        knots
    }

    /// Hat function number `k` over the knots.
    fn hat(&self, knots: &[f64], k: usize, run: usize, row: usize) -> f64 {
        let value = self.values[run][row];
        if value.is_nan() {
            return 0.0;
        }
        let value = value.clamp(knots[0], knots[knots.len() - 1]);
        let side = |other: usize| ((value - knots[other]) / (knots[k] - knots[other])).clamp(0.0, 1.0);
        match (value <= knots[k], k > 0, k + 1 < knots.len()) {
            (true, true, _) => side(k - 1),
            (false, _, true) => side(k + 1),
            _ => 1.0,
        }
    }
}

/// Columns in the layout's order, each nonzero in one signal only. Position and pitch are taken from the model: measured
/// ones share the noise of what is to be explained.
pub(crate) fn columns(experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Vec<Vec<f64>> {
    let shapes = match experiment.kind {
        Kind::SingleWheel => steady_shapes(experiment, layout),
        Kind::Traverse => traverse_shapes(experiment, layout, modelled),
    };
    let mut columns = Vec::new();
    for signal in experiment.signals() {
        for shape in &shapes {
            let mut column = vec![0.0; layout.len()];
            for Block { run, range, .. } in layout.blocks.iter().filter(|block| block.signal == signal) {
                for row in 0..range.len() {
                    column[range.start + row] = shape[*run][row];
                }
            }
            columns.push(column);
        }
    }
    columns
}

/// Smooth functions of the conditions alone, by run and row, with which the strength of an effect may vary while it
/// remains the same effect in another form.
pub(crate) fn modulations(experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Vec<Vec<Vec<f64>>> {
    let columns: &[&str] = match experiment.kind {
        Kind::SingleWheel => &["slip", "load", "wheel_speed"],
        Kind::Traverse => &["pitch", "command", "time"],
    };
    let mut shapes = Vec::new();
    for name in columns {
        let condition = match *name {
            "pitch" => along_model(experiment, layout, modelled, name),
            "command" => commanded(experiment, layout),
            _ => recorded(experiment, layout, name),
        };
        let Some(condition) = condition else { continue };
        shapes.push(product(experiment, &|run, row| condition.scaled(run, row)));
        if ["slip", "pitch", "command"].contains(name) {
            shapes.push(product(experiment, &|run, row| condition.scaled(run, row).powi(2)));
        }
    }
    shapes
}

type Shape = Vec<Vec<f64>>;

fn product(experiment: &Experiment, f: &dyn Fn(usize, usize) -> f64) -> Shape {
    experiment.runs.iter().enumerate().map(|(k, run)| (0..run.data.rows()).map(|row| f(k, row)).collect()).collect()
}

fn hats(experiment: &Experiment, condition: &Condition, shapes: &mut Vec<Shape>) {
    let knots = condition.knots();
    if knots.len() > 1 {
        for k in 0..knots.len() {
            shapes.push(product(experiment, &|run, row| condition.hat(&knots, k, run, row)));
        }
    }
}

fn recorded(experiment: &Experiment, layout: &Layout, name: &str) -> Option<Condition> {
    Condition::new(experiment, layout, &|_, run| run.data.column(name).map(<[f64]>::to_vec))
}

/// The command that acted until a row, the mean over the wheels: friction and rate depend on speed in many forms.
fn commanded(experiment: &Experiment, layout: &Layout) -> Option<Condition> {
    Condition::new(experiment, layout, &|_, run| {
        let commands: Vec<&[f64]> = run.inputs.iter().map(|name| run.data.column(name)).collect::<Option<_>>()?;
        let mean = |row: usize| commands.iter().map(|values| values[row]).sum::<f64>() / commands.len() as f64;
        Some((0..run.data.rows()).map(|row| mean(row.saturating_sub(1))).collect())
    })
}

/// A signal as the model gives it, where it was measured.
fn along_model(experiment: &Experiment, layout: &Layout, modelled: &[f64], name: &str) -> Option<Condition> {
    Condition::new(experiment, layout, &|k, _| {
        let block = layout.of_run(k).find(|block| block.signal == name)?;
        Some(modelled[block.range.clone()].to_vec())
    })
}

/// Slip in hats, and its first powers times load and speed.
fn steady_shapes(experiment: &Experiment, layout: &Layout) -> Vec<Shape> {
    let slip = recorded(experiment, layout, "slip");
    let mut shapes = Vec::new();
    match &slip {
        Some(slip) => hats(experiment, slip, &mut shapes),
        None => shapes.push(product(experiment, &|_, _| 1.0)),
    }
    for name in ["load", "wheel_speed"] {
        let Some(condition) = recorded(experiment, layout, name) else { continue };
        shapes.push(product(experiment, &|run, row| condition.scaled(run, row)));
        shapes.push(product(experiment, &|run, row| condition.scaled(run, row).powi(2)));
        if let Some(slip) = &slip {
            for power in 1..=2 {
                let value = |run, row| condition.scaled(run, row) * slip.scaled(run, row).powi(power);
                shapes.push(product(experiment, &value));
            }
        }
    }
    run_order(experiment, layout, &mut shapes);
    shapes
}

/// A drift over the list of runs.
fn run_order(experiment: &Experiment, layout: &Layout, shapes: &mut Vec<Shape>) {
    if let Some(order) = Condition::new(experiment, layout, &|k, run| Some(vec![k as f64; run.data.rows()])) {
        shapes.push(product(experiment, &|run, row| order.scaled(run, row)));
        shapes.push(product(experiment, &|run, row| order.scaled(run, row).powi(2)));
    }
}

/// Hats over time, position, pitch and commanded speed, the place in the list of runs, and one turn of a wheel.
fn traverse_shapes(experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Vec<Shape> {
    let mut shapes = Vec::new();
    let elapsed = |run: &Run| {
        let time = run.data.column("time")?;
        Some(time.iter().map(|t| t - time[0]).collect())
    };
    let command = |run: &Run| run.data.column(run.inputs.first()?).map(<[f64]>::to_vec);
    let conditions = [
        Condition::new(experiment, layout, &|_, run| elapsed(run)),
        along_model(experiment, layout, modelled, "x"),
        along_model(experiment, layout, modelled, "pitch"),
        Condition::new(experiment, layout, &|_, run| command(run)),
    ];
    for condition in conditions.iter().flatten() {
        hats(experiment, condition, &mut shapes);
    }
    run_order(experiment, layout, &mut shapes);
    let angles: Option<Vec<Vec<f64>>> = experiment.runs.iter().map(wheel_angle).collect();
    if let Some(angles) = angles {
        shapes.push(product(experiment, &|run, row| angles[run][row].sin()));
        shapes.push(product(experiment, &|run, row| angles[run][row].cos()));
    }
    shapes
}

/// Angle of the rear wheel as commanded, rad; `None` where torques are commanded.
fn wheel_angle(run: &Run) -> Option<Vec<f64>> {
    let speed = run.data.column(run.inputs.iter().find(|name| name.ends_with(".speed_command"))?)?;
    let time = run.data.column("time")?;
    let mut angle = vec![0.0];
    for k in 1..time.len() {
        angle.push(angle[k - 1] + speed[k - 1] * (time[k] - time[k - 1]));
    }
    Some(angle)
}
