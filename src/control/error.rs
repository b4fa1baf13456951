//! Why a controller could not be built or gave no command.

use super::rtc::Unsolved;
use bekker_modeldescription::{Lookup, ParameterError};

/// Why a controller could not be built or gave no command.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ControlError {
    /// A reading, a reference or a nominal dimension is not a finite number.
    #[error("{quantity}{} is {value}; a finite number was expected", of_wheel(*.wheel))]
    NotFinite {
        /// What is not finite.
        quantity: &'static str,
        /// Number of the wheel, 1 at the rear, if it belongs to a wheel.
        wheel: Option<usize>,
        /// The value itself.
        value: f64,
    },
    /// The measurement has another number of wheels than the controller.
    #[error("the measurement has {found} wheels; the controller was built for {expected}")]
    WheelCount {
        /// Wheels of the nominal rover.
        expected: usize,
        /// Wheels in the measurement.
        found: usize,
    },
    /// The measurement has another number of links than the controller.
    #[error("the measurement has {found} links; the controller was built for {expected}")]
    LinkCount {
        /// Links of the nominal rover.
        expected: usize,
        /// Links in the measurement.
        found: usize,
    },
    /// A controller that needs the true slip was not told it since its last command.
    #[error("slip control was given {found} values of true slip; {expected} were expected, one a wheel")]
    Privileged {
        /// Wheels of the nominal rover.
        expected: usize,
        /// Values given.
        found: usize,
    },
    /// A dimension of the nominal rover makes no sense.
    #[error("nominal {quantity} is {value}; expected {expected}")]
    Nominal {
        /// The dimension's name.
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
    /// The wheels' minimum loads together are not under the rover's weight, so no distribution exists.
    #[error("minimum_load = {load} N on each of {wheels} wheels is not under the weight of {weight} N")]
    MinimumLoad {
        /// The minimum load, N.
        load: f64,
        /// Number of wheels.
        wheels: usize,
        /// The rover's weight, N.
        weight: f64,
    },
    /// The contact points do not span the balance (4.3), so it has no unique least-norm solution.
    #[error(
        "all contact points of the rover or of a joint's wheels coincide at pitch {pitch} rad: the force distribution is singular"
    )]
    Singular {
        /// The measured pitch, rad.
        pitch: f64,
    },
    /// Rough-terrain control that commands torques is asked to minimise what depends on slip.
    #[error(
        "criterion = electrical_power counts slips, which rtc does not choose; expected power, traction, or kind = \"rtc_speed\""
    )]
    NoSlips,
    /// The model is to be driven by a registered control law and has none.
    #[error(
        "control.kind = \"registered\", but the model has no control law of another crate; expected one, by `drive_by`"
    )]
    NoLaw,
    /// An estimator in the loop could not be built or took no reading; its own words.
    #[error("{0}")]
    Estimation(String),
    /// The optimiser stopped without an answer.
    #[error(transparent)]
    Optimiser(#[from] Unsolved),
}

fn of_wheel(wheel: Option<usize>) -> String {
    wheel.map_or_else(String::new, |number| format!(" of wheel {number}"))
}

/// `value` if it is finite; `index` counts wheels from 0.
pub(crate) fn finite(quantity: &'static str, index: Option<usize>, value: f64) -> Result<f64, ControlError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(ControlError::NotFinite { quantity, wheel: index.map(|k| k + 1), value })
    }
}

/// Refuses a measurement with another number of wheels than the controller's.
pub(crate) fn same_count(expected: usize, found: usize) -> Result<(), ControlError> {
    if expected == found { Ok(()) } else { Err(ControlError::WheelCount { expected, found }) }
}

/// Refuses a measurement with another number of links than the controller's.
pub(crate) fn same_links(expected: usize, found: usize) -> Result<(), ControlError> {
    if expected == found { Ok(()) } else { Err(ControlError::LinkCount { expected, found }) }
}

/// Checks a parameter group against its bounds.
pub(crate) fn within_bounds(group: &'static str, mut parameters: impl Lookup) -> Result<(), ControlError> {
    parameters.check().map_err(|error| ControlError::Parameter { group, error })
}
