//! Reading and setting variables by value reference.

use super::{Interface, Lifecycle, Phase, Refusal};
use bekker_modeldescription::xml::{Causality, Entry, Kind, Variability, indicator_name};
use std::borrow::Cow;

/// Type of the values that a function of the standard works on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// 64 bit floating point.
    Real,
    /// Enumerations, as 64 bit integers.
    Enumeration,
    /// Integers of 32 bits.
    Integer,
    /// Enumerations and integers, which FMI 2.0 reads and sets by the same functions.
    Whole,
    /// A type of the standard that no variable has.
    Other(&'static str),
}

impl Type {
    fn of(entry: &Entry) -> Self {
        match entry.kind {
            Kind::Real => Self::Real,
            Kind::Integer => Self::Integer,
            Kind::Enumeration { .. } => Self::Enumeration,
        }
    }

    fn word(self) -> &'static str {
        match self {
            Self::Real => "a 64 bit floating point number",
            Self::Enumeration => "an enumeration",
            Self::Integer => "a 32 bit integer",
            Self::Whole => "an integer or enumeration",
            Self::Other(word) => word,
        }
    }
}

impl Lifecycle {
    /// Reads variables of type `asked` in order into `put(place, value)`.
    ///
    /// # Errors
    /// [`Refusal::Reference`], [`Refusal::Type`]; [`Refusal::NotComputed`] for an output before
    /// initialization; [`Refusal::Failed`] where outputs are read in initialization and cannot be computed.
    pub fn get(&mut self, references: &[u32], asked: Type, put: &mut dyn FnMut(usize, f64)) -> Result<(), Refusal> {
        let entries = self.model.description().entries.len();
        let (mut computed, mut hidden) = (false, false);
        for &reference in references {
            let indicator = (reference as usize).checked_sub(entries).filter(|number| *number < self.indicators);
            let causality = match indicator {
                Some(_) if asked == Type::Real => Causality::Local,
                _ => self.entry(reference, asked)?.causality,
            };
            hidden |= causality == Causality::Local;
            computed |= matches!(causality, Causality::Output | Causality::Local);
            if computed && self.phase == Phase::Instantiated {
                return Err(Refusal::NotComputed(match indicator {
                    Some(number) => indicator_name(number),
                    None => self.entry(reference, asked)?.variable.name.clone(),
                }));
            }
        }
        if computed && self.phase == Phase::Initialization {
            self.refresh()?;
        }
        if computed && matches!(self.phase, Phase::Initialization | Phase::Event | Phase::ContinuousTime) {
            self.evaluate()?;
        }
        if hidden
            && self.interface != Interface::ModelExchange
            && let Some(equations) = self.model.continuous()
        {
            equations.follow()?;
        }
        let indicators = self.present_indicators(references, entries)?;
        for (place, &reference) in references.iter().enumerate() {
            let reference = reference as usize;
            let value = match reference.checked_sub(entries) {
                Some(number) => indicators.get(number).copied().unwrap_or(f64::NAN),
                None => self.value(reference),
            };
            put(place, value);
        }
        Ok(())
    }

    fn value(&self, reference: usize) -> f64 {
        match self.model.description().entries[reference].causality {
            Causality::Independent => self.time(),
            _ => self.model.get(reference),
        }
    }

    /// The event indicators where they are asked for by reference, as FMI 3.0 wants it.
    fn present_indicators(&mut self, references: &[u32], entries: usize) -> Result<Vec<f64>, Refusal> {
        if references.iter().all(|reference| (*reference as usize) < entries) {
            return Ok(Vec::new());
        }
        let mut indicators = vec![0.0; self.indicators];
        if let Some(equations) = self.model.continuous() {
            equations.event_indicators(&mut indicators)?;
        }
        Ok(indicators)
    }

