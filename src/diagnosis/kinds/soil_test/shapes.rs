//! Shapes of what a test of the soil may miss.

use crate::diagnosis::diagnose::{Shape, hats, powers, product, recorded, run_order};
use crate::diagnosis::layout::Layout;
use crate::measurement::Experiment;

/// The inputs in hats, alone and as a share of what the model says, what the model says of each rig, and the order of runs.
pub(super) fn discrepancy(experiment: &Experiment, layout: &Layout, modelled: &[f64], inputs: &[&str]) -> Vec<Shape> {
    let mut shapes = Vec::new();
    let of_model = of_the_model(experiment, layout, modelled);
    for input in inputs {
        let Some(condition) = recorded(experiment, layout, input) else { continue };
        let from = shapes.len();
        hats(experiment, &condition, &mut shapes);
        let scaled: Vec<Shape> = shapes[from..]
            .iter()
            .map(|hat| product(experiment, &|run, row| hat[run][row] * of_model[run][row]))
            .collect();
        shapes.extend(scaled);
    }
    // A rig of its own: another plate, another box.
    let rigs = experiment.rigs();
    let mut different: Vec<usize> = rigs.clone();
    different.sort_unstable();
    different.dedup();
    for rig in different.iter().skip(1) {
        shapes.push(product(experiment, &|run, row| if rigs[run] == *rig { of_model[run][row] } else { 0.0 }));
    }
    run_order(experiment, layout, &mut shapes);
    shapes
}

/// The inputs and their squares.
pub(super) fn modulations(experiment: &Experiment, layout: &Layout, inputs: &[&str]) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for input in inputs {
        let Some(condition) = recorded(experiment, layout, input) else { continue };
        powers(experiment, &condition, 2, &mut shapes);
    }
    shapes
}

/// What the model says of the first signal of each run, over its largest size.
fn of_the_model(experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Shape {
    let largest =
        modelled.iter().copied().filter(|value| value.is_finite()).fold(f64::MIN_POSITIVE, |a, b| a.max(b.abs()));
    let value = |run: usize, row: usize| {
        let block = layout.of_run(run).next();
        block.map_or(0.0, |block| modelled[block.range.start + row] / largest)
    };
    product(experiment, &|run, row| {
        let value = value(run, row);
        if value.is_finite() { value } else { 0.0 }
    })
}
