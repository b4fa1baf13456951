//! Recording a simulation.

use super::table::{Table, TableError};
use crate::signals::Signals;
use bekker_modeldescription::{Lookup, ParameterError, Parameters};

/// A time series of chosen signals, under the vocabulary's names, SI units.
#[derive(Clone, Debug)]
pub struct Record {
    table: Table,
    // For each signal in the order of `Signals::values`, whether it is recorded.
    chosen: Vec<bool>,
    row: Vec<f64>,
}

impl Record {
    /// A record of `time` and the signals called `names` (all of them where `names` is `None`), for a rover with
    /// as many wheels as `signals` has. Columns stand in the vocabulary's order.
    ///
    /// # Errors
    /// [`ParameterError::Unknown`] for a name that is no signal of this rover.
    pub fn new(signals: &mut Signals, names: Option<&[String]>) -> Result<Self, ParameterError> {
        let known: Vec<String> = signals.list().into_iter().map(|(variable, _)| variable.name).collect();
        if let Some(strange) = names.into_iter().flatten().find(|name| !known.contains(name)) {
            return Err(signals.unknown(strange));
        }
        let chosen: Vec<bool> = known.iter().map(|name| names.is_none_or(|names| names.contains(name))).collect();
        let columns = known.into_iter().zip(&chosen).filter(|(_, chosen)| **chosen).map(|(name, _)| name);
        let table = Table::new(std::iter::once("time".to_owned()).chain(columns))
            .map_err(|_| ParameterError::Unknown { name: "time".to_owned(), suggestions: Vec::new() })?;
        Ok(Self { table, chosen, row: Vec::new() })
    }

    /// Adds the signals at `time`, s.
    ///
    /// # Errors
    /// [`TableError`] where a value is not finite or the number of wheels has changed.
    pub fn push(&mut self, time: f64, signals: &Signals) -> Result<(), TableError> {
        self.row.clear();
        self.row.push(time);
        let (row, mut chosen) = (&mut self.row, self.chosen.iter());
        signals.values(&mut |value| {
            if chosen.next().copied().unwrap_or(true) {
                row.push(value);
            }
        });
        self.table.push(&self.row)
    }

    /// The table so far.
    #[must_use]
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// The finished table.
    #[must_use]
    pub fn into_table(self) -> Table {
        self.table
    }
}
