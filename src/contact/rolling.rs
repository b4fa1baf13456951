//! Forces of a rolling, skidding or sliding rigid wheel on deformable soil: the full stress integrals.
//!
//! Bekker 1969; Wong and Reece 1967; Janosi and Hanamoto 1961; equations (2.1)-(2.9) of Iagnemma 2001.

use super::flattened::{Flattening, flattened};
use super::pieces::sums;
use super::rim::{Rim, Shear};
use super::surface::Surface;
use crate::scalar::{LaneAccess, Mask, Plain, Scalar, lanes, smooth_step, smooth_step_slope};
use crate::snapshot::Moving;
use crate::soil::Soil;
use crate::wheel::Wheel;

/// Where V and omega have opposite signs, the share |V|/(|V| + |r omega|) below which the contact turns
/// over from the side towards which the wheel spins to the side towards which it moves.
const TURN_OVER: f64 = 0.1;

/// V/(r omega) above which a rim counts as fully sliding.
const LOCKED_RATIO: f64 = 1e6;

/// Speed under which a wheel stands still for the purpose of its slip, m/s.
const STANDSTILL: f64 = 1e-6;

/// Forces of the soil on a wheel, at its centre.
#[derive(Clone, Copy, Debug, PartialEq, Moving, LaneAccess)]
pub struct Forces<S = f64> {
    /// Along the ground's normal, N (2.7).
    pub normal: S,
    /// Drawbar pull along the ground's tangent, N (2.8).
    pub drawbar: S,
    /// Moment that the drive must balance, N m (2.9).
    pub torque: S,
}

impl<S> AsMut<Self> for Forces<S> {
    fn as_mut(&mut self) -> &mut Self {
        self
    }
}

#[lanes]
impl<S: Scalar> Forces<S> {
    /// No force.
    #[must_use]
    pub fn zero() -> Self {
        Self::filled(S::from(0.0))
    }

    fn filled(value: S) -> Self {
        Self { normal: value, drawbar: value, torque: value }
    }

    pub(super) fn mirrored(self) -> Self {
        Self { normal: self.normal, drawbar: -self.drawbar, torque: -self.torque }
    }

    pub(super) fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Self {
            normal: S::select(mask, yes.normal, no.normal),
            drawbar: S::select(mask, yes.drawbar, no.drawbar),
            torque: S::select(mask, yes.torque, no.torque),
        }
    }

    pub(crate) fn scaled(self, factor: S) -> Self {
        Self { normal: self.normal * factor, drawbar: self.drawbar * factor, torque: self.torque * factor }
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            normal: self.normal + other.normal,
            drawbar: self.drawbar + other.drawbar,
            torque: self.torque + other.torque,
        }
    }

    /// `self` times `1 - weight` plus `other` times `weight`.
    pub(super) fn mixed(self, other: Self, weight: S) -> Self {
        let mix = |a: S, b: S| a + (b - a) * weight;
        Self {
            normal: mix(self.normal, other.normal),
            drawbar: mix(self.drawbar, other.drawbar),
            torque: mix(self.torque, other.torque),
        }
    }
}

/// Forces together with their slopes, which an implicit integrator needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rolling<S> {
    /// The forces.
    pub forces: Forces<S>,
    /// Their partial derivatives in the velocity, at constant theta_m.
    pub by_velocity: Forces<S>,
    /// Their partial derivatives in the spin, at constant theta_m.
    pub by_spin: Forces<S>,
}

#[lanes]
impl<S: Scalar> Rolling<S> {
    fn sliding(forces: Forces<S>) -> Self {
        Self { forces, by_velocity: Forces::zero(), by_spin: Forces::zero() }
    }

    /// The same contact seen from the other side where the mask says so: (V, omega) -> (-V, -omega), (DP, T) ->
    /// (-DP, -T).
    fn mirrored_where(self, mask: S::Mask) -> Self {
        let slope = |s: Forces<S>| Forces { normal: s.normal.negative_where(mask), ..s };
        let Forces { normal, drawbar, torque } = self.forces;
        Self {
            forces: Forces { normal, drawbar: drawbar.negative_where(mask), torque: torque.negative_where(mask) },
            by_velocity: slope(self.by_velocity),
            by_spin: slope(self.by_spin),
        }
    }

    fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Self {
            forces: Forces::select(mask, yes.forces, no.forces),
            by_velocity: Forces::select(mask, yes.by_velocity, no.by_velocity),
            by_spin: Forces::select(mask, yes.by_spin, no.by_spin),
        }
    }

    /// One side by side from one for each place of the mask; what stands elsewhere stays.
    fn put(&mut self, mask: S::Mask, mut one: impl FnMut(usize) -> Rolling<f64>) {
        for k in (0..S::Plain::LANES).filter(|&k| mask.lane(k)) {
            let one = one(k);
            for (mine, one) in [
                (&mut self.forces, one.forces),
                (&mut self.by_velocity, one.by_velocity),
                (&mut self.by_spin, one.by_spin),
            ] {
                put(&mut mine.normal, k, one.normal);
                put(&mut mine.drawbar, k, one.drawbar);
                put(&mut mine.torque, k, one.torque);
            }
        }
    }
}

/// Puts number `k` of those side by side.
fn put<S: Scalar>(place: &mut S, k: usize, x: f64) {
    let old = place.plain();
    *place = S::from_plain(Plain::from_lanes(|i| if i == k { x } else { old.lane(i) }));
}

/// Slip of a wheel: 1 - V/(r omega) where |r omega| >= |V| (driving), r omega/V - 1 otherwise (skid);
/// 0 at standstill (both speeds under 1e-6 m/s, where the ratio is noise).
#[must_use]
#[lanes]
pub fn slip<S: Scalar>(velocity: S, rim_speed: S) -> S {
    let (size, rim) = (velocity.abs(), rim_speed.abs());
    let stands = size.under(STANDSTILL) & rim.under(STANDSTILL);
    let drives = size.at_most(rim);
    let one = S::from(1.0);
    let ratio = S::select(drives, velocity, rim_speed) / S::select(stands, one, S::select(drives, rim_speed, velocity));
    S::select(stands, S::from(0.0), (one - ratio).negative_where(!drives))
}

/// Forces on a wheel sunk by `sinkage` (m, along the normal) whose centre moves at `velocity` (m/s, along
/// the tangent) and which turns at the absolute rate `spin` (rad/s, forward positive).
///
/// `exit_ratio` is lambda of the exit angle theta_2 = -acos(1 - lambda z/r); 0 ends the contact at the
/// bottom of the wheel. Finite everywhere; continuous in all arguments except at `velocity = spin = 0`,
/// where the formulas have no limit and zero-speed rolling at full slip is returned (a standing wheel is
/// [`super::touch`]'s business).
///
/// Error against adaptive quadrature (`tests/contact_quadrature.rs`), of N and of r N for the torque: under 1e-6 for
/// 0.5 <= n <= 1.3 and K >= 3 mm (4.5e-7 seen); outside it 4e-6 at n = 0.3, 1.2e-6 at n = 0.4, 1e-7 up to n = 2, and
/// 2e-8 at n = 1 for K down to 0.3 mm. This holds where the pressure carries the wheel: for cohesions up to the peak
/// pressure, and where the shear of a sliding rim takes away at most four fifths of what the pressure carries.
pub fn rolling<S: Scalar>(
    wheel: &Wheel<S>,
    soil: &Soil<S>,
    exit_ratio: S,
    sinkage: S,
    velocity: S,
    spin: S,
) -> Forces<S> {
    rolling_on(wheel, soil, &Surface::smooth(exit_ratio), sinkage, velocity, spin)
}

/// [`rolling()`] on any [`Surface`] of the rim. On one with a compliance `sinkage` is that of the undeformed outline.
pub fn rolling_on<S: Scalar>(
    wheel: &Wheel<S>,
    soil: &Soil<S>,
    surface: &Surface<S>,
    sinkage: S,
    velocity: S,
    spin: S,
) -> Forces<S> {
    rolling_sunk(wheel, soil, surface, sinkage, velocity, spin).0
}

