//! The contact foot: the point of the profile nearest to a wheel's centre.
//!
//! A stationary point of the distance solves g(x) = x - x_c + (h - z_c) h' = 0. The circle of radius d about the
//! centre bends upwards by at least 1/d along its lower arc. Where the profile under it bends less, h'' < 1/d
//! over x_c - d .. x_c + d, profile minus arc is concave, so a point where they touch is the only nearest one and
//! Newton's method from x_c finds it. Elsewhere (a narrow ditch, sharp waves) branch and bound over that interval
//! finds the nearest of several. For a centre below the ground the same holds upside down (`side` is -1).

use super::TerrainError;
use super::curve::{Curve, Sample};
use super::lanes::LaneTerrains;
use crate::scalar::{Mask, Plain, Scalar, lanes};

/// Point of the profile nearest to a wheel's centre, and the frame there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot<S = f64> {
    /// The point [x, z], m.
    pub position: [S; 2],
    /// Contact angle gamma: slope of the profile, uphill positive, rad.
    pub angle: S,
    /// Unit tangent, pointing towards +x.
    pub tangent: [S; 2],
    /// Unit normal, pointing up.
    pub normal: [S; 2],
    /// Distance of the centre from the foot along the normal, m; negative when the centre is below the ground.
    pub distance: S,
}

/// A wheel's centre further than this from the ground, m, is an error: no wheel is larger (its radius is at most 2 m).
const FAR: f64 = 20.0;
/// Newton steps of the fast path; beyond them the slower search is used.
const NEWTON_STEPS: usize = 12;
/// A Newton step below this part of the clearance is the last: the error after it is of the order of its square.
const LAST_STEP: f64 = 1e-8;
/// Cells narrower than this part of the clearance are not cut again (the circle osculates the profile there).
const NARROW: f64 = 1e-6;
/// A cell is dismissed only when it is further away than rounding can explain.
const ROUNDING: f64 = 1e-12;
/// Steps inside a bracket; bisection alone would need 60.
const BISECTIONS: usize = 80;
/// The derivative of the foot is unbounded where the circle osculates the profile; 1/g' is limited to 1e6 there.
const OSCULATING: f64 = 1e-6;

/// g and g' at a point of the profile.
#[lanes]
fn stationarity<S: Scalar>(sample: &Sample<S>, x: S, [centre_x, centre_z]: [S; 2]) -> (S, S) {
    let gap = centre_z - sample.height;
    let g = x - centre_x - gap * sample.slope;
    (g, sample.slope * sample.slope - gap * sample.curvature + 1.0)
}

/// The foot below `centre` on `curve`; `plain` is the same curve in plain numbers.
///
/// # Errors
/// [`TerrainError::NotFinite`] and [`TerrainError::TooFar`].
pub(super) fn foot<S: Scalar>(
    curve: &impl Curve<S>,
    plain: &impl Curve<f64>,
    centre: [S; 2],
) -> Result<Foot<S>, TerrainError> {
    let (x, sample) = nearest(plain, centre.map(|c| c.value()))?;
    if S::NDERIV == 0 {
        let [height, slope, curvature] = [sample.height, sample.slope, sample.curvature].map(S::from);
        return Ok(frame(S::from(x), &Sample { height, slope, curvature }, centre));
    }
    // One Newton step in S at the root carries the exact first derivatives (implicit function theorem).
    let root = S::from(x);
    let (g, dg) = stationarity(&curve.at(root), root, centre);
    let x = root - g / dg.larger(S::from(OSCULATING));
    Ok(frame(x, &curve.at(x), centre))
}

