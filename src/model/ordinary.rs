//! Which models are ordinary differential equations.

use super::{ControlKind, Model, Plant};
use crate::equations::NoEquations;
use bekker_modeldescription::{Parameters, Role};

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
        if let Some(id) = self.rover.effects.with_memory() {
            return Err(NoEquations::Memory { what: format!("the effect {id}"), expected: self.neutral(id) });
        }
        Ok(())
    }
    /// The effect `id` switched off, in words.
    fn neutral(&self, id: &str) -> String {
        let mut words = Vec::new();
        self.rover.effects.clone().visit("", &mut |variable, _| {
            let own = variable.name.split_once('.').is_some_and(|(group, _)| group == id);
            if own && variable.role == Role::Effect {
                words.push(format!("{} = {}", variable.name, variable.default));
            }
        });
        words.join(" and ")
    }
}
