//! Experiments whose tables are arrays: data that a program holds already.

use super::error::ExperimentError;
use super::experiment::Experiment;
use super::files::Files;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The cells of a column.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cells {
    /// Numbers; NaN where nothing was measured.
    Numbers(#[serde(with = "gaps")] Vec<f64>),
    /// Labels of set-points and runs, and time stamps; empty where missing.
    Labels(Vec<String>),
}

impl Cells {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Labels(labels) => labels.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Columns of one table, with their names, in order.
pub type Columns = Vec<(String, Cells)>;

impl Experiment {
    /// An experiment from the text of `experiment.toml` and the columns of the files that it names, by their names. The columns are
    /// mapped and checked as those of files are; a row without any value is left out.
    ///
    /// # Errors
    /// As [`read`](Self::read); tables are named as in `tables`, and their first row is line 2, as under a header.
    pub fn from_arrays(settings: &str, tables: &BTreeMap<String, Columns>) -> Result<Self, ExperimentError> {
        Self::read_from(&Files::Arrays { settings, tables }, false)
    }
}

/// JSON has no NaN: a missing number is null there.
mod gaps {
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(numbers: &[f64], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(numbers.iter().map(|number| Some(*number).filter(|number| !number.is_nan())))
    }

    pub fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<Vec<f64>, D::Error> {
        let numbers = Vec::<Option<f64>>::deserialize(from)?;
        Ok(numbers.into_iter().map(|number| number.unwrap_or(f64::NAN)).collect())
    }
}
