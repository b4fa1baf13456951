//! The definition of an effect in TOML, and its check.

use super::parse::{MAX_LENGTH, Names, Problem, is_taken, parse};
use super::program::{MAX_STACK, Program};
use super::target::{Mode, TARGETS, Target};
use super::{CustomEffect, Shared};
use bekker_modeldescription::{Role, Unit, Variable};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// How far from neutral rounding may leave an expression at its neutral parameters.
const NEUTRAL_TOLERANCE: f64 = 1e-12;

/// Points, spread over the ranges of the signals, at which an expression is tried out.
const TRIALS: u32 = 32;

/// An effect as its user writes it; the form is described in the [module](super).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EffectDefinition {
    /// Id, in snake_case; its parameters are called `<id>.<name>`.
    pub id: String,
    /// One line of meaning.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub about: String,
    /// What it acts on, for example `body.force_x`.
    pub target: String,
    /// How it changes a parameter of soil or wheel; other targets are always added to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mode: Option<Mode>,
    /// The term.
    pub expression: String,
    /// Its parameters.
    pub parameters: BTreeMap<String, ParameterDefinition>,
}

/// A parameter of an effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterDefinition {
    /// Default. With all parameters at these values the effect changes nothing.
    pub neutral: f64,
    /// Smallest allowed value.
    pub min: f64,
    /// Largest allowed value.
    pub max: f64,
    /// SI unit, `N.m` or `N m`; dimensionless where missing.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub unit: String,
    /// One line of meaning.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub about: String,
    /// Where value and bounds come from.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub source: String,
    /// Whether a diagnosis that tries the effect may move it.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub free: bool,
}

fn one() -> String {
    Unit::ONE.symbol.to_owned()
}

fn is_one(unit: &String) -> bool {
    unit == Unit::ONE.symbol
}

fn yes() -> bool {
    true
}

fn is_yes(free: &bool) -> bool {
    *free
}

/// Why an effect of the user's own is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DefinitionError {
    /// The text is not TOML, or has an unknown key or a value of the wrong type.
    #[error("the effects cannot be read: {0}")]
    Syntax(String),
    /// A key has a value that it may not have.
    #[error("effect `{id}`, {key}: {problem}")]
    Invalid {
        /// The effect.
        id: String,
        /// The key.
        key: String,
        /// What is wrong, and what was expected.
        problem: String,
    },
    /// The id belongs to something else.
    #[error("effect `{id}`: the id is taken by {owner}; choose another one")]
    Taken {
        /// The id.
        id: String,
        /// Whose it is.
        owner: String,
    },
    /// The expression cannot be parsed.
    #[error("effect `{id}`, expression `{expression}`, character {character}: {problem}")]
    Expression {
        /// The effect.
        id: String,
        /// The expression.
        expression: String,
        /// Where, counted from 1.
        character: usize,
        /// What is wrong, and what was expected.
        problem: String,
    },
    /// The effect changes something although all its parameters are neutral.
    #[error(
        "effect `{id}`: at the neutral values of its parameters the expression is {value} where {place}; \
         expected {expected}, which changes nothing"
    )]
    NotNeutral {
        /// The effect.
        id: String,
        /// The value.
        value: f64,
        /// The neutral value.
        expected: f64,
        /// The signals.
        place: String,
    },
}

impl EffectDefinition {
    /// Definitions from TOML text with `[[effect]]` tables.
    ///
    /// # Errors
    /// [`DefinitionError::Syntax`]; the definitions are checked where they are added to a model.
    pub fn all_from_toml(text: &str) -> Result<Vec<Self>, DefinitionError> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct File {
            effect: Vec<EffectDefinition>,
        }
        let file: File = crate::toml_text::read(text).map_err(|error| DefinitionError::Syntax(error.to_string()))?;
        Ok(file.effect)
    }

    /// The effect, checked, with its parameters at their neutral values.
    ///
    /// # Errors
    /// [`DefinitionError`] saying which key, and what was expected.
    pub fn build(self) -> Result<CustomEffect, DefinitionError> {
        check_name(&self.id).map_err(|problem| self.invalid("id", problem))?;
        let target = self.find_target()?;
        let mode = self.find_mode(target)?;
        let names: Vec<String> = self.parameters.keys().cloned().collect();
        let signals: Vec<&'static str> = target.hook().signals().iter().map(|(name, ..)| *name).collect();
        let variables = self.variables(&signals)?;
        let program = self.program(Names { parameters: &names, signals: &signals })?;
        if let Some(k) = (0..names.len()).find(|k| !program.uses_parameter(*k)) {
            return Err(self.invalid(&format!("parameters.{}", names[k]), "the expression does not use it".to_owned()));
        }
        let values = variables.iter().map(|variable| variable.default).collect();
        let effect =
            CustomEffect { shared: Arc::new(Shared { target, mode, program, variables, definition: self }), values };
        effect.check_neutral()?;
        Ok(effect)
    }

    fn invalid(&self, key: &str, problem: String) -> DefinitionError {
        DefinitionError::Invalid { id: self.id.clone(), key: key.to_owned(), problem }
    }

    fn find_target(&self) -> Result<Target, DefinitionError> {
        let found = TARGETS.iter().find(|(name, _)| *name == self.target);
        found.map(|(_, target)| *target).ok_or_else(|| {
            let known = TARGETS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
            self.invalid("target", format!("unknown target `{}`; known are {known}", self.target))
        })
    }

    fn find_mode(&self, target: Target) -> Result<Mode, DefinitionError> {
        match (target.is_parameter(), self.mode) {
            (true, Some(mode)) => Ok(mode),
            (true, None) => Err(self.invalid("mode", "this target needs \"factor\" or \"add\"".to_owned())),
            (false, None | Some(Mode::Add)) => Ok(Mode::Add),
            (false, Some(Mode::Factor)) => {
                Err(self.invalid("mode", format!("`{}` can only be added to, expected \"add\"", self.target)))
            }
        }
    }

    /// Descriptions of the parameters, named `<id>.<name>`.
    fn variables(&self, signals: &[&str]) -> Result<Vec<Variable>, DefinitionError> {
        if self.parameters.is_empty() {
            let problem = "expected at least one, with whose neutral value the effect is switched off".to_owned();
            return Err(self.invalid("parameters", problem));
        }
        let variables = self.parameters.iter().map(|(name, parameter)| {
            let key = format!("parameters.{name}");
            check_name(name).map_err(|problem| self.invalid(&key, problem))?;
            if is_taken(name) || signals.contains(&name.as_str()) {
                let problem = "the name is a signal, a function or a constant of the expression; choose another one";
                return Err(self.invalid(&key, problem.to_owned()));
            }
            parameter.variable(&self.id, name).map_err(|problem| self.invalid(&key, problem))
        });
        variables.collect()
    }

    fn program(&self, names: Names) -> Result<Program, DefinitionError> {
        let refused = |Problem { at, what }: Problem| DefinitionError::Expression {
            id: self.id.clone(),
            expression: shortened(&self.expression),
            character: at + 1,
            problem: what,
        };
        let length = self.expression.len();
        if length > MAX_LENGTH {
            let what = format!("the expression has {length} bytes, expected at most {MAX_LENGTH}");
            return Err(refused(Problem { at: MAX_LENGTH, what }));
        }
        let operations = parse(&self.expression, names).map_err(refused)?;
        let deep = || Problem { at: 0, what: format!("the expression needs more than {MAX_STACK} values at once") };
        Program::new(operations).ok_or_else(|| refused(deep()))
    }
}

