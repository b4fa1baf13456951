//! Rough-terrain control (RTC): a body force is shared out among the wheels as the ground allows (4.2-4.3).
//!
//! Every period: place the contacts by measured pitch and contact angles ([`Distribution`], 4.3); ask for
//! f_s = [m K (v_desired - v), m g, 0]; choose the criterion ([`Criterion`], 4.11); find the best forces
//! within load, torque and soil strength ([`Problem`], [`Optimiser`]); command the torques r T_i. The speed
//! is not held: without a term for the soil's resistance the rover drives slower than asked (4.4.1).

mod distribution;
mod nearest;
mod optimiser;
mod power;
mod problem;
mod solver;
mod strength;
mod switch;
mod traction;

pub use distribution::{Contact, Distribution};
pub use nearest::{CHEAPNESS, LAW_WEIGHT, Nearest, WISH_OUT_OF_BALANCE};
pub use optimiser::{Found, Optimiser};
pub use power::MinimumPower;
pub use problem::{Problem, load_of, traction_of};
pub use solver::{Program, Rows, Unsolved};
pub use strength::{compaction_resistance, contact_area, sinkage};
pub use switch::Criterion;
pub use traction::{MaximumTraction, Search};

use super::error::{ControlError, finite, same_count, within_bounds};
use super::{Controller, Nominal};
use crate::signals::{Command, Drive, Measurement, Reference};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Rough-terrain control.
    pub struct RoughTerrainControl {
        /// Gain K of the commanded acceleration K (v_desired - v).
        gain: [Unit::PER_SECOND] = 50.0, 0.0..=1e3, Fixed, "assumption: not in the thesis; gain times period 0.5, the fastest well-damped sampled loop (errata 11)";
        /// Contact angle C above which traction counts instead of power (4.11).
        switch_angle: [Unit::RADIAN] = 15.0_f64.to_radians(), 0.0..=1.6, Fixed, "Iagnemma 2001, 4.4.1";
        /// Least normal force asked of every wheel, for N_i > 0 (4.13).
        minimum_load: [Unit::NEWTON] = 1.0, 1e-3..=1e5, Fixed, "assumption: 2 % of an even share of 10 kg on two wheels";
        /// Share of the soil's shear strength (4.16) that is kept in reserve.
        margin: [Unit::ONE] = 0.0, 0.0..=0.95, Fixed, "neutral: Iagnemma 2001 (4.16)";
        /// Share of Bekker's compaction resistance that the body force makes up for.
        resistance: [Unit::ONE] = 0.0, 0.0..=5.0, Fixed, "neutral: Iagnemma 2001 has no such term";
    }
}

/// What the last optimisation found.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Outcome {
    /// What was optimised (4.11).
    pub criterion: Criterion,
    /// Whether the forces balance the wanted body force; otherwise they are the nearest admissible ones.
    pub feasible: bool,
    /// Whether the forces are the criterion's optimum; see [`Found::optimal`].
    pub optimal: bool,
    /// Value of the criterion: P in W (4.10) or R (4.5).
    pub objective: f64,
    /// x = [T_1, N_1, .., T_n, N_n]: tractive and normal forces, N.
    pub forces: Vec<f64>,
    /// The wanted body force f_s: N, N, N m.
    pub body_force: [f64; 3],
    /// f_s - G x: what of the body force is missing; N, N, N m.
    pub shortfall: [f64; 3],
    /// Linear programs of the traction search.
    pub steps: usize,
}

/// Rough-terrain control of a rover with n >= 2 wheels on one body; commands torques.
///
/// It keeps no history: the same readings give the same torques, bit for bit, whatever came before.
#[derive(Clone)]
pub struct Rtc {
    nominal: Nominal,
    parameters: RoughTerrainControl,
    problem: Problem,
    optimiser: Optimiser,
    /// Forces of the running optimisation, N.
    forces: Vec<f64>,
    outcome: Option<Outcome>,
}

