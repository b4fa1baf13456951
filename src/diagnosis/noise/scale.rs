//! Sizes of the noise of single values, where these differ.

use serde::{Deserialize, Serialize};

/// Size of the noise of one value, relative to that of a usual value of its signal: the value scatters by
/// `row (weight common + own)`, with `common` what a whole run has in common and `own` what the row has, as a
/// [`NoiseModel`](super::NoiseModel) gives them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scale {
    /// Of the noise of the row.
    pub row: f64,
    /// Size of the scatter that the whole run has in common there, over `row`. A soil that resists 10 % more does so by 10 % of nearly zero at
    /// the start of a test, where a load cell has noise all the same.
    pub weight: f64,
}

impl Scale {
    /// Of a usual value.
    pub const USUAL: Self = Self { row: 1.0, weight: 1.0 };
}