impl ParameterDefinition {
    fn variable(&self, id: &str, name: &str) -> Result<Variable, String> {
        let Self { neutral, min, max, .. } = *self;
        if !(min.is_finite() && max.is_finite() && min < max) {
            return Err(format!("bounds {min} .. {max}: expected finite numbers, min below max"));
        }
        if !(min..=max).contains(&neutral) {
            return Err(format!("neutral = {neutral} is outside its bounds {min} .. {max}"));
        }
        let unit = Unit::of_symbol(&self.unit).ok_or_else(|| {
            let known = Unit::ALL.iter().map(|unit| unit.symbol).collect::<Vec<_>>().join(", ");
            format!("unknown unit `{}`; known are {known}", self.unit)
        })?;
        let or = |text: &str, otherwise: &str| if text.is_empty() { otherwise.to_owned() } else { text.to_owned() };
        Ok(Variable {
            name: format!("{id}.{name}"),
            doc: or(&self.about, "Parameter of an effect of the user's own.").into(),
            unit,
            default: neutral,
            min,
            max,
            role: if self.free { Role::Effect } else { Role::Fixed },
            source: or(&self.source, "user").into(),
        })
    }
}

impl CustomEffect {
    /// Tries the expression over the ranges of the signals: corners, centre, and points between.
    fn check_neutral(&self) -> Result<(), DefinitionError> {
        let signals = self.shared.target.hook().signals();
        let expected = self.shared.mode.neutral();
        let mut values = vec![0.0; signals.len()];
        for trial in 0..TRIALS {
            for (k, (value, (name, low, high))) in values.iter_mut().zip(signals).enumerate() {
                *value = low + (high - low) * share(trial, k);
                if *name == "wheel" {
                    *value = value.round();
                }
            }
            let value = self.shared.program.evaluate(|k| self.values[k], |k| values[k]);
            let left = (value - expected).abs();
            if left.is_nan() || left > NEUTRAL_TOLERANCE {
                let (id, place) = (self.id().to_owned(), self.place(&values));
                return Err(DefinitionError::NotNeutral { id, value, expected, place });
            }
        }
        Ok(())
    }
}

/// Where between its bounds the `k`-th signal lies in a trial, 0 .. 1: at both ends, in the middle, then spread by
/// the digits of the trial's number in the base of the k-th prime (Halton 1960).
fn share(trial: u32, k: usize) -> f64 {
    const PRIMES: [u32; 10] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29];
    match trial {
        0 => 0.0,
        1 => 1.0,
        2 => 0.5,
        _ => {
            let base = PRIMES[k % PRIMES.len()];
            let (mut rest, mut weight, mut sum) = (trial, 1.0, 0.0);
            while rest > 0 {
                weight /= f64::from(base);
                sum += weight * f64::from(rest % base);
                rest /= base;
            }
            sum
        }
    }
}

/// Refuses what cannot be the id of an effect.
pub(crate) fn check_id(id: &str) -> Result<(), DefinitionError> {
    check_name(id).map_err(|problem| DefinitionError::Invalid { id: id.to_owned(), key: "id".to_owned(), problem })
}

fn check_name(name: &str) -> Result<(), String> {
    let starts = name.starts_with(|c: char| c.is_ascii_lowercase());
    let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if starts && name.chars().all(allowed) && name.len() <= 40 {
        return Ok(());
    }
    Err(format!(
        "`{}` is no name: expected a small letter, then small letters, digits and _, at most 40",
        shortened(name)
    ))
}

/// Enough of a text to recognise it by.
fn shortened(text: &str) -> String {
    const SHOWN: usize = 120;
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}
