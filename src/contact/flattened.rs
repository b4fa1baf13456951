//! A wheel that flattens under the force that the soil puts on it.
//!
//! The wheel deflects by f = C N, and stands on the arc of a larger circle, r* = r (1 + a f/z + b f/r) at the soil's sinkage z.
//! With a = 1 and b = 0 the circle enters the soil where the undeformed outline does (after Schmid 1995). N is the normal force of the
//! stress integrals on that arc, so z follows from z + C N(z) = Z, with Z the sinkage of the undeformed outline.

use super::rolling::{Forces, Rolling, rolling_share};
use super::surface::Surface;
use crate::scalar::{Mask, Scalar, lanes};
use crate::soil::Soil;
use crate::wheel::Wheel;

/// Bound of the loop, far above what it needs.
const MAX_STEPS: usize = 60;
/// The search ends where the product of its last two relative steps is below this. The product estimates the relative error that a secant step
/// leaves; the Newton step after the search squares that error. After steps by halving or with a power at one of its bounds the product is
/// no estimate; they occur far from the solution (a test holds what is left to rounding).
const CONVERGED: f64 = 1e-8;
/// Newton steps of the estimate from which the search starts; it need not converge.
const ESTIMATE_STEPS: usize = 6;
/// Relative step below which a secant is mostly rounding, and the one before is kept.
const SECANT_STEP: f64 = 1e-7;
/// Relative distance h of the symmetric difference that gives the slopes in the sinkage. Its error is of the order h^2 = 1e-10, and
/// that of rounding 1e-16/h = 1e-11.
const DIFFERENCE: f64 = 1e-5;
/// Bounds of the power with which the normal force grows with the sinkage while it is searched for.
const POWERS: [f64; 2] = [0.1, 4.0];
/// The lower bound is lowered by 0.7 z/f, at most by 20: where the arc grows with the load alone, a deeper sinkage, which leaves
/// less for the deflection f, may have a smaller force. The slope of z + f in ln z stays positive.
const LESS_POWER: [f64; 2] = [0.7, 20.0];

/// A contact whose wheel may flatten.
pub(super) struct Flattening<'a, S> {
    pub wheel: &'a Wheel<S>,
    pub soil: &'a Soil<S>,
    /// The rim with its compliance, before it flattens.
    pub surface: &'a Surface<S>,
    /// Sinkage Z of the undeformed outline, m.
    pub outline: S,
    /// Velocity of the wheel's centre and rate of turning, as in [`rolling_share`]: only their ratio counts.
    pub velocity: S,
    pub spin: S,
    /// Share of the slip that is established, 0 to 1.
    pub share: S,
}

/// Where the wheel stands.
pub(super) struct Flattened<S> {
    /// The rim with its larger arc.
    pub surface: Surface<S>,
    /// Sinkage z of the soil.
    pub sinkage: S,
    /// Change of z by a change of the normal force at constant z, m/N: -C/(1 + C dN/dz).
    sinkage_by_normal: S,
    /// Slopes of the forces in z.
    by_sinkage: Forces<S>,
}

/// Where a wheel with a compliance stands; none where it is rigid.
#[lanes]
pub(super) fn flattened<S: Scalar>(contact: &Flattening<S>) -> Option<Flattened<S>> {
    if contact.surface.compliance.is_exactly(0.0) { None } else { Some(contact.solve()) }
}

#[lanes]
impl<S: Scalar> Flattened<S> {
    /// Slopes at a constant sinkage of the outline from those at a constant sinkage of the soil.
    pub fn follow(&self, direction: &mut Rolling<S>) {
        for slope in [&mut direction.by_velocity, &mut direction.by_spin] {
            *slope = slope.plus(self.by_sinkage.scaled(self.sinkage_by_normal * slope.normal));
        }
    }
}

