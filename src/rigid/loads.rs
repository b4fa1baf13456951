//! Forces of soil and drives over one step, for bodies that something else moves.
//!
//! The forces of the soil are stiff in the wheels' velocities: a wheel's spin follows the shear of the soil at rates of
//! 1e3 to 1e5/s, so forces taken at the start of a step of 2 ms would make it unstable, and no affordable sub-step
//! helps. So each step first solves the two stages of the linearly implicit method of the joint-coordinate plant
//! ([`crate::integrator`], ROS2) from the present motion, with the forces of the rigid contacts as they were last, and
//! gives the bodies the mean forces of that step: y' = y + h (3 k1 + k2)/2 with M k1 = F1 + gamma h A k1 and
//! M k2 = F2 + gamma h A k2 - 2 M k1 means a mean force of (F1 + gamma h A k1)/2 + (F2 + gamma h A k2)/2. The wrench on
//! each wheel, the drive's torque, the friction and the stop of each joint are the parts of that sum. What the bodies then do
//! with them, with joints and rigid contacts, is rapier's.

use super::world::WheelLoad;
use crate::contact::Forces;
use crate::integrator::{DRY_FRICTION, GAMMA, Increment, Integrator};
use crate::linear::dot;
use crate::rover::Rover;
use crate::rover::dynamics::{Evaluation, WheelEvaluation};
use crate::signals::Drive;

/// Mean forces of a step.
#[derive(Clone, Debug, Default)]
pub(super) struct Loads {
    pub wheels: Vec<WheelLoad>,
    /// Friction and stop of each joint as a moment on its link, nose up.
    pub links: Vec<f64>,
    /// Horizontal force on the chassis at its reference point.
    pub resistance: f64,
}

impl Loads {
    pub fn new(rover: &Rover) -> Self {
        Self {
            wheels: vec![WheelLoad::default(); rover.wheels.len()],
            links: vec![0.0; rover.links.len()],
            resistance: 0.0,
        }
    }

    /// The mean forces of the step of size `h` whose stages `integrator` holds.
    pub fn set(&mut self, rover: &Rover, integrator: &Integrator, drive: Drive, h: f64) {
        let gh = GAMMA * h;
        let n = rover.coordinates();
        let Integrator { now, ahead, first, second, .. } = integrator;
        for (k, load) in self.wheels.iter_mut().enumerate() {
            let (start, middle) = (&now.wheels[k], &ahead.wheels[k]);
            let change = [first, second].map(|increment| force_change(start, increment, k, n, gh));
            let at = |wheel: &WheelEvaluation<f64>, i: usize| {
                wheel.touch.forces.normal * wheel.normal[i] + wheel.touch.forces.drawbar * wheel.tangent[i]
            };
            let along = |change: &Forces, i: usize| change.normal * start.normal[i] + change.drawbar * start.tangent[i];
            load.force =
                [0, 1].map(|i| 0.5 * (at(start, i) + along(&change[0], i) + at(middle, i) + along(&change[1], i)));
            load.soil_torque =
                0.5 * (start.touch.forces.torque + change[0].torque + middle.touch.forces.torque + change[1].torque);
            load.rim_torque = match drive {
                Drive::Torque => {
                    let slope = |increment: &Increment<f64>| {
                        start.drive_slope * gh * (increment.wheels[k][0] + dot(&start.turn, &increment.rate, n))
                    };
                    0.5 * (start.rim_torque + slope(first) + middle.rim_torque + slope(second))
                }
                // What the soil takes, and what the wheel's inertia takes as it turns with its body.
                Drive::Speed => {
                    let turning = 1.5 * dot(&start.turn, &first.rate, n) + 0.5 * dot(&start.turn, &second.rate, n);
                    let outside = now.outside.as_ref().map_or(0.0, |outside| outside.torque[k]);
                    load.soil_torque - outside - rover.wheel.inertia * turning
                }
            };
        }
        for (j, moment) in self.links.iter_mut().enumerate() {
            let damping = rover.links[j].parameters.damping;
            let friction = |evaluation: &Evaluation<f64>, rate: f64| (damping + evaluation.joint_friction[j]) * rate;
            let slope = damping + now.joint_friction[j] * DRY_FRICTION + now.stop_damping[j];
            let change = slope * gh * (first.rate[3 + j] + second.rate[3 + j]);
            let rates = [
                now.frames.rate(j + 1) - now.frames.rate(rover.links[j].parent),
                ahead.frames.rate(j + 1) - ahead.frames.rate(rover.links[j].parent),
            ];
            let bent = now.stop_stiffness[j] * gh * (first.position[3 + j] + second.position[3 + j]);
            let stop = now.stop_moment[j] + ahead.stop_moment[j] - bent;
            *moment = 0.5 * (stop - friction(now, rates[0]) - friction(ahead, rates[1]) - change);
        }
        self.resistance = 0.5 * (now.resistance + ahead.resistance);
    }
}

/// gamma h A k of one wheel: the change of its contact's forces with a stage's increment.
fn force_change(wheel: &WheelEvaluation<f64>, increment: &Increment<f64>, k: usize, n: usize, gh: f64) -> Forces {
    let slopes = &wheel.touch.slopes;
    let [spin, travel, turn] = increment.wheels[k];
    let mut change = slopes
        .velocity
        .scaled(dot(&wheel.tangent, &increment.rate, n))
        .plus(slopes.spin.scaled(spin))
        .plus(slopes.travel.scaled(travel))
        .plus(slopes.turn.scaled(turn));
    change.normal += slopes.damping * dot(&wheel.normal, &increment.rate, n)
        - slopes.stiffness * dot(&wheel.normal, &increment.position, n);
    change.scaled(gh)
}
