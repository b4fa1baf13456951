//! Which samples repeat each other.

use super::error::{ExperimentError, Problem};
use super::experiment::{Experiment, Run};
use std::collections::BTreeMap;

/// Inputs of repeats in a group may differ by this share of the input's range over the experiment: rigs hold a load
/// or a slip within a few per cent, and rows that pair wrongly lie further apart. A `condition` is taken at its word.
const REPEAT_TOLERANCE: f64 = 0.1;

/// One row of one run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Sample {
    /// Index of the run.
    pub run: usize,
    /// Index of the row.
    pub row: usize,
}

impl Experiment {
    /// Sets of two or more samples that repeat the same set-point: rows of one index in the runs of a group, or rows
    /// with the same `condition`. Runs whose parameters differ, another wheel or another load cell, do not repeat each other.
    #[must_use]
    pub fn replicates(&self) -> Vec<Vec<Sample>> {
        // Ordered by first appearance, so that reports do not depend on the labels.
        let mut sets: BTreeMap<(usize, String, usize), Vec<Sample>> = BTreeMap::new();
        let rigs = self.rigs();
        for (k, run) in self.runs.iter().enumerate() {
            for row in 0..run.data.rows() {
                let key = match (run.conditions.get(row), &run.group) {
                    (Some(Some(label)), _) => (rigs[k], format!("condition {label}"), 0),
                    (None, Some(group)) => (rigs[k], format!("group {group}"), row),
                    _ => continue,
                };
                sets.entry(key).or_default().push(Sample { run: k, row });
            }
        }
        let mut sets: Vec<_> = sets.into_values().filter(|set| set.len() > 1).collect();
        sets.sort();
        sets
    }

    /// For each run the first one that was made with the same parameters.
    pub(crate) fn rigs(&self) -> Vec<usize> {
        let effective = |run: &Run| {
            let mut all = self.parameters.clone();
            all.extend(run.parameters.clone());
            all
        };
        let all: Vec<BTreeMap<String, f64>> = self.runs.iter().map(effective).collect();
        all.iter().enumerate().map(|(k, own)| all.iter().position(|other| other == own).unwrap_or(k)).collect()
    }

    /// Fails where runs of one group have unequal counts of rows, or where a set of repeats has unlike inputs.
    pub(super) fn check_groups(&self) -> Result<(), ExperimentError> {
        for run in &self.runs {
            let Some(group) = &run.group else { continue };
            if !run.conditions.is_empty() {
                let message =
                    format!("the run has a `condition` column and belongs to group `{group}`; give one of them");
                return Err(refuse(run, message));
            }
            if let Some(first) = self.runs.iter().find(|other| other.group == run.group)
                && first.data.rows() != run.data.rows()
            {
                let (rows, others) = (run.data.rows(), first.data.rows());
                let message = format!("{rows} rows, where {} of the same group `{group}` has {others}", first.name);
                return Err(refuse(run, message));
            }
        }
        self.kind.format().check_repeats(self)
    }

    /// Fails where one of these inputs differs within a set of repeats by more than rigs hold it.
    pub(super) fn check_inputs_of_repeats(&self, inputs: &[&str]) -> Result<(), ExperimentError> {
        for name in inputs {
            let all = self.runs.iter().flat_map(|run| run.data.column(name).unwrap_or_default());
            let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
            for set in self.replicates().iter().filter(|set| self.runs[set[0].run].conditions.is_empty()) {
                let value = |s: &Sample| self.runs[s.run].data.value(name, s.row).unwrap_or(f64::NAN);
                let allowed = REPEAT_TOLERANCE * (high - low).max(value(&set[0]).abs());
                if let Some(odd) = set.iter().find(|s| (value(s) - value(&set[0])).abs() > allowed) {
                    let (run, first) = (&self.runs[odd.run], &self.runs[set[0].run]);
                    let message = format!(
                        "row {} has {name} {}, where row {} of {}, which it is said to repeat, has {}",
                        odd.row + 1,
                        value(odd),
                        set[0].row + 1,
                        first.name,
                        value(&set[0])
                    );
                    return Err(refuse(run, message));
                }
            }
        }
        Ok(())
    }
}

fn refuse(run: &Run, message: String) -> ExperimentError {
    ExperimentError::in_file(&run.file, Problem::NotARepeat(message))
}
