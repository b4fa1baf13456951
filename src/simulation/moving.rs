//! A rover in motion: where the simulation of a recorded drive begins.

use super::SettleError;
use crate::contact::Hold;
use crate::rover::{Rover, State};
use crate::scalar::Scalar;

impl<S: Scalar> Rover<S> {
    /// The state in steady motion with the reference point above `x` (m): as deep in the soil as at rest, moving along the
    /// ground at `velocity` (m/s) with the wheels turning at `speeds` (rad/s, relative to the carrying body, rear to front),
    /// every contact as if it had always moved so. A sinkage that grows with slip is reached within the first tenths of a second.
    ///
    /// # Errors
    /// [`SettleError`] as for [`settled_at`](Self::settled_at).
    pub fn moving_at(&self, x: S, velocity: S, speeds: &[S]) -> Result<State<S>, SettleError> {
        let mut state = self.settled_at(x)?;
        let (sin, cos) = state.position[2].sine_cosine();
        (state.rate[0], state.rate[1]) = (velocity * cos, velocity * sin);
        let radius = self.true_wheel().radius;
        for (wheel, speed) in state.wheels.iter_mut().zip(speeds) {
            wheel.spin = *speed;
            let rim = radius * *speed;
            let size = (velocity * velocity + rim * rim).sqrt();
            if size.value() > 0.0 {
                wheel.hold = Hold { travel: velocity / size, turn: rim / size };
            }
        }
        Ok(state)
    }
}
