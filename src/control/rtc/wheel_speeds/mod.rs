//! Rough-terrain control with wheel-speed loops: forces become slips, slips become speeds that each wheel's loop holds.
//!
//! A commanded torque knows no slip: where the soil gives less than it was believed to, the wheel runs away. Here the same
//! force distribution (4.3) gives, by the inverse soil model, the slip i_k at which each wheel works, and each wheel's loop
//! holds r omega_k = V_k / (1 - i_k), with V_k from the contact angles and the body's wanted speed. No wheel is asked for more
//! than its best slip i* at the body's speed (which counts as decreasing slowly), r omega_k <= V_k / (1 - i*_k), nor for more torque than the soil
//! answers there. Under the creeping speed that says nothing: the wheels creep, and on soil in which slip digs the rover backs
//! off after a while and tries again.

mod memory;
mod parameters;

use self::memory::{Progress, WheelMemory};
pub use self::parameters::SpeedRoughTerrainControl;
use super::belief::SoilBelief;
use super::kinematics::{Rolling, rolling};
use super::optimiser::Found;
use super::outcome::Outcome;
use super::sharing::{Demand, Share, Sharing};
use super::switch::Criterion;
use super::{Problem, RtcOptions, load_of, traction_of};
use crate::contact::Surface;
use crate::control::error::{ControlError, finite, same_count, same_links, within_bounds};
use crate::control::{Controller, Nominal, VelocityControl, VelocityController};
use crate::signals::{Command, Measurement, Reference};
use crate::snapshot::Moving;
use crate::soil::Soil;

/// A wheel off the ground is told by its torque: under the least on the ground, where this many times as much is expected.
const EXPECTED: f64 = 4.0;
/// It carries again from this many times the least torque on the ground.
const CARRIES: f64 = 2.0;
/// Integral action on the body's speed at most, of the wanted speed.
const MOST_TRIM: f64 = 1.0;
/// How long it has to look like that, s.
const LIFTED_AFTER: f64 = 0.1;
/// How long the optimiser may give up before that is an error, s.
const MOST_LOST: f64 = 1.0;

/// Rough-terrain control that commands wheel speeds to loops of its own, and through them torques.
#[derive(Clone, Moving)]
pub struct SpeedRtc {
    #[not_moving]
    nominal: Nominal,
    #[not_moving]
    parameters: SpeedRoughTerrainControl,
    #[not_moving]
    options: RtcOptions,
    #[not_moving]
    sharing: Sharing,
    #[not_moving]
    rolling: Vec<Rolling>,
    /// Goals of the loops, relative to the carrying bodies, rad/s.
    #[not_moving]
    goals: Vec<f64>,
    /// Limits of the torques, N m.
    #[not_moving]
    limits: Vec<f64>,
    inner: VelocityController,
    wheels: Vec<WheelMemory>,
    progress: Progress,
    outcome: Option<Outcome>,
}

impl SpeedRtc {
    /// A controller for the nominal rover with the gains `loops` for the wheels; of `options` the period is that of `loops`,
    /// and the strength is not used: the full stress integrals take its place.
    ///
    /// # Errors
    /// [`ControlError`] where the rover or a parameter makes no sense, or the minimum loads together are not under the
    /// weight.
    pub fn new(
        nominal: Nominal,
        parameters: SpeedRoughTerrainControl,
        loops: VelocityControl,
        options: RtcOptions,
    ) -> Result<Self, ControlError> {
        let inner = VelocityController::new(&nominal, loops)?;
        within_bounds("rtc_speed", parameters)?;
        let (load, wheels, weight) = (parameters.minimum_load, nominal.wheels(), nominal.weight());
        if load * wheels as f64 >= weight {
            return Err(ControlError::MinimumLoad { load, wheels, weight });
        }
        let belief = SoilBelief {
            digging: parameters.slip_sinkage,
            surface: Surface::smooth(0.0).with_lugs(&nominal.wheel, parameters.lug_height, 1.0),
            ..SoilBelief::new(nominal.wheel, nominal.soil)
        };
        Ok(Self {
            sharing: Sharing::new(&nominal, load, belief, options.solver),
            options: RtcOptions { period: loops.period, ..options },
            nominal,
            parameters,
            rolling: vec![Rolling::default(); wheels],
            goals: vec![0.0; wheels],
            limits: vec![0.0; wheels],
            inner,
            wheels: vec![WheelMemory::default(); wheels],
            progress: Progress::default(),
            outcome: None,
        })
    }

    /// Believes in `soil` under wheel `wheel` (counted from 0) from the next command on.
    pub fn set_soil(&mut self, wheel: usize, soil: Soil) {
        self.sharing.beliefs[wheel].soil = soil;
    }

    /// What the controller believes of the rover.
    #[must_use]
    pub fn nominal(&self) -> &Nominal {
        &self.nominal
    }

    /// What the last [`command`](Controller::command) found, or kept of the one before where the optimiser gave up; `None` before the first,
    /// and after one that failed.
    #[must_use]
    pub fn outcome(&self) -> Option<&Outcome> {
        self.outcome.as_ref()
    }

