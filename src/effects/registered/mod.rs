//! Effects of other crates, registered beside the library.
//!
//! Such an effect is written like those of the library: a group of parameters, declared with
//! [`parameters!`](bekker_modeldescription::parameters), that implements [`Effect`](super::Effect) over any
//! [`Scalar`](crate::scalar::Scalar). [`Effects::register`](super::Effects::register) takes it in, under an id, and from
//! then on it is set, calibrated, diagnosed and listed like the others:
//!
//! ```
//! use bekker::effects::{BodyMotion, Effect, Facts};
//! use bekker::model::Model;
//! use bekker::modeldescription::{Lookup, Unit, parameters};
//! use bekker::scalar::Scalar;
//!
//! parameters! {
//!     /// Resistance that grows with the square of the speed.
//!     pub struct Drag {
//!         /// Force at 1 m/s.
//!         force: [Unit::NEWTON] = 0.0, 0.0..=100.0, Effect, "assumption";
//!     }
//! }
//!
//! impl<S: Scalar> Effect<S> for Drag<S> {
//!     fn facts(&self) -> Facts {
//!         Facts { seen_on_rover: &["wheel[1].torque"], ..Facts::USUAL }
//!     }
//!
//!     fn body_force(&self, motion: &BodyMotion<S>) -> Option<S> {
//!         (!self.force.is_exactly(0.0)).then(|| -(self.force * motion.velocity * motion.velocity.abs()))
//!     }
//! }
//!
//! let mut model = Model::preset("two_wheeled")?;
//! model.register_effect::<Drag>("square_drag", "Resistance that grows with the square of the speed.")?;
//! model.set("square_drag.force", 2.0)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The code of another crate cannot be compiled for every scalar here. It is compiled for `f64` and for
//! [`PartDual`](crate::scalar::PartDual); what has more derivatives calls the effect once for each part of them (see
//! [`Part`](crate::scalar::Part)), so derivatives are exact however many there are. A hook of a registered effect costs a
//! dynamic call; where none is registered, nothing.

mod family;
mod hooks;
mod parts;

use super::DefinitionError;
use super::facts::Facts;
use bekker_modeldescription::{Parameters, Variable, join};
use family::Family;
use std::any::TypeId;
use std::fmt;
use std::sync::Arc;

pub use family::Registrable;

/// What is the same for all scalars.
struct Shared {
    /// The type of the group, by which two registrations are the same.
    group: TypeId,
    id: String,
    about: String,
    facts: Facts,
    variables: Vec<Variable>,
    family: Family,
}

/// An effect of another crate in a rover.
#[derive(Clone)]
pub struct RegisteredEffect<S = f64> {
    shared: Arc<Shared>,
    /// Values of the parameters, in their order.
    values: Vec<S>,
}

impl<S: fmt::Debug> fmt::Debug for RegisteredEffect<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RegisteredEffect").field("id", &self.shared.id).field("values", &self.values).finish()
    }
}

impl<S: PartialEq> PartialEq for RegisteredEffect<S> {
    fn eq(&self, other: &Self) -> bool {
        self.is_the_same_as(other) && self.values == other.values
    }
}

impl<S> RegisteredEffect<S> {
    /// The id.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.shared.id
    }

    /// One line of meaning.
    #[must_use]
    pub fn about(&self) -> &str {
        &self.shared.about
    }

    /// What there is to know of the effect.
    #[must_use]
    pub fn facts(&self) -> Facts {
        self.shared.facts
    }

    /// Whether the other is the same effect, whatever the values of its parameters.
    fn is_the_same_as(&self, other: &Self) -> bool {
        (self.shared.group, &self.shared.id) == (other.shared.group, &other.shared.id)
    }
}

impl RegisteredEffect {
    /// The effect `G`, neutral, under `id`.
    fn new<G: Registrable>(id: &str, about: &str) -> Self {
        let mut group = G::default();
        let (mut variables, mut values) = (Vec::new(), Vec::new());
        group.visit(id, &mut |variable, value| {
            variables.push(variable);
            values.push(*value);
        });
        let family = Family::of::<G>();
        let (id, about, facts) = (id.to_owned(), about.trim().to_owned(), group.facts());
        Self { shared: Arc::new(Shared { group: TypeId::of::<G>(), id, about, facts, variables, family }), values }
    }
}

/// The effects of other crates in a rover, in the order in which they were registered.
#[derive(Clone, Debug, PartialEq)]
pub struct RegisteredEffects<S = f64>(Vec<RegisteredEffect<S>>);

impl<S> Default for RegisteredEffects<S> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<S> RegisteredEffects<S> {
    /// Whether there is none.
    #[must_use]
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The effects.
    pub fn iter(&self) -> impl Iterator<Item = &RegisteredEffect<S>> {
        self.0.iter()
    }

    pub(super) fn facts(&self) -> impl Iterator<Item = (&str, Facts)> {
        self.0.iter().map(|effect| (effect.id(), effect.facts()))
    }
}

impl<S: Copy> RegisteredEffects<S> {
    /// The same effects over another scalar.
    #[must_use]
    pub fn map<T>(&self, f: &dyn Fn(S) -> T) -> RegisteredEffects<T> {
        let mapped = |effect: &RegisteredEffect<S>| RegisteredEffect {
            shared: Arc::clone(&effect.shared),
            values: effect.values.iter().map(|value| f(*value)).collect(),
        };
        RegisteredEffects(self.0.iter().map(mapped).collect())
    }
}

impl RegisteredEffects {
    pub(super) fn add<G: Registrable>(&mut self, id: &str, about: &str) -> Result<(), DefinitionError> {
        self.add_copy(&RegisteredEffect::new::<G>(id, about))
    }

    /// Adds an effect; one that is there already stays as it is.
    pub(super) fn add_copy(&mut self, effect: &RegisteredEffect) -> Result<(), DefinitionError> {
        match self.0.iter().find(|known| known.id() == effect.id()) {
            Some(known) if known.is_the_same_as(effect) => Ok(()),
            Some(_) => {
                let owner = "another registered effect".to_owned();
                Err(DefinitionError::Taken { id: effect.id().to_owned(), owner })
            }
            None => {
                self.0.push(effect.clone());
                Ok(())
            }
        }
    }
}

impl<S: Copy> Parameters<S> for RegisteredEffects<S> {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
        for effect in &mut self.0 {
            for (variable, value) in effect.shared.variables.iter().zip(&mut effect.values) {
                f(Variable { name: join(prefix, &variable.name), ..variable.clone() }, value);
            }
        }
    }

    fn values(&self, f: &mut dyn FnMut(S)) {
        self.0.iter().flat_map(|effect| &effect.values).for_each(|value| f(*value));
    }
}
