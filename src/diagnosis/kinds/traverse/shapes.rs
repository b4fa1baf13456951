//! Shapes of what a traverse may miss: functions of time, position, pitch and command. Position and pitch are taken from the
//! model: measured ones share the noise of what is to be explained.

use crate::diagnosis::diagnose::{Condition, Shape, hats, powers, product, recorded, run_order};
use crate::diagnosis::layout::Layout;
use crate::measurement::{Experiment, Run};

/// Hats over time, position, pitch and commanded speed, the place in the list of runs, and one turn of a wheel.
pub(super) fn discrepancy(experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Vec<Shape> {
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

/// Pitch and command with their squares, and time.
pub(super) fn modulations(experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Vec<Shape> {
    let conditions = [
        (along_model(experiment, layout, modelled, "pitch"), 2),
        (commanded(experiment, layout), 2),
        (recorded(experiment, layout, "time"), 1),
    ];
    let mut shapes = Vec::new();
    for (condition, most) in conditions {
        let Some(condition) = condition else { continue };
        powers(experiment, &condition, most, &mut shapes);
    }
    shapes
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

/// Angle of the rear wheel as its imposed speed gives it, rad; `None` where torques are commanded.
fn wheel_angle(run: &Run) -> Option<Vec<f64>> {
    let speed = run.data.column(run.inputs.first().filter(|_| run.imposes_speeds())?)?;
    let time = run.data.column("time")?;
    let mut angle = vec![0.0];
    for k in 1..time.len() {
        angle.push(angle[k - 1] + speed[k - 1] * (time[k] - time[k - 1]));
    }
    Some(angle)
}