    /// The optimisation problem of the last command.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.sharing.problem
    }

    /// What the last command gives to each wheel, rear to front.
    #[must_use]
    pub fn shares(&self) -> &[Share] {
        &self.sharing.shares
    }

    fn check(&self, measured: &Measurement) -> Result<(), ControlError> {
        same_count(self.nominal.wheels(), measured.wheels.len())?;
        same_links(self.nominal.links.len(), measured.links.len())?;
        finite("measured pitch", None, measured.pitch)?;
        finite("measured velocity", None, measured.velocity)?;
        for (index, wheel) in measured.wheels.iter().enumerate() {
            finite("measured contact angle", Some(index), wheel.contact_angle)?;
            finite("measured speed", Some(index), wheel.speed)?;
        }
        for link in &measured.links {
            finite("measured joint angle", None, link.angle)?;
        }
        Ok(())
    }

    /// Places the contacts and finds how the wheels move with the body.
    fn place(&mut self, measured: &Measurement) {
        let Problem { distribution, lifted, .. } = &mut self.sharing.problem;
        lifted.iter_mut().zip(&self.wheels).for_each(|(lifted, wheel)| *lifted = wheel.lifted);
        let joints = measured.links.iter().map(|link| link.angle);
        let angles = measured.wheels.iter().map(|wheel| wheel.contact_angle);
        distribution.place(&self.nominal, measured.pitch, joints, angles);
        rolling(distribution, &self.nominal, lifted, &mut self.rolling);
    }

    /// The criterion that holds on this ground: with none given, traction on rough ground, else electrical power.
    fn criterion(&self, measured: &Measurement) -> Criterion {
        let touching = measured.wheels.iter().zip(&self.wheels).filter(|(_, wheel)| !wheel.lifted);
        let angles = touching.map(|(wheel, _)| wheel.contact_angle);
        let by_ground = || match Criterion::for_terrain(angles, self.parameters.switch_angle) {
            Criterion::Traction => Criterion::Traction,
            Criterion::Power | Criterion::ElectricalPower => Criterion::ElectricalPower,
        };
        self.options.criterion.unwrap_or_else(by_ground)
    }

    /// Speeds of the loops and limits of their torques, for the body's wanted and measured speed.
    fn set_goals(&mut self, wanted: f64, speed: f64) {
        let SpeedRoughTerrainControl { creep, slip_filter, speed_hold, .. } = self.parameters;
        let radius = self.nominal.wheel.radius;
        let direction = if wanted < 0.0 { -1.0 } else { 1.0 };
        let hold = speed_hold / (speed_hold + self.options.period);
        let forward = (direction * speed).max(direction * hold * self.progress.held).max(0.0);
        self.progress.held = direction * forward;
        let unlimited = self.nominal.torque_limit().unwrap_or(f64::INFINITY);
        let goal = ((wanted + self.progress.trim) * direction).max(0.0);
        let backs_off = self.progress.backs_off > 0.0;
        let keep = slip_filter / (slip_filter + self.options.period);
        for (wheel, share) in self.wheels.iter_mut().zip(&self.sharing.shares) {
            wheel.slip = Some(wheel.slip.map_or(share.slip, |before| keep * before + (1.0 - keep) * share.slip));
        }
        let goal = goal * self.slowing();
        for (index, (wheel, share)) in self.wheels.iter_mut().zip(&self.sharing.shares).enumerate() {
            let Rolling { along, turning } = self.rolling[index];
            let slip = wheel.slip.unwrap_or_default();
            let rim = |speed: f64, slip: f64| if slip >= 0.0 { speed / (1.0 - slip) } else { speed * (1.0 + slip) };
            let (mut at_rim, mut limit) = (rim(along * goal, slip), unlimited);
            if backs_off {
                at_rim = -rim(along * creep, share.best.slip);
            } else if !wheel.lifted {
                at_rim = at_rim.min(rim(along * forward.max(creep), share.best.slip));
                if forward > creep {
                    limit = limit.min(share.best.torque.max(0.0));
                }
            }
            self.goals[index] = direction * at_rim / radius + turning * speed;
            self.limits[index] = limit;
        }
    }

    /// Factor on the body's speed where its slip is not the usual one; moves the usual slip on.
    fn slowing(&mut self) -> f64 {
        let touching = self.wheels.iter().filter(|wheel| !wheel.lifted).filter_map(|wheel| wheel.slip);
        let (sum, count) = touching.fold((0.0, 0.0), |(sum, count), slip| (sum + slip.max(0.0), count + 1.0));
        let slip: f64 = if count > 0.0 { sum / count } else { 0.0 };
        let keep = self.parameters.rim_time / (self.parameters.rim_time + self.options.period);
        let usual = self.progress.slip.map_or(slip, |before| keep * before + (1.0 - keep) * slip);
        self.progress.slip = Some(usual);
        (1.0 - slip) / (1.0 - usual)
    }

    /// Moves the body's memory on.
    fn progress(&mut self, wanted: f64, speed: f64, feasible: bool) {
        let SpeedRoughTerrainControl { integral_gain, creep, patience, back_off, .. } = self.parameters;
        let (period, direction) = (self.options.period, wanted.signum());
        let Progress { trim, creeps, backs_off, slip: _, held: _, lost: _ } = &mut self.progress;
        if wanted == 0.0 {
            self.progress = Progress::default();
            return;
        }
        let creeping = direction * speed < creep.min(0.5 * wanted.abs());
        let step = integral_gain * period * (wanted - speed);
        if (feasible && !creeping) || step * *trim < 0.0 {
            *trim = (*trim + step).clamp(-MOST_TRIM * wanted.abs(), MOST_TRIM * wanted.abs());
        }
        if *backs_off > 0.0 {
            *backs_off -= period;
            return;
        }
        *creeps = if creeping { *creeps + period } else { 0.0 };
        let beliefs = self.sharing.beliefs.iter().zip(&self.sharing.shares);
        if *creeps > patience
            && beliefs.clone().any(|(belief, share)| share.load > 0.0 && belief.digs(share.load, &share.best))
        {
            (*creeps, *backs_off) = (0.0, back_off);
        }
    }

    /// Finds out which wheels are off the ground: those that turn as asked on next to no torque where much is expected.
    fn watch(&mut self, torques: &[f64]) {
        let nominal = &self.nominal;
        let touch = nominal.wheel.radius * nominal.soil.friction_angle.tan() * self.parameters.minimum_load;
        for ((wheel, share), &torque) in self.wheels.iter_mut().zip(&self.sharing.shares).zip(torques) {
            wheel.torque = torque;
            if wheel.lifted {
                wheel.lifted = torque.abs() < CARRIES * touch;
                wheel.light = 0.0;
            } else {
                let light = torque.abs() < touch && share.torque.abs() > EXPECTED * touch;
                wheel.light = if light { wheel.light + self.options.period } else { 0.0 };
                wheel.lifted = wheel.light > LIFTED_AFTER;
            }
        }
    }
}

