//! A force distribution together with the slips that give it: resistance at the axles, limits at the best slips.
//!
//! The optimiser's rows are linear, the soil is not. So the soil is linearised about slips and loads, the forces are found,
//! the slips that give them under their loads follow from the inverse soil model, and this repeats until slips and loads no longer
//! change. After [`FREE_ROUNDS`] rounds without that, the largest change of a force shrinks from round to round.

use super::belief::{SoilBelief, Working};
use super::kinematics::Rolling;
use super::optimiser::{Found, Optimiser};
use super::problem::{Problem, load_of, traction_of};
use super::slopes::Slopes;
use super::solver::{Solver, Unsolved};
use super::switch::Criterion;
use crate::control::{ControlError, Nominal};

/// Rounds at most.
const MOST_ROUNDS: usize = 12;
/// Rounds without a limit on the change of forces. Near the largest pull the slope of pull over torque falls to zero within a few
/// per cent of slip, and the rounds can alternate between two solutions.
const FREE_ROUNDS: usize = 3;
/// Largest change of a force in the first limited round, over the force at the best slip.
const REACH: f64 = 0.5;
/// Factor on that change from one limited round to the next: in the last round it is 0.8 % of the force at the best slip.
const NARROWING: f64 = 0.6;
/// Tractive force of a drive without limit, weights.
const UNLIMITED: f64 = 1e3;
/// Largest difference between the soil's forces and those of the last linearisation, of the weight and of the weight times half the
/// base, at which forces count as balanced.
const FORESEEN: f64 = 1e-3;
/// Change of a slip in a round at which it stays.
const SLIP_STAYS: f64 = 1e-3;
/// Change of a load in a round at which it stays, of the weight.
const LOAD_STAYS: f64 = 1e-4;
/// Change of a load for which the state at the best slip stays, of the load.
const SAME_LOAD: f64 = 1e-3;
/// Change of a load in one round for which the best slip is not sought again, of the load: i* hardly depends on the load, and near
/// its peak the pull changes little with slip.
const NEAR_LOAD: f64 = 0.1;
/// Slip from which the search sets out.
const FIRST_SLIP: f64 = 0.1;

/// What one wheel is given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// Normal force N, N.
    pub load: f64,
    /// Torque of the drive, wheel side, in the direction of travel, N m.
    pub torque: f64,
    /// Slip, driving positive.
    pub slip: f64,
    /// State at the best slip i* under this load, in the direction of travel.
    pub best: Working,
}

impl Share {
    /// Finds the best slip for the present load where that has changed.
    fn renew_best(&mut self, belief: &SoilBelief) {
        let change = if self.best.torque > 0.0 { (self.load / self.best.load - 1.0).abs() } else { f64::INFINITY };
        if change >= NEAR_LOAD {
            self.best = belief.best(self.load);
        } else if change >= SAME_LOAD {
            self.best = belief.at(self.load, self.best.slip);
        }
    }
}

/// What is asked of a distribution.
#[derive(Clone, Copy, Debug)]
pub(super) struct Demand {
    /// Wanted acceleration along x, m/s^2.
    pub acceleration: f64,
    /// Speed for which electrical power counts, m/s; its sign is the direction of travel.
    pub speed: f64,
    /// What is optimised.
    pub criterion: Criterion,
}

/// Shares a body force out among wheels whose soil is believed to be known.
#[derive(Clone)]
pub(super) struct Sharing {
    pub problem: Problem,
    optimiser: Optimiser,
    /// x = [T_1, N_1, ..], N.
    pub forces: Vec<f64>,
    /// Belief of the soil under each wheel.
    pub beliefs: Vec<SoilBelief>,
    pub shares: Vec<Share>,
    /// Pull of each wheel at its slip and load along x, N; 0 in the air.
    pulls: Vec<f64>,
    /// Constant term of each wheel's linearised pull along x, N.
    offsets: Vec<f64>,
    /// Largest tractive force of a drive, N.
    drive: f64,
}

