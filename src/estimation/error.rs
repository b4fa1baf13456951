//! Why an estimator could not be built or took no reading.

use crate::linear_stress::OutsideClosedForms;
use bekker_modeldescription::{Lookup, ParameterError};

/// Why an estimator could not be built or took no reading; its estimate is then as it was.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EstimationError {
    /// A reading is not a finite number.
    #[error("{quantity}{} is {value}; a finite number was expected", of_wheel(*.wheel))]
    NotFinite {
        /// What is not finite.
        quantity: &'static str,
        /// Number of the wheel or joint, 1 first, if it belongs to one.
        wheel: Option<usize>,
        /// The value itself.
        value: f64,
    },
    /// The measurement has another number of wheels or joints than the estimator.
    #[error("the measurement has {found} {what}; the estimator was built for {expected}")]
    Count {
        /// Wheels or joints.
        what: &'static str,
        /// Of the nominal rover.
        expected: usize,
        /// In the measurement.
        found: usize,
    },
    /// The nominal rover makes no sense to this estimator.
    #[error("nominal {quantity} is {value}; expected {expected}")]
    Nominal {
        /// What of it.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// A parameter of a group is outside its bounds.
    #[error("in `{group}`: {error}")]
    Parameter {
        /// The group's name.
        group: &'static str,
        /// Which parameter, and its allowed range.
        error: ParameterError,
    },
    /// A reading is outside what the soil's formulas are for.
    #[error("{quantity} = {value}; the estimator expects {expected}")]
    Reading {
        /// Which reading.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// A reading is outside what the thesis's closed forms are for.
    #[error(transparent)]
    ClosedForm(#[from] OutsideClosedForms),
    /// Too few readings for what is asked.
    #[error("{found} readings of {what}; at least {expected} are needed")]
    TooFew {
        /// Of what.
        what: &'static str,
        /// How many are needed.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// The readings leave the answer open or contradict every answer.
    #[error("the readings determine no {what}")]
    Undetermined {
        /// What they do not determine.
        what: &'static str,
    },
}

fn of_wheel(wheel: Option<usize>) -> String {
    wheel.map_or_else(String::new, |number| format!(" of number {number}"))
}

/// `value` if it is finite; `index` counts from 0.
pub(crate) fn finite(quantity: &'static str, index: Option<usize>, value: f64) -> Result<f64, EstimationError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(EstimationError::NotFinite { quantity, wheel: index.map(|k| k + 1), value })
    }
}

/// Refuses a measurement with another number of parts than the estimator's.
pub(crate) fn same_count(what: &'static str, expected: usize, found: usize) -> Result<(), EstimationError> {
    if expected == found { Ok(()) } else { Err(EstimationError::Count { what, expected, found }) }
}

/// Checks a parameter group against its bounds.
pub(crate) fn within_bounds(group: &'static str, mut parameters: impl Lookup) -> Result<(), EstimationError> {
    parameters.check().map_err(|error| EstimationError::Parameter { group, error })
}