impl Rtc {
    /// A controller for the nominal rover.
    ///
    /// # Errors
    /// [`ControlError`] where the rover or a parameter makes no sense, or the minimum loads together are
    /// not under the weight.
    pub fn new(nominal: Nominal, parameters: RoughTerrainControl) -> Result<Self, ControlError> {
        nominal.check()?;
        within_bounds("rough_terrain_control", parameters)?;
        let (load, wheels, weight) = (parameters.minimum_load, nominal.wheels(), nominal.weight());
        if load * wheels as f64 >= weight {
            return Err(ControlError::MinimumLoad { load, wheels, weight });
        }
        let problem = Problem::new(&nominal, load, parameters.margin);
        let optimiser = Optimiser::new(&problem);
        Ok(Self { nominal, parameters, problem, optimiser, forces: vec![0.0; 2 * wheels], outcome: None })
    }

    /// What the last [`command`](Controller::command) found; `None` before the first, and after one that failed.
    #[must_use]
    pub fn outcome(&self) -> Option<&Outcome> {
        self.outcome.as_ref()
    }

    /// The optimisation problem of the last command.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// Formulates the problem that the readings pose.
    fn pose(&mut self, measured: &Measurement, goal: &Reference) -> Result<(), ControlError> {
        same_count(self.nominal.wheels(), measured.wheels.len())?;
        let pitch = finite("measured pitch", None, measured.pitch)?;
        let speed = finite("measured velocity", None, measured.velocity)?;
        let wanted = finite("the goal's velocity", None, goal.velocity)?;
        for (index, wheel) in measured.wheels.iter().enumerate() {
            finite("measured contact angle", Some(index), wheel.contact_angle)?;
        }
        let angles = measured.wheels.iter().map(|wheel| wheel.contact_angle);
        self.problem.distribution.place(&self.nominal, pitch, angles);
        let acceleration = self.parameters.gain * (wanted - speed);
        self.problem.distribution.demand(&self.nominal, finite("the wanted acceleration", None, acceleration)?);
        self.problem.expect_loads(pitch)?;
        self.problem.renew_adhesion(&self.nominal, self.parameters.margin);
        self.compensate(wanted);
        Ok(())
    }

    /// Adds the soil's resistance, against the wanted direction of motion, to the body force.
    fn compensate(&mut self, wanted: f64) {
        if self.parameters.resistance == 0.0 || wanted == 0.0 {
            return;
        }
        let Nominal { soil, wheel, .. } = &self.nominal;
        for (index, &load) in self.problem.expected_loads.iter().enumerate() {
            let resistance = self.parameters.resistance * compaction_resistance(soil, wheel, load);
            self.problem.distribution.resist(index, wheel.radius, resistance * wanted.signum());
        }
    }

    /// Renews the outcome, reusing its memory.
    fn report(&mut self, mut outcome: Outcome, criterion: Criterion, found: Found) {
        outcome.forces.clone_from(&self.forces);
        outcome.criterion = criterion;
        outcome.feasible = found.feasible;
        outcome.optimal = found.optimal;
        outcome.steps = found.steps;
        outcome.objective = match criterion {
            Criterion::Power => self.power(),
            Criterion::Traction => self.problem.ratio(&self.forces),
        };
        outcome.body_force = self.problem.distribution.body_force;
        let balance = self.problem.distribution.balance(&self.forces);
        outcome.shortfall = std::array::from_fn(|row| outcome.body_force[row] - balance[row]);
        self.outcome = Some(outcome);
    }

    /// P = sum R r^2 / (K_t^2 gear^2) T_i^2 (4.10), W.
    fn power(&self) -> f64 {
        let tractions = self.forces.iter().step_by(2);
        tractions.map(|traction| self.nominal.winding_power(self.nominal.wheel.radius * traction)).sum()
    }
}

impl Controller for Rtc {
    fn command(&mut self, measured: &Measurement, goal: &Reference, command: &mut Command) -> Result<(), ControlError> {
        let outcome = self.outcome.take().unwrap_or_default();
        self.pose(measured, goal)?;
        let angles = measured.wheels.iter().map(|wheel| wheel.contact_angle);
        let criterion = Criterion::for_terrain(angles, self.parameters.switch_angle);
        let found = self.optimiser.solve(&self.problem, criterion, &mut self.forces)?;
        for (index, &traction) in self.forces.iter().step_by(2).enumerate() {
            finite("tractive force", Some(index), traction)?;
        }
        self.report(outcome, criterion, found);
        command.drive = Drive::Torque;
        command.values.clear();
        command.values.extend(self.forces.iter().step_by(2).map(|traction| self.nominal.wheel.radius * traction));
        Ok(())
    }

    fn reset(&mut self) {
        self.outcome = None;
    }
}
