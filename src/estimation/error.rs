//! Why an estimator could not be built or took no reading.

use crate::control::ControlError;
use crate::linear_stress::OutsideClosedForms;
use bekker_modeldescription::{Lookup, ParameterError};

/// Why an estimator could not be built or took no reading; its estimate is then as it was.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EstimationError {
    /// A reading is not a finite number.
    #[error("{quantity}{} is {value}; a finite number was expected", numbered(*.number))]
    NotFinite {
        /// The reading.
        quantity: &'static str,
        /// Number of its wheel or link, from 1.
        number: Option<usize>,
        /// The value itself.
        value: f64,
    },
    /// The measurement is of another rover than the estimator.
    #[error("the measurement has {found} {what}; the estimator was built for {expected}")]
    Count {
        /// Wheels or links.
        what: &'static str,
        /// Of the nominal rover.
        expected: usize,
        /// In the measurement.
        found: usize,
    },
    /// The measurement is older than the one before.
    #[error("the measurement of t = {time} s comes after that of t = {before} s; times that grow were expected")]
    Time {
        /// Its time, s.
        time: f64,
        /// Time of the measurement before, s.
        before: f64,
    },
    /// No second point at a fixed distance from a wheel is known.
    #[error(
        "nothing tells the contact angle of wheel {wheel}: expected a second wheel on its body, or a joint to a body whose wheels tell its motion"
    )]
    Alone {
        /// The wheel, from 1 at the rear.
        wheel: usize,
    },
    /// A wheel and the point that it is paired with are the same.
    #[error("wheel {wheel} is {distance} m from the point that it is paired with; over 1 mm was expected")]
    Distance {
        /// The wheel, from 1 at the rear.
        wheel: usize,
        /// The distance, m.
        distance: f64,
    },
    /// The nominal rover makes no sense.
    #[error(transparent)]
    Rover(#[from] ControlError),
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

/// A controller that has an estimator in its loop fails with it.
impl From<EstimationError> for ControlError {
    fn from(error: EstimationError) -> Self {
        Self::Estimation(error.to_string())
    }
}

fn numbered(number: Option<usize>) -> String {
    number.map_or_else(String::new, |number| format!(" {number}"))
}

/// Refuses a reading that is not finite; `index` counts wheels or links from 0.
pub(super) fn finite(quantity: &'static str, index: Option<usize>, value: f64) -> Result<(), EstimationError> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(EstimationError::NotFinite { quantity, number: index.map(|k| k + 1), value })
    }
}

/// Refuses a measurement with another number of parts than the estimator's.
pub(super) fn same_count(what: &'static str, expected: usize, found: usize) -> Result<(), EstimationError> {
    if expected == found { Ok(()) } else { Err(EstimationError::Count { what, expected, found }) }
}

/// Checks a parameter group against its bounds.
pub(super) fn within_bounds(group: &'static str, mut parameters: impl Lookup) -> Result<(), EstimationError> {
    parameters.check().map_err(|error| EstimationError::Parameter { group, error })
}
