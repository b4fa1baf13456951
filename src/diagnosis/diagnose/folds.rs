//! What is left out together: whole conditions, or whole runs.

use crate::diagnosis::thresholds::{FOLDS, LEAST_GROUPS};
use crate::measurement::Experiment;

/// Rows (run, row) that are left out together.
pub(crate) type Fold = Vec<(usize, usize)>;

/// Folds of whole conditions: groups of repeats; conditions of equal label; with too few of them, classes of slip.
pub(crate) fn folds(experiment: &Experiment) -> Vec<Fold> {
    let mut units = units(experiment);
    if units.len() < LEAST_GROUPS {
        units = classes(experiment);
    }
    let count = units.len().min(FOLDS);
    let mut folds = vec![Fold::new(); count];
    for (k, unit) in units.into_iter().enumerate() {
        folds[k % count].extend(unit);
    }
    folds.iter_mut().for_each(|fold| fold.sort_unstable());
    folds
}

/// Rows that repeat each other, whole groups of runs together.
fn units(experiment: &Experiment) -> Vec<Fold> {
    let mut units: Vec<(String, Fold)> = Vec::new();
    for (k, run) in experiment.runs.iter().enumerate() {
        for row in 0..run.data.rows() {
            let key = match (run.conditions.get(row), &run.group) {
                (Some(Some(label)), _) => format!("condition {label}"),
                (_, Some(group)) => format!("group {group}"),
                _ => format!("run {k}"),
            };
            match units.iter_mut().find(|(known, _)| *known == key) {
                Some((_, unit)) => unit.push((k, row)),
                None => units.push((key, vec![(k, row)])),
            }
        }
    }
    units.into_iter().map(|(_, unit)| unit).collect()
}

/// Classes of about equal count along slip (or the row, in a traverse), rows of equal slip together.
fn classes(experiment: &Experiment) -> Vec<Fold> {
    let mut samples: Vec<(f64, (usize, usize))> = Vec::new();
    for (k, run) in experiment.runs.iter().enumerate() {
        for row in 0..run.data.rows() {
            samples.push((run.data.value("slip", row).unwrap_or(row as f64), (k, row)));
        }
    }
    samples.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let levels: Vec<_> = samples.chunk_by(|a, b| a.0 == b.0).collect();
    let count = levels.len().min(FOLDS);
    let mut folds = vec![Fold::new(); count];
    for (k, level) in levels.iter().enumerate() {
        folds[k * count / levels.len()].extend(level.iter().map(|(_, at)| *at));
    }
    folds
}
