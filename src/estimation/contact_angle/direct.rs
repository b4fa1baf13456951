//! The direct solution (2.29)-(2.37) in its corrected general form.

use std::f64::consts::FRAC_PI_2;

/// Deviations by which a quantity has to stand out of its noise before anything is divided by it.
const SIGNIFICANT: f64 = 3.0;

/// Rounding: quantities under this share of the speeds are differences of equal numbers.
const ROUNDING: f64 = 1e-9;

/// Motion of two points at a fixed distance at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PairMotion {
    /// Inclination alpha of the line from the rear point 1 to the front point 2, nose up, rad.
    pub inclination: f64,
    /// Its rate alpha', rad/s.
    pub rate: f64,
    /// Speeds v_1, v_2 along the directions of travel, forward positive, m/s.
    pub speeds: [f64; 2],
}

/// Standard deviations of a [`PairMotion`], their errors taken as independent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PairNoise {
    /// Of the inclination, rad.
    pub inclination: f64,
    /// Of the rate, rad/s.
    pub rate: f64,
    /// Of either speed, m/s.
    pub speeds: [f64; 2],
}

/// Contact angles that follow from one reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectSolution {
    /// gamma_1, gamma_2: directions of travel of the rear and the front point, uphill positive, rad.
    pub angles: [f64; 2],
    /// Their standard deviations, rad: to first order, and to second order where that vanishes (rotation).
    pub deviations: [f64; 2],
    /// Whether both points travel across their line, cos(theta) = 0, so that the angles follow by inspection.
    pub rotation: bool,
}

/// Why a reading has no contact angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
pub enum IllConditioned {
    /// The points stand: any contact angles fit.
    #[error("both speeds are within their noise: a rover at rest has any contact angles")]
    Stationary,
    /// The line does not turn, at equal speeds: any common direction fits.
    #[error("the rate is within its noise: a translation has any common contact angle")]
    Translation,
    /// No directions fit, even within the noise: slip, or a wheel off the ground.
    #[error("no contact angles fit these speeds and this rate: |v1|, |v2| and l alpha' make no triangle")]
    Inconsistent,
}

/// Contact angles of two points `distance` (m) apart from their motion, with standard deviations from those of the
/// motion.
///
/// With w = l alpha', (2.29) and (2.30) say that v_1, v_2 and w are the sides of a triangle (figure 2.20), so
///
/// ```text
/// sin(alpha - gamma_1) = (v_1^2 + w^2 - v_2^2) / (2 v_1 w),   sin(gamma_2 - alpha) = (v_2^2 + w^2 - v_1^2) / (2 v_2 w)
/// ```
///
/// (2.34), (2.35) corrected: they hold for either sign of alpha', of the speeds and of gamma - alpha. Contact angles are
/// taken within 90 degrees of the line, so the speeds have the same sign. A wheel's slip i puts 1/(1 - i) into its
/// speed and, where all wheels slip alike, into neither ratio of the speeds but into w/v.
///
/// # Errors
/// [`IllConditioned`] where the reading does not determine the angles; an earlier estimate may then stand in (2.5).
pub fn direct(distance: f64, motion: &PairMotion, noise: &PairNoise) -> Result<DirectSolution, IllConditioned> {
    let [v1, v2] = motion.speeds;
    let w = distance * motion.rate;
    let fastest = v1.abs().max(v2.abs());
    let stands = |k: usize| motion.speeds[k].abs() <= SIGNIFICANT * noise.speeds[k];
    if fastest == 0.0 || (stands(0) && stands(1)) {
        return Err(IllConditioned::Stationary);
    }
    let rate_noise = distance * noise.rate;
    if w.abs() <= (SIGNIFICANT * rate_noise).max(ROUNDING * fastest) {
        return Err(IllConditioned::Translation);
    }
    if v1 == 0.0 || v2 == 0.0 {
        return Err(IllConditioned::Inconsistent);
    }
    let deviations = [noise.speeds[0], noise.speeds[1], rate_noise];
    let rear = Sine::of(v1, v2, w, deviations);
    let front = Sine::of(v2, v1, w, [deviations[1], deviations[0], deviations[2]]);
    let rotation = rear.across() && front.across();
    if !rotation && (!rear.solvable() || !front.solvable() || v1 * v2 < 0.0) {
        return Err(IllConditioned::Inconsistent);
    }
    let (beta, theta) = (rear.angle(rotation), front.angle(rotation));
    Ok(DirectSolution {
        angles: [motion.inclination - beta.0, motion.inclination + theta.0],
        deviations: [beta.1.hypot(noise.inclination * beta.2), theta.1.hypot(noise.inclination * theta.2)],
        rotation,
    })
}

/// Sine of the angle between a point's direction of travel and the line.
struct Sine {
    value: f64,
    deviation: f64,
}

impl Sine {
    /// (v^2 + w^2 - u^2)/(2 v w) with the deviations of v, u and w.
    fn of(v: f64, u: f64, w: f64, [of_v, of_u, of_w]: [f64; 3]) -> Self {
        let value = ((v - u) * (v + u) + w * w) / (2.0 * v * w);
        let by_v = 1.0 / w - value / v;
        let by_w = 1.0 / v - value / w;
        let by_u = -u / (v * w);
        let deviation = (by_v * of_v).hypot(by_u * of_u).hypot(by_w * of_w);
        Self { value, deviation: deviation + ROUNDING * (1.0 + (u / w).abs()) }
    }

    /// Whether the travel is across the line, as far as one can tell.
    fn across(&self) -> bool {
        (self.value.abs() - 1.0).abs() <= SIGNIFICANT * self.deviation && self.deviation < 0.5 / SIGNIFICANT
    }

    fn solvable(&self) -> bool {
        self.value.abs() <= 1.0
    }

    /// The angle, its deviation, and the factor on the inclination's own deviation.
    fn angle(&self, rotation: bool) -> (f64, f64, f64) {
        if rotation {
            // 1 - sin x is x^2/2 about the right angle.
            return (FRAC_PI_2.copysign(self.value), (2.0 * self.deviation).sqrt(), 1.0);
        }
        let cos = (1.0 - self.value * self.value).max(0.0).sqrt();
        // First order, but never more than what second order allows at a right angle.
        let deviation = (self.deviation / cos.max(f64::MIN_POSITIVE)).min((2.0 * self.deviation).sqrt());
        (self.value.asin(), deviation, 1.0)
    }
}
