//! The plant as differential equations (Model Exchange).

use super::by_reference::{from_values, into_places};
use super::plant::{AdvancedBy, RoverFmu};
use crate::model::{Continuous, EventOutcome, Failure};
use bekker::equations::{Equations, NoEquations, derivative_of};
use bekker::model::{AnyPlant, Model as RoverModel, Run};
use bekker::sensors::Sensors;
use bekker::simulation::{Event, Status};
use bekker_modeldescription::xml::Entry;
use bekker_modeldescription::{Lookup, Parameters};
use std::ops::Range;

/// Prefix of the states' names: many have those of signals, which sensors among the effects may distort.
const PREFIX: &str = "state";

/// The equations of a rover whose states the importer integrates.
#[derive(Clone)]
pub(super) struct ModelExchange {
    pub equations: Equations,
    states: Vec<usize>,
    derivatives: Vec<usize>,
    /// Time, and that of the last accepted step, s.
    pub time: f64,
    pub accepted: f64,
    pub stuck: bool,
    /// Whether outputs and rates belong to the present states and inputs.
    fresh: bool,
}

impl ModelExchange {
    /// The equations of a plant that may have them: effects with a memory may be switched off.
    pub fn of(model: &RoverModel, run: &Run) -> Option<Self> {
        let refused = model.check_equations();
        if matches!(refused, Err(NoEquations::Drive | NoEquations::RigidBodies)) {
            return None;
        }
        Some(Self {
            equations: equations(run)?,
            states: Vec::new(),
            derivatives: Vec::new(),
            time: 0.0,
            accepted: 0.0,
            stuck: false,
            fresh: false,
        })
    }

    /// Entries of the states, of which the first will have the reference `first`, and of their derivatives.
    pub fn entries(&self, first: usize) -> (Vec<Entry>, Vec<Entry>) {
        let mut sizes = Vec::new();
        self.equations.nominals(|size| sizes.push(size));
        let mut list = Vec::new();
        self.equations.states().visit(PREFIX, &mut |variable, _| list.push(variable));
        let derivative = |(k, variable)| Entry::derivative(derivative_of(variable), first + k);
        let derivatives = list.iter().enumerate().map(derivative).collect();
        let states = list.into_iter().zip(sizes).map(|(variable, size)| Entry::state(variable, size)).collect();
        (states, derivatives)
    }

    /// Lets the next question evaluate anew.
    pub fn stale(&mut self) {
        self.fresh = false;
    }

    /// Takes the references of states and derivatives over.
    pub fn refer(&mut self, states: Range<usize>, derivatives: Range<usize>) {
        (self.states, self.derivatives) = (states.collect(), derivatives.collect());
    }
}

fn equations(run: &Run) -> Option<Equations> {
    match run.simulation() {
        AnyPlant::JointCoordinates(simulation) => Some(Equations::at(simulation)),
        #[allow(unreachable_patterns, reason = "without the feature `rigid` there is one plant")]
        _ => None,
    }
}

impl RoverFmu {
    /// Puts the equations at the run's state.
    pub(super) fn begin(&mut self) -> Result<(), Failure> {
        let Some(model_exchange) = &mut self.model_exchange else { return Ok(()) };
        if let Some(equations) = equations(&self.run) {
            model_exchange.equations = equations;
        }
        (model_exchange.time, model_exchange.accepted, model_exchange.stuck) = (0.0, 0.0, false);
        (model_exchange.fresh, self.motion) = (false, AdvancedBy::Steps);
        self.bring_up()
    }

    /// The equations at the present point: those that an integrator moves, or where the run is.
    pub(super) fn present(&self) -> Result<Equations, Failure> {
        let none = || Failure::unsupported("derivatives: only a rover whose wheels' torques are its inputs has them");
        let model_exchange = self.model_exchange.as_ref().ok_or_else(none)?;
        let mut there = match self.motion {
            AdvancedBy::Integrator => model_exchange.equations.clone(),
            AdvancedBy::Steps | AdvancedBy::BetweenSteps => equations(&self.run).ok_or_else(none)?,
        };
        there.torques_mut().copy_from_slice(&self.values[self.references.inputs.clone()]);
        Ok(there)
    }

    /// Brings rates and outputs up to the present states and inputs.
    fn bring_up(&mut self) -> Result<(), Failure> {
        if self.motion == AdvancedBy::Integrator {
            self.tune()?;
        }
        let Some(model_exchange) = &mut self.model_exchange else { return Ok(()) };
        let torques = &self.values[self.references.inputs.clone()];
        if model_exchange.fresh && model_exchange.equations.torques_mut() == torques {
            return Ok(());
        }
        model_exchange.equations.torques_mut().copy_from_slice(torques);
        let time = model_exchange.time;
        model_exchange.equations.evaluate().map_err(|error| Failure(format!("at t = {time} s: {error}")))?;
        model_exchange.fresh = true;
        let equations = &mut model_exchange.equations;
        {
            let mut put = into_places(&mut self.values[self.references.states.clone()]);
            equations.visit_states(|state| put(*state));
        }
        equations.rates(&mut into_places(&mut self.values[self.references.derivatives.clone()]));
        if self.motion == AdvancedBy::Integrator {
            equations.signals().values(&mut into_places(&mut self.values[self.references.signals.clone()]));
            // Sensors without errors, which `check` demands.
            for (place, signal) in self.references.measured.clone().zip(&self.references.measured_signals) {
                self.values[place] = self.values[*signal];
            }
            let ended = if model_exchange.stuck { Some(Event::Stuck) } else { equations.ended() };
            let status = ended.map_or(Status::Running, Status::Ended).place() as f64;
            (self.values[self.references.event], self.values[self.references.event_code]) = (status, status);
        }
        Ok(())
    }

