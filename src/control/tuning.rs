//! Gains of velocity control that follow from the plant.

use super::error::{ControlError, within_bounds};
use super::{Nominal, VelocityControl};
use crate::contact::rolling;
use bekker_modeldescription::{Unit, parameters};

/// Least damping ratio of the sampled loop, on soil as well as off the ground.
const DAMPING: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Proportional gains that are tried, of J / period: above it a wheel off the ground overcorrects a speed error.
const SHARES: usize = 100;
/// Halvings of the interval in which the largest integral gain lies.
const HALVINGS: usize = 60;
/// Step in the wheel's speed over which the soil's slope is taken, of that speed.
const SPEED_STEP: f64 = 1e-3;

parameters! {
    /// Velocity control of each wheel by itself whose gains follow from the plant.
    pub struct TunedVelocity {
        /// Speed for which the gains are found: the soil's slope dT/domega is steepest where a wheel is slow.
        speed: [Unit::METRE_PER_SECOND] = 0.25, 0.01..=10.0, Fixed, "the desired speed of Iagnemma 2001, 4.4.1";
        /// Control period, over which the torque is held.
        period: [Unit::SECOND] = 0.01, 1e-4..=1.0, Fixed, "assumption: 100 Hz, as velocity control";
    }
}

/// Slope dT/domega of the soil's moment on a wheel that carries an even share of the weight and rolls without slip
/// at `speed` (m/s), by the full stress integrals, N m s/rad.
#[must_use]
pub fn soil_slope(nominal: &Nominal, speed: f64) -> f64 {
    let (wheel, soil, share) = (&nominal.wheel, &nominal.soil, nominal.weight() / nominal.wheels() as f64);
    let rate = speed / wheel.radius;
    let (mut low, mut high) = (0.0, 0.99 * wheel.radius);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if rolling(wheel, soil, 0.0, middle, speed, rate).normal < share { low = middle } else { high = middle }
    }
    let moment = |rate: f64| rolling(wheel, soil, 0.0, high, speed, rate).torque;
    (moment(rate * (1.0 + SPEED_STEP)) - moment(rate * (1.0 - SPEED_STEP))) / (2.0 * SPEED_STEP * rate)
}

impl TunedVelocity {
    /// The gains: of all proportional and integral gains whose sampled loop has a damping ratio of 0.71 or more both
    /// off the ground (the wheel's inertia alone) and on the steepest soil (that of [`soil_slope`]), those with the
    /// largest integral gain. A load that steps up by dT leaves an integrated speed error of dT / k_i behind, so that
    /// they are the best against changes of the ground (the criterion of Astrom and Hagglund).
    ///
    /// # Errors
    /// [`ControlError`] where the rover or a parameter makes no sense.
    pub fn gains(self, nominal: &Nominal) -> Result<VelocityControl, ControlError> {
        nominal.check()?;
        within_bounds("velocity_tuned", self)?;
        let inertia = nominal.wheel.inertia;
        let slope = soil_slope(nominal, self.speed);
        let damped = |kp: f64, ki: f64| {
            [0.0, slope].into_iter().all(|slope| damping(inertia, slope, self.period, kp, ki) >= DAMPING)
        };
        let mut best = VelocityControl { kp: 0.0, ki: 0.0, kd: 0.0, derivative_filter: 0.0, period: self.period };
        for share in 1..=SHARES {
            let kp = share as f64 / SHARES as f64 * inertia / self.period;
            let (mut low, mut high) = (0.0, kp / self.period);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if damped(kp, middle) { low = middle } else { high = middle }
            }
            if low > best.ki {
                (best.kp, best.ki) = (kp, low);
            }
        }
        Ok(best)
    }
}

/// Least damping ratio of the loop's poles in the time of the control period, for the plant
/// J domega/dt = tau - a omega with the torque held over a `period`: z^2 + p z + q = 0.
fn damping(inertia: f64, slope: f64, period: f64, kp: f64, ki: f64) -> f64 {
    let decay = (-slope * period / inertia).exp();
    let gain = if slope > 0.0 { (1.0 - decay) / slope } else { period / inertia };
    let p = gain * (kp + ki * period) - 1.0 - decay;
    let q = decay - gain * kp;
    let discriminant = 0.25 * p * p - q;
    // A pole is exp(s h): its damping is that of s.
    let of_pole = |size: f64, angle: f64| {
        let decay = -size.ln();
        if decay.is_infinite() { 1.0 } else { decay / decay.hypot(angle) }
    };
    if discriminant < 0.0 {
        return of_pole(q.sqrt(), (-discriminant).sqrt().atan2(-0.5 * p));
    }
    let poles = [-0.5 * p + discriminant.sqrt(), -0.5 * p - discriminant.sqrt()];
    let of_real = |z: f64| of_pole(z.abs(), if z < 0.0 { std::f64::consts::PI } else { 0.0 });
    poles.into_iter().map(of_real).fold(f64::INFINITY, f64::min)
}
