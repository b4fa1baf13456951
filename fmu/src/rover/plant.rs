//! A rover, with its controller or without, as a [`FmuModel`].

use super::by_reference::{by_reference, from_values, into_places, starts};
use super::model_exchange::ModelExchange;
use super::outputs::{event, event_code, measurements, seed};
use super::step_position::StepPosition;
use super::{Kind, Packed, USUAL_STEP, dependencies, description};
use crate::model::{Continuous, Failure, FmuModel, Outcome};
use bekker::model::{ControlKind, Model as RoverModel, Plant, Run};
use bekker::signals::Measurement;
use bekker::simulation::Status;
use bekker_modeldescription::xml::Variability::{Fixed, Tunable};
use bekker_modeldescription::xml::{Description, Entry};
use bekker_modeldescription::{Lookup, Parameters, Variable};
use std::ops::Range;
use std::sync::Arc;

/// Where the groups of variables are among the references.
#[derive(Clone, Debug)]
pub(super) struct References {
    pub parameters: Range<usize>,
    pub inputs: Range<usize>,
    pub signals: Range<usize>,
    pub measured: Range<usize>,
    /// Of the signal that each of them measures.
    pub measured_signals: Vec<usize>,
    pub event: usize,
    /// The same as an integer.
    pub event_code: usize,
    /// The seed of the sensors' noise.
    pub seed: usize,
    /// Continuous states and their derivatives.
    pub states: Range<usize>,
    pub derivatives: Range<usize>,
}

/// What has advanced a rover to the present communication point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AdvancedBy {
    /// The run, which is at the inner step of this point.
    Steps,
    /// The run, which is at the inner step behind this point.
    BetweenSteps,
    /// An integrator that moves the states of the equations; the run stays where it was.
    Integrator,
}

/// A rover, at its start or on its way.
#[derive(Clone)]
pub(super) struct RoverFmu {
    pub(super) description: Arc<Description>,
    /// With the parameters that the run was started with, and with those that it has now.
    pub(super) model: RoverModel,
    pub(super) tuned: RoverModel,
    /// The values of the latter.
    pub(super) applied: Vec<f64>,
    pub(super) run: Run,
    /// Seconds between readings of the sensors, where this is a plant whose sensors are read.
    pub(super) sensing: Option<f64>,
    /// Values by reference; that of time is not used.
    pub(super) values: Vec<f64>,
    pub(super) references: References,
    pub(super) motion: AdvancedBy,
    /// Time of the present point, s.
    pub(super) time: f64,
    /// Signals at the inner step before the run's, where the point is between both.
    pub(super) before: Vec<f64>,
    pub(super) model_exchange: Option<ModelExchange>,
}

