//! Stresses along the rim in contact with the soil (2.1)-(2.6).
//!
//! Angles are measured at the wheel centre from the ground's normal, forward positive. Both zones are
//! run through with s in 0..1: theta = theta_1 - (theta_1 - theta_m) s^2 in front and
//! theta = theta_2 + (theta_m - theta_2) s^2 behind. The square removes the root-like start of the stress
//! at both ends for n < 1. Since (2.6) maps the rear zone onto the front one, the normal stress is the
//! same function of s in both and is computed once.

use super::surface::Surface;
use crate::scalar::{Mask, Plain, Scalar, lanes};
use crate::soil::Soil;
use crate::wheel::Wheel;

/// Least rounding of a limit that is not sharp: below it the corner differs from a sharp one by less than rounding.
const LEAST_ROUNDING: f64 = 1e-9;

/// How the soil is sheared along the rim.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shear<S> {
    /// Rolling with this V/(r omega) >= 0 (2.2).
    Ratio(S),
    /// The same with lugs or a grip below the soil's strength: kept apart, since most wheels have neither.
    OnSurface(S),
    /// Sliding everywhere, |j| -> infinity, shear of this sign.
    Full(f64),
}

/// One rim in contact.
pub(super) struct Rim<S> {
    pub(super) shear: Shear<S>,
    pub(super) theta_1: S,
    pub(super) theta_m: S,
    pub(super) theta_2: S,
    pub(super) cos_1: S,
    /// Where the shear starts, its sine, and the radius of shear over that of the arc: theta_1 and 1 without lugs.
    pub(super) theta_s: S,
    pub(super) sin_s: S,
    pub(super) shear_radius: S,
    /// The most shear stress over the soil's strength.
    pub(super) grip: S,
    /// How round the shear meets it, see [`Surface::rounding`], and the grip to the power of one over that.
    pub(super) rounding: S,
    grip_power: S,
    radius: S,
    modulus: S,
    exponent: S,
    cohesion: S,
    tan_phi: S,
    /// r/K.
    pub(super) shear_rate: S,
}

/// Integrals over theta of the stresses, and of the shear's slope in V/(r omega).
pub(super) struct Sums<S> {
    pub sigma_cos: S,
    pub sigma_sin: S,
    pub tau_cos: S,
    pub tau_sin: S,
    pub tau: S,
    pub slope_cos: S,
    pub slope_sin: S,
    pub slope: S,
}

#[lanes]
impl<S: Scalar> Sums<S> {
    pub fn zero() -> Self {
        let o = S::from(0.0);
        Self { sigma_cos: o, sigma_sin: o, tau_cos: o, tau_sin: o, tau: o, slope_cos: o, slope_sin: o, slope: o }
    }

    /// Takes the sums of `other` over where the mask says so.
    pub fn take(&mut self, mask: S::Mask, other: &Self) {
        for (mine, other) in self.all().into_iter().zip(other.values()) {
            *mine = S::select(mask, other, *mine);
        }
    }

    /// Adds the sums of `other` where the mask says so.
    pub fn add(&mut self, mask: S::Mask, other: &Self) {
        for (mine, other) in self.all().into_iter().zip(other.values()) {
            *mine = S::select(mask, *mine + other, *mine);
        }
    }

    pub fn values(&self) -> [S; 8] {
        let Self { sigma_cos, sigma_sin, tau_cos, tau_sin, tau, slope_cos, slope_sin, slope } = *self;
        [sigma_cos, sigma_sin, tau_cos, tau_sin, tau, slope_cos, slope_sin, slope]
    }

    pub fn all(&mut self) -> [&mut S; 8] {
        let Self { sigma_cos, sigma_sin, tau_cos, tau_sin, tau, slope_cos, slope_sin, slope } = self;
        [sigma_cos, sigma_sin, tau_cos, tau_sin, tau, slope_cos, slope_sin, slope]
    }
}

