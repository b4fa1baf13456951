//! What the ground under a wheel bears and costs, estimated from its load: sinkage, strength, resistance.
//!
//! The thesis's limit T^m = A (c + sigma_m tan phi) (4.15) takes the largest normal stress for the stress everywhere.
//! Mohr and Coulomb's strength summed over the patch, A c + N tan phi, needs the load alone (errata 12). Both are
//! linear in the load here, so that the constraint (4.16) stays linear: A sigma_m grows as z^(n + 1/2) with small
//! sinkage, and that is how the load grows in (4.18).
//!
//! Neither knows that shear has to be mobilised (2.1): where the patch is not much longer than K, no slip mobilises
//! it, and a controller that trusts the strength asks for torques that only spin the wheel. On the thesis's own soil,
//! K = 30 mm, this weighs more than the difference of the two (`tests/control/strength.rs` has figures).

use crate::soil::Soil;
use crate::wheel::Wheel;

/// Sinkage of a rigid wheel under a load N: z = [3 N / ((3 - n) b k sqrt(2 r))]^(2/(2n+1)) (4.18), m.
///
/// Bekker's estimate without slip; k = k_c/b + k_phi stands for the thesis's K_phi. It is kept at r at
/// most, the sinkage at which a wheel stands on its axle. `load` in N, at least 0.
#[must_use]
pub fn sinkage(soil: &Soil, wheel: &Wheel, load: f64) -> f64 {
    let n = soil.exponent;
    let (r, b) = (wheel.radius, wheel.width);
    let z = (3.0 * load / ((3.0 - n) * b * soil.modulus(b) * (2.0 * r).sqrt())).powf(2.0 / (2.0 * n + 1.0));
    z.min(r)
}

/// Area of contact A = b r theta_1 with the entry angle theta_1 = acos(1 - z/r) (errata 12), m^2.
#[must_use]
pub fn contact_area(soil: &Soil, wheel: &Wheel, load: f64) -> f64 {
    let z = sinkage(soil, wheel, load);
    wheel.width * wheel.radius * (1.0 - z / wheel.radius).acos()
}

/// Bekker's compaction resistance b k z^(n+1)/(n+1) at the sinkage (4.18), N: the work of pressing a rut
/// a metre long. It is not in the thesis's chapter 4, whose force distribution knows no resistance.
#[must_use]
pub fn compaction_resistance(soil: &Soil, wheel: &Wheel, load: f64) -> f64 {
    let z = sinkage(soil, wheel, load);
    wheel.width * soil.pressure(z, wheel.width) * z / (soil.exponent + 1.0)
}

/// Which estimate of the largest shear force the constraint (4.16) takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Strength {
    /// A c + N tan phi with the area of contact b r theta_1.
    #[default]
    MohrCoulomb,
    /// A (c + sigma_m tan phi) as printed (4.15), with the wheel's projected area b r sin theta_1.
    Thesis,
    /// (A c + N tan phi) times the share of it that a spinning wheel mobilises.
    Mobilised,
}

/// A wheel's largest shear force as a line over its load N: adhesion + friction N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShearLimit {
    /// Part that does not grow with the load, N.
    pub adhesion: f64,
    /// Part that does, of the load.
    pub friction: f64,
}

impl ShearLimit {
    /// The largest shear force under the load `load` (N), N.
    #[must_use]
    pub fn under(&self, load: f64) -> f64 {
        self.adhesion + self.friction * load
    }
}

impl Strength {
    /// The line of the share `usable` of the limit at the load `load` (N, over 0), at which its area and stress are
    /// taken.
    #[must_use]
    pub fn limit(self, soil: &Soil, wheel: &Wheel, load: f64, usable: f64) -> ShearLimit {
        let (area, stress) = match self {
            Self::MohrCoulomb => (contact_area(soil, wheel, load), 1.0),
            Self::Mobilised => {
                let (area, share) = (contact_area(soil, wheel, load), mobilised_share(soil, wheel, load));
                (share * area, share)
            }
            Self::Thesis => {
                let area = projected_area(soil, wheel, load);
                (area, area * largest_stress(soil, wheel, load) / load)
            }
        };
        // `stress`: of the mean normal stress, the load over the area.
        ShearLimit { adhesion: usable * area * soil.cohesion, friction: usable * soil.friction_angle.tan() * stress }
    }
}

/// Projected area of contact b r sin theta_1 (4.15), a function of the wheel's width and sinkage, m^2.
#[must_use]
pub fn projected_area(soil: &Soil, wheel: &Wheel, load: f64) -> f64 {
    let depth = sinkage(soil, wheel, load) / wheel.radius;
    wheel.width * wheel.radius * (depth * (2.0 - depth)).sqrt()
}

/// Largest normal stress sigma_m under a wheel without slip, at theta_m = c1 theta_1 (2.5), Pa.
#[must_use]
pub fn largest_stress(soil: &Soil, wheel: &Wheel, load: f64) -> f64 {
    let cos_entry = 1.0 - sinkage(soil, wheel, load) / wheel.radius;
    let theta_m = soil.c1.clamp(0.05, 0.95) * cos_entry.acos();
    soil.pressure(wheel.radius * (theta_m.cos() - cos_entry), wheel.width)
}

/// Share of the shear strength that a wheel spinning on the spot mobilises: the mean of 1 - exp(-j/K) (2.1) over the
/// patch, where j grows from 0 to its length L = r theta_1: 1 - (K/L)(1 - exp(-L/K)).
#[must_use]
pub fn mobilised_share(soil: &Soil, wheel: &Wheel, load: f64) -> f64 {
    let lengths = contact_area(soil, wheel, load) / wheel.width / soil.shear_modulus;
    1.0 + (-lengths).exp_m1() / lengths
}
