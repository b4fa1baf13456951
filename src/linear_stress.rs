//! The thesis's closed forms for linear stresses (2.10)-(2.24), (B.1)-(B.7).
//!
//! Along the rim of a driven wheel both stresses are taken as triangles over 0..theta_1 with their peaks at
//! theta_m, and the exponent of the shear curve as linear in theta (2.20), so that the integrals of (2.7)-(2.9)
//! have closed forms. They are a named alternative to the full integrals of [`contact`](crate::contact), exact for the linear
//! stresses and approximate for the soil. The printed equations contain errors; here they are corrected (E with
//! f at theta = 0 and divided as a whole; the first term of (B.2); the prefactor of (B.4)).
//!
//! Measured against the full integrals on 15,000 draws over the thesis's own ranges (2.3.1: n 0.2..1.5, theta_1
//! 25..55 deg, phi 20..32 deg, r/K from 3 to 150, slip 0..1) with theta_m = (0.200 + 0.309 i) theta_1, which h_1
//! and h_3 silently contain, and its bevameter sand's cohesion; `tests/linear_stress_error.rs` computes them:
//!
//! | | mean | largest |
//! |---|---|---|
//! | normal stress curve (2.10), (2.11), of its peak | 13.6 % | 38 % |
//! | shear stress curve (2.12), (2.13), of its peak | 11.0 % | 36 % |
//! | load W by (B.5) | 18.9 % | 43 % |
//! | torque T by (B.7) | 23.4 % | 48 % |
//! | drawbar pull DP by (B.6), of W | 3.2 % | 14.5 % |
//! | phi by (2.24) with c known and no noise | +1.83 deg | 6.2 deg |
//!
//! (The thesis states 9.6 % and 10.4 % for the curves.) The groups h of (B.5)-(B.7) differ from the exact (B.1)-(B.4)
//! by up to 2.1 % of W in W, 6 % in DP and 6.3 % in T/r there, without cohesion.
//! The bias of phi is a property of the approximation, not of the soil.

use crate::contact::Forces;
use crate::scalar::Scalar;
use crate::soil::Soil;
use crate::wheel::Wheel;

/// What is known of a driven wheel in the soil without knowing the soil's strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenWheel<S = f64> {
    radius: S,
    width: S,
    shear_modulus: S,
    theta_1: S,
    slip: S,
}

/// A driven wheel with linear stresses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearStress<S = f64> {
    wheel: DrivenWheel<S>,
    theta_m: S,
    sigma_m: S,
    cohesion: S,
    tan_phi: S,
}

/// The equation that one measurement gives for the strength (2.24): tan phi = (h_1 h_6 - c h_0 h_1)/(h_8 - c h_9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrengthEquation<S = f64> {
    /// h_0.
    pub h_0: S,
    /// h_1.
    pub h_1: S,
    /// h_6, Pa.
    pub h_6: S,
    /// h_8, Pa.
    pub h_8: S,
    /// h_9.
    pub h_9: S,
}

impl<S: Scalar> StrengthEquation<S> {
    /// tan phi at a known cohesion (Pa).
    pub fn tan_phi(&self, cohesion: S) -> S {
        let Self { h_0, h_1, h_6, h_8, h_9 } = *self;
        (h_1 * h_6 - cohesion * h_0 * h_1) / (h_8 - cohesion * h_9) // (2.24)
    }
}

/// The groups h_0..h_4 of (B.5)-(B.7).
struct Groups<S> {
    h_0: S,
    h_1: S,
    h_2: S,
    h_3: S,
    h_4: S,
}

/// Why the closed forms do not apply.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{quantity} = {value} {unit}; the closed forms for linear stresses expect {expected}")]
pub struct OutsideClosedForms {
    quantity: &'static str,
    value: f64,
    unit: &'static str,
    expected: &'static str,
}

fn require(
    holds: bool,
    (quantity, value, unit): (&'static str, f64, &'static str),
    expected: &'static str,
) -> Result<(), OutsideClosedForms> {
    if holds { Ok(()) } else { Err(OutsideClosedForms { quantity, value, unit, expected }) }
}

