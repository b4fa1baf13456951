//! The life of an instance: which calls are legal when, and what they do. Both versions of the standard
//! share it; a C border only translates.
//!
//! ```text
//! Instantiated --enter--> Initialization --exit--> Step --terminate--> Terminated
//!      ^                                            | failure             |
//!      +------------------- reset ---------------- Failed <               |
//!      +------------------- reset ------------------- ... ----------------+
//! ```

mod access;
mod refusal;

pub use access::Type;
pub use refusal::Refusal;

use crate::model::{Model, Outcome};
use std::fmt;

/// Largest relative distance of a communication step from a whole number of inner steps: a host that
/// computes its steps as differences of times around 1e6 steps is off by 1e-10 at most.
const STEP_TOLERANCE: f64 = 1e-9;

/// Largest distance of the host's time from the model's, relative to the communication step: the host
/// may have added up many steps. The model counts its own steps, so nothing follows from the difference.
const TIME_TOLERANCE: f64 = 1e-3;

/// Most inner steps in one communication step; at 1 ms this is eleven days of driving in one call, and
/// more is rather a slip of the host, which would not come back for hours.
const MOST_STEPS: f64 = 1e9;

/// Where an instance is in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Made, or reset: start values may be set.
    Instantiated,
    /// Start values may be set, and outputs that follow from them read.
    Initialization,
    /// Time goes on.
    Step,
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
            Self::Terminated => "terminated",
            Self::Failed => "failed",
        })
    }
}

/// Where a communication step arrived.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// The host's time that was reached, s.
    pub time: f64,
    /// Why the simulation ended, where it did.
    pub ended: Option<String>,
}

/// A model, guarded by the rules of the standard. A clone is a saved state.
#[derive(Clone)]
pub struct Lifecycle {
    model: Box<dyn Model>,
    phase: Phase,
    start: f64,
    stop: Option<f64>,
    /// Whether the initial state is older than the start values.
    stale: bool,
    ended: Option<String>,
}

impl Lifecycle {
    /// A new instance of `model`.
    #[must_use]
    pub fn new(model: Box<dyn Model>) -> Self {
        Self { model, phase: Phase::Instantiated, start: 0.0, stop: None, stale: true, ended: None }
    }

    /// Where the instance is in its life.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The model's time in the host's count, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        match self.phase {
            Phase::Instantiated | Phase::Initialization => self.start,
            _ => self.start + self.model.elapsed(),
        }
    }

    /// Enters initialization; time will go from `start` to `stop` or without end.
    ///
    /// # Errors
    /// [`Refusal::Order`], or [`Refusal::Time`] where the times are not finite or not in order.
    pub fn enter_initialization(&mut self, start: f64, stop: Option<f64>) -> Result<(), Refusal> {
        self.require(&[Phase::Instantiated])?;
        if !start.is_finite() {
            return Err(Refusal::Time(format!("the start time is {start}, expected a finite number")));
        }
        if let Some(stop) = stop.filter(|stop| !(stop.is_finite() && *stop > start)) {
            return Err(Refusal::Time(format!("the stop time is {stop}, expected a finite number above {start}")));
        }
        (self.start, self.stop, self.phase) = (start, stop, Phase::Initialization);
        Ok(())
    }

    /// Computes the initial state; then time can go on.
    ///
    /// # Errors
    /// [`Refusal::Order`], or [`Refusal::Failed`] where the parameters do not go together: they can be
    /// corrected and the call repeated.
    pub fn exit_initialization(&mut self) -> Result<(), Refusal> {
        self.require(&[Phase::Initialization])?;
        self.refresh()?;
        self.phase = Phase::Step;
        Ok(())
    }

    /// Goes on from the host's time `current` by `size`, s.
    ///
    /// # Errors
    /// [`Refusal::Order`], [`Refusal::Ended`]; [`Refusal::Time`] where `current` is not the model's time,
    /// or `size` not a positive whole multiple of the inner step, or the end beyond the stop time;
    /// [`Refusal::Failed`] where the model could not go on, after which only reading, reset and restoring
    /// are allowed.
    pub fn step(&mut self, current: f64, size: f64) -> Result<Progress, Refusal> {
        self.require(&[Phase::Step])?;
        if let Some(reason) = &self.ended {
            return Err(Refusal::Ended(reason.clone()));
        }
        let steps = self.whole_steps(current, size)?;
        match self.model.advance(steps) {
            Ok(Outcome::Running) => {}
            Ok(Outcome::Ended { reason }) => self.ended = Some(reason),
            Err(failure) => {
                self.phase = Phase::Failed;
                return Err(failure.into());
            }
        }
        Ok(Progress { time: self.time(), ended: self.ended.clone() })
    }

    /// How many inner steps a communication step is.
    fn whole_steps(&self, current: f64, size: f64) -> Result<u64, Refusal> {
        let time = self.time();
        if !(size.is_finite() && size > 0.0) {
            return Err(Refusal::Time(format!("the communication step is {size}, expected a positive number")));
        }
        let late = TIME_TOLERANCE * size;
        if !current.is_finite() || (current - time).abs() > late {
            return Err(Refusal::Time(format!("the step starts at {current} s, but this instance is at {time} s")));
        }
        if let Some(stop) = self.stop.filter(|stop| time + size > stop + late) {
            return Err(Refusal::Time(format!("the step ends at {} s, after the stop time {stop} s", time + size)));
        }
        let inner = self.model.inner_step();
        let steps = (size / inner).round();
        if steps < 1.0 || (steps * inner - size).abs() > STEP_TOLERANCE * size {
            return Err(Refusal::Time(format!(
                "the communication step {size} s is not a whole multiple of the model's inner step {inner} s"
            )));
        }
        if steps > MOST_STEPS {
            return Err(Refusal::Time(format!(
                "the communication step {size} s is {steps} inner steps, more than {MOST_STEPS} in one call"
            )));
        }
        Ok(steps as u64)
    }

    /// Ends the simulation; values remain readable.
    ///
    /// # Errors
    /// [`Refusal::Order`].
    pub fn terminate(&mut self) -> Result<(), Refusal> {
        self.require(&[Phase::Step])?;
        self.phase = Phase::Terminated;
        Ok(())
    }

    /// Back to how the instance was made, from any phase.
    pub fn reset(&mut self) {
        self.model.reset();
        (self.phase, self.start, self.stop, self.stale, self.ended) = (Phase::Instantiated, 0.0, None, true, None);
    }

    /// Marks the instance as failed, where a defect was caught outside it.
    pub fn fail(&mut self) {
        self.phase = Phase::Failed;
    }

    fn refresh(&mut self) -> Result<(), Refusal> {
        if self.stale {
            self.model.start()?;
            self.stale = false;
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
