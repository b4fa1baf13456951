//! A force distribution together with the slips that give it: resistance at the axles, limits at the best slips.
//!
//! The optimiser's rows are linear, the soil is not. So the soil is linearised about slips and loads, the forces are found,
//! the slips that give them under their loads follow from the inverse soil model, and so on until they stay.

use super::belief::{SoilBelief, Working};
use super::kinematics::Rolling;
use super::optimiser::{Found, Optimiser};
use super::problem::{Problem, load_of, traction_of};
use super::solver::{Solver, Unsolved};
use super::switch::Criterion;
use crate::control::{ControlError, Nominal};

/// Rounds at most; 3 or 4 are usual.
const MOST_ROUNDS: usize = 8;
/// Change of a slip in a round at which it stays.
const SLIP_STAYS: f64 = 1e-3;
/// Change of a load in a round at which it stays, of the weight.
const LOAD_STAYS: f64 = 1e-4;
/// Change of a load for which the best slip is not sought again, of the load: i* hardly depends on it.
const SAME_LOAD: f64 = 1e-3;
/// Step in the slip over which the soil is linearised.
const SLIP_STEP: f64 = 0.005;
/// Slip from which the search sets out.
const FIRST_SLIP: f64 = 0.1;
/// Least share of a torque's force that counts as pull: at the best slip on digging soil it is zero.
const LEAST_YIELD: f64 = 0.02;

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
}

impl Sharing {
    pub fn new(nominal: &Nominal, minimum_load: f64, digging: f64, solver: Solver) -> Self {
        let problem = Problem::new(nominal, minimum_load);
        let belief = SoilBelief { digging, ..SoilBelief::new(nominal.wheel, nominal.soil) };
        let wheels = nominal.wheels();
        Self {
            optimiser: Optimiser::new(&problem, solver),
            problem,
            forces: vec![0.0; 2 * wheels],
            beliefs: vec![belief; wheels],
            shares: vec![Share::default(); wheels],
        }
    }

    /// Finds forces, loads and slips for a demand; the contacts are placed already, `rolling` is each wheel's motion.
    pub fn share(
        &mut self,
        nominal: &Nominal,
        pitch: f64,
        rolling: &[Rolling],
        demand: &Demand,
    ) -> Result<Found, ControlError> {
        let direction = if demand.speed < 0.0 { -1.0 } else { 1.0 };
        self.problem.distribution.yields.fill(1.0);
        self.problem.expect_loads(nominal, pitch)?;
        for (share, &load) in self.shares.iter_mut().zip(&self.problem.expected_loads) {
            *share = Share { load, slip: FIRST_SLIP, ..Share::default() };
        }
        let mut found = Found { feasible: false, optimal: false, steps: 0 };
        for _ in 0..MOST_ROUNDS {
            self.problem.distribution.demand(nominal, demand.acceleration);
            self.linearise(nominal, rolling, demand, direction);
            found = self.solve(demand.criterion)?;
            if self.follow(nominal.wheel.radius, direction) {
                break;
            }
        }
        Ok(found)
    }

    fn solve(&mut self, criterion: Criterion) -> Result<Found, Unsolved> {
        self.optimiser.solve(&self.problem, criterion, &mut self.forces)
    }

    /// Writes the soil about the present loads and slips into the problem.
    fn linearise(&mut self, nominal: &Nominal, rolling: &[Rolling], demand: &Demand, direction: f64) {
        let (radius, unit) = (nominal.wheel.radius, self.problem.force_unit());
        let mut costs = self.problem.costs.take().unwrap_or_else(|| vec![[1.0, 0.0]; self.shares.len()]);
        for (wheel, share) in self.shares.iter_mut().enumerate() {
            if self.problem.lifted[wheel] {
                costs[wheel] = [1.0, 0.0];
                continue;
            }
            let belief = &self.beliefs[wheel];
            let known = share.best.torque > 0.0 && (share.load / share.best.load - 1.0).abs() < SAME_LOAD;
            if !known {
                share.best = belief.best(share.load);
            }
            share.slip = share.slip.min(share.best.slip);
            let states = [-SLIP_STEP, 0.0, SLIP_STEP].map(|step| belief.at(share.load, share.slip + step));
            let force = states.map(|state| state.torque / radius);
            let change = force[2] - force[0];
            let slope = (states[2].pull - states[0].pull) / change;
            let slope = if slope.is_finite() { slope.clamp(LEAST_YIELD, 1.0) } else { 1.0 };
            let offset = states[1].pull - slope * force[1];
            let balance = &mut self.problem.distribution;
            balance.yields[wheel] = slope;
            balance.resist(wheel, radius, -direction * offset);
            (self.problem.adhesion[wheel], self.problem.friction[wheel]) =
                (0.0, share.best.torque.max(0.0) / (radius * share.load));
            if demand.criterion == Criterion::ElectricalPower {
                let speed = demand.speed.abs() * rolling[wheel].along;
                let power = states.map(|state| electrical(nominal, speed, &state));
                let [square, linear] = quadratic(force, power, nominal.winding_power(radius));
                costs[wheel] = [square, direction * linear];
            } else {
                costs[wheel] = [1.0, 0.0];
            }
        }
        // In weights, and of order 1.
        let largest = costs.iter().map(|cost| cost[0]).fold(f64::MIN_POSITIVE, f64::max);
        costs.iter_mut().for_each(|cost| *cost = [cost[0] / largest, cost[1] / (largest * unit)]);
        self.problem.costs = Some(costs);
    }

    /// Takes the forces that were found over into loads and slips; says whether they have stayed.
    fn follow(&mut self, radius: f64, direction: f64) -> bool {
        let unit = self.problem.force_unit();
        let mut stays = true;
        for (wheel, share) in self.shares.iter_mut().enumerate() {
            if self.problem.lifted[wheel] {
                *share = Share::default();
                continue;
            }
            let load = self.forces[load_of(wheel)].max(self.problem.minimum_load);
            let torque = direction * radius * self.forces[traction_of(wheel)];
            let state = self.beliefs[wheel].with_torque(load, torque.min(share.best.torque), &share.best);
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