/// The foot on a plane through the origin with the inclination `angle`, in closed form.
///
/// # Errors
/// As [`foot`].
#[lanes]
pub(super) fn on_plane<S: Scalar>(angle: S, centre: [S; 2]) -> Result<Foot<S>, TerrainError> {
    let (sin, cos) = angle.sine_cosine();
    let [x, z] = centre;
    let distance = z * cos - x * sin;
    if !distance.abs().at_most(S::from(FAR)).all() {
        let [x, z] = [x.value(), z.value()];
        if !(x.is_finite() && z.is_finite()) {
            return Err(TerrainError::NotFinite { x, z });
        }
        return Err(TerrainError::TooFar { x, clearance: distance.value() / cos.value(), limit: FAR });
    }
    let along = x * cos + z * sin;
    Ok(Foot { position: [along * cos, along * sin], angle, tangent: [cos, sin], normal: [-sin, cos], distance })
}

/// The frame at a point of the profile, seen from `centre`.
#[lanes]
pub(super) fn frame<S: Scalar>(x: S, sample: &Sample<S>, centre: [S; 2]) -> Foot<S> {
    let cos = (sample.slope * sample.slope + 1.0).sqrt().recip();
    let sin = sample.slope * cos;
    let distance = (centre[1] - sample.height) * cos - (centre[0] - x) * sin;
    Foot {
        position: [x, sample.height],
        angle: sample.slope.arc_tangent(),
        tangent: [cos, sin],
        normal: [-sin, cos],
        distance,
    }
}

fn nearest(curve: &impl Curve<f64>, centre: [f64; 2]) -> Result<(f64, Sample<f64>), TerrainError> {
    let [x, z] = centre;
    if !(x.is_finite() && z.is_finite()) {
        return Err(TerrainError::NotFinite { x, z });
    }
    let below = curve.at(x);
    let clearance = z - below.height;
    // False for NaN too.
    let within = clearance.abs() <= FAR;
    if !within {
        return Err(TerrainError::TooFar { x, clearance, limit: FAR });
    }
    let side = if clearance < 0.0 { -1.0 } else { 1.0 };
    let (foot, sample, arrived) = newton(curve, centre, below, true);
    let newton = arrived.then_some((foot, sample));
    if let Some((foot, sample)) = newton {
        let reach = length(foot - x, z - sample.height);
        let same_side = (z - sample.height) * clearance >= 0.0;
        let unique = |bend: f64| bend * reach < 1.0;
        if same_side && (unique(curve.bend_anywhere(side)) || unique(curve.bend(side, x - reach, x + reach, &below))) {
            return Ok((foot, sample));
        }
    }
    let mut search = Search { curve, centre, side, reach: clearance.abs(), best: None };
    if let Some((foot, sample)) = newton {
        search.offer(foot, sample);
    }
    search.cell(x - search.reach, x + search.reach);
    // The nearest point is stationary and within reach; without one the centre lies on the profile.
    Ok(search.best.unwrap_or((x, below)))
}

/// Newton's method from below the centre, where the mask says so; also where it has arrived, within the interval that
/// holds the nearest point.
#[lanes]
fn newton<R: Plain>(curve: &impl Curve<R>, centre: [R; 2], below: Sample<R>, mask: R::Mask) -> (R, Sample<R>, R::Mask) {
    let clearance = (centre[1] - below.height).abs();
    let (mut x, mut sample) = (centre[0], below);
    let (mut active, mut arrived) = (mask, mask & !mask);
    for _ in 0..NEWTON_STEPS {
        let (g, dg) = stationarity(&sample, x, centre);
        let step = g / dg;
        let next = x - step;
        active = active & dg.over(0.0) & (next - centre[0]).abs().at_most(clearance);
        x = R::select(active, next, x);
        sample = curve.at(x);
        let last = active & step.abs().at_most(clearance * LAST_STEP);
        arrived = arrived | last;
        active = active & !last;
        if !active.any() {
            break;
        }
    }
    (x, sample, arrived)
}

