//! Rate or increment of a whole state.

use super::condensed::Condensed;
use crate::linear::{Factors, Vector, add_scaled, dot, zeros};
use crate::rover::dynamics::Evaluation;
use crate::rover::{Rover, State};
use crate::scalar::{Scalar, lanes};
use crate::signals::Drive;

/// Rate or increment of a whole state; a wheel's entries are its spin, `hold.travel` and `hold.turn`.
#[derive(Clone, Debug)]
pub(crate) struct Increment<S> {
    pub position: Vector<S>,
    pub rate: Vector<S>,
    pub wheels: Vec<[S; 3]>,
}

#[lanes]
impl<S: Scalar> Increment<S> {
    /// The time derivative of `state`, as evaluated.
    pub(super) fn set(&mut self, rover: &Rover<S>, state: &State<S>, evaluation: &Evaluation<S>) {
        self.position[..state.rate.len()].copy_from_slice(&state.rate);
        self.rate = evaluation.acceleration;
        for (k, (entry, wheel)) in self.wheels.iter_mut().zip(&evaluation.wheels).enumerate() {
            *entry = [evaluation.spin_rate(rover, k), wheel.touch.rate.travel, wheel.touch.rate.turn];
        }
    }

    pub(super) fn add_scaled(&mut self, other: &Self, factor: f64, n: usize) {
        let factor = S::from(factor);
        add_scaled(&mut self.position, factor, &other.position, n);
        add_scaled(&mut self.rate, factor, &other.rate, n);
        for (entry, other) in self.wheels.iter_mut().zip(&other.wheels) {
            for (a, b) in entry.iter_mut().zip(other) {
                *a += *b * factor;
            }
        }
    }

    pub fn add_to(&self, state: &mut State<S>, factor: f64) {
        for (i, (position, rate)) in state.position.iter_mut().zip(&mut state.rate).enumerate() {
            *position += self.position[i] * factor;
            *rate += self.rate[i] * factor;
        }
        for (wheel, [spin, travel, turn]) in state.wheels.iter_mut().zip(&self.wheels) {
            wheel.spin += *spin * factor;
            wheel.hold.travel += *travel * factor;
            wheel.hold.turn += *turn * factor;
        }
    }

    /// Replaces this right-hand side r by the solution k of (I - gamma h A) k = r.
    pub(super) fn solve(
        &mut self,
        rover: &Rover<S>,
        now: &Evaluation<S>,
        condensed: &[Condensed<S>],
        factors: &Factors<S>,
        drive: Drive,
        gh: f64,
    ) {
        let n = rover.coordinates();
        let inertia = rover.wheel.inertia;
        let mut right = zeros();
        for (i, row) in now.system.iter().enumerate().take(n) {
            right[i] = dot(row, &self.rate, n);
        }
        for ((wheel, c), entry) in now.wheels.iter().zip(condensed).zip(&mut self.wheels) {
            let slopes = &wheel.touch.slopes;
            let (travel, turn) = (c.hold_factor * entry[1], c.hold_factor * entry[2]);
            let mut constant = slopes.travel.scaled(travel).plus(slopes.turn.scaled(turn));
            let mut reaction = constant.torque;
            if drive == Drive::Torque {
                // The part of the spin's increment that does not depend on the body's motion.
                entry[0] = (inertia * entry[0] - constant.torque * gh) * c.spin_factor;
                constant = constant.plus(c.by_spin.scaled(entry[0]));
                reaction = c.reaction_by_spin * entry[0];
            } else {
                entry[0] = S::from(0.0);
            }
            let sunk = dot(&wheel.normal, &self.position, n);
            add_scaled(&mut right, (constant.normal - slopes.stiffness * sunk) * gh, &wheel.normal, n);
            add_scaled(&mut right, constant.drawbar * gh, &wheel.tangent, n);
            add_scaled(&mut right, reaction * gh, &wheel.turn, n);
        }
        for j in 0..rover.links.len() {
            right[3 + j] -= now.stop_stiffness[j] * self.position[3 + j] * gh;
        }
        self.rate = factors.solve(&right);
        for i in 0..n {
            self.position[i] += self.rate[i] * gh;
        }
        for ((wheel, c), entry) in now.wheels.iter().zip(condensed).zip(&mut self.wheels) {
            let velocity = dot(&wheel.tangent, &self.rate, n);
            entry[0] += c.spin_by_velocity * velocity + c.spin_by_turn * dot(&wheel.turn, &self.rate, n);
            let slopes = &wheel.touch.slopes;
            for i in 0..2 {
                let driven = slopes.rate_by_velocity[i] * velocity + slopes.rate_by_spin[i] * entry[0];
                entry[i + 1] = (entry[i + 1] + driven * gh) * c.hold_factor;
            }
        }
    }
}