impl RoverFmu {
    /// The rover of a model file, at its start.
    ///
    /// # Errors
    /// A sentence where the model does not start.
    pub fn new(mut model: RoverModel, packed: Packed) -> Result<Self, String> {
        let kind = packed.kind;
        let mut sensing = None;
        if kind == Kind::Rover && model.control.kind != ControlKind::SpeedLoop {
            sensing = Some(reading_period(&model)?);
            if model.control.kind != ControlKind::Speed {
                model.control.kind = ControlKind::Torque;
            }
        }
        let run = start(&model, sensing)?;
        let model_exchange = (kind == Kind::Rover).then(|| ModelExchange::of(&model, &run)).flatten();
        let mut entries = vec![Entry::time()];
        let mut group = |some: Vec<Entry>| {
            let first = entries.len();
            entries.extend(some);
            first..entries.len()
        };
        let mut parameters = Vec::new();
        let tunable = model.stepping.plant == Plant::JointCoordinates;
        let rules = model.clone();
        visit(&mut model, sensing, &mut |variable, value| {
            let variability = if tunable && rules.is_tunable(&variable.name) { Tunable } else { Fixed };
            parameters.push(Entry { variability, ..Entry::parameter(variable, *value) });
        });
        let parameters = group(parameters);
        let seed = group(vec![seed(&model)?]).start;
        let inputs = model.inputs().list().into_iter().map(|(variable, value)| Entry::input(variable, value));
        let inputs = group(inputs.collect());
        let signals = run.signals().clone().list().into_iter().map(|(variable, _)| Entry::output(variable));
        let signals = group(signals.collect());
        let (wheels, links) = (model.rover.wheels.len(), model.rover.links.len());
        let sensed = if sensing.is_some() { measurements("measured", wheels, links) } else { Vec::new() };
        let measured = group(sensed.into_iter().map(Entry::output).collect());
        let event = group(vec![event(), event_code()]).start;
        let event_code = event + 1;
        let first = event_code + 1;
        let (states, derivatives) =
            model_exchange.as_ref().map(|model_exchange| model_exchange.entries(first)).unwrap_or_default();
        let (states, derivatives) = (group(states), group(derivatives));
        let of_signal = |signal| signals.start + signal;
        let measured_signals = Measurement::measured_signals(run.signals()).into_iter().map(of_signal).collect();
        let references = References {
            parameters,
            inputs,
            signals,
            measured,
            measured_signals,
            event,
            event_code,
            seed,
            states,
            derivatives,
        };
        dependencies::write(&mut entries, &references, model_exchange.is_some());
        let description = Arc::new(description(&model, packed, run.step_size(), entries));
        let values = starts(&description);
        let mut rover = Self {
            description,
            before: vec![0.0; references.signals.len()],
            applied: values[references.parameters.clone()].to_vec(),
            tuned: model.clone(),
            model,
            run,
            sensing,
            values,
            references,
            motion: AdvancedBy::Steps,
            time: 0.0,
            model_exchange,
        };
        if let Some(model_exchange) = &mut rover.model_exchange {
            model_exchange.refer(rover.references.states.clone(), rover.references.derivatives.clone());
        }
        Ok(rover)
    }

    /// Takes signals, measurements and event from the run.
    pub(super) fn read_outputs(&mut self) {
        let References { signals, measured, event, .. } = &self.references;
        self.run.signals().values(&mut into_places(&mut self.values[signals.clone()]));
        self.run.measurement().values(&mut into_places(&mut self.values[measured.clone()]));
        let status = self.run.status().place() as f64;
        (self.values[*event], self.values[self.references.event_code]) = (status, status);
        (self.motion, self.time) = (AdvancedBy::Steps, self.run.time());
    }

    /// Shows the signals of the start under the inputs, where the model is also offered for model exchange: torques, currents and
    /// powers are those with which the first step begins, as the equations have them. Elsewhere the first decision or imposed
    /// speed belongs to the first step, as in the core.
    fn begin_with_inputs(&mut self) -> Result<(), Failure> {
        if self.model_exchange.is_none() {
            return Ok(());
        }
        let signals = self.run.signals_under_inputs().map_err(|error| Failure(error.to_string()))?;
        signals.values(&mut into_places(&mut self.values[self.references.signals.clone()]));
        Ok(())
    }

    pub(super) fn write_inputs(&mut self) -> Result<(), Failure> {
        let values = &self.values[self.references.inputs.clone()];
        self.run.inputs_mut().set_all(values).map_err(|error| Failure(error.to_string()))
    }

    /// Takes the parameters' values over and makes the run that they start.
    pub(super) fn restart(&mut self, parameters: &[f64]) -> Result<(), Failure> {
        let mut model = self.model.clone();
        write(&mut model, self.sensing, parameters);
        model.stepping.seed = self.values[self.references.seed] as u32;
        self.run = start(&model, self.sensing).map_err(Failure)?;
        (self.tuned, self.model) = (model.clone(), model);
        self.applied = parameters.to_vec();
        Ok(())
    }

    /// The values of the parameters that the run was started with.
    pub(super) fn started_with(&self) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.references.parameters.len());
        visit(&mut self.model.clone(), self.sensing, &mut |_, value| values.push(*value));
        values
    }

    /// Makes inner steps up to the `target`-th.
    fn run_to(&mut self, target: u64) -> Result<Status, Failure> {
        let steps = target.saturating_sub(self.ticks());
        self.run.advance(steps).map_err(|error| Failure(error.to_string()))
    }

    fn ticks(&self) -> u64 {
        self.run.simulation().ticks()
    }

    /// Puts the signals between those of the inner step before and the run's.
    fn interpolate(&mut self, share: f64) {
        let mut places = self.values[self.references.signals.clone()].iter_mut().zip(&self.before);
        self.run.signals().values(&mut |after| {
            if let Some((place, before)) = places.next() {
                *place = before + share * (after - before);
            }
        });
    }

    fn outcome(&self) -> Outcome {
        match self.run.status() {
            Status::Running => Outcome::Running,
            Status::Ended(event) => Outcome::Ended { reason: event.to_string() },
        }
    }

    /// Keeps the run's signals, before it goes a step beyond the communication point.
    fn keep_before(&mut self) {
        self.run.signals().values(&mut into_places(&mut self.before));
    }
}

