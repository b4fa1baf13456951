//! The torque that a load demands of a soil of given strength, whatever its modulus.
//!
//! At a given sinkage and slip the shear displacement of (2.2) depends on no soil parameter but K, so the integrals
//! (2.7) and (2.9) are the sum of a part proportional to c and a part proportional to the modulus:
//! N = c N_c + k N_s(phi) and T = c T_c + k T_s(phi). The load fixes k, and
//!
//! ```text
//! T = c T_c + (W - c N_c) T_s/N_s.
//! ```
//!
//! With linear stresses this is the thesis's (2.24); here it is exact for (2.1)-(2.9). The exponent n and the place
//! theta_m of the peak are taken from the nominal soil.

use super::super::EstimationError;
use super::reading::{Deviations, Reading, StrengthParameters};
use crate::contact::rolling;
use crate::scalar::{Dual, Scalar};
use crate::soil::Soil;
use crate::wheel::Wheel;

/// Modulus at which the part of the pressure is taken, N/m^(n+2): any, since that part is proportional to it.
const REFERENCE_MODULUS: f64 = 1e6;

/// Friction angles between which the equation is evaluated, rad; an estimate passes them on its way only.
const FRICTION_ANGLES: (f64, f64) = (0.01, 1.3);

/// Torque that a reading should show, and how it changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Torque, N m.
    pub torque: f64,
    /// Its slopes in c (Pa), phi (rad) and ln K.
    pub by_strength: [f64; 3],
    /// Its slopes in load (N), sinkage (m) and slip.
    pub by_input: [f64; 3],
}

impl Prediction {
    /// Variance of measured minus predicted torque from the reading's errors, (N m)^2.
    #[must_use]
    pub fn variance(&self, deviations: &Deviations) -> f64 {
        let [load, sinkage, slip] = self.by_input;
        let parts = [deviations.torque, load * deviations.load, sinkage * deviations.sinkage, slip * deviations.slip];
        parts.iter().map(|part| part * part).sum()
    }
}

/// The torque's equation about present guesses of the strength and of what load, sinkage and slip really are.
///
/// The errors of a reading's inputs are no small ones where the torque is curved (slip), so the equation is taken at the
/// inputs that the torque itself makes likely, not at the measured ones; otherwise noise makes slopes and weights go
/// with the error and biases the strength.
pub(super) struct Linearised {
    pub prediction: Prediction,
    /// Measured torque less the predicted one at the guessed strength, inputs accounted for to first order.
    pub innovation: f64,
    /// Variance of that innovation, (N m)^2.
    pub variance: f64,
}

impl Linearised {
    pub fn new(
        wheel: &Wheel,
        soil: &Soil,
        at: [f64; 3],
        guess: &Reading,
        measured: &Reading,
        errors: &Deviations,
    ) -> Self {
        let prediction = predict_at(wheel, soil, at, guess);
        let [load, sinkage, slip] = prediction.by_input;
        let shift = load * (measured.load - guess.load)
            + sinkage * (measured.sinkage - guess.sinkage)
            + slip * (measured.slip - guess.slip);
        let innovation = measured.torque - prediction.torque - shift;
        Self { prediction, innovation, variance: prediction.variance(errors) }
    }

    /// The inputs that an innovation, in units of its variance, makes likely.
    pub fn likely(&self, wheel: &Wheel, measured: &Reading, errors: &Deviations, innovation: f64) -> Reading {
        let [load, sinkage, slip] = self.prediction.by_input;
        let moved = |x: f64, slope: f64, deviation: f64| x + deviation * deviation * slope * innovation;
        let Reading { load: w, sinkage: z, slip: i, .. } = *measured;
        Reading {
            load: moved(w, load, errors.load).clamp(0.2 * w, 5.0 * w),
            torque: measured.torque,
            sinkage: moved(z, sinkage, errors.sinkage).clamp(0.2 * z, (5.0 * z).min(0.99 * wheel.radius).max(z)),
            slip: moved(i, slip, errors.slip).clamp(0.2 * i, 1.0),
        }
    }
}

/// Parts of load and torque at a sinkage and a slip.
struct Parts<S> {
    /// Load and torque of cohesion alone.
    cohesive: [S; 2],
    /// Torque over load of pressure and friction.
    frictional: S,
}

