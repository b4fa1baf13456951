//! What the variables that a model computes depend on, for the model structure of both versions of the standard.

use super::{Causality, Description, Entry};

impl Description {
    /// Whether an entry is a continuous state.
    fn is_state(&self, reference: usize) -> bool {
        self.entries.iter().any(|entry| entry.derivative_of == Some(reference))
    }

    /// References on which an entry depends at the same instant: inputs and continuous states.
    #[must_use]
    pub fn dependencies(&self, entry: &Entry) -> Vec<usize> {
        let known = |(reference, other): (usize, &Entry)| {
            (other.causality == Causality::Input || self.is_state(reference)).then_some(reference)
        };
        entry.dependencies.clone().unwrap_or_else(|| self.entries.iter().enumerate().filter_map(known).collect())
    }

    /// References on which an entry depends at the start: parameters, all of them, and inputs. `None` where the entry does
    /// not say on which inputs, so that a tool must assume all.
    pub(super) fn initial_dependencies(&self, entry: &Entry) -> Option<Vec<usize>> {
        let inputs = entry.initial_dependencies.as_ref()?;
        let entries = self.entries.iter().enumerate();
        let parameters = entries.filter(|(_, other)| other.causality == Causality::Parameter);
        Some(parameters.map(|(reference, _)| reference).chain(inputs.iter().copied()).collect())
    }

    /// The references under which FMI 3.0 shows `references`, each once.
    pub(super) fn shown_references(&self, references: &[usize]) -> Vec<usize> {
        let mut shown: Vec<usize> = references.iter().map(|reference| self.arrays.shown(*reference).0).collect();
        shown.sort_unstable();
        shown.dedup();
        shown
    }
}
