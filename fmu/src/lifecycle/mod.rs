//! The life of an instance: which calls are legal when, and what they do. Both versions of the standard
//! share it; a C border only translates.
//!
//! ```text
//! Instantiated --enter--> Initialization --exit--> Step (co-simulation) <----> Event
//!      ^                        |                        |                      |
//!      |                        +-exit--> Event (model exchange) <--> ContinuousTime
//!      +------ reset, from every phase ---- Terminated <-- terminate, or Failed <-- a failure
//! ```

mod access;
mod bytes;
mod derivatives;
mod exchange;
mod refusal;
mod stepping;

pub use access::Type;
pub use derivatives::Direction;
pub use refusal::Refusal;
pub use stepping::{LONGEST, Progress};

use crate::model::FmuModel;
use std::fmt;
use stepping::Slope;

/// Who integrates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interface {
    /// The model, between communication points.
    CoSimulation {
        /// Whether the importer handles events (FMI 3.0): then it may enter [`Phase::Event`], and steps follow it.
        events: bool,
    },
    /// The importer.
    ModelExchange,
}

/// Where an instance is in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Made, or reset: start values may be set.
    Instantiated,
    /// Start values may be set, and outputs that follow from them read.
    Initialization,
    /// Co-simulation: time goes on.
    Step,
    /// Co-simulation: inside a step, in the importer's callback.
    Intermediate,
    /// At an event: values may change by jumps.
    Event,
    /// Model exchange: the importer integrates.
    ContinuousTime,
    /// At its end: values may be read.
    Terminated,
    /// A step or a start failed: values may be read; reset or restore to go on.
    Failed,
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Instantiated => "instantiated",
            Self::Initialization => "initialization mode",
            Self::Step => "step mode",
            Self::Intermediate => "intermediate update mode",
            Self::Event => "event mode",
            Self::ContinuousTime => "continuous-time mode",
            Self::Terminated => "terminated",
            Self::Failed => "failed",
        })
    }
}

/// A model, guarded by the rules of the standard. A clone is a saved state.
#[derive(Clone)]
pub struct Lifecycle {
    model: Box<dyn FmuModel>,
    interface: Interface,
    phase: Phase,
    start: f64,
    stop: Option<f64>,
    /// Model exchange: the importer's time since the start, s.
    clock: f64,
    /// Whether the initial state is older than the start values.
    stale: bool,
    /// Model exchange: whether outputs and derivatives belong to the present time, states and inputs.
    fresh: bool,
    /// Model exchange: the derivatives of the states.
    rates: Vec<f64>,
    /// How many event indicators there are.
    indicators: usize,
    /// How inputs go on within the next step.
    slopes: Vec<Slope>,
    ended: Option<String>,
}

impl Lifecycle {
    /// A new instance of `model`, for co-simulation without events.
    #[must_use]
    pub fn new(model: Box<dyn FmuModel>) -> Self {
        Self::cosimulation(model, false)
    }

    /// A new instance for co-simulation; `events` as in [`Interface::CoSimulation`].
    #[must_use]
    pub fn cosimulation(mut model: Box<dyn FmuModel>, events: bool) -> Self {
        let indicators = model.continuous().map_or(0, |equations| equations.indicators());
        Self {
            model,
            interface: Interface::CoSimulation { events },
            phase: Phase::Instantiated,
            start: 0.0,
            stop: None,
            clock: 0.0,
            stale: true,
            fresh: false,
            rates: Vec::new(),
            indicators,
            slopes: Vec::new(),
            ended: None,
        }
    }

    /// A new instance for model exchange.
    ///
    /// # Errors
    /// [`Refusal::Unsupported`] where the model is no system of differential equations.
    pub fn exchange(mut model: Box<dyn FmuModel>) -> Result<Self, Refusal> {
        let states = match model.continuous() {
            Some(equations) => equations.states().len(),
            None => return Err(Refusal::Unsupported("the FMU offers co-simulation only".into())),
        };
        let mut life = Self::cosimulation(model, false);
        life.interface = Interface::ModelExchange;
        life.rates = vec![0.0; states];
        Ok(life)
    }

    /// Where the instance is in its life.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The variables.
    #[must_use]
    pub fn description(&self) -> &bekker_modeldescription::xml::Description {
        self.model.description()
    }

