//! Which models are ordinary differential equations.

use super::{ControlKind, Model, Plant};
use crate::equations::NoEquations;

impl Model {
    /// Whether a run of this model is explicit differential equations and nothing else, see [`crate::equations`].
    ///
    /// # Errors
    /// [`NoEquations`] names what is not.
    pub fn check_equations(&self) -> Result<(), NoEquations> {
        if self.stepping.plant == Plant::RigidBodies {
            return Err(NoEquations::RigidBodies);
        }
        if self.control.kind != ControlKind::Torque {
            return Err(NoEquations::Drive);
        }
        let memory = |what, expected| Err(NoEquations::Memory { what, expected });
        let effects = &self.rover.effects;
        if effects.remember() {
            return memory("the effect multi_pass", "multi_pass.growth = 0");
        }
        if effects.sensor_lag.acts() {
            return memory("the effect sensor_lag", "sensor_lag.time_constant = 0 and sensor_lag.dead_time = 0");
        }
        Ok(())
    }
}
