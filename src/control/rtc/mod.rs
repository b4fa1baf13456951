//! Rough-terrain control (RTC): a body force is shared out among the wheels as the ground allows (4.2-4.3).
//!
//! Every period: place the contacts by measured pitch and contact angles ([`Distribution`], 4.3); ask for
//! f_s = [m K (v_desired - v), m g, 0]; choose the criterion ([`Criterion`], 4.11); find the best forces
//! within load, torque and soil strength ([`Problem`], [`Optimiser`]); command the torques r T_i. The speed
//! is not held: without a term for the soil's resistance the rover drives slower than asked (4.4.1).
//!
//! [`SpeedRtc`] is another controller on the same force distribution: it counts with the soil's resistance and strength by the
//! full stress integrals, and holds wheel speeds in the place of torques.
//!
//! Beyond the thesis, each neutral by default: compensation of the soil's resistance and integral action on the
//! body's speed, so that it is held; and a [`SpeedLoop`] at each wheel, which trims its torque where the soil gives
//! way under it and finds wheels that are off the ground. Soil strength ([`Rtc::set_soil`]) and contact angles (in
//! the [`Measurement`]) may come from estimators.

mod active_set;
mod belief;
mod distribution;
mod interior_point;
mod kinematics;
mod nearest;
mod optimiser;
mod oracle;
mod outcome;
mod power;
mod problem;
mod sharing;
mod slopes;
mod solver;
mod speed_loop;
mod strength;
mod switch;
mod traction;
mod wheel_speeds;

pub use belief::{SUFFICIENT, SoilBelief, Working};
pub use distribution::{Contact, Distribution, JointBalance};
pub use nearest::{CHEAPNESS, LAW_WEIGHT, Nearest, WISH_OUT_OF_BALANCE};
pub use optimiser::{Found, Optimiser};
pub use oracle::{Attainable, Oracle};
pub use outcome::{Footing, Outcome};
pub use power::MinimumPower;
pub use problem::{Problem, load_of, traction_of};
pub use sharing::Share;
pub use solver::{Program, Rows, Solver, Unsolved};
pub use speed_loop::SpeedLoop;
use speed_loop::Speeds;
pub use strength::{
    ShearLimit, Strength, compaction_resistance, contact_area, largest_stress, mobilised_share, projected_area, sinkage,
};
pub use switch::Criterion;
pub use traction::{MaximumTraction, Search};
pub use wheel_speeds::{SpeedRoughTerrainControl, SpeedRtc};

use super::error::{ControlError, finite, same_count, same_links, within_bounds};
use super::{Controller, Nominal};
use crate::signals::{Command, Drive, Measurement, Reference};
use crate::snapshot::{Moving, Reader, SnapshotError, Writer, loaded};
use crate::soil::Soil;
use bekker_modeldescription::{Lookup, Unit, parameters};
use std::ops::RangeInclusive;

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
        /// Gain of the commanded acceleration on the integral of v_desired - v, against the droop that resistance causes.
        integral_gain: [Unit::PER_SECOND2] = 0.0, 0.0..=1e3, Fixed, "neutral: Iagnemma 2001 holds no speed";
        /// Proportional gain of each wheel's speed loop, which acts outside `speed_band`.
        speed_kp: [Unit::SPEED_GAIN] = 0.0, 0.0..=1e3, Fixed, "neutral: Iagnemma 2001 commands torques alone";
        /// Integral gain of each wheel's speed loop.
        speed_ki: [Unit::NEWTON_METRE_PER_RADIAN] = 0.0, 0.0..=1e5, Fixed, "neutral: Iagnemma 2001 commands torques alone";
        /// How far a wheel's speed may be from v_desired / r, of that, before its loop acts.
        speed_band: [Unit::ONE] = 0.2, 0.0..=10.0, Fixed, "assumption: 1/(1 + 0.2) is the rim's travel at 17 % slip";
    }
}

/// How rough-terrain control goes about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RtcOptions {
    /// Which shear limit the forces keep (4.16).
    pub strength: Strength,
    /// Who solves the optimisation.
    pub solver: Solver,
    /// Control period at which commands are asked for, s; integral action and speed loops count with it.
    pub period: f64,
    /// What is optimised; `None` goes by the ground (4.11, 4.12).
    pub criterion: Option<Criterion>,
}

impl Default for RtcOptions {
    fn default() -> Self {
        Self { strength: Strength::default(), solver: Solver::default(), period: 0.01, criterion: None }
    }
}

