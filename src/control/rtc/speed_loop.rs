//! A speed loop around one wheel of rough-terrain control: it trims the torque only where the wheel's speed leaves a
//! band around the wanted one.

use super::RoughTerrainControl;
use crate::snapshot::Moving;

/// A wheel that carries is told from one in the air by its torque; between once and this many times the least
/// torque on the ground nothing changes.
const HYSTERESIS: f64 = 2.0;

/// Speeds of one wheel, as angular speeds of a wheel that rolls, rad/s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Speeds {
    /// Wanted.
    pub wanted: f64,
    /// Measured at the encoder.
    pub wheel: f64,
    /// The body's measured speed.
    pub body: f64,
}

/// One wheel's loop.
///
/// A torque-commanded wheel has no speed of its own: where the soil cannot answer the torque it runs away, digs, and
/// wastes its power. Within the band around v_desired / r the optimised torque stands untouched. Above it a
/// proportional and integral law takes torque away, below it adds some (override control with conditional
/// integration, so that the integral returns to zero by itself and the band is left and entered without a jump).
///
/// A wheel that runs above its band, and faster than the body by as much, on less torque than the least load on the
/// ground could answer, r N_min tan phi, is off the ground: it gets no torque but its loop's, which keeps it near the
/// speed of the ground, and the other wheels share the whole. Once that takes twice this torque it carries again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Moving)]
pub struct SpeedLoop {
    /// Integral part, N m.
    integral: f64,
    lifted: bool,
}

impl SpeedLoop {
    /// Whether the wheel is off the ground.
    #[must_use]
    pub fn lifted(&self) -> bool {
        self.lifted
    }

    /// Torque for the next period of `period` s, N m: `torque` as optimised, trimmed so that the wheel's speed stays by
    /// the wanted one. `touch` is the least torque on the ground and `limit` that of the drive, N m.
    pub(super) fn torque(
        &mut self,
        gains: &RoughTerrainControl,
        period: f64,
        speeds: &Speeds,
        torque: f64,
        touch: f64,
        limit: f64,
    ) -> f64 {
        let Speeds { wanted, wheel, body } = *speeds;
        let room = gains.speed_band * wanted.abs();
        // Over zero where the wheel is too slow for the band, under zero where it is too fast.
        let (slow, fast) = (wanted - room - wheel, wanted + room - wheel);
        let error = if slow > 0.0 { slow } else { fast.min(0.0) };
        let step = gains.speed_ki * period;
        self.integral = if self.integral < 0.0 {
            (self.integral + step * fast).min(0.0)
        } else if self.integral > 0.0 {
            (self.integral + step * slow).max(0.0)
        } else {
            step * error
        };
        self.integral = self.integral.clamp(-2.0 * limit, 2.0 * limit);
        let given = (torque + gains.speed_kp * error + self.integral).clamp(-limit, limit);
        let runs_away = wheel.abs() > wanted.abs() + room && wheel.abs() > body.abs() + room;
        let was_lifted = self.lifted;
        self.lifted = if was_lifted { given.abs() < HYSTERESIS * touch } else { runs_away && given.abs() < touch };
        if self.lifted && !was_lifted {
            // It was there against a torque that the wheel does not get any more.
            self.integral = 0.0;
        }
        given
    }
}
