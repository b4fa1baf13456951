//! A rover as explicit ordinary differential equations, for an integrator outside this crate.
//!
//! ```text
//! x' = f(x, u),    y = g(x, u)
//! ```
//!
//! with the torques commanded of the wheels for u and the signals for y. The [`simulation`](crate::simulation) integrates
//! the same right-hand side with its linearly implicit method of fixed step, so that both tend to the same motion. The
//! equations are stiff where wheels stand or roll slowly (rates of the contact's memory and of the spin: some 1e3 /s and
//! more); an implicit integrator is the right one.
//!
//! What a step of the simulation keeps beside x has no place here: which ground has been passed, the lag and dead time of
//! a record, noise of sensors. [`Model::check_equations`](crate::model::Model::check_equations) names what is switched on of it. That a rover is stuck is a matter of
//! the way behind it; [`Equations::accept`] watches it from one accepted step to the next.
//!
//! Over dual numbers the same code gives exact derivatives: [`Equations::tangent`].

mod reach;
mod states;

pub use reach::LostMotion;
pub use states::{BodyStates, EnergyStates, JointStates, States, WheelStates, derivative_of};

use crate::motor;
use crate::rover::dynamics::{DynamicsError, Evaluation};
use crate::rover::{Rover, State};
use crate::scalar::{Dual, Plain, Scalar};
use crate::signals::{Command, Drive, Signals};
use crate::simulation::{Energies, Event, Simulation, TIPPED, Window, belly_clearance};
use crate::snapshot::{Moving, Reader, SnapshotError, Writer};
use crate::terrain::Profile;
use bekker_modeldescription::Parameters;
use states::places;

/// Why a model has no such equations.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoEquations {
    /// Something keeps a memory that is no continuous state.
    #[error("{what} keeps a memory that is no state of a differential equation; expected {expected}, or co-simulation")]
    Memory {
        /// What keeps it.
        what: String,
        /// What would do.
        expected: String,
    },
    /// The drives are not commanded by torques.
    #[error("differential equations need the wheels' torques for inputs; expected control.kind = \"torque\"")]
    Drive,
    /// The plant of rigid bodies steps by itself.
    #[error("the plant of rigid bodies is no differential equation; expected simulation.plant = \"joint_coordinates\"")]
    RigidBodies,
}

/// A rover under commanded torques as x' = f(x, u).
#[derive(Clone, Debug, Moving)]
pub struct Equations<S = f64> {
    #[not_moving]
    rover: Rover<S>,
    command: Command<S>,
    state: State<S>,
    energies: Energies<S>,
    #[not_moving]
    evaluation: Evaluation<S>,
    #[not_moving]
    signals: Signals<S>,
    window: Window,
    /// The state nearest to the present one at which the right-hand side has a value, and by how much the present position
    /// lies beyond it, [x, z] in m.
    #[not_moving]
    within: State<S>,
    #[not_moving]
    beyond: [f64; 2],
    /// What the energies balance to, J: a constant of the exact motion since the last start of an integrator.
    balance: Option<f64>,
}

/// Derivatives of rates and signals along a direction in states and inputs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tangent {
    /// Of the rates of the states, in their order.
    pub rates: Vec<f64>,
    /// Of the signals, in the vocabulary's order.
    pub signals: Vec<f64>,
}

impl Equations {
    /// The equations at the present state of `simulation`, under its present torques.
    #[must_use]
    pub fn at(simulation: &Simulation) -> Self {
        simulation.equations()
    }

    /// Writes states, inputs and what [`Equations::accept`] stores.
    pub fn write(&self, to: &mut Writer) {
        self.save(to);
    }

    /// Takes over what the equations of the same rover wrote; to be evaluated anew.
    ///
    /// # Errors
    /// [`SnapshotError`]; the equations are of no use then.
    pub fn read(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        self.load(from)
    }