impl<S: Scalar> DrivenWheel<S> {
    /// A wheel that has sunk in by `sinkage` (m) and drives with `slip`, on soil of the given shear modulus K (m).
    ///
    /// # Errors
    /// [`OutsideClosedForms`] unless 0 < sinkage < r, 0 <= slip <= 1 and K > 0: the forms are for driving forward.
    pub fn new(wheel: &Wheel<S>, shear_modulus: S, sinkage: S, slip: S) -> Result<Self, OutsideClosedForms> {
        let (z, i, k) = (sinkage.value(), slip.value(), shear_modulus.value());
        require(z > 0.0 && z < wheel.radius.value(), ("sinkage", z, "m"), "more than 0 and less than the radius")?;
        require((0.0..=1.0).contains(&i), ("slip", i, ""), "0 .. 1")?;
        require(k > 0.0, ("shear modulus K", k, "m"), "more than 0")?;
        let theta_1 = (-sinkage / wheel.radius + 1.0).acos();
        Ok(Self { radius: wheel.radius, width: wheel.width, shear_modulus, theta_1, slip })
    }

    /// Entry angle theta_1, rad.
    pub fn theta_1(&self) -> S {
        self.theta_1
    }

    /// f of (2.20) at theta = 0, the exponent of the shear curve at the bottom of the wheel.
    pub fn exponent(&self) -> S {
        let cos_1 = self.theta_1.cos();
        self.radius * self.theta_1 / (self.shear_modulus * 2.0) * (-cos_1 + 1.0 + self.slip * (cos_1 + 1.0))
    }

    /// tan phi from the load (N), the torque (N m) and a known cohesion (Pa) by (2.24).
    ///
    /// Biased by +1.8 degrees on average (see the module); exact for (B.5) and (B.7).
    pub fn tan_phi(&self, load: S, torque: S, cohesion: S) -> S {
        self.strength_equation(load, torque).tan_phi(cohesion)
    }

    /// The equation (2.24) of the strength that follows from the load (N) and the torque (N m).
    pub fn strength_equation(&self, load: S, torque: S) -> StrengthEquation<S> {
        let Groups { h_0, h_1, h_2, h_3, h_4 } = self.groups();
        let theta_1_2 = self.theta_1 * self.theta_1;
        let h_5 = h_4 + 0.5;
        let h_6 = torque / (self.radius * self.radius * self.width * self.theta_1);
        let h_7 = load / (self.radius * self.width);
        let h_8 = h_5 * h_7 - h_6 * (h_3 + h_2 * theta_1_2);
        let h_9 = theta_1_2 * h_0 * h_5 / 3.0 - h_0 * (h_3 + h_2 * theta_1_2);
        StrengthEquation { h_0, h_1, h_6, h_8, h_9 }
    }

    fn groups(&self) -> Groups<S> {
        let Self { theta_1, slip: i, .. } = *self;
        let f = self.exponent();
        let e = (-f).exp_m1() / f; // E = -(1 - e^-f)/f (corrected)
        let theta_1_2 = theta_1 * theta_1;
        let slip_6 = i / 6.0 + 1.0;
        Groups {
            h_0: e + 1.0,
            h_1: theta_1 / 2.0 - theta_1 * theta_1_2 / 20.0 * (i / 2.0 + 1.0),
            h_2: e / 6.0 * slip_6 * slip_6,
            h_3: theta_1_2 / 5.0 * (-theta_1_2 / 20.0 + 1.0) * (i / 4.0 + 1.0),
            h_4: e / 2.0 * (-i / 10.0 + 1.0),
        }
    }
}

impl<S: Scalar> LinearStress<S> {
    /// Linear stresses with a peak normal stress `sigma_m` (Pa) at `theta_m` (rad) and the strength of `soil`.
    ///
    /// # Errors
    /// [`OutsideClosedForms`] unless 0 < theta_m < theta_1.
    pub fn new(wheel: DrivenWheel<S>, theta_m: S, sigma_m: S, soil: &Soil<S>) -> Result<Self, OutsideClosedForms> {
        let (peak, entry) = (theta_m.value(), wheel.theta_1.value());
        require(peak > 0.0 && peak < entry, ("theta_m", peak, "rad"), "more than 0 and less than theta_1")?;
        Ok(Self { wheel, theta_m, sigma_m, cohesion: soil.cohesion, tan_phi: soil.friction_angle.tan() })
    }

    /// Linear stresses of a wheel in `soil`: theta_m = (c1 + c2 i) theta_1, within 0.05 .. 0.95 theta_1, and
    /// sigma_m by Bekker's curve at the depth r (cos theta_m - cos theta_1) (2.5).
    ///
    /// # Errors
    /// As [`DrivenWheel::new`].
    pub fn of_soil(wheel: &Wheel<S>, soil: &Soil<S>, sinkage: S, slip: S) -> Result<Self, OutsideClosedForms> {
        let driven = DrivenWheel::new(wheel, soil.shear_modulus, sinkage, slip)?;
        let share = (soil.c1 + soil.c2 * slip).larger(S::from(0.05)).smaller(S::from(0.95));
        let theta_m = share * driven.theta_1;
        let depth = wheel.radius * (theta_m.cos() - driven.theta_1.cos()); // (2.4)
        Self::new(driven, theta_m, soil.pressure(depth, wheel.width), soil)
    }

