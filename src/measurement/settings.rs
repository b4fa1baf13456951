//! `experiment.toml`: strict, with the line of whatever is wrong.

use super::checker::Checker;
use super::dialect::{Dialect, Filters};
use super::error::{ExperimentError, Problem};
use super::experiment::{Kind, Prior};
use super::files::{Files, SETTINGS};
use super::filter::Filter;
use super::mapping::{ColumnEntry, Factor, Target};
use super::sensor::{Sensor, SensorTable};
use super::share::Share;
use super::written::{PriorEntry, Quantity, SettingsText};
use crate::effects::EffectDefinition;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml::Spanned;

pub(super) type Quantities = BTreeMap<String, Spanned<Quantity>>;
pub(super) type Priors = BTreeMap<String, Spanned<PriorEntry>>;

/// The file as it stands.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub name: String,
    pub kind: Kind,
    #[serde(default)]
    pub ignore: Vec<String>,
    #[serde(default)]
    pub file: Dialect,
    #[serde(default)]
    pub columns: BTreeMap<String, Spanned<ColumnEntry>>,
    #[serde(default)]
    pub inputs: Quantities,
    #[serde(default)]
    pub parameters: Quantities,
    #[serde(default)]
    pub priors: Priors,
    pub soil: Option<SoilTable>,
    #[serde(default)]
    pub shared: BTreeMap<Share, String>,
    pub model: Option<String>,
    #[serde(default)]
    pub noise: Quantities,
    #[serde(default)]
    pub sensors: BTreeMap<String, Spanned<SensorTable>>,
    #[serde(default)]
    pub effect: Vec<Spanned<EffectDefinition>>,
    pub run: Vec<RunTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SoilTable {
    pub class: Spanned<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RunTable {
    pub file: String,
    pub name: Option<Spanned<String>>,
    pub group: Option<String>,
    pub terrain: Option<Spanned<String>>,
    pub x0: Option<Spanned<f64>>,
    #[serde(default, rename = "where")]
    pub filters: Filters,
    #[serde(default)]
    pub inputs: Quantities,
    #[serde(default)]
    pub parameters: Quantities,
}

/// The checked settings of an experiment.
pub(super) struct Settings {
    pub file: PathBuf,
    pub name: String,
    pub kind: Kind,
    pub ignore: Vec<String>,
    pub dialect: Dialect,
    /// Column, what it becomes, and the line on which that stands.
    pub columns: Vec<(String, Target, u64)>,
    pub parameters: BTreeMap<String, f64>,
    pub priors: BTreeMap<String, Prior>,
    pub soil_class: Option<String>,
    pub shared: BTreeMap<Share, String>,
    pub model: Option<String>,
    /// Standard deviation and the line on which it stands.
    pub noise: BTreeMap<String, (f64, u64)>,
    /// Errors of sensors by signal, and the line on which they stand.
    pub sensors: BTreeMap<String, (Sensor, u64)>,
    /// Candidates of the user's own.
    pub effects: Vec<EffectDefinition>,
    pub runs: Vec<RunSettings>,
}

/// The checked settings of one run.
pub(super) struct RunSettings {
    pub file: String,
    pub name: Option<String>,
    pub group: Option<String>,
    pub terrain: Option<String>,
    pub x0: Option<f64>,
    pub filters: Vec<Filter>,
    /// Inputs that stay the same in all rows, those of the whole experiment included: name, number and its unit.
    pub inputs: Vec<(String, f64, Factor)>,
    pub parameters: BTreeMap<String, f64>,
}

impl Settings {
    /// Whether a column is not for the model; a `*` at the end of an entry stands for any end of a name.
    pub fn ignores(&self, column: &str) -> bool {
        self.ignore.iter().any(|entry| match entry.strip_suffix('*') {
            Some(start) => column.starts_with(start),
            None => entry == column,
        })
    }
}

impl Settings {
    pub fn read(files: &Files) -> Result<Self, ExperimentError> {
        let (path, text) = (files.path(SETTINGS), files.text(SETTINGS)?);
        let file: File = toml::from_str(&text).map_err(|e| not_toml(&path, &text, &e))?;
        if file.run.is_empty() {
            let problem = Problem::Setting("at least one [[run]] is needed".to_owned());
            return Err(ExperimentError::in_file(&path, problem));
        }
        let effects: Vec<_> = file.effect.iter().map(Spanned::get_ref).cloned().collect();
        let check = Checker { text: SettingsText { path: &path, text: &text }, kind: file.kind, effects: &effects };
        file.effect.iter().try_for_each(|effect| check.effect(effect))?;
        let parameters = check.parameters(&file.parameters)?;
        let priors = check.priors(&file.priors, &parameters)?;
        let runs: Vec<_> = file.run.iter().map(|run| check.run(run, &file)).collect::<Result<_, _>>()?;
        Ok(Self {
            columns: check.columns(&file)?,
            parameters,
            priors,
            soil_class: file.soil.as_ref().map(|soil| check.soil_class(&soil.class)).transpose()?,
            shared: file.shared,
            noise: file.noise.iter().map(|(name, sd)| check.noise(name, sd)).collect::<Result<_, _>>()?,
            sensors: check.sensors(&file.sensors)?,
            runs,
            name: file.name,
            kind: file.kind,
            ignore: file.ignore,
            dialect: file.file,
            model: file.model,
            effects,
            file: path.clone(),
        })
    }
}

fn not_toml(path: &Path, text: &str, error: &toml::de::Error) -> ExperimentError {
    let mut message = error.message().to_owned();
    // `wheel.radius = 0.1` is a table `wheel` with a key `radius`.
    if message.contains("invalid type: map") || message.contains("expected `value` or `unit`") {
        message.push_str(" (names with a dot are quoted: \"wheel.radius\" = 0.1)");
    }
    let place = ExperimentError::in_file(path, Problem::Setting(message));
    match error.span() {
        Some(span) => place.at_line(SettingsText { path, text }.line(span.start)),
        None => place,
    }
}