    /// Derivatives at the present states and inputs along `states` and `inputs`, exact by dual numbers. It allocates.
    ///
    /// # Errors
    /// [`DynamicsError`] where the equations have no value here.
    pub fn tangent(&self, states: &[f64], inputs: &[f64]) -> Result<Tangent, DynamicsError> {
        let dual = Dual::<1>::from;
        let along = |value: &mut Dual<1>, by: f64| *value += dual(0.0).derivative(0) * by;
        let mut lifted = self.map(&dual);
        let mut by = states.iter();
        places(&mut lifted.state, &mut lifted.energies, |place| along(place, by.next().copied().unwrap_or(0.0)));
        lifted.command.values.iter_mut().zip(inputs).for_each(|(value, by)| along(value, *by));
        lifted.evaluate()?;
        let part = |value: Dual<1>| value.eps.0.map_or(0.0, |eps| eps[0]);
        let mut tangent = Tangent::default();
        lifted.rates(&mut |rate| tangent.rates.push(part(rate)));
        lifted.signals.values(&mut |signal| tangent.signals.push(part(signal)));
        Ok(tangent)
    }
}

impl<S: Scalar> Equations<S> {
    pub(crate) fn new(rover: Rover<S>, state: State<S>, energies: Energies<S>, command: Command<S>) -> Self {
        let signals = Signals::of(rover.wheels.len(), rover.links.len());
        let window = Window::at(state.position[0].value());
        let (evaluation, within, beyond) = (Evaluation::new(&rover), state.clone(), [0.0; 2]);
        Self { evaluation, rover, command, state, energies, signals, window, within, beyond, balance: None }
    }

    fn map<T: Scalar>(&self, f: &dyn Fn(S) -> T) -> Equations<T> {
        let values = self.command.values.iter().map(|value| f(*value)).collect();
        let command = Command { drive: self.command.drive, values };
        Equations::new(self.rover.map(f), self.state.map(f), self.energies.map(f), command)
    }

    /// How many states there are.
    #[must_use]
    pub fn count(&self) -> usize {
        States::<S>::count(self.rover.wheels.len(), self.rover.links.len())
    }

    /// The states by name.
    #[must_use]
    pub fn states(&self) -> States<S> {
        States::of(&self.state, &self.energies)
    }

    /// Typical sizes of the states, in their order: a step of a wheel's radius, walking speed, a tenth of a radian.
    pub fn nominals(&self, mut f: impl FnMut(f64)) {
        let radius = self.rover.wheel.radius.value();
        let (speed, weight) = (0.1, self.rover.total_mass().value() * self.rover.environment.gravity.value());
        [radius, radius, 0.1, speed, speed, 0.1].into_iter().for_each(&mut f);
        (0..self.rover.links.len()).for_each(|_| [0.1, 0.1].into_iter().for_each(&mut f));
        (0..self.rover.wheels.len()).for_each(|_| [speed / radius, 1.0, 1.0, 10.0, 1.0].into_iter().for_each(&mut f));
        (0..5).for_each(|_| f(weight * radius));
    }

    /// Goes on with other constants of the rover, whose structure stays; to be evaluated anew.
    pub fn retune(&mut self, rover: Rover<S>) {
        self.evaluation = Evaluation::new(&rover);
        self.rover = rover;
    }

    /// Calls `f` with every state's value.
    pub fn visit_states(&mut self, mut f: impl FnMut(&mut S)) {
        places(&mut self.state, &mut self.energies, &mut f);
    }

    /// The torques that are commanded, N m.
    pub fn torques_mut(&mut self) -> &mut [S] {
        &mut self.command.values
    }

    /// Evaluates right-hand side and signals at the present states and inputs; allocates nothing. An implicit integrator also
    /// tries states that no rover reaches; see the module `reach` for what holds there.
    ///
    /// # Errors
    /// [`DynamicsError`] where something is not finite, or an effect of the user's own gives no value.
    pub fn evaluate(&mut self) -> Result<(), DynamicsError> {
        self.update_within_reach()?;
        self.evaluation.sense(&self.rover, &self.state, &self.energies, &mut self.signals);
        Ok(())
    }

