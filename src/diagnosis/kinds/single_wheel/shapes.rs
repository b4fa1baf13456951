//! Shapes of what a steady point may miss: functions of slip, load and wheel speed.

use crate::diagnosis::diagnose::{Shape, hats, powers, product, recorded, run_order};
use crate::diagnosis::layout::Layout;
use crate::measurement::Experiment;

/// Slip in hats, and its first powers times load and speed.
pub(super) fn discrepancy(experiment: &Experiment, layout: &Layout) -> Vec<Shape> {
    let slip = recorded(experiment, layout, "slip");
    let mut shapes = Vec::new();
    match &slip {
        Some(slip) => hats(experiment, slip, &mut shapes),
        None => shapes.push(product(experiment, &|_, _| 1.0)),
    }
    for name in ["load", "wheel_speed"] {
        let Some(condition) = recorded(experiment, layout, name) else { continue };
        powers(experiment, &condition, 2, &mut shapes);
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

/// Slip and its square, load and wheel speed.
pub(super) fn modulations(experiment: &Experiment, layout: &Layout) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for (name, most) in [("slip", 2), ("load", 1), ("wheel_speed", 1)] {
        let Some(condition) = recorded(experiment, layout, name) else { continue };
        powers(experiment, &condition, most, &mut shapes);
    }
    shapes
}
