//! Stresses along the rim in contact with the soil (2.1)-(2.6).
//!
//! Angles are measured at the wheel centre from the ground's normal, forward positive. Both zones are
//! run through with s in 0..1: theta = theta_1 - (theta_1 - theta_m) s^2 in front and
//! theta = theta_2 + (theta_m - theta_2) s^2 behind. The square removes the root-like start of the stress
//! at both ends for n < 1. Since (2.6) maps the rear zone onto the front one, the normal stress is the
//! same function of s in both and is computed once.

use super::surface::Surface;
use crate::scalar::Scalar;
use crate::soil::Soil;
use crate::wheel::Wheel;

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

impl<S: Scalar> Sums<S> {
    pub fn zero() -> Self {
        let o = S::from(0.0);
        Self { sigma_cos: o, sigma_sin: o, tau_cos: o, tau_sin: o, tau: o, slope_cos: o, slope_sin: o, slope: o }
    }
}

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
        let theta_1 = (S::from(1.0) - depth.smaller(S::from(1.5))).acos();
        let theta_2 = if exit_ratio.value() > 0.0 {
            -(S::from(1.0) - (exit_ratio * depth).smaller(S::from(1.5))).acos()
        } else {
            S::from(0.0)
        };
        let plain = surface.shear_radius.is_exactly(1.0) && surface.grip.is_exactly(1.0);
        let shear = match shear {
            Shear::Ratio(ratio) if !plain => Shear::OnSurface(ratio),
            shear => shear,
        };
        let slip_size = match shear {
            Shear::Ratio(ratio) | Shear::OnSurface(ratio) if ratio.value() <= 1.0 => S::from(1.0) - ratio,
            Shear::Ratio(ratio) | Shear::OnSurface(ratio) => S::from(1.0) - ratio.recip(),
            Shear::Full(_) => S::from(1.0),
        };
        let share = (soil.c1 + soil.c2 * slip_size * established).larger(S::from(0.05)).smaller(S::from(0.95));
        let (sin_1, cos_1) = theta_1.sin_cos();
        let (theta_s, sin_s) = if surface.shear_radius.is_exactly(1.0) {
            (theta_1, sin_1)
        } else {
            let theta_s = (cos_1 / surface.shear_radius).acos();
            (theta_s, theta_s.sin())
        };
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
            radius,
            modulus: soil.modulus(wheel.width),
            exponent: soil.exponent,
            cohesion: soil.cohesion * surface.cohesion_gain,
            tan_phi: soil.friction_angle.tan() * surface.friction_gain,
            shear_rate: radius / soil.shear_modulus,
        }
    }

    /// Adds the points of both zones at `s`, with their quadrature weights in s.
    #[inline]
    pub fn add(&self, sums: &mut Sums<S>, s: f64, front_weight: f64, rear_weight: f64) {
        let s2 = s * s;
        let front = self.theta_1 - self.theta_m;
        let theta = self.theta_1 - front * s2;
        let (sin, cos) = theta.sin_cos();
        let depth = (self.radius * (cos - self.cos_1)).larger(S::from(0.0));
        let sigma = self.modulus * depth.power(self.exponent); // (2.5)
        let strength = self.cohesion + sigma * self.tan_phi; // (2.1)
        if front_weight > 0.0 {
            self.point(sums, (theta, sin, cos), (sigma, strength), front * (2.0 * s * front_weight));
        }
        if rear_weight > 0.0 {
            let rear = self.theta_m - self.theta_2;
            let theta = self.theta_2 + rear * s2; // (2.6): the same s, so the same sigma
            let (sin, cos) = theta.sin_cos();
            self.point(sums, (theta, sin, cos), (sigma, strength), rear * (2.0 * s * rear_weight));
        }
    }

    /// Adds one point of the rim with the weight `d_theta`.
    #[inline]
    fn point(&self, sums: &mut Sums<S>, (theta, sin, cos): (S, S, S), (sigma, strength): (S, S), d_theta: S) {
        let (tau, slope) = match self.shear {
            Shear::Ratio(ratio) => {
                // j/r = theta_1 - theta - V/(r omega) (sin theta_1 - sin theta)
                let lift = self.sin_s - sin;
                let j = self.theta_1 - theta - ratio * lift;
                let decay = (-(j.abs() * self.shear_rate)).exp();
                let size = strength * (S::from(1.0) - decay);
                let tau = if j.value() < 0.0 { -size } else { size };
                (tau, -(strength * decay * self.shear_rate * lift))
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
    #[inline(never)]
    fn on_surface(&self, ratio: S, theta: S, sin: S, strength: S) -> (S, S) {
        // j/r = (r_s/r)(theta_s - theta) - V/(r omega) (sin theta_s - sin theta)
        let lift = self.sin_s - sin;
        let j = self.shear_radius * (self.theta_s - theta) - ratio * lift;
        let decay = (-(j.abs() * self.shear_rate)).exp();
        let built_up = S::from(1.0) - decay;
        let (size, slope) = if built_up.value() > self.grip.value() {
            (strength * self.grip, S::from(0.0))
        } else {
            (strength * built_up, -(strength * decay * self.shear_rate * lift))
        };
        (if j.value() < 0.0 { -size } else { size }, slope)
    }
}