impl Sharing {
    pub fn new(nominal: &Nominal, minimum_load: f64, belief: SoilBelief, solver: Solver) -> Self {
        let mut problem = Problem::new(nominal, minimum_load);
        let wheels = nominal.wheels();
        let unlimited = UNLIMITED * problem.force_unit();
        let drive = nominal.torque_limit().map_or(unlimited, |torque| torque / nominal.wheel.radius);
        problem.drive_limits = Some(vec![[-drive, drive]; wheels]);
        Self {
            optimiser: Optimiser::new(&problem, solver),
            problem,
            forces: vec![0.0; 2 * wheels],
            beliefs: vec![belief; wheels],
            shares: vec![Share::default(); wheels],
            pulls: vec![0.0; wheels],
            offsets: vec![0.0; wheels],
            drive,
        }
    }

    /// Finds forces, loads and slips for a demand; the contacts are placed already, `rolling` is each wheel's motion. The search
    /// sets out from the slip and the load that `guess` gives for a wheel.
    ///
    /// # Errors
    /// [`ControlError::Singular`] where the contact points coincide. [`ControlError::Optimiser`] where the optimiser gives up in the first
    /// round: slips (no more than the best ones) and loads are those of `guess` then, and no torques are known.
    pub fn share(
        &mut self,
        nominal: &Nominal,
        pitch: f64,
        rolling: &[Rolling],
        demand: &Demand,
        guess: impl Fn(usize) -> Option<[f64; 2]>,
    ) -> Result<Found, ControlError> {
        let direction = if demand.speed < 0.0 { -1.0 } else { 1.0 };
        self.problem.distribution.yields.fill(1.0);
        self.problem.distribution.load_yields.fill(0.0);
        self.problem.expect_loads(nominal, pitch)?;
        for (wheel, share) in self.shares.iter_mut().enumerate() {
            let [slip, load] = guess(wheel).unwrap_or([FIRST_SLIP, self.problem.expected_loads[wheel]]);
            *share = Share { load, slip, ..Share::default() };
        }
        let mut found = Found { feasible: false, optimal: false, steps: 0 };
        let mut reach = f64::INFINITY;
        for round in 0..MOST_ROUNDS {
            self.problem.distribution.demand(nominal, demand.acceleration);
            self.linearise(nominal, rolling, demand, direction, reach);
            found = match self.solve(demand.criterion) {
                Ok(found) => found,
                // The optimiser gives up: the forces of the round before stay, by the slopes written just now.
                Err(_) if round > 0 => break,
                Err(unsolved) => return Err(unsolved.into()),
            };
            if self.follow(nominal.wheel.radius, direction) {
                return Ok(found);
            }
            if round + 1 >= FREE_ROUNDS {
                reach = if reach.is_finite() { NARROWING * reach } else { REACH };
            }
        }
        found.feasible &= self.is_foreseen();
        Ok(found)
    }

    fn is_foreseen(&self) -> bool {
        let problem = &self.problem;
        (0..problem.rows()).all(|row| self.unforeseen(row).abs() <= FORESEEN * problem.row_unit(row))
    }

    /// What the soil gives at the slips and loads beyond the linearised pulls in row `row` of the balance, N or N m.
    pub fn unforeseen(&self, row: usize) -> f64 {
        let balance = &self.problem.distribution;
        let beyond = |wheel: usize| {
            let [force, load] = [traction_of(wheel), load_of(wheel)].map(|column| self.forces[column]);
            let linear = balance.yields[wheel] * force + balance.load_yields[wheel] * load + self.offsets[wheel];
            self.pulls[wheel] - linear
        };
        let touching = (0..self.shares.len()).filter(|&wheel| !self.problem.lifted[wheel]);
        touching.map(|wheel| balance.axle_coefficient(row, wheel) * beyond(wheel)).sum()
    }

    fn solve(&mut self, criterion: Criterion) -> Result<Found, Unsolved> {
        self.optimiser.solve(&self.problem, criterion, &mut self.forces)
    }

