//! Slip-sinkage.

use super::{Effect, Facts, Local, Place, SOIL_TEST};
use crate::scalar::{Mask, Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

/// Below it four terms of the series of (1 - e^-x)/x are nearer, x^4/120, than the difference, whose rounding is of 1e-16/x.
const SMALL: f64 = 1.5e-3;
/// Largest slip of Reece's law, whose sinkage has no bound, and largest share of the sinkage that it may add.
const LARGEST_SLIP: f64 = 0.95;
const MOST_CARRIED: f64 = 0.9;

parameters! {
    /// A slipping wheel digs itself in, with s = min(|i|, 1): by the sinkage exponent, n = n_0 + n_1 s (Ding et al. 2011), or by the
    /// sinkage itself, p = (k_c/b + k_phi) (z/f)^n, or by both. f is the product of 1 + g ((1 + s)/(1 - 0.5 s) - 1) (Lyasko 2010 has
    /// g = 1) and z/(z - z_j) with z_j = h s/(1 - s) (Reece 1965), where s counts up to 0.95, z_j up to 0.9 z, and z is the sinkage of the
    /// undeformed outline. It digs at once or, with a relaxation length l, along its way: ds/dt = (min(|r omega - V|, v) - s v)/l with
    /// v = max(|r omega|, |V|), so that s = min(|i|, 1) in steady motion. Of a change of slip 63 % have come after l and 95 % after 3 l,
    /// measured along the rim or along the way, whichever is longer. s belongs to the wheel: one that follows does not find the hole of
    /// the one before it.
    pub struct SlipSinkage {
        /// Growth n_1 of the sinkage exponent with slip.
        n1: [Unit::ONE] = 0.0, 0.0..=1.5, Effect, "Ding et al. 2011, J. Terramechanics 48: 0.35-0.5";
        /// Share g of Lyasko's growth of the sinkage with slip.
        growth: [Unit::ONE] = 0.0, 0.0..=2.0, Effect, "Lyasko 2010, J. Terramechanics 47: 1";
        /// Height h of the lugs that carry soil away; at a slip of a half this adds h to the sinkage.
        carried: [Unit::METRE] = 0.0, 0.0..=0.05, Effect, "Reece 1965, Proc. IMechE 180: the height of the lugs";
        /// Relaxation length l with which the sinkage follows the slip, along the rim or along the way; 0 follows at once.
        length: [Unit::METRE] = 0.0, 0.0..=1.0, Fixed, "neutral; assumption: the contact's length, 0.6 r at a sinkage of 0.2 r";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for SlipSinkage<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["sinkage", "drawbar_pull"],
            seen_on_rover: &["wheel[1].sinkage"],
            typical: &[("n1", 0.4), ("growth", 0.2), ("carried", 0.001)],
            advice: &[SOIL_TEST],
            // Whether the ground keeps a slip is decided at the start.
            not_tunable: &["length"],
            ..Facts::USUAL
        }
    }

    fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        let deepens = !(self.growth.is_exactly(0.0) && self.carried.is_exactly(0.0));
        if self.n1.is_exactly(0.0) && !deepens {
            return;
        }
        let slip = S::select(self.length.over(0.0), place.dug_slip.larger(S::from(0.0)), place.slip.abs());
        let slip = slip.smaller(S::from(1.0));
        local.soil.exponent += self.n1 * slip;
        if deepens {
            local.soil.scale_moduli(self.pressed(slip, place.sinkage).power(local.soil.exponent));
        }
    }

    fn digging_length(&self) -> Option<S> {
        self.length.over(0.0).any().then_some(self.length)
    }
}