#[lanes]
impl<S: Scalar> Rim<S> {
    pub fn new(
        wheel: &Wheel<S>,
        soil: &Soil<S>,
        surface: &Surface<S>,
        sinkage: S,
        shear: Shear<S>,
        established: S,
    ) -> Self {
        let (radius, exit_ratio) = (wheel.radius * surface.arc, surface.exit_ratio);
        let depth = sinkage / radius;
        // A wheel sunk to its axle is an event; the clamp only keeps the formula finite until then.
        let theta_1 = (S::from(1.0) - depth.smaller(S::from(1.5))).arc_cosine();
        let exits = exit_ratio.over(0.0);
        let theta_2 = if exits.any() {
            let exit = -(S::from(1.0) - (exit_ratio * depth).smaller(S::from(1.5))).arc_cosine();
            S::select(exits, exit, S::from(0.0))
        } else {
            S::from(0.0)
        };
        let plain = surface.shear_radius.is_exactly(1.0) && surface.grip.is_exactly(1.0);
        let shear = match shear {
            Shear::Ratio(ratio) if !plain => Shear::OnSurface(ratio),
            shear => shear,
        };
        let slip_size = match shear {
            Shear::Ratio(ratio) | Shear::OnSurface(ratio) => {
                let drives = ratio.at_most(S::from(1.0));
                S::from(1.0) - S::select(drives, ratio, S::select(drives, S::from(1.0), ratio).recip())
            }
            Shear::Full(_) => S::from(1.0),
        };
        let share = (soil.c1 + soil.c2 * slip_size * established).larger(S::from(0.05)).smaller(S::from(0.95));
        let (sin_1, cos_1) = theta_1.sine_cosine();
        let (theta_s, sin_s) = if surface.shear_radius.is_exactly(1.0) {
            (theta_1, sin_1)
        } else {
            let theta_s = (cos_1 / surface.shear_radius).arc_cosine();
            (theta_s, theta_s.sine_cosine().0)
        };
        let (sin_phi, cos_phi) = soil.friction_angle.sine_cosine();
        Self {
            shear,
            theta_1,
            theta_m: share * theta_1,
            theta_2,
            cos_1,
            theta_s,
            sin_s,
            shear_radius: surface.shear_radius,
            grip: surface.grip,
            rounding: surface.rounding,
            grip_power: if surface.rounding.is_exactly(0.0) {
                S::from(1.0)
            } else {
                surface.grip.power(surface.rounding.larger(S::from(LEAST_ROUNDING)).recip())
            },
            radius,
            modulus: soil.modulus(wheel.width),
            exponent: soil.exponent,
            cohesion: soil.cohesion * surface.cohesion_gain,
            tan_phi: sin_phi / cos_phi * surface.friction_gain,
            shear_rate: radius / soil.shear_modulus,
        }
    }

    /// Adds the points of both zones at `s`, with the quadrature's weight in s.
    pub fn add(&self, sums: &mut Sums<S>, s: f64, weight: f64) {
        let s2 = s * s;
        let (front, rear) = (self.theta_1 - self.theta_m, self.theta_m - self.theta_2);
        let (at_front, load) = self.load(S::from(s2), front);
        self.point(sums, at_front, load, front * (2.0 * s * weight));
        let theta = self.theta_2 + rear * s2; // (2.6): the same s, so the same sigma
        let (sin, cos) = theta.sine_cosine();
        self.point(sums, (theta, sin, cos), load, rear * (2.0 * s * weight));
    }

    /// Adds the point of one zone at `s`, the front one where `in_front` says so.
    pub fn add_in(&self, sums: &mut Sums<S>, in_front: S::Mask, s: S::Plain, weight: S::Plain) {
        let s2 = S::from_plain(s * s);
        let (front, rear) = (self.theta_1 - self.theta_m, self.theta_m - self.theta_2);
        let (mut at, load) = self.load(s2, front);
        if !in_front.all() {
            let theta = self.theta_2 + rear * s2; // (2.6)
            let (sin, cos) = theta.sine_cosine();
            let choose = |front: S, rear: S| S::select(in_front, front, rear);
            at = (choose(at.0, theta), choose(at.1, sin), choose(at.2, cos));
        }
        self.point(sums, at, load, S::select(in_front, front, rear) * S::from_plain(s * weight * 2.0));
    }