impl SpeedRtc {
    /// Commands torques for what the force distribution gave; `before` is the outcome of the last command.
    fn act(
        &mut self,
        shared: Result<Found, ControlError>,
        demand: &Demand,
        measured: &Measurement,
        before: Option<Outcome>,
        command: &mut Command,
    ) -> Result<(), ControlError> {
        let gave_up = matches!(shared, Err(ControlError::Optimiser(_)));
        self.progress.lost = if gave_up { self.progress.lost + self.options.period } else { 0.0 };
        let found = match (shared, &before) {
            (Err(ControlError::Optimiser(_)), Some(last)) if self.progress.lost <= MOST_LOST => self.keep(last),
            (other, _) => other?,
        };
        for (wheel, share) in self.wheels.iter_mut().zip(&self.sharing.shares) {
            finite("slip of the force distribution", None, share.slip)?;
            (wheel.last_slip, wheel.last_load) = (share.slip, share.load);
        }
        self.set_goals(demand.speed, measured.velocity);
        let (goals, limits) = (&self.goals, &self.limits);
        self.inner.hold_within(measured, |index| goals[index], |index| limits[index], command)?;
        if !gave_up {
            self.watch(&command.values);
        }
        self.progress(demand.speed, measured.velocity, found.feasible);
        let Sharing { problem, forces, .. } = &self.sharing;
        let mut outcome = before.unwrap_or_default();
        outcome.renew(&self.nominal, problem, forces, demand.criterion, found, &command.values);
        self.outcome = Some(outcome);
        Ok(())
    }

    /// Where the optimiser gives up the forces, slips and loads of the last command stay, but for wheels that have lifted since.
    fn keep(&mut self, last: &Outcome) -> Found {
        let Sharing { problem, forces, shares, .. } = &mut self.sharing;
        forces.copy_from_slice(&last.forces);
        for (wheel, _) in problem.lifted.iter().enumerate().filter(|(_, lifted)| **lifted) {
            (forces[traction_of(wheel)], forces[load_of(wheel)]) = (0.0, 0.0);
            shares[wheel] = Share::default();
        }
        Found { feasible: false, optimal: false, steps: 0 }
    }
}

impl Controller for SpeedRtc {
    fn command(&mut self, measured: &Measurement, goal: &Reference, command: &mut Command) -> Result<(), ControlError> {
        let before = self.outcome.take();
        self.check(measured)?;
        let wanted = finite("the goal's velocity", None, goal.velocity)?;
        self.place(measured);
        let gravity = self.nominal.gravity;
        let acceleration = (self.parameters.gain * (wanted - measured.velocity)).clamp(-gravity, gravity);
        let demand = Demand { acceleration, speed: wanted, criterion: self.criterion(measured) };
        let wheels = &self.wheels;
        let shared = self.sharing.share(&self.nominal, measured.pitch, &self.rolling, &demand, |k| wheels[k].found());
        self.act(shared, &demand, measured, before, command)
    }

    fn reset(&mut self) {
        self.outcome = None;
        self.inner.reset();
        self.wheels.fill(WheelMemory::default());
        self.progress = Progress::default();
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
mod tests;