#[lanes]
impl<S: Scalar> SlipSinkage<S> {
    /// Share 1/f of the sinkage that presses the soil, at a slip from 0 to 1.
    fn pressed(&self, slip: S, sinkage: S) -> S {
        // (1 + s)/(1 - 0.5 s) - 1 = 1.5 s/(1 - 0.5 s)
        let grown = self.growth * slip * 1.5 / (slip * -0.5 + 1.0) + 1.0;
        let slip = slip.smaller(S::from(LARGEST_SLIP));
        let carried = self.carried * slip / (S::from(1.0) - slip);
        let stands = sinkage.over(0.0);
        let share = carried / S::select(stands, sinkage, S::from(1.0));
        let share = S::select(stands, share.smaller(S::from(MOST_CARRIED)), S::from(0.0));
        (S::from(1.0) - share) / grown
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

    /// Rate of the slip `dug` that the ground shows, 1/s, with the relaxation length `length` (m, more than 0).
    pub(crate) fn rate(&self, dug: S, length: S) -> S {
        (self.slipping - dug * self.renewal) / length
    }

    /// That slip after `h` seconds: exact where the motion stays the same.
    pub(crate) fn after(&self, dug: S, length: S, h: f64) -> S {
        dug + self.rate(dug, length) * relaxed(self.renewal / length * h) * h
    }

    /// That slip after a long time; none of a wheel that stands.
    pub(crate) fn steady(&self) -> S {
        let moves = self.renewal.over(0.0);
        S::select(moves, self.slipping / S::select(moves, self.renewal, S::from(1.0)), S::from(0.0))
    }
}

/// (1 - e^-x)/x, for x >= 0.
#[lanes]
fn relaxed<S: Scalar>(x: S) -> S {
    let small = x.under(SMALL);
    let safe = S::select(small, S::from(1.0), x);
    let series = ((x * (-1.0 / 24.0) + 1.0 / 6.0) * x - 0.5) * x + 1.0;
    S::select(small, series, (S::from(1.0) - (-safe).exp()) / safe)
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
    fn analytic_reeces_law_ends_at_its_largest_slip_and_share() {
        let lugs = SlipSinkage { n1: 0.0, growth: 0.0, carried: 0.004, length: 0.0 };
        // z_j = h at a slip of a half.
        assert!((lugs.pressed(0.5, 0.02) - 0.8).abs() < ROUNDING);
        assert_eq!(lugs.pressed(1.0, 0.2), lugs.pressed(LARGEST_SLIP, 0.2));
        assert!((lugs.pressed(1.0, 0.2) - (1.0 - 0.004 * 19.0 / 0.2)).abs() < ROUNDING);
        assert!((lugs.pressed(0.9, 0.001) - (1.0 - MOST_CARRIED)).abs() < ROUNDING);
        assert_eq!([lugs.pressed(0.0, 0.02), lugs.pressed(0.9, 0.0)], [1.0, 1.0]);
    }

    #[test]
    fn analytic_in_steady_motion_the_ground_shows_the_slip() {
        assert_eq!(Digging::new(0.0, 0.0, true).steady(), 0.0);
        for (velocity, rim_speed) in [(0.06, 0.1), (0.1, 0.06), (-0.06, -0.1), (-0.02, 0.1), (0.0, -0.1)] {
            let slip = crate::contact::slip(velocity, rim_speed).abs().min(1.0);
            let motion = Digging::new(velocity, rim_speed, true);
            assert!((motion.steady() - slip).abs() < ROUNDING);
            assert!((motion.rate(slip, 0.05)).abs() < ROUNDING);
            assert!((motion.after(slip, 0.05, 0.3) - slip).abs() < ROUNDING);
        }
    }

    #[test]
    fn analytic_the_series_and_the_closed_form_meet() {
        for x in [0.0, 1e-9, 1e-4, 0.999 * SMALL, 1.001 * SMALL, 0.1, 3.0] {
            let exact = if x > 0.0 { -(-x).exp_m1() / x } else { 1.0 };
            // A rounding of e^-x over x.
            assert!((relaxed(x) - exact).abs() < f64::EPSILON / SMALL, "{x}");
        }
    }

    #[test]
    fn analytic_a_standing_wheel_and_one_in_the_air_dig_nothing() {
        assert_eq!(Digging::new(0.0, 0.0, true).after(0.3, 0.05, 1.0), 0.3);
        assert_eq!(Digging::new(0.0, 0.1, false).after(0.3, 0.05, 1.0), 0.3);
    }
}
