//! Variations of a test of the soil: other plates, other stresses, further, faster, and more repeats.

use crate::diagnosis::separate::plan::handy;
use crate::diagnosis::separate::variation::Variation;
use crate::measurement::{Experiment, Run, Table};

/// Another plate is so many times as large, another speed so many times as fast.
const LARGER: f64 = 2.0;
const FASTER: f64 = 10.0;

/// Variations that the model can be asked about: each adds runs like those at hand, or makes them anew.
pub(super) fn variations(experiment: &Experiment, pressed: bool) -> Vec<Variation> {
    let mut all = Vec::new();
    let mut add = |text: String, runs: Vec<Run>| {
        let mut varied = experiment.clone();
        varied.runs.extend(runs);
        all.push(Variation { text, experiment: varied, cost: 1 });
    };
    if pressed {
        for factor in [LARGER, 1.0 / LARGER] {
            if let Some((runs, words)) = other_plate(experiment, factor) {
                add(words, runs);
            }
        }
        add(faster("plate.speed"), with_parameter(experiment, "plate.speed", FASTER, 0.01));
    } else {
        let largest = largest(experiment, "normal_stress");
        if largest > 0.0 {
            let runs = heaviest(experiment, largest, LARGER);
            add(format!("three tests under {} Pa", handy(LARGER * largest)), runs);
        }
        add(faster("shear_box.speed"), with_parameter(experiment, "shear_box.speed", FASTER, 0.001));
    }
    let input = if pressed { "sinkage" } else { "displacement" };
    let deeper = Experiment {
        runs: experiment.runs.iter().map(|run| scaled(run, input, LARGER)).collect(),
        ..experiment.clone()
    };
    let end = handy(LARGER * largest(experiment, input));
    all.push(Variation { text: format!("{input} up to {end} m"), experiment: deeper, cost: 1 });
    all
}

fn faster(name: &str) -> String {
    format!("a second {name}, ten times the present one")
}

fn largest(experiment: &Experiment, column: &str) -> f64 {
    let values = experiment.runs.iter().flat_map(|run| run.data.column(column).unwrap_or_default());
    values.copied().fold(0.0, f64::max)
}

/// Runs of the first rig with a plate of another size, which no run has yet, and how to say so.
fn other_plate(experiment: &Experiment, factor: f64) -> Option<(Vec<Run>, String)> {
    let stated = |run: &Run, name: &str| run.parameters.get(name).or_else(|| experiment.parameters.get(name)).copied();
    let sizes = |name: &str| -> Vec<f64> {
        experiment.runs.iter().filter_map(|run| stated(run, name)).filter(|size| *size > 0.0).collect()
    };
    for names in [&["plate.diameter"][..], &["plate.width", "plate.length"]] {
        let all = sizes(names[0]);
        let ends = (all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(0.0, f64::max));
        if all.is_empty() {
            continue;
        }
        let from = if factor > 1.0 { ends.1 } else { ends.0 };
        let own = |run: &&Run| stated(run, names[0]) == Some(from);
        let mut runs: Vec<Run> = experiment.runs.iter().filter(own).cloned().collect();
        for run in &mut runs {
            for name in names {
                if let Some(size) = stated(run, name) {
                    run.parameters.insert((*name).to_owned(), handy(size * factor));
                }
            }
            run.group = run.group.as_ref().map(|group| format!("{group}, other plate"));
        }
        let count = runs.len();
        return Some((runs, format!("{count} more tests with a plate of {} m ({})", handy(from * factor), names[0])));
    }
    None
}

/// All runs once more with a parameter that is so many times what it was.
fn with_parameter(experiment: &Experiment, name: &str, factor: f64, usual: f64) -> Vec<Run> {
    let of = |run: &Run| run.parameters.get(name).or_else(|| experiment.parameters.get(name)).copied().unwrap_or(usual);
    let mut runs = experiment.runs.clone();
    for run in &mut runs {
        let value = handy(of(run) * factor);
        run.parameters.insert(name.to_owned(), value);
        run.group = run.group.as_ref().map(|group| format!("{group}, faster"));
    }
    runs
}

/// The runs under the largest normal stress once more under a larger one.
fn heaviest(experiment: &Experiment, largest: f64, factor: f64) -> Vec<Run> {
    let mean = |run: &Run| {
        let values = run.data.column("normal_stress").unwrap_or_default();
        values.iter().sum::<f64>() / values.len().max(1) as f64
    };
    let runs = experiment.runs.iter().filter(|run| mean(run) > 0.9 * largest);
    let changed = |run: &Run| {
        let mut run = scaled(run, "normal_stress", factor);
        run.group = run.group.as_ref().map(|group| format!("{group}, heavier"));
        run
    };
    runs.map(changed).collect()
}

/// A run with one column scaled.
fn scaled(run: &Run, column: &str, factor: f64) -> Run {
    let names = run.data.names().to_vec();
    let Ok(mut table) = Table::new(names.clone()) else { return run.clone() };
    for row in 0..run.data.rows() {
        let cell = |name: &String| {
            let value = run.data.value(name, row)?;
            Some(if name == column { value * factor } else { value })
        };
        if table.push_with_gaps(&names.iter().map(cell).collect::<Vec<_>>()).is_err() {
            return run.clone();
        }
    }
    Run { data: table, ..run.clone() }
}