    /// Calls `f` with every state's rate, in their order, as last evaluated.
    pub fn rates(&self, f: &mut dyn FnMut(S)) {
        let (rate, acceleration) = (&self.state.rate, &self.evaluation.acceleration);
        rate[..3].iter().chain(&acceleration[..3]).for_each(|rate| f(*rate));
        for j in 3..rate.len() {
            f(rate[j]);
            f(acceleration[j]);
        }
        let (length, radius) = (self.rover.effects.digging_length(), self.rover.true_wheel().radius);
        for (k, (wheel, state)) in self.evaluation.wheels.iter().zip(&self.state.wheels).enumerate() {
            f(self.evaluation.spin_rate(&self.rover, k));
            // What the memory exceeds its bound by fades like the memory itself.
            let (hold, bounded, own) = (state.hold, self.within.wheels[k].hold, wheel.touch.slopes.rate_own);
            f(wheel.touch.rate.travel + (hold.travel - bounded.travel) * own);
            f(wheel.touch.rate.turn + (hold.turn - bounded.turn) * own);
            let warming = self.rover.effects.warming(wheel.winding_power());
            f(warming.map_or(S::from(0.0), |warming| warming.rate(state.winding_rise)));
            f(length.map_or(S::from(0.0), |length| wheel.digging(radius).rate(state.dug_slip, length)));
        }
        let powers = self.evaluation.powers();
        [powers.dissipated, powers.electrical, powers.drive, powers.soil_loss, powers.other_loss]
            .into_iter()
            .for_each(f);
    }

    /// The signals, as last evaluated: the true ones, but for the errors of sensors among the rover's effects.
    #[must_use]
    pub fn signals(&self) -> &Signals<S> {
        &self.signals
    }

    /// How many event indicators there are: a lift-off and a drive's limits a wheel, and four of the whole rover.
    #[must_use]
    pub fn indicators(&self) -> usize {
        2 * self.rover.wheels.len() + 4
    }

    /// Calls `f` with every event indicator, as last evaluated; a change of sign is an event. Of each wheel its sinkage
    /// (m, negative off the ground) and what is left of its drive's limits (share; negative where one binds); then what
    /// is left of the pitch to tipping over (rad), of the sinkage to the axle (m), of the belly's clearance (m) and of the
    /// known ground (m; 1 where it has no end). The last four end a simulation.
    pub fn event_indicators(&self, mut f: impl FnMut(f64)) {
        for (k, wheel) in self.evaluation.wheels.iter().enumerate() {
            f(wheel.sinkage.value());
            f(self.drive_reserve(k));
        }
        self.reserves().into_iter().for_each(|(_, reserve)| f(reserve));
    }

    /// What is left until the simulation ends, by event.
    fn reserves(&self) -> [(Event, f64); 4] {
        let radius = self.rover.true_wheel().radius.value();
        let wheels = &self.evaluation.wheels;
        let least = |of: &dyn Fn(&crate::rover::dynamics::WheelEvaluation<S>) -> f64| {
            wheels.iter().map(of).fold(f64::INFINITY, f64::min)
        };
        let ground = match &self.rover.terrain.profile {
            Profile::Samples(curve) => {
                let (from, to) = curve.range();
                least(&|wheel| {
                    let x = wheel.foot_x.value() + self.beyond[0];
                    (x - from).min(to - x)
                })
            }
            _ => 1.0,
        };
        [
            (Event::TippedOver, TIPPED - self.state.position[2].value().abs()),
            (Event::SunkToAxle, least(&|wheel| radius - wheel.sinkage.value())),
            (Event::BellyContact, belly_clearance(&self.rover, &self.state).lane(0)),
            (Event::LeftTerrain, ground),
        ]
    }

    /// The event that has ended the simulation at the states last evaluated, if one has.
    #[must_use]
    pub fn ended(&self) -> Option<Event> {
        self.reserves().into_iter().find(|(_, reserve)| *reserve < 0.0).map(|(event, _)| event)
    }

    /// Share of drive `k`'s limits that the torque asked of it leaves.
    fn drive_reserve(&self, k: usize) -> f64 {
        let wheel = &self.evaluation.wheels[k];
        let asked = self.command.values[k];
        motor::reserve(&self.rover.motor, &wheel.motor, &self.rover.effects, wheel.speed, asked).value()
    }

    /// Takes over that an integrator has accepted the states last evaluated, `step` seconds after those before; whether
    /// the rover is stuck.
    pub fn accept(&mut self, step: f64) -> bool {
        let radius = self.rover.true_wheel().radius.value();
        let speeds = self.evaluation.wheels.iter().map(|wheel| wheel.speed.value());
        self.window.stuck(self.state.position[0].value(), speeds, radius, step)
    }
}

impl<S: Scalar> Simulation<S> {
    /// The differential equations of the rover, at its present state and torques.
    pub(crate) fn equations(&self) -> Equations<S> {
        let values = self.command().values.iter().map(|value| S::from(*value)).collect();
        let command = Command { drive: Drive::Torque, values };
        Equations::new(self.rover().clone(), self.state().clone(), self.energies(), command)
    }
}
