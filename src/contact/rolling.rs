//! Forces of a rolling, skidding or sliding rigid wheel on deformable soil: the full stress integrals.
//!
//! Bekker 1969; Wong and Reece 1967; Janosi and Hanamoto 1961; equations (2.1)-(2.9) of Iagnemma 2001.

use super::quadrature::{NODES_8, NODES_12};
use super::rim::{Rim, Shear, Sums};
use crate::scalar::{Scalar, smooth_step};
use crate::soil::Soil;
use crate::wheel::Wheel;

/// Largest r/K for which 8 nodes a zone stay within 1e-6; above it 12 are used (the shear builds up
/// within a few K of the entry point, which 8 nodes no longer resolve).
const FEW_NODES_UP_TO: f64 = 10.0;

/// Where V and omega have opposite signs, the share |V|/(|V| + |r omega|) below which the contact turns
/// over from the side towards which the wheel spins to the side towards which it moves.
const TURN_OVER: f64 = 0.1;

/// V/(r omega) above which a rim counts as fully sliding.
const LOCKED_RATIO: f64 = 1e6;

/// Forces of the soil on a wheel, at its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forces<S = f64> {
    /// Along the ground's normal, N (2.7).
    pub normal: S,
    /// Drawbar pull along the ground's tangent, N (2.8).
    pub drawbar: S,
    /// Moment that the drive must balance, N m (2.9).
    pub torque: S,
}

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

    pub(super) fn scaled(self, factor: S) -> Self {
        Self { normal: self.normal * factor, drawbar: self.drawbar * factor, torque: self.torque * factor }
    }

    pub(super) fn plus(self, other: Self) -> Self {
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

/// Forces together with their slope in the ratio V/(r omega), which an implicit integrator needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rolling<S = f64> {
    /// The forces.
    pub forces: Forces<S>,
    /// Their partial derivatives in V/(r omega), at constant theta_m.
    pub by_ratio: Forces<S>,
}

impl<S: Scalar> Rolling<S> {
    fn mirrored(self) -> Self {
        Self { forces: self.forces.mirrored(), by_ratio: self.by_ratio.mirrored() }
    }
}

/// Slip of a wheel: 1 - V/(r omega) where |r omega| >= |V| (driving), r omega/V - 1 otherwise (skid);
/// 0 at standstill.
#[must_use]
pub fn slip<S: Scalar>(velocity: S, rim_speed: S) -> S {
    if velocity.value() == 0.0 && rim_speed.value() == 0.0 {
        S::from(0.0)
    } else if rim_speed.value().abs() >= velocity.value().abs() {
        S::from(1.0) - velocity / rim_speed
    } else {
        rim_speed / velocity - 1.0
    }
}

/// Forces on a wheel sunk by `sinkage` (m, along the normal) whose centre moves at `velocity` (m/s, along
/// the tangent) and which turns at the absolute rate `spin` (rad/s, forward positive).
///
/// `exit_ratio` is lambda of the exit angle theta_2 = -acos(1 - lambda z/r); 0 ends the contact at the
/// bottom of the wheel. Finite everywhere; continuous in all arguments except at `velocity = spin = 0`,
/// where the formulas have no limit and zero-speed rolling at full slip is returned (a standing wheel is
/// [`super::touch`]'s business). Error against adaptive quadrature: under 1e-6 of N (of r N for the
/// torque) for 0.5 <= n <= 1.3 and K >= 3 mm.
pub fn rolling<S: Scalar>(
    wheel: &Wheel<S>,
    soil: &Soil<S>,
    exit_ratio: S,
    sinkage: S,
    velocity: S,
    spin: S,
) -> Forces<S> {
    rolling_with_slope(wheel, soil, exit_ratio, sinkage, velocity, spin).forces
}

