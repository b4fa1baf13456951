//! The model that a run was started from.

use super::Model;
use crate::snapshot::Fingerprint;
use std::sync::{Arc, OnceLock};

/// A model that does not change any more, shared by a run and its clones, and its fingerprint once that is asked for.
#[derive(Clone, Debug)]
pub(super) struct Origin(Arc<Kept>);

#[derive(Debug)]
struct Kept {
    model: Model,
    fingerprint: OnceLock<Fingerprint>,
}

impl Origin {
    pub fn new(model: &Model) -> Self {
        Self(Arc::new(Kept { model: model.clone(), fingerprint: OnceLock::new() }))
    }

    pub fn model(&self) -> &Model {
        &self.0.model
    }

    pub fn fingerprint(&self) -> Fingerprint {
        *self.0.fingerprint.get_or_init(|| Fingerprint::of(&self.0.model))
    }
}
