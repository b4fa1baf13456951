//! What the ground under a wheel bears and costs, estimated from its load: sinkage, strength, resistance.

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