/// [`rolling`] with the slope of the forces in V/(r omega).
pub fn rolling_with_slope<S: Scalar>(
    wheel: &Wheel<S>,
    soil: &Soil<S>,
    exit_ratio: S,
    sinkage: S,
    velocity: S,
    spin: S,
) -> Rolling<S> {
    if sinkage.value() <= 0.0 {
        return Rolling { forces: Forces::zero(), by_ratio: Forces::zero() };
    }
    let backward = velocity.value() < 0.0 || (velocity.value() == 0.0 && spin.value() < 0.0);
    if backward {
        // The contact is mirrored: evaluate with (-V, -omega) and negate DP and T.
        return forward(wheel, soil, exit_ratio, sinkage, -velocity, -spin).mirrored();
    }
    forward(wheel, soil, exit_ratio, sinkage, velocity, spin)
}

/// `rolling` for `velocity >= 0`.
fn forward<S: Scalar>(
    wheel: &Wheel<S>,
    soil: &Soil<S>,
    exit_ratio: S,
    sinkage: S,
    velocity: S,
    spin: S,
) -> Rolling<S> {
    let at = |shear: Shear<S>| integrate(&Rim::new(wheel, soil, exit_ratio, sinkage, shear), wheel);
    let rim_speed = wheel.radius * spin;
    let ratio = velocity.value() / rim_speed.value();
    if rim_speed.value() > 0.0 && ratio < LOCKED_RATIO {
        return at(Shear::Ratio(velocity / rim_speed));
    }
    // The rim slides forward over the soil, which shears against it.
    let sliding = at(Shear::Full(-1.0));
    if rim_speed.value() >= 0.0 {
        return sliding;
    }
    let share = velocity / (velocity - rim_speed);
    if share.value() >= TURN_OVER {
        return sliding;
    }
    // Spinning backward on the spot, the limit V -> 0 of the mirrored contact.
    let spinning = at(Shear::Ratio(S::from(0.0))).mirrored();
    let weight = smooth_step(share / TURN_OVER);
    Rolling { forces: spinning.forces.mixed(sliding.forces, weight), by_ratio: Forces::zero() }
}

/// The integrals (2.7)-(2.9) over one rim.
fn integrate<S: Scalar>(rim: &Rim<S>, wheel: &Wheel<S>) -> Rolling<S> {
    let sums = if rim.needs_few_nodes(FEW_NODES_UP_TO) { sums(rim, &NODES_8) } else { sums(rim, &NODES_12) };
    let area = wheel.radius * wheel.width;
    let forces = |sigma_cos: S, sigma_sin: S, tau_cos: S, tau_sin: S, tau: S| Forces {
        normal: area * (sigma_cos + tau_sin),  // (2.7)
        drawbar: area * (tau_cos - sigma_sin), // (2.8)
        torque: area * wheel.radius * tau,     // (2.9)
    };
    let zero = S::from(0.0);
    Rolling {
        forces: forces(sums.sigma_cos, sums.sigma_sin, sums.tau_cos, sums.tau_sin, sums.tau),
        by_ratio: forces(zero, zero, sums.slope_cos, sums.slope_sin, sums.slope),
    }
}

fn sums<S: Scalar>(rim: &Rim<S>, nodes: &[(f64, f64)]) -> Sums<S> {
    let mut sums = Sums::zero();
    match rim.kink() {
        None => nodes.iter().for_each(|&(s, weight)| rim.add(&mut sums, s, weight, weight)),
        // At negative slip the shear changes sign within one zone: its interval is split there.
        Some(kink) => {
            let (front, rear) = if kink.in_front { (1.0, 0.0) } else { (0.0, 1.0) };
            for &(s, weight) in nodes {
                rim.add(&mut sums, s, weight * rear, weight * front);
                for (from, to) in [(0.0, kink.s), (kink.s, 1.0)] {
                    let part = weight * (to - from);
                    rim.add(&mut sums, from + (to - from) * s, part * front, part * rear);
                }
            }
        }
    }
    sums
}