    /// The model's time in the host's count, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        match (self.phase, self.interface) {
            (Phase::Instantiated | Phase::Initialization, _) => self.start,
            (_, Interface::ModelExchange) => self.start + self.clock,
            _ => self.start + self.model.elapsed(),
        }
    }

    /// Seconds since the start.
    #[must_use]
    pub fn elapsed(&self) -> f64 {
        self.model.elapsed()
    }

    /// A time of the host's in seconds since the start.
    #[must_use]
    pub fn since_start(&self, time: f64) -> f64 {
        time - self.start
    }

    /// Why the simulation ended, where it has.
    #[must_use]
    pub fn ended(&self) -> Option<&str> {
        self.ended.as_deref()
    }

    /// Says, before initialization, from when to when time will go (FMI 2.0 does so in a call of its own).
    ///
    /// # Errors
    /// [`Refusal::Order`], or [`Refusal::Time`] where the times are not finite or not in order.
    pub fn set_up(&mut self, start: f64, stop: Option<f64>) -> Result<(), Refusal> {
        self.require(&[Phase::Instantiated])?;
        if !start.is_finite() {
            return Err(Refusal::Time(format!("the start time is {start}, expected a finite number")));
        }
        if let Some(stop) = stop.filter(|stop| !(stop.is_finite() && *stop > start)) {
            return Err(Refusal::Time(format!("the stop time is {stop}, expected a finite number above {start}")));
        }
        (self.start, self.stop) = (start, stop);
        Ok(())
    }

    /// Enters initialization; time will go from `start` to `stop` or without end.
    ///
    /// # Errors
    /// As [`set_up`](Self::set_up).
    pub fn enter_initialization(&mut self, start: f64, stop: Option<f64>) -> Result<(), Refusal> {
        self.set_up(start, stop)?;
        self.phase = Phase::Initialization;
        Ok(())
    }

    /// Enters initialization with the times of [`set_up`](Self::set_up), or from 0 without end.
    ///
    /// # Errors
    /// [`Refusal::Order`].
    pub fn enter_initialization_as_set_up(&mut self) -> Result<(), Refusal> {
        self.require(&[Phase::Instantiated])?;
        self.phase = Phase::Initialization;
        Ok(())
    }

    /// Computes the initial state; then time can go on.
    ///
    /// # Errors
    /// [`Refusal::Order`], or [`Refusal::Failed`] where the parameters do not go together, or in model exchange leave
    /// no differential equations: they can be corrected and the call repeated.
    pub fn exit_initialization(&mut self) -> Result<(), Refusal> {
        self.require(&[Phase::Initialization])?;
        self.refresh()?;
        self.phase = match self.interface {
            Interface::CoSimulation { events: false } => Phase::Step,
            Interface::CoSimulation { events: true } => Phase::Event,
            Interface::ModelExchange => {
                self.equations()?.check()?;
                Phase::Event
            }
        };
        Ok(())
    }

    /// Ends the simulation; values remain readable.
    ///
    /// # Errors
    /// [`Refusal::Order`].
    pub fn terminate(&mut self) -> Result<(), Refusal> {
        match self.interface {
            Interface::CoSimulation { events: false } => self.require(&[Phase::Step])?,
            Interface::CoSimulation { events: true } => self.require(&[Phase::Step, Phase::Event])?,
            Interface::ModelExchange => self.require(&[Phase::Event, Phase::ContinuousTime])?,
        }
        self.phase = Phase::Terminated;
        Ok(())
    }

    /// Back to how the instance was made, from any phase.
    pub fn reset(&mut self) {
        self.model.reset();
        (self.phase, self.start, self.stop, self.stale, self.ended) = (Phase::Instantiated, 0.0, None, true, None);
        (self.clock, self.fresh) = (0.0, false);
        self.slopes.clear();
    }

    /// Marks the instance as failed, where a defect was caught outside it.
    pub fn fail(&mut self) {
        self.phase = Phase::Failed;
    }

    /// Brings the initial state up to date with the start values.
    fn refresh(&mut self) -> Result<(), Refusal> {
        if self.stale {
            self.model.start()?;
            (self.stale, self.fresh) = (false, false);
        }
        Ok(())
    }

    fn require(&self, legal: &[Phase]) -> Result<(), Refusal> {
        if legal.contains(&self.phase) {
            return Ok(());
        }
        let words: Vec<String> = legal.iter().map(|phase| format!("`{phase}`")).collect();
        Err(Refusal::Order { phase: self.phase, expected: words.join(" or ") })
    }
}
