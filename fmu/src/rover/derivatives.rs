//! Derivatives of outputs and rates by inputs and states, exact by dual numbers.
//!
//! In co-simulation they are those at the run's present inner step, with its states held: how outputs answer to inputs at
//! once. A controller between inputs and plant decides at its own instants, so that nothing answers at once; it is
//! refused.

use super::plant::{AdvancedBy, References, RoverFmu};
use crate::model::Failure;
use bekker::equations::{Equations, Tangent};

/// An unknown, by its place in a [`Tangent`].
enum Unknown {
    Rate(usize),
    Signal(usize),
}

/// A known, by its place among states or inputs; nothing depends on time alone.
enum Known {
    State(usize),
    Input(usize),
    Time,
}

impl RoverFmu {
    pub(super) fn push_forward(
        &self,
        unknowns: &[usize],
        knowns: &[usize],
        seed: &[f64],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let (unknowns, knowns) =
            self.pairs(unknowns, knowns, (seed.len(), knowns.len()), (out.len(), unknowns.len()))?;
        let equations = self.present()?;
        let tangent = self.along(&equations, &mut knowns.iter().zip(seed.iter().copied()))?;
        out.iter_mut().zip(&unknowns).for_each(|(place, unknown)| *place = unknown.of(&tangent));
        Ok(())
    }

    /// One tangent a known: forward differentiation has no cheaper way.
    pub(super) fn pull_back(
        &self,
        unknowns: &[usize],
        knowns: &[usize],
        seed: &[f64],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let (unknowns, knowns) =
            self.pairs(unknowns, knowns, (seed.len(), unknowns.len()), (out.len(), knowns.len()))?;
        let equations = self.present()?;
        for (place, known) in out.iter_mut().zip(&knowns) {
            let tangent = self.along(&equations, &mut std::iter::once((known, 1.0)))?;
            *place = unknowns.iter().zip(seed).map(|(unknown, seed)| seed * unknown.of(&tangent)).sum();
        }
        Ok(())
    }

    fn along(&self, equations: &Equations, seeds: &mut dyn Iterator<Item = (&Known, f64)>) -> Result<Tangent, Failure> {
        let (mut states, mut inputs) =
            (vec![0.0; self.references.states.len()], vec![0.0; self.references.inputs.len()]);
        for (known, seed) in seeds {
            match known {
                Known::State(k) => states[*k] += seed,
                Known::Input(k) => inputs[*k] += seed,
                Known::Time => {}
            }
        }
        equations.tangent(&states, &inputs).map_err(|error| Failure(error.to_string()))
    }

    fn pairs(
        &self,
        unknowns: &[usize],
        knowns: &[usize],
        seed: (usize, usize),
        out: (usize, usize),
    ) -> Result<(Vec<Unknown>, Vec<Known>), Failure> {
        for (what, (got, expected)) in [("seed", seed), ("result", out)] {
            if got != expected {
                return Err(Failure(format!("the {what} of a derivative has {got} values, expected {expected}")));
            }
        }
        let unknowns = unknowns.iter().map(|reference| self.unknown(*reference)).collect::<Result<_, _>>()?;
        let knowns = knowns.iter().map(|reference| self.known(*reference)).collect::<Result<_, _>>()?;
        Ok((unknowns, knowns))
    }

    fn unknown(&self, reference: usize) -> Result<Unknown, Failure> {
        let References { signals, derivatives, measured, measured_signals, .. } = &self.references;
        if derivatives.contains(&reference) {
            return Ok(Unknown::Rate(reference - derivatives.start));
        }
        if signals.contains(&reference) {
            return Ok(Unknown::Signal(reference - signals.start));
        }
        if measured.contains(&reference) && self.motion == AdvancedBy::Integrator {
            return Ok(Unknown::Signal(measured_signals[reference - measured.start] - signals.start));
        }
        Err(self.refused(reference, "unknown"))
    }

    fn known(&self, reference: usize) -> Result<Known, Failure> {
        let References { inputs, states, .. } = &self.references;
        if reference == 0 {
            return Ok(Known::Time);
        }
        if inputs.contains(&reference) {
            return Ok(Known::Input(reference - inputs.start));
        }
        if states.contains(&reference) {
            return Ok(Known::State(reference - states.start));
        }
        Err(self.refused(reference, "known"))
    }

    fn refused(&self, reference: usize, what: &str) -> Failure {
        let entry = self.description.entries.get(reference);
        let name = entry.map_or_else(|| format!("value reference {reference}"), |entry| entry.variable.name.clone());
        let expected = match what {
            "known" => "inputs and continuous states",
            _ => "signals and derivatives of states",
        };
        Failure(format!("`{name}` cannot be the {what} of a derivative; expected {expected}"))
    }
}

impl Unknown {
    fn of(&self, tangent: &Tangent) -> f64 {
        match self {
            Self::Rate(k) => tangent.rates[*k],
            Self::Signal(k) => tangent.signals[*k],
        }
    }
}
