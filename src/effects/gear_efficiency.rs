//! Efficiency of the gear.

use super::coulomb_friction::REVERSAL_SPEED;
use super::torque_scale::BACK_DRIVEN;
use super::{Effect, Facts};
use crate::motor::Geared;
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

/// Torque over which the loss builds up around zero torque, N m on the wheel's side: 0.1 % of usual torques.
const REVERSAL_TORQUE: f64 = 0.001;

parameters! {
    /// The gear takes a share of the power that passes it: T_out = eta T_in where the motor drives,
    /// T_in / eta where the wheel drives the motor back.
    pub struct GearEfficiency {
        /// Efficiency eta, the same in both directions; 1 is no loss.
        eta: [Unit::ONE] = 1.0, 0.4..=1.0, Effect, "planetary gears of two to four stages, makers' data: 0.6-0.85";
    }
}

/// The gear at one wheel speed, smooth in speed and torque.
///
/// With a = ln(eta) s, where s = omega/sqrt(omega^2 + epsilon^2) is the smooth direction, torque before and behind
/// the gear lie on a hyperbola with slopes eta^s and eta^-s and slope 1 at the origin: a hyperbolic turn by a of
/// (T, sqrt(T^2 + tau^2)) about a centre tau sinh(a/2). So it has a closed inverse and never gives power away.
struct Curve<S> {
    cosh: S,
    sinh: S,
    /// tau sinh(a/2), and its derivative in a.
    offset: S,
    offset_slope: S,
    /// Derivative of a in the speed.
    by_speed: S,
}

#[lanes]
impl<S: Scalar> Curve<S> {
    fn new(eta: S, speed: S) -> Self {
        let norm = (speed * speed + REVERSAL_SPEED * REVERSAL_SPEED).sqrt();
        let loss = eta.ln();
        let a = loss * speed / norm;
        let (half_sinh, half_cosh) = ((a * 0.5).sinh(), (a * 0.5).cosh());
        Self {
            cosh: a.cosh(),
            sinh: a.sinh(),
            offset: half_sinh * REVERSAL_TORQUE,
            offset_slope: half_cosh * (0.5 * REVERSAL_TORQUE),
            by_speed: loss * (REVERSAL_SPEED * REVERSAL_SPEED) / (norm * norm * norm),
        }
    }

    fn root(shifted: S) -> S {
        (shifted * shifted + REVERSAL_TORQUE * REVERSAL_TORQUE).sqrt()
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for GearEfficiency<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["torque"],
            seen_on_rover: &["wheel[1].torque"],
            advice: BACK_DRIVEN,
            ..Facts::USUAL
        }
    }

    fn gear(&self, speed: S, torque: S) -> Option<Geared<S>> {
        if self.eta.is_exactly(1.0) {
            return None;
        }
        let curve = Curve::new(self.eta, speed);
        let shifted = torque - curve.offset;
        let root = Curve::root(shifted);
        let by_torque = curve.cosh + curve.sinh * shifted / root;
        let by_a = curve.sinh * shifted + curve.cosh * root - (by_torque + 1.0) * curve.offset_slope;
        Some(Geared {
            torque: curve.cosh * shifted + curve.sinh * root - curve.offset,
            by_torque,
            by_speed: by_a * curve.by_speed,
        })
    }

    /// The exact inverse of [`gear`](Effect::gear).
    fn gear_input(&self, speed: S, torque: S) -> Option<S> {
        if self.eta.is_exactly(1.0) {
            return None;
        }
        let curve = Curve::new(self.eta, speed);
        let shifted = torque + curve.offset;
        Some(curve.cosh * shifted - curve.sinh * Curve::root(shifted) + curve.offset)
    }
}