    /// The wheel.
    pub fn wheel(&self) -> &DrivenWheel<S> {
        &self.wheel
    }

    /// Angle of the peaks theta_m, rad.
    pub fn theta_m(&self) -> S {
        self.theta_m
    }

    /// Peak normal stress sigma_m, Pa.
    pub fn sigma_m(&self) -> S {
        self.sigma_m
    }

    /// Normal stress at `theta` (rad) in 0..theta_1, Pa (2.10), (2.11).
    pub fn sigma(&self, theta: S) -> S {
        self.sigma_m * self.triangle(theta)
    }

    /// Shear stress at `theta` (rad) by the linear normal stress and the linear exponent (2.20), Pa.
    pub fn tau(&self, theta: S) -> S {
        let f = self.wheel.exponent() * (-theta / self.wheel.theta_1 + 1.0);
        -(self.cohesion + self.sigma(theta) * self.tan_phi) * (-f).exp_m1()
    }

    /// Shear stress at `theta` (rad) as a triangle with its peak tau_m, Pa (2.12), (2.13).
    pub fn triangular_tau(&self, theta: S) -> S {
        self.tau_m() * self.triangle(theta)
    }

    fn triangle(&self, theta: S) -> S {
        let (theta_1, theta_m) = (self.wheel.theta_1, self.theta_m);
        if theta < theta_m { theta / theta_m } else { (theta_1 - theta) / (theta_1 - theta_m) }
    }

    /// Shear stress at theta_m, Pa (2.19).
    pub fn tau_m(&self) -> S {
        let DrivenWheel { radius, shear_modulus, theta_1, slip, .. } = self.wheel;
        let j = radius * (theta_1 - self.theta_m - (-slip + 1.0) * (theta_1.sin() - self.theta_m.sin()));
        -(self.cohesion + self.sigma_m * self.tan_phi) * (-j / shear_modulus).exp_m1()
    }

    /// Forces with both stresses triangular: W (2.17), DP (2.15), T (2.18).
    pub fn triangular(&self) -> Forces<S> {
        let DrivenWheel { radius, width, theta_1, .. } = self.wheel;
        let (p, q) = self.moments();
        let tau_m = self.tau_m();
        Forces {
            normal: radius * width * (self.sigma_m * p + tau_m * q),
            drawbar: radius * width * (tau_m * p - self.sigma_m * q),
            torque: radius * radius * width * tau_m * theta_1 / 2.0,
        }
    }

    /// Integrals over 0..theta_1 of the unit triangle times cos theta and times sin theta.
    fn moments(&self) -> (S, S) {
        let (theta_1, theta_m) = (self.wheel.theta_1, self.theta_m);
        let ((sin_1, cos_1), (sin_m, cos_m)) = (theta_1.sin_cos(), theta_m.sin_cos());
        let area = (theta_m * (theta_1 - theta_m)).recip();
        let cosine = area * (theta_1 * cos_m - theta_m * cos_1 - theta_1 + theta_m);
        (cosine, area * (theta_1 * sin_m - theta_m * sin_1))
    }

    /// Forces with a linear normal stress and the linear exponent: W (B.1), DP = H - R (B.2), (B.3), T (B.4).
    pub fn forces(&self) -> Forces<S> {
        let DrivenWheel { radius, width, .. } = self.wheel;
        Forces {
            normal: radius * width * self.load(),
            drawbar: radius * width * (self.thrust() - self.resistance()),
            torque: radius * radius * width * self.twist(),
        }
    }

    /// e^-f and e^(-f (1 - theta_m/theta_1)): decay of the shear curve at theta = 0 and at theta_m.
    fn decays(&self) -> (S, S) {
        let f = self.wheel.exponent();
        ((-f).exp(), (-f * (-self.theta_m / self.wheel.theta_1 + 1.0)).exp())
    }

