//! Controllers of other crates.
//!
//! A control law is a group of gains, declared with [`parameters!`](bekker_modeldescription::parameters), that makes a
//! [`Controller`] for a nominal rover. [`Model::drive_by`](crate::model::Model::drive_by) gives it to a model, under an id;
//! its gains are then set by name like all other parameters, and the model drives, is cloned and saved as with a
//! controller of this crate.

use super::{ControlError, Controller, Nominal};
use crate::signals::{Command, Measurement, Reference};
use crate::snapshot::{Moving, Reader, SnapshotError, Writer};
use bekker_modeldescription::{Parameters, Variable};
use std::fmt;

/// Gains of a control law, and the controllers that it makes.
pub trait ControlLaw: Parameters<f64> + Clone + fmt::Debug + Send + Sync + 'static {
    /// The controller at work.
    type Controller: Controller + History + Clone + Send + Sync + 'static;

    /// Control period, over which a command is held, s.
    fn period(&self) -> f64;

    /// A controller at rest for the nominal rover.
    ///
    /// # Errors
    /// [`ControlError`] where the rover or a gain makes no sense.
    fn controller(&self, nominal: &Nominal) -> Result<Self::Controller, ControlError>;
}

/// What a controller remembers from one command to the next, as bytes: a run that is saved goes on to the same bits only
/// where all of it is written.
pub trait History {
    /// Writes all that a command changes.
    fn save(&self, to: &mut Writer);

    /// Reads it into a controller of the same rover, in the same order.
    ///
    /// # Errors
    /// [`SnapshotError`]; the controller is of no use then.
    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError>;
}

/// A law of any type.
trait AnyLaw: fmt::Debug + Send + Sync {
    fn copy(&self) -> Box<dyn AnyLaw>;
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut f64));
    fn values(&self, f: &mut dyn FnMut(f64));
    fn period(&self) -> f64;
    fn controller(&self, nominal: &Nominal) -> Result<Box<dyn AnyController>, ControlError>;
}

impl<L: ControlLaw> AnyLaw for L {
    fn copy(&self) -> Box<dyn AnyLaw> {
        Box::new(self.clone())
    }

    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut f64)) {
        Parameters::visit(self, prefix, f);
    }

    fn values(&self, f: &mut dyn FnMut(f64)) {
        Parameters::values(self, f);
    }

    fn period(&self) -> f64 {
        ControlLaw::period(self)
    }

    fn controller(&self, nominal: &Nominal) -> Result<Box<dyn AnyController>, ControlError> {
        Ok(Box::new(ControlLaw::controller(self, nominal)?))
    }
}

/// A controller of any type.
trait AnyController: Controller + History + Send + Sync {
    fn copy(&self) -> Box<dyn AnyController>;
}

impl<C: Controller + History + Clone + Send + Sync + 'static> AnyController for C {
    fn copy(&self) -> Box<dyn AnyController> {
        Box::new(self.clone())
    }
}

/// A control law of another crate in a model, with its gains.
pub struct RegisteredLaw {
    id: String,
    law: Box<dyn AnyLaw>,
}

impl Clone for RegisteredLaw {
    fn clone(&self) -> Self {
        Self { id: self.id.clone(), law: self.law.copy() }
    }
}

impl fmt::Debug for RegisteredLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RegisteredLaw").field("id", &self.id).field("law", &self.law).finish()
    }
}

impl RegisteredLaw {
    pub(crate) fn new(id: &str, law: impl ControlLaw) -> Self {
        Self { id: id.to_owned(), law: Box::new(law) }
    }

    /// The id: the first part of the names of its gains.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.id
    }

    /// Control period, s.
    pub(crate) fn period(&self) -> f64 {
        self.law.period()
    }

    pub(crate) fn controller(&self, nominal: &Nominal) -> Result<RegisteredController, ControlError> {
        Ok(RegisteredController(self.law.controller(nominal)?))
    }
}

/// The gains, called `<id>.<name>`.
impl Parameters<f64> for RegisteredLaw {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut f64)) {
        self.law.visit(&bekker_modeldescription::join(prefix, &self.id), f);
    }

    fn values(&self, f: &mut dyn FnMut(f64)) {
        self.law.values(f);
    }
}

/// A controller of another crate at work.
pub(crate) struct RegisteredController(Box<dyn AnyController>);

impl Clone for RegisteredController {
    fn clone(&self) -> Self {
        Self(self.0.copy())
    }
}

impl Moving for RegisteredController {
    fn save(&self, to: &mut Writer) {
        self.0.save(to);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        self.0.load(from)
    }
}

impl Controller for RegisteredController {
    fn command(&mut self, measured: &Measurement, goal: &Reference, command: &mut Command) -> Result<(), ControlError> {
        self.0.command(measured, goal, command)
    }

    fn reset(&mut self) {
        self.0.reset();
    }
}