    /// The point of the front zone at s^2 with its sine and cosine; normal stress and strength there.
    fn load(&self, s2: S, front: S) -> ((S, S, S), (S, S)) {
        let theta = self.theta_1 - front * s2;
        let (sin, cos) = theta.sine_cosine();
        let depth = (self.radius * (cos - self.cos_1)).larger(S::from(0.0));
        let sigma = self.modulus * depth.power(self.exponent); // (2.5)
        ((theta, sin, cos), (sigma, self.cohesion + sigma * self.tan_phi)) // (2.1)
    }

    /// Adds one point of the rim with the weight `d_theta`.
    fn point(&self, sums: &mut Sums<S>, (theta, sin, cos): (S, S, S), (sigma, strength): (S, S), d_theta: S) {
        let (tau, slope) = match self.shear {
            Shear::Ratio(ratio) => {
                // j/r = theta_1 - theta - V/(r omega) (sin theta_1 - sin theta)
                let lift = self.sin_s - sin;
                let j = self.theta_1 - theta - ratio * lift;
                let decay = (-(j.abs() * self.shear_rate)).exponential();
                let size = strength * (S::from(1.0) - decay);
                (size.negative_where(j.under(0.0)), -(strength * decay * self.shear_rate * lift))
            }
            Shear::OnSurface(ratio) => self.on_surface(ratio, theta, sin, strength),
            Shear::Full(sign) => (strength * self.grip * sign, S::from(0.0)),
        };
        let (sigma, tau, slope) = (sigma * d_theta, tau * d_theta, slope * d_theta);
        sums.sigma_cos += sigma * cos;
        sums.sigma_sin += sigma * sin;
        sums.tau_cos += tau * cos;
        sums.tau_sin += tau * sin;
        sums.tau += tau;
        sums.slope_cos += slope * cos;
        sums.slope_sin += slope * sin;
        sums.slope += slope;
    }

    /// Shear stress and its slope with lugs or a limited grip.
    fn on_surface(&self, ratio: S, theta: S, sin: S, strength: S) -> (S, S) {
        // j/r = (r_s/r)(theta_s - theta) - V/(r omega) (sin theta_s - sin theta)
        let lift = self.sin_s - sin;
        let j = self.shear_radius * (self.theta_s - theta) - ratio * lift;
        let decay = (-(j.abs() * self.shear_rate)).exponential();
        let built_up = S::from(1.0) - decay;
        if !self.rounding.is_exactly(0.0) {
            let (mut share, mut by_built_up) = self.rounded(built_up);
            let sharp = self.rounding.at_most(S::from(0.0));
            if S::Plain::LANES > 1 && sharp.any() {
                let slips = self.grip.below(built_up);
                let by_sharp = S::select(slips, S::from(0.0), S::from(1.0));
                share = S::select(sharp, S::select(slips, self.grip, built_up), share);
                by_built_up = S::select(sharp, by_sharp, by_built_up);
            }
            let slope = -(strength * by_built_up * decay * self.shear_rate * lift);
            return ((strength * share).negative_where(j.under(0.0)), slope);
        }
        let slips = self.grip.below(built_up);
        let size = strength * S::select(slips, self.grip, built_up);
        let slope = S::select(slips, S::from(0.0), -(strength * decay * self.shear_rate * lift));
        (size.negative_where(j.under(0.0)), slope)
    }

    /// Share of the strength that a rim transmits where the soil has built `b` of it up, and its slope in b: a blend of b
    /// and the grip g as of two asymptotes (Churchill and Usagi 1972), with the term that makes it g at b = 1. Powers are
    /// taken of ratios of at most 1, so that none overflows.
    fn rounded(&self, b: S) -> (S, S) {
        let (one, g) = (S::from(1.0), self.grip);
        let w = self.rounding.larger(S::from(LEAST_ROUNDING));
        let sticks = b.at_most(g);
        let ratio = S::select(sticks, b / g, g / b).power(w.recip());
        // Of b where the soil sticks, of g where it slips.
        let whole = self.grip_power * S::select(sticks, ratio, one);
        let sum = one + ratio - whole;
        let blend = sum.power(-w);
        let share = S::select(sticks, b, g) * blend;
        // d/db b D^-w = D^(-w - 1); beyond the corner D is `sum` over `ratio`.
        let slope = blend / sum * S::select(sticks, one, ratio * (g / b));
        (share, slope)
    }
}
