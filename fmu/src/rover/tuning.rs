//! Parameters that change between two steps.

use super::plant::{RoverFmu, write};
use crate::model::Failure;
use bekker_modeldescription::xml::Entry;
use bekker_modeldescription::xml::Variability::Tunable;

/// The values that act of those that are set: of tunable parameters the new ones, of others those of the start.
pub(super) fn wanted(entries: &[Entry], values: &[f64], applied: &[f64]) -> Vec<f64> {
    let all = entries.iter().zip(values).zip(applied);
    all.map(|((entry, value), applied)| if entry.variability == Tunable { *value } else { *applied }).collect()
}

impl RoverFmu {
    /// Lets tunable parameters that have been set act from now on; others wait for the next start.
    pub(super) fn tune(&mut self) -> Result<(), Failure> {
        let values = &self.values[self.references.parameters.clone()];
        if *values == *self.applied {
            return Ok(());
        }
        let entries = &self.description.entries[self.references.parameters.clone()];
        self.tune_to(wanted(entries, values, &self.applied))
    }

    pub(super) fn tune_to(&mut self, wanted: Vec<f64>) -> Result<(), Failure> {
        if wanted == self.applied {
            return Ok(());
        }
        let mut model = self.tuned.clone();
        write(&mut model, self.sensing, &wanted);
        self.run.retune(&model).map_err(|error| Failure(error.to_string()))?;
        if let Some(model_exchange) = &mut self.model_exchange {
            model_exchange.equations.retune(model.rover.clone());
            // Another mass or gravity is another energy.
            model_exchange.equations.forget_balance();
            model_exchange.stale();
        }
        (self.tuned, self.applied) = (model, wanted);
        Ok(())
    }
}
