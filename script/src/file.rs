//! The file's own shape, before anything in it has a meaning.

use serde::Deserialize;
use std::collections::BTreeMap;

/// A script as it is written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub name: Option<String>,
    pub model: toml::Value,
    pub interval: f64,
    pub duration: f64,
    pub seed: Option<u32>,
    #[serde(default)]
    pub reset_after: f64,
    pub inputs: Option<toml::Value>,
    pub actions: Option<toml::Value>,
    pub action_scale: Option<f64>,
    pub expect: Expect,
}

/// What a script expects, as it is written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Expect {
    pub status: Option<String>,
    pub ends_within: Option<[f64; 2]>,
    pub signals: Option<toml::Value>,
    #[serde(default)]
    pub tolerance: BTreeMap<String, Allowed>,
    #[serde(default)]
    pub range: BTreeMap<String, [f64; 2]>,
    pub record: Option<Vec<String>>,
    pub record_every: Option<f64>,
}

/// A tolerance as it is written: absolute alone, or both parts.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(untagged, expecting = "expected a number, or a table of `absolute` and `relative`")]
pub(super) enum Allowed {
    Absolute(f64),
    Parts(Parts),
}

/// Both parts of a tolerance.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Parts {
    pub absolute: f64,
    pub relative: f64,
}
