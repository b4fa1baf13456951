//! Which parameters a model states, as against those that keep a built-in value.

use super::Model;
use bekker_modeldescription::Lookup;
use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

/// Names of the parameters that a model file lists under `[parameters]`, or that were stated otherwise.
///
/// They do not act in a simulation. A comparison with an experiment asks for them: what a model states goes before the
/// experiment's own `[parameters]`, what it merely has by default does not.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct Stated(Arc<BTreeSet<String>>);

impl Stated {
    /// Whether `name` is stated.
    #[must_use]
    pub fn contains(&self, name: &str) -> bool {
        self.0.contains(name)
    }

    /// All names, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(String::as_str)
    }

    /// Adds a name.
    pub fn insert(&mut self, name: &str) {
        Arc::make_mut(&mut self.0).insert(name.to_owned());
    }
}

impl<T: Into<String>> FromIterator<T> for Stated {
    fn from_iter<I: IntoIterator<Item = T>>(names: I) -> Self {
        Self(Arc::new(names.into_iter().map(Into::into).collect()))
    }
}

/// The same text whatever is stated: the fingerprint of a model (see [`snapshot`](crate::snapshot)) is taken from its text,
/// and a run may go on in a model that only states other names.
impl fmt::Debug for Stated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Stated")
    }
}

impl Model {
    /// Makes every parameter count as stated, as if this model had been written to a file and read back.
    pub fn state_all(&mut self) {
        self.stated = self.list().into_iter().map(|(variable, _)| variable.name).collect();
    }
}
