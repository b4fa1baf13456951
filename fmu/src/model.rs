//! What a model must offer to become an FMU. Nothing here knows of a version of the standard.

use bekker_modeldescription::xml::Description;

/// How an advance went.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// All steps were made.
    Running,
    /// The simulation ended on the way, for a reason that belongs to the model's world (a rover that
    /// tips over), not through an error; the values are those of that instant.
    Ended {
        /// Why, in a sentence for people.
        reason: String,
    },
}

/// Why a model could not start or go on, in a sentence for people.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct Failure(pub String);

/// A model with variables, which advances in inner steps of its own.
///
/// References are places in [`Description::entries`]; [`Lifecycle`](crate::lifecycle::Lifecycle) checks them,
/// the values and the order of calls, so that a model need not.
pub trait Model: Send {
    /// The variables, with the values at which the model was loaded.
    fn description(&self) -> &Description;

    /// The value of a variable; of an output only after [`start`](Self::start). Enumerations as their number.
    fn get(&self, reference: usize) -> f64;

    /// Sets a parameter before [`start`](Self::start), or an input at any time.
    fn set(&mut self, reference: usize, value: f64);

    /// Computes the initial state from the parameters; called again where they change before the first step.
    ///
    /// # Errors
    /// A [`Failure`] where the parameters do not go together.
    fn start(&mut self) -> Result<(), Failure>;

    /// Step of the model's integrator with the present parameters, s.
    fn inner_step(&self) -> f64;

    /// Seconds since the start.
    fn elapsed(&self) -> f64;

    /// Makes `steps` inner steps with the present inputs.
    ///
    /// # Errors
    /// A [`Failure`] where the state cannot be continued.
    fn advance(&mut self, steps: u64) -> Result<Outcome, Failure>;

    /// Back to the values at which the model was loaded.
    fn reset(&mut self);

    /// A copy with the whole state, which goes on exactly as this one would.
    fn duplicate(&self) -> Box<dyn Model>;
}

impl Clone for Box<dyn Model> {
    fn clone(&self) -> Self {
        self.duplicate()
    }
}
