//! The explicit right-hand side x' = f(x, u, p), for callers that integrate or differentiate it themselves.

use super::dynamics::{DynamicsError, Evaluation};
use super::{Rover, State};
use crate::contact::Hold;
use crate::scalar::Scalar;
use crate::signals::Command;

/// Time derivative of a [`State`].
#[derive(Clone, Debug, PartialEq)]
pub struct StateRate<S = f64> {
    /// Rates of x, z, pitch and joint angles; m/s, rad/s.
    pub position: Vec<S>,
    /// Their accelerations; m/s^2, rad/s^2.
    pub rate: Vec<S>,
    /// Angular acceleration of each wheel (rad/s^2; of no meaning where speeds are imposed) and the rate
    /// of its contact's memory (1/s). What changes slowly beside them, the heat of windings and the slip to which the ground is dug,
    /// has its rates in [`crate::equations`].
    pub wheels: Vec<(S, Hold<S>)>,
}

impl<S: Scalar> Rover<S> {
    /// f(x, u, p): the time derivative of `state` under `command`. Allocates; the simulation's own steps do not.
    ///
    /// # Errors
    /// [`DynamicsError`] where a wheel is beyond the ground or something is not finite.
    pub fn rate_of_change(&self, state: &State<S>, command: &Command) -> Result<StateRate<S>, DynamicsError> {
        let mut evaluation = Evaluation::new(self);
        evaluation.update(self, state, command)?;
        Ok(StateRate {
            position: state.rate.clone(),
            rate: evaluation.acceleration[..self.coordinates()].to_vec(),
            wheels: evaluation
                .wheels
                .iter()
                .enumerate()
                .map(|(k, wheel)| (evaluation.spin_rate(self, k), wheel.touch.rate))
                .collect(),
        })
    }
}
