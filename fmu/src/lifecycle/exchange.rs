//! Model exchange: the importer integrates, the model gives derivatives and events.

use super::{Interface, Lifecycle, Phase, Refusal};
use crate::model::{Continuous, EventOutcome};

impl Lifecycle {
    /// The differential equations of the model.
    pub(super) fn equations(&mut self) -> Result<&mut dyn Continuous, Refusal> {
        if self.interface != Interface::ModelExchange {
            return Err(Refusal::Unsupported(
                "the function is for model exchange, the instance for co-simulation".into(),
            ));
        }
        self.model.continuous().ok_or_else(|| Refusal::Unsupported("the FMU offers co-simulation only".into()))
    }

    /// Computes derivatives and outputs where time, states or inputs have changed.
    pub(super) fn evaluate(&mut self) -> Result<(), Refusal> {
        if self.fresh || self.interface != Interface::ModelExchange {
            return Ok(());
        }
        let mut rates = std::mem::take(&mut self.rates);
        let evaluated = self.equations().and_then(|equations| equations.rates(&mut rates).map_err(Refusal::Discarded));
        self.rates = rates;
        evaluated?;
        self.fresh = true;
        Ok(())
    }

    /// Enters event mode.
    ///
    /// # Errors
    /// [`Refusal::Order`], or [`Refusal::Unsupported`] in co-simulation without events.
    pub fn enter_event_mode(&mut self) -> Result<(), Refusal> {
        match self.interface {
            Interface::CoSimulation { events: false } => {
                let text = "event mode is not used (co-simulation with eventModeUsed = false)";
                return Err(Refusal::Unsupported(text.into()));
            }
            Interface::CoSimulation { events: true } => self.require(&[Phase::Step])?,
            Interface::ModelExchange => self.require(&[Phase::ContinuousTime])?,
        }
        self.phase = Phase::Event;
        Ok(())
    }

    /// Takes an event over. Its times are the host's.
    ///
    /// # Errors
    /// [`Refusal::Order`]; [`Refusal::Failed`] where the model cannot go on.
    pub fn update_discrete_states(&mut self) -> Result<EventOutcome, Refusal> {
        self.require(&[Phase::Event])?;
        match self.interface {
            Interface::CoSimulation { .. } => {
                Ok(EventOutcome { terminate: self.ended.clone(), ..EventOutcome::default() })
            }
            Interface::ModelExchange => {
                self.evaluate()?;
                let outcome = self.equations()?.handle_event();
                self.outcome(outcome)
            }
        }
    }

    /// Enters the mode in which the importer integrates.
    ///
    /// # Errors
    /// [`Refusal::Order`], or [`Refusal::Unsupported`] in co-simulation.
    pub fn enter_continuous_time(&mut self) -> Result<(), Refusal> {
        self.equations()?;
        self.require(&[Phase::Event])?;
        self.phase = Phase::ContinuousTime;
        Ok(())
    }

    /// Takes over that the importer has accepted a step.
    ///
    /// # Errors
    /// [`Refusal::Order`]; [`Refusal::Failed`] where the model cannot go on.
    pub fn completed_step(&mut self) -> Result<EventOutcome, Refusal> {
        self.equations()?;
        self.require(&[Phase::ContinuousTime])?;
        self.evaluate()?;
        let outcome = self.equations()?.completed_step();
        self.outcome(outcome)
    }

    fn outcome(&mut self, outcome: Result<EventOutcome, crate::model::Failure>) -> Result<EventOutcome, Refusal> {
        match outcome {
            Ok(mut outcome) => {
                self.fresh &= !outcome.states_changed;
                self.ended = outcome.terminate.clone().or(self.ended.take());
                outcome.next_time = outcome.next_time.map(|time| time + self.start);
                Ok(outcome)
            }
            Err(failure) => {
                self.phase = Phase::Failed;
                Err(failure.into())
            }
        }
    }

    /// Takes the host's time over.
    ///
    /// # Errors
    /// [`Refusal::Order`]; [`Refusal::Time`] where it is not finite or before the start.
    pub fn set_time(&mut self, time: f64) -> Result<(), Refusal> {
        self.equations()?;
        self.require(&[Phase::Event, Phase::ContinuousTime])?;
        if !(time.is_finite() && time >= self.start) {
            let start = self.start;
            return Err(Refusal::Time(format!("the time is {time}, expected a finite number of at least {start} s")));
        }
        let clock = time - self.start;
        self.equations()?.set_time(clock);
        (self.clock, self.fresh) = (clock, false);
        Ok(())
    }

    /// Takes the continuous states over.
    ///
    /// # Errors
    /// [`Refusal::Order`]; [`Refusal::Failed`] for a wrong number or a value that is not finite.
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), Refusal> {
        self.equations()?;
        self.require(&[Phase::Event, Phase::ContinuousTime])?;
        self.count("continuous states", states.len(), self.rates.len())?;
        let at_event = self.phase == Phase::Event;
        let equations = self.equations()?;
        equations.set_states(states)?;
        if at_event {
            equations.states_set_at_event();
        }
        self.fresh = false;
        Ok(())
    }

    /// The continuous states.
    ///
    /// # Errors
    /// [`Refusal::Order`]; [`Refusal::Count`].
    pub fn states(&mut self, states: &mut [f64]) -> Result<(), Refusal> {
        self.readable(states.len())?;
        self.equations()?.get_states(states);
        Ok(())
    }

    /// Typical sizes of the continuous states.
    ///
    /// # Errors
    /// [`Refusal::Order`]; [`Refusal::Count`].
    pub fn nominals(&mut self, nominals: &mut [f64]) -> Result<(), Refusal> {
        self.readable(nominals.len())?;
        self.equations()?.nominals(nominals);
        Ok(())
    }

    /// The derivatives of the continuous states.
    ///
    /// # Errors
    /// [`Refusal::Order`]; [`Refusal::Count`]; [`Refusal::Discarded`] where they have no value.
    pub fn state_derivatives(&mut self, derivatives: &mut [f64]) -> Result<(), Refusal> {
        self.readable(derivatives.len())?;
        self.evaluate()?;
        derivatives.copy_from_slice(&self.rates);
        Ok(())
    }

    /// The event indicators.
    ///
    /// # Errors
    /// As [`state_derivatives`](Self::state_derivatives).
    pub fn event_indicators(&mut self, indicators: &mut [f64]) -> Result<(), Refusal> {
        self.equations()?;
        self.count("event indicators", indicators.len(), self.indicators)?;
        self.begun()?;
        self.evaluate()?;
        self.equations()?.event_indicators(indicators).map_err(Refusal::Discarded)
    }

    /// How many continuous states and event indicators there are.
    ///
    /// # Errors
    /// [`Refusal::Unsupported`] in co-simulation.
    pub fn sizes(&mut self) -> Result<(usize, usize), Refusal> {
        self.equations()?;
        Ok((self.rates.len(), self.indicators))
    }

    fn readable(&mut self, count: usize) -> Result<(), Refusal> {
        self.equations()?;
        self.count("continuous states", count, self.rates.len())?;
        self.begun()
    }

    /// Values exist from initialization on.
    fn begun(&mut self) -> Result<(), Refusal> {
        self.require(&[Phase::Initialization, Phase::Event, Phase::ContinuousTime, Phase::Terminated, Phase::Failed])?;
        if self.phase == Phase::Initialization {
            self.refresh()?;
        }
        Ok(())
    }

    fn count(&self, what: &'static str, given: usize, expected: usize) -> Result<(), Refusal> {
        if given == expected { Ok(()) } else { Err(Refusal::Count { what, given, expected }) }
    }
}
