//! What a model must offer to become an FMU. It is the same for all versions of the standard.

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

impl Failure {
    /// The failure of a model that does not offer `what`.
    #[must_use]
    pub fn unsupported(what: &str) -> Self {
        Self(format!("this model does not offer {what}"))
    }
}

/// What the handling of an event has changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EventOutcome {
    /// Whether continuous states have other values than before.
    pub states_changed: bool,
    /// Why the simulation has to end, where it has.
    pub terminate: Option<String>,
    /// When the next event of time comes, s; `None` where none is known.
    pub next_time: Option<f64>,
}

/// A model as explicit ordinary differential equations, x' = f(x, u, t), which the importer integrates.
///
/// Inputs and parameters are set through [`FmuModel::set`], outputs read through [`FmuModel::get`]; they belong to the
/// states of the last call of [`rates`](Self::rates).
pub trait Continuous {
    /// Whether the present parameters leave nothing but ordinary differential equations.
    ///
    /// # Errors
    /// A [`Failure`] that names what keeps a memory which is no state of such an equation.
    fn check(&self) -> Result<(), Failure>;

    /// Puts the equations where co-simulation is, so that states, derivatives and event indicators can be read there too.
    ///
    /// # Errors
    /// As [`rates`](Self::rates).
    fn follow(&mut self) -> Result<(), Failure>;

    /// References of the continuous states, in their order.
    fn states(&self) -> &[usize];

    /// References of their derivatives, in the same order.
    fn derivatives(&self) -> &[usize];

    /// Takes the time over, s.
    fn set_time(&mut self, time: f64);

    /// Takes the states over.
    ///
    /// # Errors
    /// A [`Failure`] for a wrong number of states, or one that is not finite; nothing is changed then.
    fn set_states(&mut self, x: &[f64]) -> Result<(), Failure>;

    /// The states.
    fn get_states(&self, x: &mut [f64]);

    /// Typical sizes of the states, by which an integrator scales its tolerances.
    fn nominals(&self, x: &mut [f64]);

    /// The derivatives of the states; also brings the outputs up to date.
    ///
    /// # Errors
    /// A [`Failure`] where the equations have no value at these states.
    fn rates(&mut self, dx: &mut [f64]) -> Result<(), Failure>;

    /// How many event indicators there are.
    fn indicators(&self) -> usize;

    /// Functions whose change of sign is an event.
    ///
    /// # Errors
    /// As [`rates`](Self::rates).
    fn event_indicators(&mut self, z: &mut [f64]) -> Result<(), Failure>;

    /// Takes over that the importer has set the states at an event, not integrated them.
    fn states_set_at_event(&mut self);

    /// Takes an event over, after which the integrator starts afresh.
    ///
    /// # Errors
    /// As [`rates`](Self::rates).
    fn handle_event(&mut self) -> Result<EventOutcome, Failure>;

    /// Takes over that the integrator has accepted a step up to the present time and states.
    ///
    /// # Errors
    /// As [`rates`](Self::rates), and where the integrator does not follow the equations, as an explicit method with too large a
    /// step.
    fn completed_step(&mut self) -> Result<EventOutcome, Failure>;
}

/// A model with variables, which advances in inner steps of its own.
///
/// References are places in [`Description::entries`]; [`Lifecycle`](crate::lifecycle::Lifecycle) checks them,
/// the values and the order of calls, so that a model need not.
pub trait FmuModel: Send {
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

    /// Goes on to `time` seconds since the start, any time from the present one on, with the present inputs.
    ///
    /// # Errors
    /// A [`Failure`] where the state cannot be continued, or `time` lies before the present one.
    fn advance_to(&mut self, _time: f64) -> Result<Outcome, Failure> {
        Err(Failure::unsupported("communication points between its inner steps"))
    }

    /// Back to the values at which the model was loaded.
    fn reset(&mut self);

    /// A copy with the whole state, which goes on exactly as this one would.
    fn duplicate(&self) -> Box<dyn FmuModel>;

    /// The whole state as bytes: values, time, everything that moves. They also serve in another process.
    ///
    /// # Errors
    /// A [`Failure`] where the model holds something that cannot be written.
    fn serialise(&self) -> Result<Vec<u8>, Failure> {
        Err(Failure::unsupported("its state as bytes"))
    }

    /// Takes a state over that [`serialise`](Self::serialise) wrote, here or in another process.
    ///
    /// # Errors
    /// A [`Failure`] for bytes of another model or version, for truncated and for damaged ones; nothing is changed
    /// then.
    fn deserialise(&mut self, _bytes: &[u8]) -> Result<(), Failure> {
        Err(Failure::unsupported("its state as bytes"))
    }

    /// Derivatives of `unknowns` by `knowns` times `seed` (one value a known) into `out` (one value an unknown), at
    /// the present point.
    ///
    /// # Errors
    /// A [`Failure`] where a pair has no derivative here.
    fn directional(
        &mut self,
        _unknowns: &[usize],
        _knowns: &[usize],
        _seed: &[f64],
        _out: &mut [f64],
    ) -> Result<(), Failure> {
        Err(Failure::unsupported("derivatives of its outputs"))
    }

    /// The transposed product: `seed` has one value an unknown, `out` one a known.
    ///
    /// # Errors
    /// As [`directional`](Self::directional).
    fn adjoint(
        &mut self,
        _unknowns: &[usize],
        _knowns: &[usize],
        _seed: &[f64],
        _out: &mut [f64],
    ) -> Result<(), Failure> {
        Err(Failure::unsupported("derivatives of its outputs"))
    }

    /// The model as ordinary differential equations (Model Exchange); `None` where it is none, as with a controller.
    fn continuous(&mut self) -> Option<&mut dyn Continuous> {
        None
    }
}

impl Clone for Box<dyn FmuModel> {
    fn clone(&self) -> Self {
        self.duplicate()
    }
}