    /// The references of the entries that an importer's references stand for: an array's elements in its place.
    ///
    /// # Errors
    /// [`Refusal::Reference`] for an element of an array, which has no reference of its own.
    pub fn elements<'a>(&self, references: &'a [u32]) -> Result<Cow<'a, [u32]>, Refusal> {
        let arrays = &self.model.description().arrays;
        if arrays.is_empty() {
            return Ok(Cow::Borrowed(references));
        }
        let mut all = Vec::with_capacity(references.len());
        for &reference in references {
            match arrays.elements(reference as usize) {
                Some(elements) => all.extend(elements.iter().map(|element| *element as u32)),
                None if arrays.hides(reference as usize) => {
                    return Err(Refusal::Reference { reference, largest: self.largest() });
                }
                None => all.push(reference),
            }
        }
        Ok(Cow::Owned(all))
    }

    /// The largest value reference.
    pub(super) fn largest(&self) -> usize {
        (self.model.description().entries.len() + self.indicators).saturating_sub(1)
    }

    /// Sets variables of type `asked`; either all or, with an error, none.
    ///
    /// # Errors
    /// [`Refusal::Reference`], [`Refusal::Type`], [`Refusal::Length`]; [`Refusal::ReadOnly`] for time and
    /// outputs, for anything after the end and for fixed parameters after initialization;
    /// [`Refusal::Value`] outside the bounds.
    pub fn set(&mut self, references: &[u32], asked: Type, values: &[f64]) -> Result<(), Refusal> {
        if references.len() != values.len() {
            return Err(Refusal::Length { references: references.len(), values: values.len() });
        }
        for (&reference, &value) in references.iter().zip(values) {
            let entry = self.entry(reference, asked)?;
            self.settable(entry)?;
            if !entry.variable.allows(value) {
                let (name, range) = (entry.variable.name.clone(), entry.variable.range());
                return Err(Refusal::Value { name, value, range });
            }
        }
        for (&reference, &value) in references.iter().zip(values) {
            self.model.set(reference as usize, value);
        }
        self.stale |= matches!(self.phase, Phase::Instantiated | Phase::Initialization) && !references.is_empty();
        self.fresh &= references.is_empty();
        Ok(())
    }

    /// Whether all references exist and have the type `asked`.
    ///
    /// # Errors
    /// [`Refusal::Reference`], [`Refusal::Type`].
    pub fn expect(&self, references: &[u32], asked: Type) -> Result<(), Refusal> {
        references.iter().try_for_each(|reference| self.entry(*reference, asked).map(|_| ()))
    }

    pub(super) fn entry(&self, reference: u32, asked: Type) -> Result<&Entry, Refusal> {
        let entry = self.model.description().entries.get(reference as usize);
        let entry = entry.ok_or(Refusal::Reference { reference, largest: self.largest() })?;
        let actual = Type::of(entry);
        let whole = asked == Type::Whole && matches!(actual, Type::Enumeration | Type::Integer);
        if actual == asked || whole {
            return Ok(entry);
        }
        let name = entry.variable.name.clone();
        Err(Refusal::Type { name, reference, actual: actual.word(), asked: asked.word() })
    }

    fn settable(&self, entry: &Entry) -> Result<(), Refusal> {
        let before = matches!(self.phase, Phase::Instantiated | Phase::Initialization);
        let at_points = before || matches!(self.phase, Phase::Step | Phase::Event);
        let any_time = at_points || matches!(self.phase, Phase::Intermediate | Phase::ContinuousTime);
        let legal = match (entry.causality, entry.variability) {
            (Causality::Input, _) => any_time,
            (Causality::Parameter, Variability::Tunable) => at_points,
            (Causality::Parameter, _) => before,
            (Causality::Output | Causality::Local | Causality::Independent, _) => false,
        };
        if legal {
            return Ok(());
        }
        let never = matches!(entry.causality, Causality::Output | Causality::Local | Causality::Independent);
        Err(Refusal::ReadOnly {
            name: entry.variable.name.clone(),
            what: format!("`{} {}`", entry.variability.word(), entry.causality.word()),
            when: if never { "by the importer".into() } else { format!("in the phase `{}`", self.phase) },
        })
    }
}