/// The feet below several centres, each on its own of `curves`: those whose profile bends little by Newton's method side by
/// side, the others by `one`.
///
/// # Errors
/// As [`foot`], of the first that has one.
#[lanes]
pub(super) fn side_by_side<R: Plain>(
    curves: &impl Curve<R>,
    one: impl Fn(usize) -> Result<Foot<f64>, TerrainError>,
    centre: [R; 2],
) -> Result<Foot<R>, TerrainError> {
    let below = curves.at(centre[0]);
    let clearance = centre[1] - below.height;
    let within = clearance.abs().at_most(R::from(FAR));
    let (x, sample, arrived) = newton(curves, centre, below, within);
    let (along, gap) = (x - centre[0], centre[1] - sample.height);
    let reach = (along * along + gap * gap).sqrt();
    let most = curves.most_bend(centre[0], reach);
    let found = arrived & R::from(0.0).at_most(gap * clearance) & (most * reach).under(1.0);
    let mut feet = frame(x, &sample, centre);
    if !found.all() {
        put_each(&mut feet, !found, one)?;
    }
    Ok(feet)
}

/// Finds the feet of the mask one by one.
#[inline(never)]
pub(super) fn put_each<R: Plain>(
    feet: &mut Foot<R>,
    mask: R::Mask,
    one: impl Fn(usize) -> Result<Foot<f64>, TerrainError>,
) -> Result<(), TerrainError> {
    for k in (0..R::LANES).filter(|&k| mask.lane(k)) {
        let Foot { position, angle, tangent, normal, distance } = one(k)?;
        let pairs = [(&mut feet.position, position), (&mut feet.tangent, tangent), (&mut feet.normal, normal)];
        for (places, values) in pairs {
            places.iter_mut().zip(values).for_each(|(place, x)| put(place, k, x));
        }
        put(&mut feet.angle, k, angle);
        put(&mut feet.distance, k, distance);
    }
    Ok(())
}

/// Puts number `k` of those side by side.
fn put<R: Plain>(place: &mut R, k: usize, x: f64) {
    let old = *place;
    *place = R::from_lanes(|i| if i == k { x } else { old.lane(i) });
}

/// Branch and bound for the nearest of several stationary points.
struct Search<'a, C> {
    curve: &'a C,
    centre: [f64; 2],
    /// 1 for a centre above the ground, -1 below.
    side: f64,
    /// The nearest point is no further than this.
    reach: f64,
    best: Option<(f64, Sample<f64>)>,
}

#[lanes]
impl<R: Plain> Foot<R> {
    /// The same with constants of another scalar.
    fn constant<S: Scalar<Plain = R>>(self) -> Foot<S> {
        let pair = |[a, b]: [R; 2]| [S::from_plain(a), S::from_plain(b)];
        Foot {
            position: pair(self.position),
            angle: S::from_plain(self.angle),
            tangent: pair(self.tangent),
            normal: pair(self.normal),
            distance: S::from_plain(self.distance),
        }
    }
}

/// The foot below `centre` on a curve by formula, or the feet below several centres on several such curves.
///
/// # Errors
/// As [`foot`].
#[lanes]
pub(super) fn on_formula<S: Scalar, C: Curve<f64>>(
    curve: &impl Curve<S>,
    sides: &impl Curve<S::Plain>,
    plain: impl Fn(usize) -> C,
    centre: [S; 2],
) -> Result<Foot<S>, TerrainError> {
    if S::Plain::LANES == 1 {
        return foot(curve, &plain(0), centre);
    }
    let centres = [centre[0].plain(), centre[1].plain()];
    let one = |k: usize| {
        let curve = plain(k);
        foot(&curve, &curve, [centres[0].lane(k), centres[1].lane(k)])
    };
    Ok(side_by_side(sides, one, centres)?.constant())
}

/// The feet below several centres on several grounds.
///
/// # Errors
/// As [`foot`].
#[lanes]
pub(super) fn on_several<S: Scalar>(several: &LaneTerrains, centre: [S; 2]) -> Result<Foot<S>, TerrainError> {
    Ok(several.foot([centre[0].plain(), centre[1].plain()])?.constant())
}

