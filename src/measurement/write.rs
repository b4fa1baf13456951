//! Writing an experiment folder.

use super::experiment::{Experiment, Kind, Prior, Run};
use super::sensor::Sensor;
use super::share::Share;
use crate::effects::EffectDefinition;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Why an experiment folder cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The system refuses a file or folder.
    #[error("cannot write `{}`: {source}", file.display())]
    File {
        /// The file or folder.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The folder holds an experiment already: what was recorded there is not overwritten.
    #[error("`{}` is there already; give a new folder", file.display())]
    Exists {
        /// The file that is there.
        file: PathBuf,
    },
    /// The settings cannot be written as TOML.
    #[error("`{}`: {source}", file.display())]
    Settings {
        /// The file.
        file: PathBuf,
        /// Why.
        source: toml::ser::Error,
    },
}

/// `experiment.toml` as it is written.
#[derive(Serialize)]
struct File<'a> {
    name: &'a str,
    kind: Kind,
    #[serde(skip_serializing_if = "Option::is_none")]
    model: Option<&'a String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    soil: Option<SoilTable<'a>>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    shared: &'a BTreeMap<Share, String>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    parameters: &'a BTreeMap<String, f64>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    priors: &'a BTreeMap<String, Prior>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    noise: &'a BTreeMap<String, f64>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    sensors: &'a BTreeMap<String, Sensor>,
    run: Vec<RunTable<'a>>,
    #[serde(skip_serializing_if = "<[EffectDefinition]>::is_empty")]
    effect: &'a [EffectDefinition],
}

#[derive(Serialize)]
struct SoilTable<'a> {
    class: &'a str,
}

#[derive(Serialize)]
struct RunTable<'a> {
    file: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    group: Option<&'a String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    terrain: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    x0: Option<f64>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    parameters: &'a BTreeMap<String, f64>,
}

impl Experiment {
    /// Writes `experiment.toml`, a CSV file for each run, named by [`Run::name`], and one for each different ground.
    /// Missing values are empty cells. Folders are made as needed.
    ///
    /// # Errors
    /// [`WriteError`] where a file cannot be written, or `folder` holds an experiment already.
    pub fn write(&self, folder: impl AsRef<Path>) -> Result<(), WriteError> {
        let folder = folder.as_ref();
        let settings = folder.join("experiment.toml");
        if settings.exists() {
            return Err(WriteError::Exists { file: settings });
        }
        let mut grounds = Vec::new();
        let mut tables = Vec::new();
        for run in &self.runs {
            let file = format!("{}.csv", run.name);
            write_run(run, &folder.join(&file))?;
            let terrain = run.terrain.as_ref().map(|ground| {
                let at = grounds.iter().position(|known| *known == ground).unwrap_or_else(|| {
                    grounds.push(ground);
                    grounds.len() - 1
                });
                ground_name(at)
            });
            let (group, x0) = (run.group.as_ref(), run.x0);
            tables.push(RunTable { file, group, terrain, x0, parameters: &run.parameters });
        }
        for (k, ground) in grounds.iter().enumerate() {
            let file = folder.join(ground_name(k));
            ground.save(&file).map_err(|source| WriteError::File { file, source })?;
        }
        let (name, kind, parameters) = (self.name.as_str(), self.kind, &self.parameters);
        let file = File {
            name,
            kind,
            model: self.model.as_ref(),
            soil: self.soil_class.as_deref().map(|class| SoilTable { class }),
            shared: &self.shared,
            parameters,
            priors: &self.priors,
            noise: &self.noise,
            sensors: &self.sensors,
            run: tables,
            effect: &self.effects,
        };
        let text = toml::to_string(&file).map_err(|source| WriteError::Settings { file: settings.clone(), source })?;
        std::fs::write(&settings, text).map_err(|source| WriteError::File { file: settings, source })
    }
}

fn ground_name(k: usize) -> String {
    format!("ground{}.csv", k + 1)
}

fn write_run(run: &Run, file: &Path) -> Result<(), WriteError> {
    let failed = |source| WriteError::File { file: file.to_owned(), source };
    if let Some(parent) = file.parent() {
        std::fs::create_dir_all(parent).map_err(failed)?;
    }
    if run.conditions.is_empty() {
        return run.data.save(file).map_err(failed);
    }
    let broken = |error: csv::Error| failed(error.into());
    let mut csv = csv::Writer::from_path(file).map_err(broken)?;
    let names = run.data.names();
    // The labels stand last: at the start of a line some of them would make a comment of it.
    csv.write_record(names.iter().map(String::as_str).chain(["condition"])).map_err(broken)?;
    for (row, condition) in run.conditions.iter().enumerate() {
        let number = |name: &String| run.data.value(name, row).map_or_else(String::new, |value| format!("{value:?}"));
        let label = std::iter::once(condition.clone().unwrap_or_default());
        csv.write_record(names.iter().map(number).chain(label)).map_err(broken)?;
    }
    csv.flush().map_err(failed)
}
