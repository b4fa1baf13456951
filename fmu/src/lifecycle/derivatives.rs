//! Partial derivatives, and what depends on what.

use super::{Lifecycle, Phase, Refusal, Type};
use bekker_modeldescription::xml::{Causality, Entry};

/// The way in which a product with the matrix of partial derivatives is formed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// A column of knowns in, a column of unknowns out.
    Forward,
    /// A row of unknowns in, a row of knowns out.
    Adjoint,
}

impl Lifecycle {
    /// The matrix of derivatives of `unknowns` by `knowns` times `seed`, or in [`Direction::Adjoint`] its transpose
    /// times `seed`, at the present point.
    ///
    /// # Errors
    /// [`Refusal::Order`]; [`Refusal::Reference`], [`Refusal::Type`]; [`Refusal::Count`] where seed or result have
    /// another length than the list that they belong to; [`Refusal::Derivative`] for a list that holds a variable of
    /// the wrong causality or a seed that is not finite; [`Refusal::Failed`] where a pair has no derivative here.
    pub fn partial(
        &mut self,
        direction: Direction,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        result: &mut [f64],
    ) -> Result<(), Refusal> {
        let legal = [Phase::Initialization, Phase::Step, Phase::Intermediate, Phase::Event, Phase::ContinuousTime];
        self.require(&[&legal[..], &[Phase::Terminated]].concat())?;
        let (given, wanted) = match direction {
            Direction::Forward => (knowns.len(), unknowns.len()),
            Direction::Adjoint => (unknowns.len(), knowns.len()),
        };
        for (what, given, expected) in [("seeds", seed.len(), given), ("sensitivities", result.len(), wanted)] {
            if given != expected {
                return Err(Refusal::Count { what, given, expected });
            }
        }
        if let Some(value) = seed.iter().find(|value| !value.is_finite()) {
            return Err(Refusal::Derivative(format!("a seed is {value}, expected finite numbers")));
        }
        let unknowns = self.listed(unknowns, "an unknown", &[Causality::Output, Causality::Local])?;
        let known = [Causality::Input, Causality::Parameter, Causality::Local, Causality::Independent];
        let knowns = self.listed(knowns, "a known", &known)?;
        if self.phase == Phase::Initialization {
            self.refresh()?;
        }
        self.evaluate()?;
        match direction {
            Direction::Forward => self.model.directional(&unknowns, &knowns, seed, result)?,
            Direction::Adjoint => self.model.adjoint(&unknowns, &knowns, seed, result)?,
        }
        Ok(())
    }

    fn listed(&self, references: &[u32], part: &str, legal: &[Causality]) -> Result<Vec<usize>, Refusal> {
        let place = |reference: &u32| {
            let entry = self.entry(*reference, Type::Real)?;
            if legal.contains(&entry.causality) {
                return Ok(*reference as usize);
            }
            let (name, word) = (&entry.variable.name, entry.causality.word());
            Err(Refusal::Derivative(format!("`{name}` is of causality `{word}` and cannot be {part} of a derivative")))
        };
        references.iter().map(place).collect()
    }

    /// On which inputs and continuous states an unknown depends at the same instant; an event indicator on all of them.
    ///
    /// # Errors
    /// [`Refusal::Reference`]; [`Refusal::Derivative`] for a variable that the model does not compute.
    pub fn dependencies(&self, dependent: u32) -> Result<Vec<u32>, Refusal> {
        let description = self.model.description();
        let indicator = (dependent as usize).checked_sub(description.entries.len());
        let all = indicator.filter(|number| *number < self.indicators).map(|_| Entry::time());
        let found = description.entries.get(dependent as usize).or(all.as_ref());
        let found = found.ok_or(Refusal::Reference { reference: dependent, largest: self.largest() })?;
        if all.is_none() && !matches!(found.causality, Causality::Output | Causality::Local) {
            return Err(Refusal::Derivative(format!("`{}` depends on nothing: it is set", found.variable.name)));
        }
        let known = description.dependencies(found).into_iter();
        Ok(known.filter_map(|reference| u32::try_from(reference).ok()).collect())
    }
}