#[lanes]
impl<S: Scalar> Flattening<'_, S> {
    /// The soil's sinkage, with its derivatives by the implicit function theorem.
    pub fn solve(&self) -> Flattened<S> {
        let f = |x: S| x.plain();
        let (wheel, soil, surface) = (self.wheel.map(&f), self.soil.map(&f), self.surface.map(&f));
        let plain = Flattening {
            wheel: &wheel,
            soil: &soil,
            surface: &surface,
            outline: self.outline.plain(),
            velocity: self.velocity.plain(),
            spin: self.spin.plain(),
            share: self.share.plain(),
        };
        let (found, slopes) = plain.search();
        let (fixed, by_sinkage) = (S::from_plain(found), lifted::<S>(&slopes));
        let slope = self.surface.compliance * by_sinkage.normal + 1.0;
        let rest = fixed + self.surface.compliance * self.forces(fixed).normal.larger(S::from(0.0)) - self.outline;
        // Where a wheel carries next to nothing, because the shear of its rim pulls it down, N may fall with z as fast as 1/C: there is no
        // solution or more than one then.
        let sinkage = (fixed - rest / slope).smaller(self.outline);
        let sinkage_by_normal = -self.surface.compliance / slope;
        Flattened { surface: self.arc(sinkage), sinkage, sinkage_by_normal, by_sinkage }
    }

    /// The rim where the soil is pressed in by `sinkage`.
    fn arc(&self, sinkage: S) -> Surface<S> {
        let Surface { arc_by_sinkage, arc_by_load, .. } = *self.surface;
        let deflection = self.outline - sinkage;
        let growth = deflection * (arc_by_sinkage / sinkage + arc_by_load / self.wheel.radius);
        Surface {
            arc: self.surface.arc * (growth + 1.0),
            arm: self.surface.arm * (self.surface.arm_share * growth + 1.0),
            ..*self.surface
        }
    }

    /// Forces of the motion as far as its slip is established.
    fn forces(&self, sinkage: S) -> Forces<S> {
        let surface = self.arc(sinkage);
        let (rolling, pressure) =
            rolling_share(self.wheel, self.soil, &surface, sinkage, self.velocity, self.spin, self.share);
        let symmetric = Forces { normal: pressure, ..Forces::zero() };
        symmetric.mixed(rolling.forces, self.share)
    }

    /// z by Newton's method in its logarithm, where the growth of N with z is that of its last two values, within a
    /// bracket that shrinks; and the slopes of the forces in z.
    fn search(&self) -> (S, Forces<S>) {
        let (mut low, mut high) = (S::from(0.0), self.outline);
        let mut z = self.estimate();
        let mut power = self.soil.exponent;
        let mut before = (z, S::from(0.0));
        let mut last_step = S::from(1.0);
        let mut goes_on = self.outline.over(0.0);
        for k in 0..MAX_STEPS {
            let normal = self.forces(z).normal.larger(S::from(f64::MIN_POSITIVE));
            let deflection = self.surface.compliance * normal;
            if k > 0 {
                let change = z - before.0;
                let tells = !change.abs().at_most(z * SECANT_STEP);
                let secant = (normal - before.1) * z / (S::select(tells, change, z) * normal);
                let less = (z / deflection * LESS_POWER[0]).smaller(S::from(LESS_POWER[1]));
                let bounded = secant.larger(-less + POWERS[0]).smaller(S::from(POWERS[1]));
                power = S::select(tells, bounded, power);
            }
            let rest = z + deflection - self.outline;
            let deep = rest.over(0.0);
            (low, high) = (S::select(deep, low, z), S::select(deep, z, high));
            let next = z * (-(rest / (z + power * deflection))).exponential();
            let next = S::select(low.at_most(next) & next.at_most(high), next, (low + high) * 0.5);
            before = (z, normal);
            let step = (next - z).abs() / z;
            z = S::select(goes_on, next, z);
            goes_on = goes_on & !(step * last_step).under(CONVERGED);
            last_step = step;
            if !goes_on.any() {
                break;
            }
        }
        let [below, above] = [1.0 - DIFFERENCE, 1.0 + DIFFERENCE].map(|share| self.forces(z * share));
        (z, above.plus(below.scaled(S::from(-1.0))).scaled((z * (2.0 * DIFFERENCE)).recip()))
    }

    /// z where N is Bekker's estimate b (k_c/b + k_phi) z^n sqrt(2 r* z)/(1 + n/2), roughly: the search starts there. The arc's length
    /// sqrt(2 r* z) = sqrt(2 r Z) of a = 1 and b = 0 does not change with z. In the logarithm the left side is convex, so Newton's method from Z converges.
    fn estimate(&self) -> S {
        let (wheel, exponent) = (self.wheel, self.soil.exponent);
        let modulus = wheel.width * self.soil.modulus(wheel.width) * (wheel.radius * self.outline * 2.0).sqrt();
        let scale = modulus / (exponent * 0.5 + 1.0) * self.surface.compliance;
        let mut z = self.outline;
        for _ in 0..ESTIMATE_STEPS {
            let deflection = scale * z.power(exponent);
            z *= (-((z + deflection - self.outline) / (z + exponent * deflection))).exponential();
        }
        z
    }
}