    /// Writes the soil about the present loads and slips into the problem; each force may change by `reach` of that at the best slip.
    fn linearise(&mut self, nominal: &Nominal, rolling: &[Rolling], demand: &Demand, direction: f64, reach: f64) {
        let (radius, unit) = (nominal.wheel.radius, self.problem.force_unit());
        let mut costs = self.problem.costs.take().unwrap_or_else(|| vec![[1.0, 0.0]; self.shares.len()]);
        for wheel in 0..self.shares.len() {
            costs[wheel] = [1.0, 0.0];
            if self.problem.lifted[wheel] {
                self.allow(wheel, 0.0, self.drive);
                continue;
            }
            let share = &mut self.shares[wheel];
            share.renew_best(&self.beliefs[wheel]);
            share.slip = share.slip.min(share.best.slip);
            let (load, most) = (share.load, share.best.torque.max(0.0) / radius);
            let slopes = Slopes::about(&self.beliefs[wheel], load, share.slip, radius);
            let balance = &mut self.problem.distribution;
            balance.yields[wheel] = slopes.over_force;
            balance.load_yields[wheel] = direction * slopes.over_load;
            balance.resist(wheel, radius, -direction * slopes.offset);
            self.offsets[wheel] = direction * slopes.offset;
            (self.problem.adhesion[wheel], self.problem.friction[wheel]) = (0.0, most / load);
            // Within the limits of the drive and of the soil at the present load.
            let here = direction * slopes.force[1].clamp(-most, most).clamp(-self.drive, self.drive);
            self.allow(wheel, here, if reach.is_finite() { reach * most } else { reach });
            if demand.criterion == Criterion::ElectricalPower {
                let speed = demand.speed.abs() * rolling[wheel].along;
                let power = slopes.states.map(|state| electrical(nominal, speed, &state));
                let [square, linear] = quadratic(slopes.force, power, nominal.winding_power(radius));
                costs[wheel] = [square, direction * linear];
            }
        }
        // In weights, and of order 1.
        let largest = costs.iter().map(|cost| cost[0]).fold(f64::MIN_POSITIVE, f64::max);
        costs.iter_mut().for_each(|cost| *cost = [cost[0] / largest, cost[1] / (largest * unit)]);
        self.problem.costs = Some(costs);
    }

    /// Lets the tractive force of a wheel be `reach` from `here` and within the drive's limits, N.
    fn allow(&mut self, wheel: usize, here: f64, reach: f64) {
        if let Some(limits) = &mut self.problem.drive_limits {
            limits[wheel] = [(here - reach).max(-self.drive), (here + reach).min(self.drive)];
        }
    }

    /// Takes the forces that were found over into loads and slips; says whether they have stayed.
    fn follow(&mut self, radius: f64, direction: f64) -> bool {
        let unit = self.problem.force_unit();
        let mut stays = true;
        for (wheel, share) in self.shares.iter_mut().enumerate() {
            if self.problem.lifted[wheel] {
                *share = Share::default();
                self.pulls[wheel] = 0.0;
                continue;
            }
            let load = self.forces[load_of(wheel)].max(self.problem.minimum_load);
            let torque = direction * radius * self.forces[traction_of(wheel)];
            let state = self.beliefs[wheel].with_torque(load, torque.min(share.best.torque), &share.best);
            // The best slip's state is one under the load before.
            let here = if state.load == load { state } else { self.beliefs[wheel].at(load, state.slip) };
            self.pulls[wheel] = direction * here.pull;
            stays &= (state.slip - share.slip).abs() < SLIP_STAYS && (load - share.load).abs() < LOAD_STAYS * unit;
            *share = Share { load, torque, slip: state.slip, best: share.best };
        }
        stays
    }
}

/// Electrical power of a drive, W: R I^2 (4.6) and the torque times the rim's rate, r omega = V / (1 - i).
pub(super) fn electrical(nominal: &Nominal, speed: f64, state: &Working) -> f64 {
    let rim = if state.slip >= 0.0 { speed / (1.0 - state.slip) } else { speed * (1.0 + state.slip) };
    nominal.winding_power(state.torque) + state.torque * rim / nominal.wheel.radius
}

/// Weights (a, b) of a F^2/2 + b F through three points of a curve, `a` no less than `least`.
fn quadratic(force: [f64; 3], power: [f64; 3], least: f64) -> [f64; 2] {
    let below = (power[1] - power[0]) / (force[1] - force[0]);
    let above = (power[2] - power[1]) / (force[2] - force[1]);
    let curvature = 2.0 * (above - below) / (force[2] - force[0]);
    if !curvature.is_finite() {
        return [least.max(f64::MIN_POSITIVE), 0.0];
    }
    let curvature = curvature.max(least).max(f64::MIN_POSITIVE);
    [curvature, (power[2] - power[0]) / (force[2] - force[0]) - curvature * force[1]]
}
