//! Checks of the entries of `experiment.toml`: numbers, units, names.

use super::error::ExperimentError;
use super::experiment::{Kind, Prior};
use super::filter::Filter;
use super::mapping::{ColumnEntry, Factor, Target};
use super::settings::{File, Priors, Quantities, RunSettings, RunTable};
use super::suspicion;
use super::vocabulary;
use super::written::{PriorEntry, Quantity, SettingsText, parameter_factor};
use crate::effects::EffectDefinition;
use crate::soil_class::SoilClass;
use bekker_modeldescription::Unit;
use std::collections::BTreeMap;
use std::path::Path;
use toml::Spanned;

/// Checks single entries; errors name the key and its line.
pub(super) struct Checker<'a> {
    pub text: SettingsText<'a>,
    pub kind: Kind,
    /// Effects of the user's own, whose parameters have units too.
    pub effects: &'a [EffectDefinition],
}

impl Checker<'_> {
    pub fn run(&self, run: &RunTable, file: &File) -> Result<RunSettings, ExperimentError> {
        let kind = self.kind.name();
        let only_traverse = |key: &str, at: usize| {
            let message = format!("only a `traverse` run has `{key}`; this is a `{kind}`");
            Err(self.text.error(key, at, message))
        };
        match (&run.terrain, &run.x0) {
            _ if self.kind.format().has_course() => {}
            (Some(terrain), _) => only_traverse("terrain", terrain.span().start)?,
            (None, Some(x0)) => only_traverse("x0", x0.span().start)?,
            (None, None) => {}
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
        Err(self.text.error("name", name.span().start, message))
    }

    fn filter(&self, column: &str, value: &Spanned<toml::Value>) -> Result<Filter, ExperimentError> {
        let refused = |message| self.text.error(&format!("where.{column}"), value.span().start, message);
        Filter::of(column, value.get_ref()).map_err(refused)
    }

    fn input(&self, name: &str, value: &Spanned<Quantity>) -> Result<(String, f64, Factor), ExperimentError> {
        let (key, at) = (format!("inputs.{name}"), value.span().start);
        let (number, symbol) = value.get_ref().parts();
        let unit = self.signal(name).ok_or_else(|| self.unknown_signal(&key, at, name))?;
        let factor = Factor::of_signal(unit, symbol).map_err(|message| self.text.error(&key, at, message))?;
        Ok((name.to_owned(), self.finite(&key, number, at)?, factor))
    }

    pub fn signal(&self, name: &str) -> Option<Unit> {
        self.kind.format().signal_unit(name)
    }

    pub fn unknown_signal(&self, key: &str, at: usize, name: &str) -> ExperimentError {
        let near = vocabulary::alike(self.kind, name);
        let near = if near.is_empty() { String::new() } else { format!("; did you mean {}?", near.join(", ")) };
        let message = format!("`{name}` is no signal of a `{}` experiment{near}", self.kind.name());
        self.text.error(key, at, message)
    }

    pub fn columns(&self, file: &File) -> Result<Vec<(String, Target, u64)>, ExperimentError> {
        let one = |(name, entry): (&String, &Spanned<ColumnEntry>)| {
            let (key, at) = (format!("columns.{name}"), entry.span().start);
            if file.ignore.contains(name) {
                let message = "the column is also listed under `ignore`".to_owned();
                return Err(self.text.error(&key, at, message));
            }
            let target = Target::of(entry.get_ref(), self.kind, self.effects);
            let target = target.map_err(|message| self.text.error(&key, at, message))?;
            Ok((name.clone(), target, self.text.line(at)))
        };
        file.columns.iter().map(one).collect()
    }

    pub fn effect(&self, effect: &Spanned<EffectDefinition>) -> Result<(), ExperimentError> {
        let refused = |error| self.text.error("effect", effect.span().start, format!("{error}"));
        effect.get_ref().clone().build().map(|_| ()).map_err(refused)
    }

    pub fn parameters(&self, numbers: &Quantities) -> Result<BTreeMap<String, f64>, ExperimentError> {
        let one = |(name, value): (&String, &Spanned<Quantity>)| {
            let (key, at) = (format!("parameters.{name}"), value.span().start);
            let (number, unit) = value.get_ref().parts();
            let factor = parameter_factor(name, unit, self.effects);
            let factor = factor.map_err(|message| self.text.error(&key, at, message))?;
            let number = self.finite(&key, number, at)? * factor;
            suspicion::parameter(name, number, self.effects).map_err(|message| self.text.error(&key, at, message))?;
            Ok((name.clone(), number))
        };
        numbers.iter().map(one).collect()
    }

    fn finite(&self, key: &str, number: f64, at: usize) -> Result<f64, ExperimentError> {
        if number.is_finite() {
            return Ok(number);
        }
        Err(self.text.error(key, at, format!("{number} is not a finite number")))
    }

    /// Priors with their means: a deviation alone stands about the value in `[parameters]`.
    pub fn priors(
        &self,
        priors: &Priors,
        parameters: &BTreeMap<String, f64>,
    ) -> Result<BTreeMap<String, Prior>, ExperimentError> {
        let prior = |(name, entry): (&String, &Spanned<PriorEntry>)| {
            let (key, at) = (format!("priors.{name}"), entry.span().start);
            let refused = |message: String| self.text.error(&key, at, message);
            let (mean, deviation, unit) = entry.get_ref().parts().map_err(refused)?;
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

    pub fn soil_class(&self, class: &Spanned<String>) -> Result<String, ExperimentError> {
        let name = class.get_ref();
        if SoilClass::find(name).is_some() {
            return Ok(name.clone());
        }
        let message = format!("no class of soil is called `{name}`; expected one of {}", SoilClass::names());
        Err(self.text.error("soil.class", class.span().start, message))
    }

    pub fn noise(&self, name: &str, sd: &Spanned<Quantity>) -> Result<(String, (f64, u64)), ExperimentError> {
        let (key, at) = (format!("noise.{name}"), sd.span().start);
        let (number, symbol) = sd.get_ref().parts();
        // A signal that is none is refused once it is known what the runs measure.
        let factor = match (symbol, self.signal(name)) {
            (Some(symbol), Some(unit)) => {
                unit.factor_of(symbol).map_err(|e| self.text.error(&key, at, e.to_string()))?
            }
            (Some(_), None) => return Err(self.unknown_signal(&key, at, name)),
            (None, _) => 1.0,
        };
        let number = self.finite(&key, number, at)? * factor;
        if number > 0.0 {
            return Ok((name.to_owned(), (number, self.text.line(at))));
        }
        Err(self.text.error(&key, at, format!("a standard deviation is positive, not {number}")))
    }
}
