//! Effects and control laws of other crates in a model.

use super::effects::{groups_of_names, refuse_group};
use super::{ControlKind, Model};
use crate::control::{ControlLaw, RegisteredLaw};
use crate::effects::{DefinitionError, Registrable};

impl Model {
    /// Registers the effect `G` of another crate, neutral, under `id`, with one line of meaning; see
    /// [`registered`](crate::effects::registered). One that is there already stays as it is.
    ///
    /// # Errors
    /// [`DefinitionError`] where the id is no name or taken; the model is unchanged then.
    pub fn register_effect<G: Registrable>(&mut self, id: &str, about: &str) -> Result<(), DefinitionError> {
        let mut effects = self.rover.effects.clone();
        effects.register::<G>(id, about)?;
        self.refuse_taken(id)?;
        self.rover.effects = effects;
        Ok(())
    }

    /// Registers a control law of another crate, whose gains are called `<id>.<name>` from now on; see
    /// [`registered`](crate::control::registered). It drives the rover where `control.kind` is
    /// [`Registered`](ControlKind::Registered), and takes the place of a law that was registered before.
    ///
    /// # Errors
    /// [`DefinitionError`] where the id is no name or taken; the model is unchanged then.
    pub fn register_law(&mut self, id: &str, law: impl ControlLaw) -> Result<(), DefinitionError> {
        crate::effects::custom::check_id(id)?;
        refuse_group(&groups_of_names(), id)?;
        if self.rover.effects.list().iter().any(|(effect, _)| effect == id) {
            let owner = "an effect of the model".to_owned();
            return Err(DefinitionError::Taken { id: id.to_owned(), owner });
        }
        self.registered_law = Some(RegisteredLaw::new(id, law));
        Ok(())
    }

    /// Lets a control law of another crate drive the rover: [`register_law`](Self::register_law), and the choice of it.
    ///
    /// # Errors
    /// As [`register_law`](Self::register_law).
    pub fn drive_by(&mut self, id: &str, law: impl ControlLaw) -> Result<(), DefinitionError> {
        self.register_law(id, law)?;
        self.control.kind = ControlKind::Registered;
        Ok(())
    }

    /// Control period where a controller decides, s; `None` where commands come from outside.
    #[must_use]
    pub fn control_period(&self) -> Option<f64> {
        match self.control.kind {
            ControlKind::Registered => self.registered_law.as_ref().map(RegisteredLaw::period),
            _ => self.control.period(),
        }
    }

    /// Refuses for an effect the id of something else in the model.
    pub(super) fn refuse_taken(&self, id: &str) -> Result<(), DefinitionError> {
        refuse_group(&groups_of_names(), id)?;
        if self.registered_law.as_ref().is_some_and(|law| law.id() == id) {
            let owner = "the control law of the model".to_owned();
            return Err(DefinitionError::Taken { id: id.to_owned(), owner });
        }
        Ok(())
    }
}
