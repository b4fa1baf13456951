//! Several experiments on one soil as one experiment.
//!
//! The runs of all parts stand side by side. Each part keeps its own: what it measures is called `part.signal`, so that every part has
//! noise of its own; what is known of its rig goes with each of its runs; groups of repeats and labels of conditions are its own too.

use super::experiment::{Experiment, Kind, Run};
use super::table::Table;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

/// Why experiments cannot be joined.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum JointError {
    /// There is nothing to join.
    #[error("at least two experiments are joined, found {0}")]
    TooFew(usize),
    /// A part is itself several experiments.
    #[error("`{0}` is several experiments already: give each of them by itself")]
    Nested(String),
}

/// One of the experiments that are joined.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Short name, with which signals, runs and parameters of this part begin or end: that of its folder.
    pub name: String,
    /// The experiment as it was read.
    pub experiment: Experiment,
}

impl Experiment {
    /// Joins experiments on one soil. They are named by their folders, with a number where two are alike.
    ///
    /// # Errors
    /// [`JointError`] for fewer than two, or one that is joined already.
    pub fn joint(experiments: Vec<Self>) -> Result<Self, JointError> {
        let mut named: Vec<(String, Self)> = Vec::new();
        for experiment in experiments {
            let name = unlike(&short_name(&experiment), &named);
            named.push((name, experiment));
        }
        Self::joint_named(named)
    }

    /// The same under names that are given; they are different, and in letters, digits, `_` and `-`.
    ///
    /// # Errors
    /// As [`joint`](Self::joint).
    pub fn joint_named(experiments: Vec<(String, Self)>) -> Result<Self, JointError> {
        if experiments.len() < 2 {
            return Err(JointError::TooFew(experiments.len()));
        }
        if let Some((_, nested)) = experiments.iter().find(|(_, experiment)| !experiment.parts.is_empty()) {
            return Err(JointError::Nested(nested.name.clone()));
        }
        let parts: Vec<Part> = experiments.into_iter().map(|(name, experiment)| Part { name, experiment }).collect();
        let names: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
        Ok(Self {
            name: names.join(" + "),
            kind: parts[0].experiment.kind,
            folder: PathBuf::new(),
            parameters: BTreeMap::new(),
            priors: BTreeMap::new(),
            shared: BTreeMap::new(),
            soil_class: parts.iter().find_map(|part| part.experiment.soil_class.clone()),
            model: None,
            noise: parts.iter().flat_map(Part::noise).collect(),
            sensors: BTreeMap::new(),
            effects: Vec::new(),
            runs: parts.iter().flat_map(Part::runs).collect(),
            doubts: parts.iter().flat_map(Part::doubts).collect(),
            parts,
        })
    }

    /// Where the runs of each part stand; nothing where there are no parts.
    #[must_use]
    pub fn runs_of_parts(&self) -> Vec<Range<usize>> {
        let mut end = 0;
        let range = |part: &Part| {
            let start = end;
            end += part.experiment.runs.len();
            start..end
        };
        self.parts.iter().map(range).collect()
    }

    /// A run as it was read: of several experiments that of its part, whose signals have no other name before their own.
    pub(crate) fn recorded_run(&self, run: usize) -> &Run {
        let mut parts = self.parts.iter().zip(self.runs_of_parts());
        let own = parts.find(|(_, runs)| runs.contains(&run));
        own.map_or(&self.runs[run], |(part, runs)| &part.experiment.runs[run - runs.start])
    }

    /// Kind of the experiment that a run is of.
    pub(crate) fn kind_of_run(&self, run: usize) -> Kind {
        let mut parts = self.parts.iter().zip(self.runs_of_parts());
        parts.find(|(_, runs)| runs.contains(&run)).map_or(self.kind, |(part, _)| part.experiment.kind)
    }

    /// The same with some of the runs only, by their index in rising order.
    #[must_use]
    pub fn with_runs(&self, runs: &[usize]) -> Self {
        let mut part = self.clone();
        part.runs = runs.iter().map(|run| self.runs[*run].clone()).collect();
        for (own, range) in part.parts.iter_mut().zip(self.runs_of_parts()) {
            let kept: Vec<usize> = runs.iter().filter(|run| range.contains(run)).map(|run| run - range.start).collect();
            own.experiment = own.experiment.with_runs(&kept);
        }
        part
    }
}

impl Part {
    /// Name of one of its signals among those of all parts.
    #[must_use]
    pub fn signal(&self, signal: &str) -> String {
        format!("{}.{signal}", self.name)
    }

    /// Name that a signal of all parts has in this one; `None` where it is another part's.
    #[must_use]
    pub fn own<'a>(&self, signal: &'a str) -> Option<&'a str> {
        signal.strip_prefix(self.name.as_str())?.strip_prefix('.')
    }

    fn noise(&self) -> impl Iterator<Item = (String, f64)> {
        self.experiment.noise.iter().map(|(signal, deviation)| (self.signal(signal), *deviation))
    }

    fn doubts(&self) -> impl Iterator<Item = String> {
        self.experiment.doubts.iter().map(|doubt| format!("{}: {doubt}", self.name))
    }

    fn runs(&self) -> impl Iterator<Item = Run> {
        self.experiment.runs.iter().map(|run| {
            let mut parameters = self.experiment.parameters.clone();
            parameters.extend(run.parameters.clone());
            let own = |name: &String| format!("{}/{name}", self.name);
            Run {
                name: own(&run.name),
                group: run.group.as_ref().map(own),
                parameters,
                data: self.renamed(run),
                conditions: run.conditions.iter().map(|label| label.as_ref().map(own)).collect(),
                measured: run.measured.iter().map(|signal| self.signal(signal)).collect(),
                ..run.clone()
            }
        })
    }

    /// The columns of a run, of which those that count as measured get the name among all parts.
    fn renamed(&self, run: &Run) -> Table {
        let name =
            |name: &str| if run.measured.iter().any(|own| own == name) { self.signal(name) } else { name.to_owned() };
        run.data.renamed(name)
    }
}

/// The folder's name or, of an experiment made in memory, its own, in letters, digits, `_` and `-`.
fn short_name(experiment: &Experiment) -> String {
    let folder = experiment.folder.file_name().map(|name| name.to_string_lossy().into_owned());
    let name = folder.unwrap_or_else(|| experiment.name.clone());
    let plain = |c: char| if c.is_alphanumeric() || c == '_' || c == '-' { c } else { '_' };
    let name: String = name.chars().map(plain).collect();
    if name.is_empty() { "experiment".to_owned() } else { name }
}

/// `name`, with a number where a part has it already.
fn unlike(name: &str, parts: &[(String, Experiment)]) -> String {
    let taken = |name: &str| parts.iter().any(|(known, _)| known == name);
    let numbered = (2..).map(|number| format!("{name}_{number}"));
    std::iter::once(name.to_owned()).chain(numbered).find(|name| !taken(name)).unwrap_or_default()
}