/// Rough-terrain control of a rover with n >= 2 wheels on a chassis or on links with passive joints; commands torques.
///
/// Without integral action and speed loops it keeps no history: the same readings give the same torques, bit for
/// bit, whatever came before.
#[derive(Clone)]
pub struct Rtc {
    nominal: Nominal,
    parameters: RoughTerrainControl,
    options: RtcOptions,
    problem: Problem,
    optimiser: Optimiser,
    /// Forces of the running optimisation, N.
    forces: Vec<f64>,
    outcome: Option<Outcome>,
    /// Acceleration that the integral action asks for, m/s^2.
    integral: f64,
    speed_loops: Vec<SpeedLoop>,
    /// Bounds of cohesion, friction angle and shear modulus.
    strength_bounds: [RangeInclusive<f64>; 3],
}

/// The soil may have been set; the optimisation is posed and solved anew from each measurement.
impl Moving for Rtc {
    fn save(&self, to: &mut Writer) {
        let Self {
            nominal,
            integral,
            speed_loops,
            outcome,
            parameters: _,
            options: _,
            problem: _,
            optimiser: _,
            forces: _,
            strength_bounds: _,
        } = self;
        let Soil { cohesion, friction_angle, shear_modulus, .. } = nominal.soil;
        [cohesion, friction_angle, shear_modulus].save(to);
        integral.save(to);
        speed_loops.save(to);
        outcome.save(to);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        let soil = &mut self.nominal.soil;
        [soil.cohesion, soil.friction_angle, soil.shear_modulus] = loaded(from)?;
        self.integral.load(from)?;
        self.speed_loops.load(from)?;
        self.outcome.load(from)
    }
}

impl Rtc {
    /// A controller for the nominal rover.
    ///
    /// # Errors
    /// [`ControlError`] where the rover or a parameter makes no sense, or the minimum loads together are
    /// not under the weight.
    pub fn new(nominal: Nominal, parameters: RoughTerrainControl) -> Result<Self, ControlError> {
        Self::with_options(nominal, parameters, RtcOptions::default())
    }

    /// A controller for the nominal rover that goes about it as `options` say.
    ///
    /// # Errors
    /// As [`Rtc::new`].
    pub fn with_options(
        nominal: Nominal,
        parameters: RoughTerrainControl,
        options: RtcOptions,
    ) -> Result<Self, ControlError> {
        nominal.check()?;
        within_bounds("rough_terrain_control", parameters)?;
        if options.criterion == Some(Criterion::ElectricalPower) {
            return Err(ControlError::NoSlips);
        }
        let (load, wheels, weight) = (parameters.minimum_load, nominal.wheels(), nominal.weight());
        if load * wheels as f64 >= weight {
            return Err(ControlError::MinimumLoad { load, wheels, weight });
        }
        let problem = Problem::new(&nominal, load);
        let optimiser = Optimiser::new(&problem, options.solver);
        let (forces, speed_loops) = (vec![0.0; 2 * wheels], vec![SpeedLoop::default(); wheels]);
        let strength_bounds = ["cohesion", "friction_angle", "shear_modulus"].map(bounds_of_soil);
        Ok(Self {
            nominal,
            parameters,
            options,
            problem,
            optimiser,
            forces,
            outcome: None,
            integral: 0.0,
            speed_loops,
            strength_bounds,
        })
    }

    /// Takes over an estimate of the soil's strength: cohesion, Pa, friction angle, rad, and shear modulus K, m (which
    /// [`Strength::Mobilised`] alone reads), within the vocabulary's bounds. It holds from the next command on.
    ///
    /// # Errors
    /// [`ControlError::Parameter`] where a value is out of bounds or not finite; the soil is then as before.
    pub fn set_soil(&mut self, cohesion: f64, friction_angle: f64, shear_modulus: f64) -> Result<(), ControlError> {
        let soil = Soil { cohesion, friction_angle, shear_modulus, ..self.nominal.soil };
        let values = [cohesion, friction_angle, shear_modulus];
        // The vocabulary's own check lists all parameters, which allocates: it is left to say what is wrong.
        if !values.iter().zip(&self.strength_bounds).all(|(value, bounds)| bounds.contains(value)) {
            within_bounds("estimated soil", soil)?;
        }
        self.nominal.soil = soil;
        Ok(())
    }

