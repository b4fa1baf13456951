//! `experiment.toml`: strict, with the line of whatever is wrong.

use super::dialect::{Dialect, Filters};
use super::error::{ExperimentError, Problem};
use super::experiment::{Kind, Prior};
use super::files::{Files, SETTINGS};
use super::filter::Filter;
use super::mapping::{ColumnEntry, Factor, Target};
use super::suspicion;
use super::vocabulary;
use super::written::{Place, PriorEntry, Quantity, Written, parameter_factor};
use crate::effects::EffectDefinition;
use crate::soil_class::SoilClass;
use bekker_modeldescription::Unit;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml::Spanned;

type Quantities = BTreeMap<String, Spanned<Quantity>>;

/// The file as it stands.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    kind: Kind,
    #[serde(default)]
    ignore: Vec<String>,
    #[serde(default)]
    file: Dialect,
    #[serde(default)]
    columns: BTreeMap<String, Spanned<ColumnEntry>>,
    #[serde(default)]
    inputs: Quantities,
    #[serde(default)]
    parameters: Quantities,
    #[serde(default)]
    priors: BTreeMap<String, Spanned<PriorEntry>>,
    soil: Option<SoilTable>,
    model: Option<String>,
    #[serde(default)]
    noise: Quantities,
    #[serde(default)]
    effect: Vec<Spanned<EffectDefinition>>,
    run: Vec<RunTable>,
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
    name: Option<Spanned<String>>,
    group: Option<String>,
    terrain: Option<Spanned<String>>,
    x0: Option<Spanned<f64>>,
    #[serde(default, rename = "where")]
    filters: Filters,
    #[serde(default)]
    inputs: Quantities,
    #[serde(default)]
    parameters: Quantities,
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
        let check = Checker { place: Place { path: &path, text: &text }, kind: file.kind, effects: &effects };
        file.effect.iter().try_for_each(|effect| check.effect(effect))?;
        let parameters = check.parameters(&file.parameters)?;
        let priors = check.priors(&file.priors, &parameters)?;
        let runs: Vec<_> = file.run.iter().map(|run| check.run(run, &file)).collect::<Result<_, _>>()?;
        Ok(Self {
            columns: check.columns(&file)?,
            parameters,
            priors,
            soil_class: file.soil.as_ref().map(|soil| check.soil_class(&soil.class)).transpose()?,
            noise: file.noise.iter().map(|(name, sd)| check.noise(name, sd)).collect::<Result<_, _>>()?,
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

struct Checker<'a> {
    place: Place<'a>,
    kind: Kind,
    effects: &'a [EffectDefinition],
}

impl Checker<'_> {
    fn run(&self, run: &RunTable, file: &File) -> Result<RunSettings, ExperimentError> {
        let kind = self.kind.name();
        let only_traverse = |key: &str, at: usize| {
            let message = format!("only a `traverse` run has `{key}`; this is a `{kind}`");
            Err(self.place.error(key, at, message))
        };
        match (self.kind, &run.terrain, &run.x0) {
            (Kind::SingleWheel, Some(terrain), _) => only_traverse("terrain", terrain.span().start)?,
            (Kind::SingleWheel, None, Some(x0)) => only_traverse("x0", x0.span().start)?,
            _ => {}
        }
        let mut inputs = file.inputs.clone();
        inputs.extend(run.inputs.clone());
        let filters = file.file.filters.iter().chain(&run.filters);
        Ok(RunSettings {
            file: run.file.clone(),
            name: run.name.as_ref().map(|name| self.run_name(name)).transpose()?,
            group: run.group.clone(),
            terrain: run.terrain.as_ref().map(|terrain| terrain.get_ref().clone()),
            x0: run.x0.as_ref().map(|x0| self.finite("x0", *x0.get_ref(), x0.span().start)).transpose()?,
            filters: filters.map(|(column, value)| self.filter(column, value)).collect::<Result<_, _>>()?,
            inputs: inputs.iter().map(|(name, value)| self.input(name, value)).collect::<Result<_, _>>()?,
            parameters: self.parameters(&run.parameters)?,
        })
    }

    /// Runs are written to files of their name, below a folder.
    fn run_name(&self, name: &Spanned<String>) -> Result<String, ExperimentError> {
        let path = Path::new(name.get_ref());
        let inside = path.components().all(|part| matches!(part, std::path::Component::Normal(_)));
        if inside && !name.get_ref().is_empty() {
            return Ok(name.get_ref().clone());
        }
        let message = "expected a name, or a path below the experiment's folder".to_owned();
        Err(self.place.error("name", name.span().start, message))
    }

    fn filter(&self, column: &str, value: &Spanned<toml::Value>) -> Result<Filter, ExperimentError> {
        let refused = |message| self.place.error(&format!("where.{column}"), value.span().start, message);
        Filter::of(column, value.get_ref()).map_err(refused)
    }

    fn input(&self, name: &str, value: &Spanned<Quantity>) -> Result<(String, f64, Factor), ExperimentError> {
        let (key, at) = (format!("inputs.{name}"), value.span().start);
        let (number, symbol) = value.get_ref().parts();
        let unit = self.signal(name).ok_or_else(|| self.unknown_signal(&key, at, name))?;
        let factor = Factor::of_signal(unit, symbol).map_err(|message| self.place.error(&key, at, message))?;
        Ok((name.to_owned(), self.finite(&key, number, at)?, factor))
    }

    fn signal(&self, name: &str) -> Option<Unit> {
        vocabulary::signal_unit(self.kind, name)
    }

    fn unknown_signal(&self, key: &str, at: usize, name: &str) -> ExperimentError {
        let near = vocabulary::alike(self.kind, name);
        let near = if near.is_empty() { String::new() } else { format!("; did you mean {}?", near.join(", ")) };
        let message = format!("`{name}` is no signal of a `{}` experiment{near}", self.kind.name());
        self.place.error(key, at, message)
    }

    fn columns(&self, file: &File) -> Result<Vec<(String, Target, u64)>, ExperimentError> {
        let one = |(name, entry): (&String, &Spanned<ColumnEntry>)| {
            let (key, at) = (format!("columns.{name}"), entry.span().start);
            if file.ignore.contains(name) {
                let message = "the column is also listed under `ignore`".to_owned();
                return Err(self.place.error(&key, at, message));
            }
            let target = Target::of(entry.get_ref(), self.kind, self.effects);
            let target = target.map_err(|message| self.place.error(&key, at, message))?;
            Ok((name.clone(), target, self.place.line(at)))
        };
        file.columns.iter().map(one).collect()
    }

    fn effect(&self, effect: &Spanned<EffectDefinition>) -> Result<(), ExperimentError> {
        let refused = |error| self.place.error("effect", effect.span().start, format!("{error}"));
        effect.get_ref().clone().build().map(|_| ()).map_err(refused)
    }

    fn parameters(&self, numbers: &Quantities) -> Result<BTreeMap<String, f64>, ExperimentError> {
        let one = |(name, value): (&String, &Spanned<Quantity>)| {
            let (key, at) = (format!("parameters.{name}"), value.span().start);
            let (number, unit) = value.get_ref().parts();
            let factor = parameter_factor(name, unit, self.effects);
            let factor = factor.map_err(|message| self.place.error(&key, at, message))?;
            let number = self.finite(&key, number, at)? * factor;
            suspicion::parameter(name, number, self.effects).map_err(|message| self.place.error(&key, at, message))?;
            Ok((name.clone(), number))
        };
        numbers.iter().map(one).collect()
    }

    fn finite(&self, key: &str, number: f64, at: usize) -> Result<f64, ExperimentError> {
        if number.is_finite() {
            return Ok(number);
        }
        Err(self.place.error(key, at, format!("{number} is not a finite number")))
    }

    /// Priors with their means: a deviation alone stands about the value in `[parameters]`.
    fn priors(
        &self,
        priors: &BTreeMap<String, Spanned<PriorEntry>>,
        parameters: &BTreeMap<String, f64>,
    ) -> Result<BTreeMap<String, Prior>, ExperimentError> {
        let prior = |(name, entry): (&String, &Spanned<PriorEntry>)| {
            let (key, at) = (format!("priors.{name}"), entry.span().start);
            let refused = |message: String| self.place.error(&key, at, message);
            let (mean, deviation, unit) = match entry.get_ref() {
                Written::Plain(deviation) => (None, *deviation, None),
                Written::Table(table) => (table.mean, table.sd, table.unit.as_deref()),
            };
            if !deviation.is_finite() || deviation <= 0.0 {
                return Err(refused(format!("a standard deviation is positive and finite, not {deviation}")));
            }
            let factor = parameter_factor(name, unit, self.effects).map_err(refused)?;
            let missing = || {
                refused(format!(
                    "a standard deviation alone needs the mean under [parameters]; or write {{ mean = .., sd = {deviation} }}"
                ))
            };
            let known = || parameters.get(name).copied();
            let prior = Prior {
                mean: mean.map(|mean| mean * factor).or_else(known).ok_or_else(missing)?,
                deviation: deviation * factor,
            };
            if !prior.mean.is_finite() {
                return Err(refused(format!("the mean {} is not a finite number", prior.mean)));
            }
            suspicion::prior(name, prior, self.effects).map_err(refused)?;
            Ok((name.clone(), prior))
        };
        priors.iter().map(prior).collect()
    }

    fn soil_class(&self, class: &Spanned<String>) -> Result<String, ExperimentError> {
        let name = class.get_ref();
        if SoilClass::find(name).is_some() {
            return Ok(name.clone());
        }
        let message = format!("no class of soil is called `{name}`; expected one of {}", SoilClass::names());
        Err(self.place.error("soil.class", class.span().start, message))
    }

    fn noise(&self, name: &str, sd: &Spanned<Quantity>) -> Result<(String, (f64, u64)), ExperimentError> {
        let (key, at) = (format!("noise.{name}"), sd.span().start);
        let (number, symbol) = sd.get_ref().parts();
        // A signal that is none is refused once it is known what the runs measure.
        let factor = match (symbol, self.signal(name)) {
            (Some(symbol), Some(unit)) => {
                unit.factor_of(symbol).map_err(|e| self.place.error(&key, at, e.to_string()))?
            }
            (Some(_), None) => return Err(self.unknown_signal(&key, at, name)),
            (None, _) => 1.0,
        };
        let number = self.finite(&key, number, at)? * factor;
        if number > 0.0 {
            return Ok((name.to_owned(), (number, self.place.line(at))));
        }
        Err(self.place.error(&key, at, format!("a standard deviation is positive, not {number}")))
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
        Some(span) => place.at_line(Place { path, text }.line(span.start)),
        None => place,
    }
}