/// [`rolling_on()`] with the sinkage of the soil, which the undeformed outline of a compliant wheel exceeds.
pub fn rolling_sunk<S: Scalar>(
    wheel: &Wheel<S>,
    soil: &Soil<S>,
    surface: &Surface<S>,
    outline: S,
    velocity: S,
    spin: S,
) -> (Forces<S>, S) {
    let share = S::from(1.0);
    let contact = Flattening { wheel, soil, surface, outline, velocity, spin, share };
    let flat = if outline.value() > 0.0 { flattened(&contact) } else { None };
    let (rim, sinkage) = flat.as_ref().map_or((surface, outline), |flat| (&flat.surface, flat.sinkage));
    let mut forces = rolling_share(wheel, soil, rim, sinkage, velocity, spin, share).0.forces;
    let (resists, leads) = (!surface.resistance.is_exactly(0.0), surface.leads());
    if (resists || leads) && sinkage.value() > 0.0 {
        let rim_speed = wheel.radius * spin;
        let speed = norm(velocity, rim_speed);
        if speed.value() > 0.0 && resists {
            forces.drawbar -= surface.against_travel(velocity / speed).0;
        }
        if speed.value() > 0.0 && leads {
            forces.torque += surface.resisting(forces.normal, rim_speed / speed).moment;
        }
    }
    (forces, sinkage)
}

/// Length of a vector, and 0 with zero slope at the origin.
#[lanes]
pub(super) fn norm<S: Scalar>(x: S, y: S) -> S {
    let squared = x * x + y * y;
    let is_there = squared.over(0.0);
    S::select(is_there, S::select(is_there, squared, S::from(1.0)).sqrt(), S::from(0.0))
}

/// [`rolling()`] with the slopes of the forces, in a contact of which only the `share` (0..1) of the slip
/// is established: it sets theta_m. Also the normal force of the pressure alone, N.
#[inline(never)]
#[lanes(entry)]
pub(super) fn rolling_share<S: Scalar>(
    wheel: &Wheel<S>,
    soil: &Soil<S>,
    surface: &Surface<S>,
    sinkage: S,
    velocity: S,
    spin: S,
    share: S,
) -> (Rolling<S>, S) {
    S::wide(|| {
        let none = (Rolling::sliding(Forces::zero()), S::from(0.0));
        let touches = sinkage.over(0.0);
        if !touches.any() {
            return none;
        }
        let zero = S::from(0.0);
        let backward = velocity.below(zero) | (!(velocity.below(zero) | zero.below(velocity)) & spin.below(zero));
        // The contact is mirrored: evaluate with (-V, -omega) and negate DP and T.
        let (velocity, spin) = (velocity.negative_where(backward), spin.negative_where(backward));
        let contact = Contact { wheel, soil, surface, sinkage, share };
        let (rolling, pressure) = contact.forward(velocity, spin, touches);
        let rolling = rolling.mirrored_where(backward);
        (Rolling::select(touches, rolling, none.0), S::select(touches, pressure, none.1))
    })
}

/// A contact whose motion varies.
struct Contact<'a, S> {
    wheel: &'a Wheel<S>,
    soil: &'a Soil<S>,
    surface: &'a Surface<S>,
    sinkage: S,
    share: S,
}

