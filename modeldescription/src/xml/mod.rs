//! `modelDescription.xml` of the Functional Mock-up Interface, from the vocabulary.
//!
//! A [`Description`] says what a model offers, without a word about the standard's version;
//! [`Description::fmi2`] writes it as FMI 2.0, [`Description::fmi3`] as FMI 3.0
//! (<https://fmi-standard.org/docs/3.0.2/>).

mod arrays;
mod dependencies;
mod entry;
mod fmi2;
mod fmi3;
mod names;
mod quantity;
mod system;
mod terminals;
mod token;
mod writer;

pub use arrays::Arrays;
pub use entry::{Causality, Entry, Item, Kind, Variability};
pub use system::{Component, Shared, System};

use std::collections::HashSet;
use uuid::Uuid;

/// Namespace of the instantiation tokens (a UUID drawn once for this project).
const TOKENS: Uuid = Uuid::from_u128(0x6f1d_52c4_8a0e_4b7b_9c35_2e7a_d1c0_94b6);

/// The default experiment that a tool offers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Experiment {
    /// Start time, s.
    pub start: f64,
    /// Stop time, s.
    pub stop: f64,
    /// Communication step, s.
    pub step: f64,
}

/// What a model offers to a simulation tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Name for people.
    pub name: String,
    /// Name of the library file and of the model: a C identifier, see [`identifier`].
    pub identifier: String,
    /// One line about the model.
    pub description: String,
    /// Version of the model.
    pub version: String,
    /// Licence of the packed files, as an SPDX expression.
    pub license: String,
    /// Who made the model, for people.
    pub author: String,
    /// Whose the packed files are, for people.
    pub copyright: String,
    /// Program and version that made the package.
    pub generation_tool: String,
    /// When the package was made, in UTC without fractions of a second (`2026-11-21T19:00:00Z`), where it is to say so.
    pub date: Option<String>,
    /// Default experiment.
    pub experiment: Experiment,
    /// Step of the model's own integrator, s.
    pub inner_step: f64,
    /// Name and meaning of the categories in which the library logs.
    pub log_categories: &'static [(&'static str, &'static str)],
    /// Everything the model is made of, also what no variable shows (terrain, structure): part of the
    /// token, so that a description and a model file which do not belong together are noticed.
    pub content: String,
    /// Variables; the first is the independent one, and the place in the list is the value reference.
    pub entries: Vec<Entry>,
    /// Entries that FMI 3.0 shows together; FMI 2.0 has no arrays.
    pub arrays: Arrays,
}

/// What a model can do beyond values and steps, as the capability flags of the standard tell it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Abilities {
    /// Whether a saved state can be written as bytes.
    pub states_as_bytes: bool,
    /// Whether it has directional derivatives.
    pub directional: bool,
    /// Whether it has adjoint derivatives.
    pub adjoint: bool,
    /// For a model that also is a system of differential equations (model exchange): the number of event indicators.
    pub exchange: Option<usize>,
}

/// Name of the event indicator with this number, from 0 on.
#[must_use]
pub fn indicator_name(number: usize) -> String {
    format!("event_indicator[{}]", number + 1)
}

/// Why a description cannot be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DescriptionError {
    /// Two variables have the same name.
    #[error("two variables are called `{0}`")]
    Duplicate(String),
    /// A number that the file needs is not finite.
    #[error("{what} is {value}, expected a finite number")]
    NotFinite {
        /// What has the value.
        what: String,
        /// The value.
        value: f64,
    },
    /// The library's name is not a C identifier.
    #[error("`{0}` is not a C identifier (letters, digits, underscore; no digit first)")]
    Identifier(String),
    /// XML cannot hold a character, not even escaped.
    #[error("{what} has the character U+{code:04X}, which XML 1.0 does not allow")]
    Character {
        /// The text that has it.
        what: String,
        /// Its code point.
        code: u32,
    },
}

impl Description {
    /// References and entries as FMI 3.0 shows them: of an array the first element.
    pub(crate) fn shown(&self) -> impl Iterator<Item = (usize, &Entry)> {
        self.entries.iter().enumerate().filter(|(reference, _)| !self.arrays.hides(*reference))
    }

    /// The variable called `name`.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.variable.name == name)
    }

    /// `modelDescription.xml` of FMI 2.0.
    ///
    /// # Errors
    /// A [`DescriptionError`] where the file could not be valid.
    pub fn fmi2(&self, abilities: &Abilities) -> Result<String, DescriptionError> {
        Ok(fmi2::write(self, abilities, &self.token()?))
    }

    /// `modelDescription.xml` of FMI 3.0.
    ///
    /// # Errors
    /// As [`fmi2`](Self::fmi2).
    pub fn fmi3(&self, abilities: &Abilities) -> Result<String, DescriptionError> {
        Ok(fmi3::write(self, abilities, &self.token()?))
    }

    /// `terminalsAndIcons/terminalsAndIcons.xml` of FMI 3.0.
    ///
    /// # Errors
    /// As [`fmi2`](Self::fmi2).
    pub fn terminals(&self) -> Result<String, DescriptionError> {
        self.check()?;
        Ok(terminals::write(self))
    }

    /// `guid` of FMI 2.0 and `instantiationToken` of FMI 3.0: a UUID (version 5) of the description and of the
    /// content, the date apart. Abilities follow from these and add nothing.
    ///
    /// # Errors
    /// As [`fmi2`](Self::fmi2).
    pub fn token(&self) -> Result<String, DescriptionError> {
        self.check()?;
        Ok(Uuid::new_v5(&TOKENS, &token::bytes(self)).to_string())
    }

    fn check(&self) -> Result<(), DescriptionError> {
        if !names::is_identifier(&self.identifier) {
            return Err(DescriptionError::Identifier(self.identifier.clone()));
        }
        let Self { name, description, version, license, author, copyright, generation_tool, .. } = self;
        for text in [name, description, version, license, author, copyright, generation_tool] {
            writable(text)?;
        }
        let Experiment { start, stop, step } = self.experiment;
        for (what, value) in
            [("start time", start), ("stop time", stop), ("communication step", step), ("inner step", self.inner_step)]
        {
            finite(what, value)?;
        }
        let mut seen = HashSet::new();
        writable(self.date.as_deref().unwrap_or_default())?;
        for entry in &self.entries {
            entry.check()?;
            if !seen.insert(entry.variable.name.as_str()) {
                return Err(DescriptionError::Duplicate(entry.variable.name.clone()));
            }
        }
        Ok(())
    }
}

/// A C identifier as near to `name` as possible: other characters become underscores.
#[must_use]
pub fn identifier(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if names::is_identifier(&plain) { plain } else { format!("model_{plain}") }
}

fn finite(what: &str, value: f64) -> Result<(), DescriptionError> {
    if value.is_finite() { Ok(()) } else { Err(DescriptionError::NotFinite { what: what.to_owned(), value }) }
}

/// XML 1.0 allows tab, line feed, carriage return, and everything from the space on but two code points.
fn writable(text: &str) -> Result<(), DescriptionError> {
    let bad = |c: &char| (*c < ' ' && !matches!(c, '\t' | '\n' | '\r')) || matches!(c, '\u{FFFE}' | '\u{FFFF}');
    match text.chars().find(bad) {
        None => Ok(()),
        Some(c) => Err(DescriptionError::Character { what: format!("{text:?}"), code: u32::from(c) }),
    }
}
