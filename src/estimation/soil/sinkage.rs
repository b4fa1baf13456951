//! Sinkage of a driven wheel from its load, where nothing measures it.

use crate::contact::rolling;
use crate::control::rtc::sinkage;
use crate::soil::Soil;
use crate::wheel::Wheel;

/// Steps; N grows as z^(n + 1/2) nearly, so that each one removes most of the error.
const STEPS: usize = 6;

/// Share of the sinkage by which it may still move when the search ends.
const SETTLED: f64 = 1e-6;

/// Sinkage (m) at which a wheel that turns with `slip` (0..1) carries `load` (N) on `soil`, moduli included: from
/// Bekker's relation (4.18), refined on the full normal force (2.7) by z -> z (W/N)^(1/(n + 1/2)). `None` where the
/// wheel would sink to its axle.
#[must_use]
pub fn sinkage_under_load(wheel: &Wheel, soil: &Soil, load: f64, slip: f64) -> Option<f64> {
    let mut z = sinkage(soil, wheel, load);
    for _ in 0..STEPS {
        let carried = rolling(wheel, soil, 0.0, z, 1.0 - slip, 1.0 / wheel.radius).normal;
        let next = z * (load / carried).powf(1.0 / (soil.exponent + 0.5));
        if !(next > 0.0 && next < wheel.radius) {
            return None;
        }
        let moved = (next - z).abs();
        z = next;
        if moved <= SETTLED * z {
            break;
        }
    }
    Some(z)
}