/// The same forces without derivatives as constants.
#[lanes]
fn lifted<S: Scalar>(forces: &Forces<S::Plain>) -> Forces<S> {
    Forces {
        normal: S::from_plain(forces.normal),
        drawbar: S::from_plain(forces.drawbar),
        torque: S::from_plain(forces.torque),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rover::Rover;

    /// Relative error of the normal force, in units of r* / z times the rounding of a number: the angle of entry follows from 1 - z/r*, of which
    /// z/r* is the part that counts.
    const ROUNDINGS: f64 = 4.0;

    #[test]
    fn analytic_sinkage_and_deflection_add_up_to_the_sinkage_of_the_outline() {
        let laws = [(1.0, 0.0), (0.0, 10.0), (0.5, 20.0)];
        let judged: u32 = laws.iter().map(|(by_sinkage, by_load)| add_up(*by_sinkage, *by_load)).sum();
        assert!(judged > 3 * 280, "{judged} of {} carry a load", 3 * 320);
    }

    /// Checks one law; returns how many contacts carry a load.
    fn add_up(arc_by_sinkage: f64, arc_by_load: f64) -> u32 {
        let Rover { wheel, mut soil, .. } = Rover::two_wheeled();
        let mut judged = 0;
        for exponent in [0.3, 0.8, 1.1, 2.0] {
            soil.exponent = exponent;
            for compliance in [1e-7, 1e-6, 1e-5, 1e-4, 3e-4] {
                for outline in [1e-4, 1e-3, 1e-2, 5e-2] {
                    for velocity in [1.6, 1.0, 0.7, 0.1] {
                        let surface = Surface { compliance, arc_by_sinkage, arc_by_load, ..Surface::smooth(0.0) };
                        let spin = wheel.radius.recip();
                        let contact = Flattening {
                            wheel: &wheel,
                            soil: &soil,
                            surface: &surface,
                            outline,
                            velocity,
                            spin,
                            share: 1.0,
                        };
                        let z = contact.solve().sinkage;
                        let normal = contact.forces(z).normal;
                        if normal <= 0.0 {
                            // The shear of a skidding rim pulls it down: nothing flattens it.
                            continue;
                        }
                        judged += 1;
                        let rest = z + compliance * normal - outline;
                        let growth = (outline - z) * (arc_by_sinkage / z + arc_by_load / wheel.radius);
                        let rounding = f64::EPSILON * (1.0 + wheel.radius * (1.0 + growth) / z);
                        let place = format!(
                            "a {arc_by_sinkage}, b {arc_by_load}, n {exponent}, C {compliance}, Z {outline}, V/(r omega) {velocity}"
                        );
                        assert!(
                            z > 0.0 && (rest / outline).abs() <= ROUNDINGS * rounding,
                            "{place}: z {z} leaves {rest} m, rounding {rounding}"
                        );
                    }
                }
            }
        }
        judged
    }
}
