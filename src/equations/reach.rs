//! The right-hand side at states that no rover reaches.
//!
//! An implicit integrator searches the end of its step by Newton's method and looks far away on the way: a hundred metres
//! below the ground, beyond its last sample, at a memory of the contact far longer than 1. A failure there ends most
//! integrators. So the right-hand side is continued: a wheel too far above or below the ground has the forces of one nearer to
//! it (none, or those of the deepest contact), one beyond the known ground those at its end, and a memory that is much too
//! long acts as a shorter one. Where a rover can be, nothing of this changes anything.
//!
//! Whether an integrator that has accepted a state still follows the equations is a matter of their energies: weight and
//! motion, the work of the drives, and the losses balance.

use super::Equations;
use crate::rover::dynamics::DynamicsError;
use crate::scalar::{Plain, Scalar};
use crate::terrain::TerrainError;

/// Share of the distance from which on a wheel has no foot, at which it is evaluated.
const NEARER: f64 = 0.5;

/// Distance from the end of the known ground at which a wheel beyond it is evaluated, m.
const INSIDE: f64 = 1e-3;

/// Corrections of a position, at most: two for each of eight wheels.
const CORRECTIONS: usize = 16;

/// Error of the energies that no integrator within a usual tolerance makes, as shares of their turnover and of the work that
/// lifts the rover by a wheel's radius. CVode stays below an eighth of it even at a relative tolerance of 1e-2.
const UNBALANCED: [f64; 2] = [0.1, 0.1];

/// Length of a contact's memory that no integrator within a usual tolerance gives it: exactly it is at most 1. Explicit methods
/// with too large a step drive it beyond in a few steps, for its rate |v|/d is the stiffest of all.
const LONGEST_MEMORY: f64 = 1.2;

/// What would do in place of an integrator that has lost the motion.
const EXPECTED: &str = "expected an implicit method (CVode), or an explicit one with smaller steps (Euler's method: less than \
     2 soil.hold_displacement over the speed of the rim)";

/// Why an accepted state is no point of the motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LostMotion {
    /// The energies do not balance.
    #[error(
        "the energies of the integrated motion are off by {error} J, more than {allowed} J: the integrator does not follow \
         the equations; {EXPECTED}"
    )]
    Unbalanced {
        /// Error since the integrator started, J.
        error: f64,
        /// Largest error that counts as one of integration, J.
        allowed: f64,
    },
    /// A contact's memory is longer than it can be.
    #[error(
        "the contact's memory of wheel {wheel} is longer than 1, the most that it can be: the integrator does not follow the \
         equations; {EXPECTED}"
    )]
    Memory {
        /// Wheel, from 1 at the rear.
        wheel: usize,
    },
    /// A wheel is further from the ground than any rover comes.
    #[error(
        "a wheel is {distance} m from where the ground can be evaluated: the integrator does not follow the equations; \
         {EXPECTED}"
    )]
    Away {
        /// How far, m.
        distance: f64,
    },
}

impl<S: Scalar> Equations<S> {
    /// Evaluates at the present state or, where that has no value, at one nearby that has.
    pub(super) fn update_within_reach(&mut self) -> Result<(), DynamicsError> {
        self.within.copy_from(&self.state);
        self.beyond = [0.0; 2];
        for wheel in &mut self.within.wheels {
            let length = wheel.hold.travel.value().hypot(wheel.hold.turn.value());
            if length > LONGEST_MEMORY {
                let share = S::from(LONGEST_MEMORY / length);
                (wheel.hold.travel, wheel.hold.turn) = (wheel.hold.travel * share, wheel.hold.turn * share);
            }
        }
        let mut corrections = 0;
        loop {
            let failure = match self.evaluation.update(&self.rover, &self.within, &self.command) {
                Err(DynamicsError::Terrain { source, .. }) if corrections < CORRECTIONS => source,
                other => return other,
            };
            corrections += 1;
            let [x, z] = self.towards(&failure).ok_or(DynamicsError::NotFinite)?;
            self.within.position[0] += S::from(x);
            self.within.position[1] += S::from(z);
            self.beyond = [self.beyond[0] - x, self.beyond[1] - z];
        }
    }

    /// The way towards the ground where a wheel has failed to find it, [x, z] in m.
    fn towards(&self, failure: &TerrainError) -> Option<[f64; 2]> {
        match *failure {
            TerrainError::TooFar { clearance, limit, .. } => {
                clearance.is_finite().then(|| [0.0, limit.copysign(clearance) * NEARER - clearance])
            }
            TerrainError::Left { x, from, to } => {
                let inside = if x < from { from + INSIDE } else { to - INSIDE };
                let height = |x: f64| self.rover.terrain.at(S::from(x)).height.plain().lane(0);
                Some([inside - x, height(inside) - height(x)])
            }
            TerrainError::NotFinite { .. } => None,
        }
    }

    /// Lets the balance of energies start anew at the next [`check_motion`](Self::check_motion): the states have been set.
    pub fn forget_balance(&mut self) {
        self.balance = None;
    }

    /// Whether the states last evaluated are still a point of the motion, for an integrator that has accepted them.
    ///
    /// # Errors
    /// [`LostMotion`].
    pub fn check_motion(&mut self) -> Result<(), LostMotion> {
        if self.beyond[1] != 0.0 && self.beyond[0] == 0.0 {
            return Err(LostMotion::Away { distance: self.beyond[1].abs() });
        }
        for (k, wheel) in self.state.wheels.iter().enumerate() {
            let length = wheel.hold.travel.value().hypot(wheel.hold.turn.value());
            // False for NaN too.
            let within = length <= LONGEST_MEMORY;
            if !within {
                return Err(LostMotion::Memory { wheel: k + 1 });
            }
        }
        let Some(start) = self.balance else {
            self.balance = Some(self.balanced());
            return Ok(());
        };
        let energies = &self.energies;
        let turnover = [energies.drive, energies.soil_loss, energies.other_loss].map(|energy| energy.value().abs());
        let lift = self.rover.total_mass() * self.rover.environment.gravity * self.rover.wheel.radius;
        let allowed = UNBALANCED[0] * turnover.iter().sum::<f64>() + UNBALANCED[1] * lift.value();
        let error = (self.balanced() - start).abs();
        // False for NaN too.
        let within = error <= allowed;
        if within { Ok(()) } else { Err(LostMotion::Unbalanced { error, allowed }) }
    }

    /// Energy of motion and weight, and what has left it, J.
    fn balanced(&self) -> f64 {
        let mechanical = self.evaluation.mechanical_energy(&self.rover, &self.state);
        let energies = &self.energies;
        (mechanical + energies.soil_loss + energies.other_loss - energies.drive).value()
    }
}