    /// W/(r b) (B.1), Pa.
    fn load(&self) -> S {
        let (theta_1, theta_m, friction) = (self.wheel.theta_1, self.theta_m, self.sigma_m * self.tan_phi);
        let ((sin_1, cos_1), (sin_m, cos_m)) = (theta_1.sin_cos(), theta_m.sin_cos());
        let g = self.wheel.exponent() / theta_1;
        let g_2 = g * g;
        let (p, q) = self.moments();
        let (at_0, at_m) = self.decays();
        let cohesive = -(g_2 * cos_1 + g * sin_1 + at_0) / (g_2 + 1.0) + 1.0;
        let sines = theta_m * sin_1 - theta_1 * sin_m * at_m;
        let cosines = theta_m * cos_1 - theta_1 * cos_m * at_m + at_0 * (theta_1 - theta_m);
        let mobilised =
            (g * 2.0 * cosines - (g_2 - 1.0) * sines) / (theta_m * (theta_1 - theta_m) * (g_2 + 1.0) * (g_2 + 1.0));
        self.cohesion * cohesive + self.sigma_m * p + friction * (q + mobilised)
    }

    /// H/(r b) (B.2, first term corrected), Pa.
    fn thrust(&self) -> S {
        let (theta_1, theta_m, friction) = (self.wheel.theta_1, self.theta_m, self.sigma_m * self.tan_phi);
        let ((sin_1, cos_1), (sin_m, cos_m)) = (theta_1.sin_cos(), theta_m.sin_cos());
        let g = self.wheel.exponent() / theta_1;
        let g_2 = g * g;
        let (p, _) = self.moments();
        let (at_0, at_m) = self.decays();
        let cohesive = g / (g_2 + 1.0) * (g * sin_1 - cos_1 + at_0);
        let sines = theta_m * sin_1 - theta_1 * sin_m * at_m;
        let cosines = theta_m * cos_1 - theta_1 * cos_m * at_m + at_0 * (theta_1 - theta_m);
        let mobilised =
            (g * 2.0 * sines + (g_2 - 1.0) * cosines) / (theta_m * (theta_1 - theta_m) * (g_2 + 1.0) * (g_2 + 1.0));
        self.cohesion * cohesive + friction * (p - mobilised)
    }

    /// R/(r b) (B.3), Pa.
    fn resistance(&self) -> S {
        self.sigma_m * self.moments().1
    }

    /// T/(r^2 b) (B.4, prefactor corrected), Pa. With a = theta_m/theta_1 and e^-x = 1 - x + x^2/2 - x^3 rest(x) its
    /// terms become f/2 - f^2 rest(f) and f (rest(f) - (1 - a)^2 rest(f (1 - a)))/a, which lose no digits at small f.
    fn twist(&self) -> S {
        let theta_1 = self.wheel.theta_1;
        let f = self.wheel.exponent();
        let a = self.theta_m / theta_1;
        let behind = -a + 1.0;
        let cohesive = f * (-f * decay_rest(f) + 0.5);
        let frictional = f * (decay_rest(f) - behind * behind * decay_rest(f * behind)) / a;
        theta_1 * (self.cohesion * cohesive + self.sigma_m * self.tan_phi * frictional)
    }

    /// Forces by the simplified groups h_0..h_4: W (B.5), DP (B.6), T (B.7).
    pub fn simplified(&self) -> Forces<S> {
        let DrivenWheel { radius, width, theta_1, .. } = self.wheel;
        let Groups { h_0, h_1, h_2, h_3, h_4 } = self.wheel.groups();
        let (c, sigma_m, friction) = (self.cohesion, self.sigma_m, self.sigma_m * self.tan_phi);
        let (sin_1, theta_1_2) = (theta_1.sin(), theta_1 * theta_1);
        let area = radius * width;
        Forces {
            normal: area * (c * h_0 * theta_1_2 / 3.0 + h_1 * sigma_m + friction * (h_3 + h_2 * theta_1_2)), // (B.5)
            drawbar: area * (c * h_0 * sin_1 + friction * (h_1 + h_4 * sin_1) - h_3 * sigma_m),              // (B.6)
            torque: radius * area * theta_1 * (c * h_0 + friction * (h_4 + 0.5)),                            // (B.7)
        }
    }
}

/// (1 - x + x^2/2 - e^-x)/x^3, by its series where the difference would lose digits.
fn decay_rest<S: Scalar>(x: S) -> S {
    if x.value().abs() > 0.5 {
        return (x * (x / 2.0 - 1.0) - (-x).exp_m1()) / (x * x * x);
    }
    // 1/3! - x/4! + x^2/5! - ..; the terms up to x^13 leave 1e-18 at 0.5.
    let brackets = (4..17).rev().fold(S::from(1.0), |inner, k| -x * inner / f64::from(k) + 1.0);
    brackets / 6.0
}
