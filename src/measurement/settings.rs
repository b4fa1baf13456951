//! `experiment.toml`: strict, with the line of whatever is wrong.

use super::error::{ExperimentError, Problem};
use super::experiment::{Kind, Prior};
use super::files::{Files, SETTINGS};
use crate::effects::EffectDefinition;
use crate::soil_class::SoilClass;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml::Spanned;

type Numbers = BTreeMap<String, Spanned<f64>>;

/// The file as it stands.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    kind: Kind,
    #[serde(default)]
    ignore: Vec<String>,
    #[serde(default)]
    parameters: Numbers,
    #[serde(default)]
    priors: BTreeMap<String, Spanned<PriorEntry>>,
    soil: Option<SoilTable>,
    model: Option<String>,
    #[serde(default)]
    noise: Numbers,
    #[serde(default)]
    effect: Vec<Spanned<EffectDefinition>>,
    run: Vec<RunTable>,
}

/// A prior as it is written: with its mean, or as a deviation about the value in `[parameters]`.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected { mean = number, sd = number }, or a standard deviation alone")]
enum PriorEntry {
    Deviation(f64),
    Whole(Prior),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SoilTable {
    class: Spanned<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RunTable {
    file: String,
    group: Option<String>,
    terrain: Option<Spanned<String>>,
    x0: Option<Spanned<f64>>,
    #[serde(default)]
    parameters: Numbers,
}

/// The checked settings of an experiment.
pub(super) struct Settings {
    pub file: PathBuf,
    pub name: String,
    pub kind: Kind,
    pub ignore: Vec<String>,
    pub parameters: BTreeMap<String, f64>,
    pub priors: BTreeMap<String, Prior>,
    pub soil_class: Option<String>,
    pub model: Option<String>,
    /// Standard deviation and the line on which it stands.
    pub noise: BTreeMap<String, (f64, u64)>,
    /// Candidates of the user's own.
    pub effects: Vec<EffectDefinition>,
    pub runs: Vec<RunSettings>,
}

/// The checked settings of one run.
pub(super) struct RunSettings {
    pub file: String,
    pub group: Option<String>,
    pub terrain: Option<String>,
    pub x0: Option<f64>,
    pub parameters: BTreeMap<String, f64>,
}

impl Settings {
    pub fn read(files: &Files) -> Result<Self, ExperimentError> {
        let (path, text) = (files.path(SETTINGS), files.text(SETTINGS)?);
        let file: File = toml::from_str(&text).map_err(|e| not_toml(&path, &text, &e))?;
        if file.run.is_empty() {
            let problem = Problem::Setting("at least one [[run]] is needed".to_owned());
            return Err(ExperimentError::in_file(&path, problem));
        }
        let check = Checker { path: &path, text: &text };
        let noise = file.noise.iter().map(|(name, sd)| {
            Ok((name.clone(), (check.positive("noise", name, sd)?, line_of(&text, sd.span().start))))
        });
        let priors = check.priors(&file)?;
        Ok(Self {
            name: file.name,
            kind: file.kind,
            ignore: file.ignore,
            parameters: check.numbers("parameters", &file.parameters)?,
            priors,
            soil_class: file.soil.as_ref().map(|soil| check.soil_class(&soil.class)).transpose()?,
            model: file.model,
            noise: noise.collect::<Result<_, _>>()?,
            effects: file.effect.into_iter().map(|effect| check.effect(effect)).collect::<Result<_, _>>()?,
            runs: file.run.into_iter().map(|run| check.run(file.kind, run)).collect::<Result<_, _>>()?,
            file: path.clone(),
        })
    }
}

struct Checker<'a> {
    path: &'a Path,
    text: &'a str,
}

impl Checker<'_> {
    fn run(&self, kind: Kind, run: RunTable) -> Result<RunSettings, ExperimentError> {
        let parameters = self.numbers("parameters", &run.parameters)?;
        let only_traverse = |key: &str, at: usize| {
            self.error(key, at, format!("only a `traverse` run has `{key}`; this is a `{}`", kind.name()))
        };
        if kind == Kind::SingleWheel {
            if let Some(terrain) = &run.terrain {
                return Err(only_traverse("terrain", terrain.span().start));
            }
            if let Some(x0) = &run.x0 {
                return Err(only_traverse("x0", x0.span().start));
            }
        }
        Ok(RunSettings {
            file: run.file,
            group: run.group,
            terrain: run.terrain.map(Spanned::into_inner),
            x0: run.x0.map(|x0| self.finite("x0", &x0)).transpose()?,
            parameters,
        })
    }

