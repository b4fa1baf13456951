//! A wheel as a disc over the ground: the rim's point that is nearest, and the contact there.

use crate::map::Surface;
use crate::robot::{Frames, LinkIndex, RobotWheel};
use nalgebra::Vector3;

/// The rim is looked at from here to there, from straight down in the wheel's plane, rad: to a little over the axle, so that a
/// wall before the wheel counts.
const REACH: f64 = 1.7;

/// Places of the rim that are looked at first: 9 degrees apart, 1 cm on a wheel of 6.4 cm.
const COARSE: usize = 21;

/// Steps of the golden section, after which the rim's point is known to 2e-5 rad, and the distance to 1e-11 of the radius where
/// the ground is smooth.
const GOLDEN: usize = 20;

/// How a wheel hangs over the ground.
#[derive(Clone, Copy, Debug)]
pub struct Hang {
    /// Link that carries the wheel.
    pub link: Option<LinkIndex>,
    /// Wheel's centre, m.
    pub centre: Vector3<f64>,
    /// Point of the rim with the smallest vertical distance, m.
    pub rim: Vector3<f64>,
    /// Axle, to the left.
    pub axle: Vector3<f64>,
    /// That distance, m; negative inside the ground.
    pub gap: f64,
    /// Slopes of the ground below that point, in x and y.
    pub slope: [f64; 2],
}

/// Contact of a wheel with the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Contact point p, m.
    pub point: Vector3<f64>,
    /// Normal, out of the ground.
    pub normal: Vector3<f64>,
    /// Tangent in the wheel's plane, forward: the direction of traction.
    pub forward: Vector3<f64>,
    /// Tangent across the wheel, to the left.
    pub left: Vector3<f64>,
}

impl Contact {
    /// Slope of the ground in the wheel's plane, uphill positive, rad.
    #[must_use]
    pub fn angle(&self) -> f64 {
        self.forward.z.clamp(-1.0, 1.0).asin()
    }
}

/// Where and how near a wheel of `radius` is to the ground, which is raised by `shift` (m). The error is a place of unknown ground.
///
/// The wheel is a disc without width (appendix A: contact at a point), so that it bridges what is narrower than itself along its
/// path: the distance is continuous whatever the map.
pub fn hang(
    surface: &Surface,
    frames: &Frames,
    wheel: &RobotWheel,
    radius: f64,
    shift: f64,
) -> Result<Hang, Vector3<f64>> {
    let centre = frames.point(wheel.link, wheel.centre);
    let forward = frames.direction(wheel.link, Vector3::x());
    let up = frames.direction(wheel.link, Vector3::z());
    // Angle from straight down in the wheel's plane, forward positive, so that the scan looks at the same part of the rim whatever
    // the joint's angle.
    let down = (-forward.z).atan2(up.z);
    let rim = |angle: f64| centre + radius * ((down + angle).sin() * forward - (down + angle).cos() * up);
    let gap = |angle: f64| {
        let at = rim(angle);
        surface.height([at.x, at.y]).map(|ground| at.z - ground - shift).ok_or(at)
    };
    let step = 2.0 * REACH / (COARSE - 1) as f64;
    let mut best = (f64::INFINITY, 0.0);
    for k in 0..COARSE {
        let angle = k as f64 * step - REACH;
        let here = gap(angle)?;
        if here < best.0 {
            best = (here, angle);
        }
    }
    let angle = golden(&gap, best.1 - step, best.1 + step)?;
    let point = rim(angle);
    let patch = surface.at([point.x, point.y]).ok_or(point)?;
    let axle = frames.direction(wheel.link, Vector3::y());
    let slope = [patch.slope_x, patch.slope_y];
    Ok(Hang { link: wheel.link, centre, rim: point, axle, gap: point.z - patch.height - shift, slope })
}

/// Place of the smallest value between `low` and `high`.
fn golden(f: &impl Fn(f64) -> Result<f64, Vector3<f64>>, low: f64, high: f64) -> Result<f64, Vector3<f64>> {
    let share = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (low, high);
    let (mut a, mut b) = (high - share * (high - low), low + share * (high - low));
    let (mut fa, mut fb) = (f(a)?, f(b)?);
    for _ in 0..GOLDEN {
        if fa < fb {
            (high, b, fb) = (b, a, fa);
            a = high - share * (high - low);
            fa = f(a)?;
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + share * (high - low);
            fb = f(b)?;
        }
    }
    Ok(if fa < fb { a } else { b })
}

impl Hang {
    /// The contact of a wheel that touches; `None` where the wheel's plane lies in the ground's.
    ///
    /// In the wheel's plane the normal points from the rim's point to the axle, which holds on a crease too, where the ground has
    /// no slope of its own; across that plane it is the ground's.
    pub(super) fn contact(&self) -> Option<Contact> {
        let inward = (self.centre - self.rim).normalize();
        let forward = self.axle.cross(&inward).try_normalize(f64::EPSILON)?;
        let ground = Vector3::new(-self.slope[0], -self.slope[1], 1.0);
        let left = ground.cross(&forward).try_normalize(f64::EPSILON)?;
        Some(Contact { point: self.rim, normal: forward.cross(&left), forward, left })
    }

    /// How the distance changes with a motion of the rim's point.
    pub(super) fn rate(&self, motion: &Vector3<f64>) -> f64 {
        motion.z - self.slope[0] * motion.x - self.slope[1] * motion.y
    }
}
