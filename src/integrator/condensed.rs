//! Elimination of a wheel's spin and memory from the implicit system.

use crate::contact::Forces;
use crate::linear::{Matrix, add_outer};
use crate::rover::Rover;
use crate::rover::dynamics::WheelEvaluation;
use crate::scalar::{Scalar, lanes};
use crate::signals::Drive;

/// What elimination of one wheel's spin and memory leaves. The spin's increment is
/// `spin + spin_by_velocity * tangent.k + spin_by_turn * turn.k`, with `spin` from the right-hand side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Condensed<S> {
    /// Slopes of the forces in the spin, with the memory eliminated.
    pub by_spin: Forces<S>,
    /// Slopes of the forces in the tangential velocity and in the body's turn, with the spin eliminated too.
    pub by_velocity: Forces<S>,
    pub by_turn: Forces<S>,
    /// The same of the drive's reaction on the body, and its slope in `spin`.
    pub reaction_by_velocity: S,
    pub reaction_by_turn: S,
    pub reaction_by_spin: S,
    /// 1/(1 - gamma h slope) of the memory.
    pub hold_factor: S,
    /// 1/(I - gamma h slope) of the spin.
    pub spin_factor: S,
    pub spin_by_velocity: S,
    pub spin_by_turn: S,
}

#[lanes]
impl<S: Scalar> Condensed<S> {
    pub fn zero() -> Self {
        let (zero, none) = (S::from(0.0), Forces::zero());
        Self {
            by_spin: none,
            by_velocity: none,
            by_turn: none,
            reaction_by_velocity: zero,
            reaction_by_turn: zero,
            reaction_by_spin: zero,
            hold_factor: zero,
            spin_factor: zero,
            spin_by_velocity: zero,
            spin_by_turn: zero,
        }
    }

    pub fn new(rover: &Rover<S>, wheel: &WheelEvaluation<S>, drive: Drive, gh: f64) -> Self {
        let slopes = &wheel.touch.slopes;
        let hold_factor = (S::from(1.0) - slopes.rate_own * gh).recip();
        let through_hold = |[travel, turn]: [S; 2]| {
            slopes.travel.scaled(travel * hold_factor * gh).plus(slopes.turn.scaled(turn * hold_factor * gh))
        };
        let by_velocity = slopes.velocity.plus(through_hold(slopes.rate_by_velocity));
        let by_spin = slopes.spin.plus(through_hold(slopes.rate_by_spin));
        let spin_factor = (rover.wheel.inertia + (by_spin.torque - wheel.drive_slope) * gh).recip();
        let (spin_by_velocity, spin_by_turn) = match drive {
            // I dw = ... - gamma h dT + gamma h slope (dw + a.du): the drive's slope is in the relative speed.
            Drive::Torque => (-(by_velocity.torque * spin_factor * gh), wheel.drive_slope * spin_factor * gh),
            // The spin follows the body: its increment is minus the body's turn.
            Drive::Speed => (S::from(0.0), S::from(-1.0)),
        };
        let total = by_velocity.plus(by_spin.scaled(spin_by_velocity));
        let by_turn = by_spin.scaled(spin_by_turn);
        let (reaction_by_velocity, reaction_by_turn, reaction_by_spin) = match drive {
            Drive::Torque => {
                (wheel.drive_slope * spin_by_velocity, wheel.drive_slope * (spin_by_turn + 1.0), wheel.drive_slope)
            }
            Drive::Speed => (total.torque, by_turn.torque, S::from(0.0)),
        };
        Self {
            by_spin,
            by_velocity: total,
            by_turn,
            reaction_by_velocity,
            reaction_by_turn,
            reaction_by_spin,
            hold_factor,
            spin_factor,
            spin_by_velocity,
            spin_by_turn,
        }
    }
}

/// Adds `- gamma h` times the slopes of one wheel's contact and drive to the condensed matrix.
#[lanes]
pub(super) fn add_contact<S: Scalar>(
    matrix: &mut Matrix<S>,
    wheel: &WheelEvaluation<S>,
    condensed: &Condensed<S>,
    gh: f64,
    n: usize,
) {
    let slopes = &wheel.touch.slopes;
    let (by_velocity, by_turn) = (&condensed.by_velocity, &condensed.by_turn);
    let along_normal = (slopes.stiffness * gh - slopes.damping) * gh;
    add_outer(matrix, along_normal, &wheel.normal, &wheel.normal, n);
    add_outer(matrix, by_velocity.normal * -gh, &wheel.normal, &wheel.tangent, n);
    add_outer(matrix, by_velocity.drawbar * -gh, &wheel.tangent, &wheel.tangent, n);
    add_outer(matrix, by_turn.normal * -gh, &wheel.normal, &wheel.turn, n);
    add_outer(matrix, by_turn.drawbar * -gh, &wheel.tangent, &wheel.turn, n);
    add_outer(matrix, condensed.reaction_by_velocity * -gh, &wheel.turn, &wheel.tangent, n);
    add_outer(matrix, condensed.reaction_by_turn * -gh, &wheel.turn, &wheel.turn, n);
}
