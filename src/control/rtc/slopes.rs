//! Linearisation of the pull of one wheel over tractive force and load.

use super::belief::{SoilBelief, Working};

/// Step in the slip over which the soil is linearised.
const SLIP_STEP: f64 = 0.005;
/// Change of the load over which the soil is linearised, of the load.
const LOAD_STEP: f64 = 0.01;
/// Least share of a torque's force that counts as pull: at the best slip on digging soil it is zero,
/// which would make the balance singular.
const LEAST_YIELD: f64 = 0.02;

/// DP = offset + over_force T/r + over_load N, in the direction of travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slopes {
    /// Change of the pull with the torque's force T/r under the same load.
    pub over_force: f64,
    /// Change of the pull with the load under the same torque.
    pub over_load: f64,
    /// Pull without torque and load, N.
    pub offset: f64,
    /// T/r a step under the slip, at it, and a step over it, N.
    pub force: [f64; 3],
    /// The states there.
    pub states: [Working; 3],
}

impl Slopes {
    /// Slopes about `load` (N, over 0) and `slip` for a wheel of `radius` m.
    pub fn about(belief: &SoilBelief, load: f64, slip: f64, radius: f64) -> Self {
        let states = [-SLIP_STEP, 0.0, SLIP_STEP].map(|step| belief.at(load, slip + step));
        let force = states.map(|state| state.torque / radius);
        let over_force = (states[2].pull - states[0].pull) / (force[2] - force[0]);
        let over_force = if over_force.is_finite() { over_force.clamp(LEAST_YIELD, 1.0) } else { 1.0 };
        // Along constant torque: a heavier wheel at the same slip needs more torque, so that its slip falls.
        let heavier = belief.at(load * (1.0 + LOAD_STEP), slip);
        let gained = heavier.pull - states[1].pull - over_force * (heavier.torque / radius - force[1]);
        let over_load = gained / (LOAD_STEP * load);
        let over_load = if over_load.is_finite() { over_load } else { 0.0 };
        let offset = states[1].pull - over_force * force[1] - over_load * load;
        Self { over_force, over_load, offset, force, states }
    }
}