fn parts<S: Scalar>(wheel: &Wheel, soil: &Soil, strength: [S; 3], sinkage: S, slip: S) -> Parts<S> {
    let wheel = wheel.map(&|x| S::from(x));
    let bare = Soil { k_c: 0.0, k_phi: 0.0, cohesion: 0.0, friction_angle: 0.0, ..*soil }.map(&|x| S::from(x));
    let zero = S::from(0.0);
    let (spin, shear_modulus) = (wheel.radius.recip(), strength[2].exp());
    let velocity = -slip + 1.0; // r omega = 1 m/s
    let at = |soil: &Soil<S>| rolling(&wheel, soil, zero, sinkage, velocity, spin);
    let cohesive = at(&Soil { cohesion: strength[0], shear_modulus, ..bare });
    let pressed = at(&Soil { k_phi: S::from(REFERENCE_MODULUS), friction_angle: strength[1], shear_modulus, ..bare });
    Parts { cohesive: [cohesive.normal, cohesive.torque], frictional: pressed.torque / pressed.normal }
}

fn torque<S: Scalar>(wheel: &Wheel, soil: &Soil, strength: [S; 3], [load, sinkage, slip]: [S; 3]) -> S {
    let Parts { cohesive: [n_c, t_c], frictional } = parts(wheel, soil, strength, sinkage, slip);
    t_c + (load - n_c) * frictional
}

/// The torque that `reading` should show on a soil of this strength, with exact slopes. Of `soil` the exponent and
/// c1, c2 are used.
#[must_use]
pub fn predict(wheel: &Wheel, soil: &Soil, strength: &StrengthParameters, reading: &Reading) -> Prediction {
    predict_at(wheel, soil, strength.coordinates(), reading)
}

pub(super) fn predict_at(wheel: &Wheel, soil: &Soil, at: [f64; 3], reading: &Reading) -> Prediction {
    // Six are used. The diagnosis has numbers with eight derivatives too, and each width is one more copy of the physics to compile.
    let variable = |x: f64, k: usize| Dual::<8>::from(x).derivative(k);
    let phi = at[1].clamp(FRICTION_ANGLES.0, FRICTION_ANGLES.1);
    let strength = [variable(at[0], 0), variable(phi, 1), variable(at[2], 2)];
    let inputs = [variable(reading.load, 3), variable(reading.sinkage, 4), variable(reading.slip, 5)];
    let torque = torque(wheel, soil, strength, inputs);
    let slope = |k: usize| torque.eps.0.map_or(0.0, |all| all[k]);
    Prediction {
        torque: torque.re,
        by_strength: [slope(0), slope(1), slope(2)],
        by_input: [slope(3), slope(4), slope(5)],
    }
}

/// Friction angle (rad) from one reading with c (Pa) and K (of `soil`) known: (2.24) with the full integrals, by
/// Newton's method on the torque.
///
/// # Errors
/// [`EstimationError`] where the reading makes no sense, or no angle in 0.6..74 degrees gives its torque.
pub fn friction_angle_at(wheel: &Wheel, soil: &Soil, reading: &Reading, cohesion: f64) -> Result<f64, EstimationError> {
    /// Steps of Newton's method; 4 to 6 are needed.
    const STEPS: usize = 30;
    reading.check(wheel)?;
    let fixed = Dual::<1>::from;
    let inputs = [fixed(reading.load), fixed(reading.sinkage), fixed(reading.slip)];
    let mut phi = soil.friction_angle.clamp(0.2, 0.9);
    for _ in 0..STEPS {
        let strength = [fixed(cohesion), fixed(phi).derivative(0), fixed(soil.shear_modulus.ln())];
        let torque = torque(wheel, soil, strength, inputs);
        let slope = torque.eps.0.map_or(0.0, |all| all[0]);
        let step = (reading.torque - torque.re) / slope;
        let next = (phi + step).clamp(FRICTION_ANGLES.0, FRICTION_ANGLES.1);
        if !next.is_finite() || (next == phi && step.abs() > 1e-12) {
            break;
        }
        let done = (next - phi).abs() < 1e-13;
        phi = next;
        if done {
            return Ok(phi);
        }
    }
    Err(EstimationError::Undetermined { what: "friction angle" })
}
