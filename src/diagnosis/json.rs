//! The JSON of a diagnosis: a stable interface, see `result.schema.json`.

use super::diagnose::Diagnosis;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A diagnosis with what follows from it.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    diagnosis: &'a Diagnosis,
    #[serde(rename = "where", skip_serializing_if = "BTreeMap::is_empty")]
    places: BTreeMap<&'a str, Vec<&'a str>>,
    next_experiment: String,
    improved_is: String,
}

impl Diagnosis {
    /// The diagnosis as JSON. Numbers that are not finite are null.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let (next_experiment, improved_is) = (self.next_experiment(), self.improved_is());
        json!(Document { diagnosis: self, places: self.named_places(), next_experiment, improved_is })
    }
}