impl<C: Curve<f64>> Search<'_, C> {
    fn distance(&self, x: f64, sample: &Sample<f64>) -> f64 {
        length(x - self.centre[0], sample.height - self.centre[1])
    }

    /// Takes a stationary point if it is nearer than the one at hand.
    fn offer(&mut self, x: f64, sample: Sample<f64>) {
        let distance = self.distance(x, &sample);
        if self.best.is_none_or(|(best, at)| distance < self.distance(best, &at)) {
            self.best = Some((x, sample));
            self.reach = self.reach.min(distance);
        }
    }

    /// Finds what is nearest within `from..to`, if it is nearer than `reach`.
    fn cell(&mut self, from: f64, to: f64) {
        let (from, to) = (from.max(self.centre[0] - self.reach), to.min(self.centre[0] + self.reach));
        if from >= to {
            return;
        }
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let sample = self.curve.at(middle);
        let bend = self.curve.bend(self.side, from, to, &sample);
        if self.stays_outside(bend, middle, half, &sample) {
            return;
        }
        self.reach = self.reach.min(self.distance(middle, &sample));
        // Bounds on the depth gap = z_c - h and, with those on h'', on g' = 1 + h'^2 - gap h'' over the cell: where
        // it cannot vanish there is at most one stationary point.
        let other = self.curve.bend(-self.side, from, to, &sample);
        let gap = self.side * (self.centre[1] - sample.height);
        let spread = half * (sample.slope.abs() + 0.5 * half * bend.abs().max(other.abs()));
        let monotone = bend * (gap + spread) < 1.0 && other * (spread - gap) < 1.0;
        let cut = self.curve.cut(from, to);
        if monotone || half <= NARROW * self.reach || !(cut > from && cut < to) {
            self.bracketed(from, to);
        } else {
            self.cell(from, cut);
            self.cell(cut, to);
        }
    }

    /// Whether the profile within `half` of `middle` stays outside the circle of radius `reach` about the centre.
    /// Its height over the arc, phi = h - a, has phi'' <= bend - 1/reach, since the arc bends by at least 1/reach.
    fn stays_outside(&self, bend: f64, middle: f64, half: f64, sample: &Sample<f64>) -> bool {
        let along = middle - self.centre[0];
        let arc = (self.reach * self.reach - along * along).max(0.0).sqrt();
        let phi = arc - self.side * (self.centre[1] - sample.height);
        let slope = self.side * sample.slope - along / arc;
        let second = bend - 1.0 / self.reach;
        let highest = if second < 0.0 { (-slope / second).clamp(-half, half) } else { half.copysign(slope) };
        phi + highest * (slope + 0.5 * second * highest) < -ROUNDING * self.reach
    }

    /// The minimum within `from..to` by Newton's method kept inside the bracket by bisection.
    fn bracketed(&mut self, mut from: f64, mut to: f64) {
        let g = |x: f64| stationarity(&self.curve.at(x), x, self.centre).0;
        if g(from) > 0.0 || g(to) < 0.0 {
            return;
        }
        let smallest = 2.0 * f64::EPSILON * (self.centre[0].abs() + self.reach);
        let mut x = 0.5 * (from + to);
        let mut sample = self.curve.at(x);
        for _ in 0..BISECTIONS {
            let (g, dg) = stationarity(&sample, x, self.centre);
            if g > 0.0 {
                to = x
            } else {
                from = x
            }
            let step = g / dg;
            if step.abs() <= smallest || to - from <= smallest {
                break;
            }
            let next = x - step;
            x = if next > from && next < to { next } else { 0.5 * (from + to) };
            sample = self.curve.at(x);
        }
        self.offer(x, sample);
    }
}

#[inline]
fn length(dx: f64, dz: f64) -> f64 {
    (dx * dx + dz * dz).sqrt()
}