    fn ended(&self) -> EventOutcome {
        let ended = self.model_exchange.as_ref().and_then(|model_exchange| {
            if model_exchange.stuck { Some(Event::Stuck) } else { model_exchange.equations.ended() }
        });
        EventOutcome { terminate: ended.map(|event| event.to_string()), ..EventOutcome::default() }
    }
}

/// The importer's integrator may try any finite states: the equations are continued where no rover can be.
impl Continuous for RoverFmu {
    fn check(&self) -> Result<(), Failure> {
        self.tuned.check_equations().map_err(|error| Failure(error.to_string()))?;
        let mut sensors = self.tuned.sensors;
        let neutral = Sensors::default().list();
        match sensors.list().into_iter().zip(neutral).find(|((_, value), (_, neutral))| value != neutral) {
            None => Ok(()),
            Some(((variable, _), (_, neutral))) => Err(Failure(format!(
                "`sensor.{}` makes measurements that are sampled or noisy, which is no differential equation; \
                 expected {neutral}, or co-simulation",
                variable.name
            ))),
        }
    }

    fn follow(&mut self) -> Result<(), Failure> {
        let present = self.present()?;
        let time = self.time;
        if let Some(model_exchange) = &mut self.model_exchange {
            (model_exchange.equations, model_exchange.fresh) = (present, false);
            if self.motion != AdvancedBy::Integrator {
                model_exchange.time = time;
            }
        }
        self.bring_up()
    }

    fn states(&self) -> &[usize] {
        self.model_exchange.as_ref().map_or(&[], |model_exchange| &model_exchange.states)
    }

    fn derivatives(&self) -> &[usize] {
        self.model_exchange.as_ref().map_or(&[], |model_exchange| &model_exchange.derivatives)
    }

    fn set_time(&mut self, time: f64) {
        if let Some(model_exchange) = &mut self.model_exchange {
            (model_exchange.time, self.motion) = (time, AdvancedBy::Integrator);
        }
        self.time = time;
    }

    fn set_states(&mut self, x: &[f64]) -> Result<(), Failure> {
        let Some(model_exchange) = &mut self.model_exchange else { return Ok(()) };
        let expected = model_exchange.states.len();
        if x.len() != expected {
            return Err(Failure(format!("{} continuous states were given, expected {expected}", x.len())));
        }
        if let Some(k) = x.iter().position(|value| !value.is_finite()) {
            let name = &self.description.entries[model_exchange.states[k]].variable.name;
            return Err(Failure(format!("`{name}` = {}, expected a finite number", x[k])));
        }
        model_exchange.equations.visit_states(from_values(x));
        (model_exchange.fresh, self.motion) = (false, AdvancedBy::Integrator);
        Ok(())
    }

    fn get_states(&self, x: &mut [f64]) {
        if let Some(model_exchange) = &self.model_exchange {
            model_exchange.equations.states().values(&mut into_places(x));
        }
    }

    fn nominals(&self, x: &mut [f64]) {
        for (place, reference) in x.iter_mut().zip(Continuous::states(self)) {
            *place = self.description.entries[*reference].nominal.unwrap_or(1.0);
        }
    }

    fn rates(&mut self, dx: &mut [f64]) -> Result<(), Failure> {
        if let Some(model_exchange) = &mut self.model_exchange
            && self.motion != AdvancedBy::Integrator
        {
            (model_exchange.fresh, self.motion) = (false, AdvancedBy::Integrator);
        }
        self.bring_up()?;
        if let Some(model_exchange) = &self.model_exchange {
            model_exchange.equations.rates(&mut into_places(dx));
        }
        Ok(())
    }

    fn indicators(&self) -> usize {
        self.model_exchange.as_ref().map_or(0, |model_exchange| model_exchange.equations.indicators())
    }

    fn event_indicators(&mut self, z: &mut [f64]) -> Result<(), Failure> {
        self.bring_up()?;
        if let Some(model_exchange) = &self.model_exchange {
            model_exchange.equations.event_indicators(into_places(z));
        }
        Ok(())
    }

    fn states_set_at_event(&mut self) {
        if let Some(model_exchange) = &mut self.model_exchange {
            model_exchange.equations.forget_balance();
        }
    }

    fn handle_event(&mut self) -> Result<EventOutcome, Failure> {
        self.bring_up()?;
        Ok(self.ended())
    }

    fn completed_step(&mut self) -> Result<EventOutcome, Failure> {
        self.bring_up()?;
        if let Some(model_exchange) = &mut self.model_exchange {
            let step = model_exchange.time - model_exchange.accepted;
            model_exchange.accepted = model_exchange.time;
            let time = model_exchange.time;
            let checked = model_exchange.equations.check_motion();
            checked.map_err(|error| Failure(format!("at t = {time} s: {error}")))?;
            model_exchange.stuck |= step > 0.0 && model_exchange.equations.accept(step);
        }
        Ok(self.ended())
    }
}
