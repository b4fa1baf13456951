//! Slip-sinkage.

use super::{Effect, Facts, Local, Place, SOIL_TEST};
use crate::scalar::{Mask, Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// A slipping wheel digs itself in: n = n_0 + n_1 min(|i|, 1) (Ding et al. 2011), at once or, with a length l, along its way:
    /// n = n_0 + n_1 s with ds/dt = (min(|r omega - V|, v) - s v)/l and v = max(|r omega|, |V|), so that s = min(|i|, 1) in steady
    /// motion. A wheel that spins on the spot then digs itself in while l of its rim passes, and one that rolls on leaves its hole after l.
    pub struct SlipSinkage {
        /// Growth n_1 of the sinkage exponent with slip.
        n1: [Unit::ONE] = 0.0, 0.0..=1.5, Effect, "Ding et al. 2011, J. Terramechanics 48: 0.35-0.5";
        /// Way of rim or wheel l within which the sinkage follows the slip; 0 follows at once.
        length: [Unit::METRE] = 0.0, 0.0..=1.0, Fixed, "neutral; about the contact's length, 0.6 r at a sinkage of 0.2 r";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for SlipSinkage<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["sinkage", "drawbar_pull"],
            seen_on_rover: &["wheel[1].sinkage"],
            advice: &[SOIL_TEST],
            ..Facts::USUAL
        }
    }

    fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        if self.n1.is_exactly(0.0) {
            return;
        }
        let slip = S::select(self.length.over(0.0), place.dug_slip.larger(S::from(0.0)), place.slip.abs());
        local.soil.exponent += self.n1 * slip.smaller(S::from(1.0));
    }

    fn dug_within(&self) -> Option<S> {
        self.length.over(0.0).any().then_some(self.length)
    }
}

/// How the ground under a wheel is dug over and left behind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Digging<S = f64> {
    /// Speed at which the rim slips over the ground, at most `renewal`; none off the ground; m/s.
    slipping: S,
    /// Speed at which ground passes under the wheel, by the rim or by the way; m/s.
    renewal: S,
}

#[lanes]
impl<S: Scalar> Digging<S> {
    /// Of a wheel that moves at `velocity` (m/s) with this speed of its rim (m/s), where the mask says that it touches the ground.
    pub(crate) fn new(velocity: S, rim_speed: S, touches: S::Mask) -> Self {
        let (travel, rim) = (velocity.abs(), rim_speed.abs());
        let renewal = S::select(touches, travel.larger(rim), travel);
        let slipping = (rim_speed - velocity).abs().smaller(renewal);
        Self { slipping: S::select(touches, slipping, S::from(0.0)), renewal }
    }

    /// The mean of two instants.
    pub(crate) fn mean(self, other: Self) -> Self {
        Self { slipping: (self.slipping + other.slipping) * 0.5, renewal: (self.renewal + other.renewal) * 0.5 }
    }

    /// Rate of the slip `dug` that the ground shows, 1/s, where it follows within `length` (m, more than 0).
    pub(crate) fn rate(&self, dug: S, length: S) -> S {
        (self.slipping - dug * self.renewal) / length
    }

    /// That slip after `h` seconds: exact where the motion stays the same. Where the length is 0 it is not kept.
    pub(crate) fn after(&self, dug: S, length: S, h: f64) -> S {
        let (one, moves) = (S::from(1.0), self.renewal.over(0.0) & length.over(0.0));
        let (renewal, length) = (S::select(moves, self.renewal, one), S::select(moves, length, one));
        let end = self.slipping / renewal;
        S::select(moves, end + (dug - end) * (-(renewal / length * h)).exp(), dug)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a few operations with numbers of the order 1.
    const ROUNDING: f64 = 1e-14;

    #[test]
    fn analytic_a_spinning_wheel_digs_itself_in_and_leaves_its_hole_by_rolling_on() {
        let (length, r_omega) = (0.05, 0.1);
        // On the spot, for the time in which twice the length of the rim passes.
        let spins = Digging::new(0.0, r_omega, true);
        let dug = spins.after(0.0, length, 2.0 * length / r_omega);
        assert!((dug - (1.0 - (-2.0_f64).exp())).abs() < ROUNDING);
        // Rolling without slip over the same way.
        let left = Digging::new(r_omega, r_omega, true).after(dug, length, 2.0 * length / r_omega);
        assert!((left - dug * (-2.0_f64).exp()).abs() < ROUNDING);
    }

    #[test]
    fn analytic_in_steady_motion_the_ground_shows_the_slip() {
        for (velocity, rim_speed) in [(0.06, 0.1), (0.1, 0.06), (-0.06, -0.1), (-0.02, 0.1), (0.0, -0.1)] {
            let slip = crate::contact::slip(velocity, rim_speed).abs().min(1.0);
            let motion = Digging::new(velocity, rim_speed, true);
            assert!((motion.rate(slip, 0.05)).abs() < ROUNDING);
            assert!((motion.after(slip, 0.05, 0.3) - slip).abs() < ROUNDING);
        }
    }

    #[test]
    fn analytic_a_standing_wheel_and_one_in_the_air_dig_nothing() {
        assert_eq!(Digging::new(0.0, 0.0, true).after(0.3, 0.05, 1.0), 0.3);
        assert_eq!(Digging::new(0.0, 0.1, false).after(0.3, 0.05, 1.0), 0.3);
    }
}
