//! Warming of the motors' windings.

use super::{Advice, Effect, Facts};
use crate::motor::Motor;
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

/// Growth of copper's resistance, 1/K (IEC 60028: 0.00393 at 20 degrees Celsius).
const COPPER: f64 = 0.0039;
/// Fall of the torque constant, 1/K: the remanence of NdFeB magnets, makers' data 0.0009-0.0012 (ferrites: 0.002).
const MAGNET: f64 = 0.0011;
/// Rise beyond which the coefficients go no further, K: the insulation ends near 155 degrees Celsius.
const MOST_RISE: f64 = 200.0;

parameters! {
    /// R (1 + 0.0039 dT) and K_t (1 - 0.0011 dT), with dT' = (R_th R I^2 - dT)/time_constant for each motor.
    /// The drive corrects the torque constant, so current and power show the heat, torques do not.
    pub struct WindingHeat {
        /// Thermal resistance R_th from the winding to its surroundings; 0 is a winding that stays cold.
        thermal_resistance: [Unit::KELVIN_PER_WATT] = 0.0, 0.0..=30.0, Effect, "makers' data of 20 W motors: 3 K/W to the housing, 14 K/W more to the air";
        /// Time constant of the warming.
        time_constant: [Unit::SECOND] = 100.0, 1.0..=1e4, Fixed, "assumption between the winding (10-20 s) and the housing (600 s) of a 20 W motor";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for WindingHeat<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_rover: &["power"],
            advice: const {
                &[Advice::rover(
                    "let the loaded drive run for half an hour and record current and voltage: only heat changes with time",
                )]
            },
            ..Facts::USUAL
        }
    }

    fn motor(&self, winding_rise: S, motor: &mut Motor<S>) {
        if !self.thermal_resistance.is_exactly(0.0) {
            let rise = winding_rise.smaller(S::from(MOST_RISE));
            motor.resistance *= rise * COPPER + 1.0;
            motor.torque_constant *= S::from(1.0) - rise * MAGNET;
        }
    }

    fn warming(&self, power: S) -> Option<Warming<S>> {
        if self.thermal_resistance.is_exactly(0.0) {
            return None;
        }
        Some(Warming { end: self.thermal_resistance * power, time_constant: self.time_constant })
    }
}

/// How a winding warms: towards a rise `end`, with a time constant.
#[derive(Clone, Copy, Debug)]
pub struct Warming<S = f64> {
    /// Rise over its surroundings at which it would stay, K.
    pub end: S,
    /// Time constant, s.
    pub time_constant: S,
}

impl<S: Scalar> Warming<S> {
    /// Rate of the rise, K/s.
    pub(crate) fn rate(&self, rise: S) -> S {
        (self.end - rise) / self.time_constant
    }

    /// The rise after `h` seconds: exact where the law stays the same.
    pub(crate) fn after(&self, rise: S, h: f64) -> S {
        self.end + (rise - self.end) * (-(self.time_constant.recip() * h)).exp()
    }

    /// The law that took a rise from `before` to `after` in `h` seconds: at a power that stayed the same.
    pub(crate) fn between(self, before: S, after: S, h: f64) -> Self {
        let left = (-(self.time_constant.recip() * h)).exp();
        Self { end: (after - before * left) / (S::from(1.0) - left), ..self }
    }

    /// Two paths of heat at once: their rates add.
    pub(super) fn beside(self, other: Self) -> Self {
        let (rate, others) = (self.time_constant.recip(), other.time_constant.recip());
        let both = rate + others;
        Self { end: (self.end * rate + other.end * others) / both, time_constant: both.recip() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding: over a hundredth of the time constant a difference of 0.02 K is found to 1e-14 of the rise of 40 K, and goes on for a
    /// hundred times as long.
    const ROUNDING: f64 = 1e-9;

    #[test]
    fn analytic_a_law_is_found_from_two_rises_and_goes_on() {
        let law = Warming { end: 60.0, time_constant: 600.0 };
        let (before, h) = (35.0, 6.0);
        let after = law.after(before, h);
        let found = Warming { end: 0.0, ..law }.between(before, after, h);
        assert!((found.end - law.end).abs() < ROUNDING);
        assert!((found.after(after, 300.0) - law.after(before, h + 300.0)).abs() < ROUNDING);
    }
}