    fn effect(&self, effect: Spanned<EffectDefinition>) -> Result<EffectDefinition, ExperimentError> {
        let at = effect.span().start;
        let definition = effect.into_inner();
        match definition.clone().build() {
            Ok(_) => Ok(definition),
            Err(refused) => Err(self.error("effect", at, refused.to_string())),
        }
    }

    fn numbers(&self, table: &str, numbers: &Numbers) -> Result<BTreeMap<String, f64>, ExperimentError> {
        numbers
            .iter()
            .map(|(name, value)| Ok((name.clone(), self.finite(&format!("{table}.{name}"), value)?)))
            .collect()
    }

    fn finite(&self, key: &str, value: &Spanned<f64>) -> Result<f64, ExperimentError> {
        let number = *value.get_ref();
        if number.is_finite() {
            return Ok(number);
        }
        Err(self.error(key, value.span().start, format!("{number} is not a finite number")))
    }

    /// Priors with their means: a deviation alone stands about the value in `[parameters]`.
    fn priors(&self, file: &File) -> Result<BTreeMap<String, Prior>, ExperimentError> {
        let prior = |(name, entry): (&String, &Spanned<PriorEntry>)| {
            let (key, at) = (format!("priors.{name}"), entry.span().start);
            let prior = match entry.get_ref() {
                PriorEntry::Whole(prior) => *prior,
                PriorEntry::Deviation(deviation) => {
                    let mean = file.parameters.get(name).map(|value| *value.get_ref());
                    let missing = || {
                        let message = format!(
                            "a standard deviation alone needs the mean under [parameters]; or write {{ mean = .., sd = {deviation} }}"
                        );
                        self.error(&key, at, message)
                    };
                    Prior { mean: mean.ok_or_else(missing)?, deviation: *deviation }
                }
            };
            if !prior.mean.is_finite() {
                return Err(self.error(&key, at, format!("the mean {} is not a finite number", prior.mean)));
            }
            if !prior.deviation.is_finite() || prior.deviation <= 0.0 {
                let message = format!("a standard deviation is positive and finite, not {}", prior.deviation);
                return Err(self.error(&key, at, message));
            }
            Ok((name.clone(), prior))
        };
        file.priors.iter().map(prior).collect()
    }

    fn soil_class(&self, class: &Spanned<String>) -> Result<String, ExperimentError> {
        let name = class.get_ref();
        if SoilClass::find(name).is_some() {
            return Ok(name.clone());
        }
        let message = format!("no class of soil is called `{name}`; expected one of {}", SoilClass::names());
        Err(self.error("soil.class", class.span().start, message))
    }

    fn positive(&self, table: &str, name: &str, value: &Spanned<f64>) -> Result<f64, ExperimentError> {
        let key = format!("{table}.{name}");
        let number = self.finite(&key, value)?;
        if number > 0.0 {
            return Ok(number);
        }
        Err(self.error(&key, value.span().start, format!("a standard deviation is positive, not {number}")))
    }

    fn error(&self, key: &str, at: usize, message: String) -> ExperimentError {
        ExperimentError::in_file(self.path, Problem::Setting(message)).at_line(line_of(self.text, at)).at_column(key)
    }
}

fn not_toml(path: &Path, text: &str, error: &toml::de::Error) -> ExperimentError {
    let mut message = error.message().to_owned();
    if message.contains("invalid type: map") {
        message.push_str(" (names with a dot are quoted: \"wheel.radius\" = 0.1)");
    }
    let place = ExperimentError::in_file(path, Problem::Setting(message));
    match error.span() {
        Some(span) => place.at_line(line_of(text, span.start)),
        None => place,
    }
}

/// Line of a byte offset, counted from 1.
fn line_of(text: &str, at: usize) -> u64 {
    text.as_bytes()[..at.min(text.len())].iter().filter(|byte| **byte == b'\n').count() as u64 + 1
}