impl<S: Scalar> Contact<'_, S> {
    #[lanes]
    fn at(&self, shear: Shear<S>) -> Integrals<S> {
        let rim = Rim::new(self.wheel, self.soil, self.surface, self.sinkage, shear, self.share);
        integrate(&rim, self.wheel, self.surface)
    }

    /// Forces for `velocity >= 0` where the wheel touches. In SIMD lanes, wheels that roll forward are computed
    /// together and the others one by one.
    #[lanes]
    fn forward(&self, velocity: S, spin: S, touches: S::Mask) -> (Rolling<S>, S) {
        let rim_speed = self.wheel.radius * spin;
        // The quotient counts where the rim turns forward only, else it may be anything.
        let rolls = rim_speed.over(0.0) & (velocity / rim_speed).under(LOCKED_RATIO);
        if S::Plain::LANES == 1 {
            return if rolls.all() { self.roll(velocity, spin) } else { self.slide(velocity, rim_speed) };
        }
        let (safe, odd) = (rolls & touches, touches & !rolls);
        let choose = |x: S, other: f64| S::select(safe, x, S::from(other));
        let (sinkage, depth) = (self.sinkage, self.wheel.radius * 1e-3);
        let ordinary = Contact { sinkage: S::select(safe, sinkage, depth), share: choose(self.share, 1.0), ..*self };
        let (mut rolling, mut pressure) = if safe.any() {
            ordinary.roll(choose(velocity, 1.0), S::select(safe, spin, self.wheel.radius.recip()))
        } else {
            (Rolling::sliding(Forces::zero()), S::from(0.0))
        };
        if odd.any() {
            self.slide_each(velocity, spin, odd, &mut rolling, &mut pressure);
        }
        (rolling, pressure)
    }

    /// Of those side by side the ones that slide, one by one.
    #[inline(never)]
    fn slide_each(&self, velocity: S, spin: S, odd: S::Mask, rolling: &mut Rolling<S>, pressure: &mut S) {
        let mut pressures = [0.0; 8];
        rolling.put(odd, |k| {
            let f = |x: S| x.plain().lane(k);
            let (wheel, soil, surface) = (self.wheel.map(&f), self.soil.map(&f), self.surface.map(&f));
            let (sinkage, share) = (f(self.sinkage), f(self.share));
            let one = Contact { wheel: &wheel, soil: &soil, surface: &surface, sinkage, share };
            let (rolling, pressure) = one.forward(f(velocity), f(spin), true);
            pressures[k % 8] = pressure;
            rolling
        });
        (0..S::Plain::LANES).filter(|&k| odd.lane(k)).for_each(|k| put(pressure, k, pressures[k % 8]));
    }

    /// Forces of a rim that turns the way it moves.
    #[lanes]
    fn roll(&self, velocity: S, spin: S) -> (Rolling<S>, S) {
        let rim_speed = self.wheel.radius * spin;
        let ratio = velocity / rim_speed;
        let integrals = self.at(Shear::Ratio(ratio));
        let rolling = Rolling {
            forces: integrals.forces,
            by_velocity: integrals.by_ratio.scaled(rim_speed.recip()),
            by_spin: integrals.by_ratio.scaled(-(ratio / spin)),
        };
        (rolling, integrals.pressure)
    }

    /// Forces of one rim that slides forward over the soil, which shears against it.
    fn slide(&self, velocity: S, rim_speed: S) -> (Rolling<S>, S) {
        let sliding = self.at(Shear::Full(-1.0));
        if rim_speed.value() >= 0.0 {
            return (Rolling::sliding(sliding.forces), sliding.pressure);
        }
        let share = velocity / (velocity - rim_speed);
        if share.value() >= TURN_OVER {
            return (Rolling::sliding(sliding.forces), sliding.pressure);
        }
        (self.turning_over(&sliding.forces, share, velocity, rim_speed), sliding.pressure)
    }

    /// Between spinning backward on the spot (the limit V -> 0 of the mirrored contact) and sliding.
    fn turning_over(&self, sliding: &Forces<S>, share: S, velocity: S, rim_speed: S) -> Rolling<S> {
        let spinning = self.at(Shear::Ratio(S::from(0.0))).forces.mirrored();
        let change = sliding.plus(spinning.scaled(S::from(-1.0)));
        let by_share = change.scaled(smooth_step_slope(share / TURN_OVER) / TURN_OVER);
        let squared = (velocity - rim_speed).recip() * (velocity - rim_speed).recip();
        Rolling {
            forces: spinning.mixed(*sliding, smooth_step(share / TURN_OVER)),
            by_velocity: by_share.scaled(-(rim_speed * squared)),
            by_spin: by_share.scaled(velocity * self.wheel.radius * squared),
        }
    }
}

/// The integrals over one rim.
struct Integrals<S> {
    forces: Forces<S>,
    /// Slopes of the forces in V/(r omega).
    by_ratio: Forces<S>,
    /// The pressure's part of the normal force.
    pressure: S,
}

/// The integrals (2.7)-(2.9) over one rim, and their slopes in V/(r omega).
#[lanes]
fn integrate<S: Scalar>(rim: &Rim<S>, wheel: &Wheel<S>, surface: &Surface<S>) -> Integrals<S> {
    let sums = sums(rim);
    let area = wheel.radius * surface.arc * wheel.width;
    let (lugs, arm) = (surface.shear_radius, wheel.radius * surface.arm);
    let forces = |sigma_cos: S, sigma_sin: S, tau_cos: S, tau_sin: S, tau: S| Forces {
        normal: area * (sigma_cos + tau_sin * lugs),  // (2.7)
        drawbar: area * (tau_cos * lugs - sigma_sin), // (2.8)
        torque: area * arm * tau * (lugs * lugs),     // (2.9)
    };
    let zero = S::from(0.0);
    Integrals {
        forces: forces(sums.sigma_cos, sums.sigma_sin, sums.tau_cos, sums.tau_sin, sums.tau),
        by_ratio: forces(zero, zero, sums.slope_cos, sums.slope_sin, sums.slope),
        pressure: area * sums.sigma_cos,
    }
}