/// The parameters of such an FMU: those of the model, and the sensors where they are read without a controller.
fn visit(model: &mut RoverModel, sensing: Option<f64>, f: &mut dyn FnMut(Variable, &mut f64)) {
    model.visit("", f);
    if sensing.is_some() {
        model.sensors.visit("sensor", f);
    }
}

/// Gives these parameters their values.
pub(super) fn write(model: &mut RoverModel, sensing: Option<f64>, values: &[f64]) {
    let mut take = from_values(values);
    visit(model, sensing, &mut |_, place| take(place));
}

fn start(model: &RoverModel, sensing: Option<f64>) -> Result<Run, String> {
    let mut run = model.start().map_err(|error| error.to_string())?;
    if let Some(period) = sensing {
        run.sense_every(period).map_err(|error| error.to_string())?;
    }
    Ok(run)
}

/// How often a plant's sensors are read: once a period of the model's controller, and about 100 times a second without one.
fn reading_period(model: &RoverModel) -> Result<f64, String> {
    let step = model.stepping.step_size;
    Ok(match model.control.kind {
        ControlKind::Torque | ControlKind::Speed => (USUAL_STEP / step).round().max(1.0) * step,
        _ => model.control.period().ok_or("the model's controller has no period")?,
    })
}

impl FmuModel for RoverFmu {
    by_reference!();

    fn start(&mut self) -> Result<(), Failure> {
        let parameters = self.values[self.references.parameters.clone()].to_vec();
        self.restart(&parameters)?;
        self.write_inputs()?;
        self.read_outputs();
        self.begin_with_inputs()?;
        self.begin()
    }

    fn inner_step(&self) -> f64 {
        self.run.step_size()
    }

    fn advance(&mut self, steps: u64) -> Result<Outcome, Failure> {
        self.tune()?;
        self.write_inputs()?;
        let target = self.ticks() + steps;
        self.run_to(target)?;
        self.read_outputs();
        Ok(self.outcome())
    }

    fn advance_to(&mut self, time: f64) -> Result<Outcome, Failure> {
        let place = StepPosition::of(time, self.inner_step())?;
        let now = self.time;
        if place.end() < self.ticks() || (self.motion == AdvancedBy::BetweenSteps && time < now) {
            return Err(Failure(format!("the communication point {time} s lies before the present time, {now} s")));
        }
        self.tune()?;
        self.write_inputs()?;
        if place.share > 0.0 && self.ticks() <= place.whole {
            self.run_to(place.whole)?;
            self.read_outputs();
            self.keep_before();
        }
        let status = self.run_to(place.end())?;
        if place.share == 0.0 || (self.ticks() < place.end() && status != Status::Running) {
            self.read_outputs();
            return Ok(self.outcome());
        }
        self.interpolate(place.share);
        (self.motion, self.time) = (AdvancedBy::BetweenSteps, time);
        Ok(Outcome::Running)
    }

    fn reset(&mut self) {
        self.values = starts(&self.description);
        (self.motion, self.time) = (AdvancedBy::Steps, 0.0);
    }

    fn serialise(&self) -> Result<Vec<u8>, Failure> {
        self.save()
    }

    fn deserialise(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        self.load(bytes)
    }

    fn directional(
        &mut self,
        unknowns: &[usize],
        knowns: &[usize],
        seed: &[f64],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.push_forward(unknowns, knowns, seed, out)
    }

    fn adjoint(&mut self, unknowns: &[usize], knowns: &[usize], seed: &[f64], out: &mut [f64]) -> Result<(), Failure> {
        self.pull_back(unknowns, knowns, seed, out)
    }

    fn continuous(&mut self) -> Option<&mut dyn Continuous> {
        if self.model_exchange.is_some() { Some(self) } else { None }
    }
}