    /// What the controller believes of the rover and its soil.
    #[must_use]
    pub fn nominal(&self) -> &Nominal {
        &self.nominal
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
        same_links(self.nominal.links.len(), measured.links.len())?;
        let pitch = finite("measured pitch", None, measured.pitch)?;
        let speed = finite("measured velocity", None, measured.velocity)?;
        let wanted = finite("the goal's velocity", None, goal.velocity)?;
        for (index, wheel) in measured.wheels.iter().enumerate() {
            finite("measured contact angle", Some(index), wheel.contact_angle)?;
            if self.holds_speed() {
                finite("measured speed", Some(index), wheel.speed)?;
            }
        }
        for link in &measured.links {
            finite("measured joint angle", None, link.angle)?;
        }
        let joint_angles = measured.links.iter().map(|link| link.angle);
        let angles = measured.wheels.iter().map(|wheel| wheel.contact_angle);
        self.problem.distribution.place(&self.nominal, pitch, joint_angles, angles);
        let acceleration = self.parameters.gain * (wanted - speed) + self.integral;
        self.problem.distribution.demand(&self.nominal, finite("the wanted acceleration", None, acceleration)?);
        self.problem.expect_loads(&self.nominal, pitch)?;
        self.problem.renew_strength(&self.nominal, self.parameters.margin, self.options.strength);
        for (lifted, wheel) in self.problem.lifted.iter_mut().zip(&self.speed_loops) {
            *lifted = wheel.lifted();
        }
        self.compensate(wanted);
        Ok(())
    }

    /// Whether the wheels' speed loops are at work.
    fn holds_speed(&self) -> bool {
        self.parameters.speed_kp > 0.0 || self.parameters.speed_ki > 0.0
    }

    /// Integral action on the body's speed: not further into what the ground does not give, and within one weight.
    fn integrate(&mut self, error: f64, feasible: bool) {
        let step = self.parameters.integral_gain * self.options.period * error;
        if feasible || step * self.integral < 0.0 {
            self.integral = (self.integral + step).clamp(-self.nominal.gravity, self.nominal.gravity);
        }
    }

    /// Torques r T_i with what the speed loops add, within the drives' limit, N m; moves the loops on.
    fn torques(&mut self, measured: &Measurement, goal: &Reference, torques: &mut Vec<f64>) {
        let (radius, limit) = (self.nominal.wheel.radius, self.nominal.torque_limit().unwrap_or(f64::INFINITY));
        torques.clear();
        torques.extend(self.forces.iter().step_by(2).map(|traction| radius * traction));
        if !self.holds_speed() {
            return;
        }
        // The least torque that a wheel on the ground can pass on.
        let touch = radius * self.nominal.soil.friction_angle.tan() * self.problem.minimum_load;
        let wheels = self.speed_loops.iter_mut().zip(&measured.wheels);
        for (torque, (wheel, seen)) in torques.iter_mut().zip(wheels) {
            let speeds = Speeds { wanted: goal.velocity / radius, wheel: seen.speed, body: measured.velocity / radius };
            *torque = wheel.torque(&self.parameters, self.options.period, &speeds, *torque, touch, limit);
        }
    }

    /// Adds the soil's resistance, against the wanted direction of motion, to the body force.
    fn compensate(&mut self, wanted: f64) {
        if self.parameters.resistance == 0.0 || wanted == 0.0 {
            return;
        }
        let Nominal { soil, wheel, .. } = &self.nominal;
        for (index, &load) in self.problem.expected_loads.iter().enumerate() {
            if self.problem.lifted[index] {
                continue;
            }
            let resistance = self.parameters.resistance * compaction_resistance(soil, wheel, load);
            self.problem.distribution.resist(index, wheel.radius, resistance * wanted.signum());
        }
    }
}

/// Bounds of a parameter of the soil in the vocabulary; none contains anything where there is no such parameter.
fn bounds_of_soil(name: &str) -> RangeInclusive<f64> {
    let all = Soil::<f64>::default().list();
    all.iter().find(|(variable, _)| variable.name == name).map_or(f64::NAN..=f64::NAN, |(of, _)| of.min..=of.max)
}

impl Controller for Rtc {
    fn command(&mut self, measured: &Measurement, goal: &Reference, command: &mut Command) -> Result<(), ControlError> {
        let mut outcome = self.outcome.take().unwrap_or_default();
        self.pose(measured, goal)?;
        let touching = measured.wheels.iter().zip(&self.problem.lifted).filter(|(_, lifted)| !**lifted);
        let angles = touching.map(|(wheel, _)| wheel.contact_angle);
        let by_ground = || Criterion::for_terrain(angles, self.parameters.switch_angle);
        let criterion = self.options.criterion.unwrap_or_else(by_ground);
        let found = self.optimiser.solve(&self.problem, criterion, &mut self.forces)?;
        for (index, &traction) in self.forces.iter().step_by(2).enumerate() {
            finite("tractive force", Some(index), traction)?;
        }
        command.drive = Drive::Torque;
        self.torques(measured, goal, &mut command.values);
        self.integrate(goal.velocity - measured.velocity, found.feasible);
        outcome.renew(&self.nominal, &self.problem, &self.forces, criterion, found, &command.values);
        self.outcome = Some(outcome);
        Ok(())
    }

    fn reset(&mut self) {
        self.outcome = None;
        self.integral = 0.0;
        self.speed_loops.fill(SpeedLoop::default());
    }
}
