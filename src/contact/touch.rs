//! The contact of a moving, turning, standing wheel, with what an implicit integrator needs of it.
//!
//! The stress integrals depend on V/(r omega) only and have no limit at standstill. Below the soil's
//! `hold_speed` they blend into a standing contact that remembers two displacements, each divided by the
//! soil's `hold_displacement` and saturating at one (Dahl 1968):
//! - `shear`: how far the rim has crept over the soil, the mobilised share of the shear strength;
//! - `lean`: how far the wheel has rolled, which moves the pressure from symmetric (0) to the side
//!   towards which it rolls (+1 forward: the rolling contact; -1 backward: its mirror image).
//!
//! A standing wheel carries tangential force through both, at rest and without creep.

use super::rim::{Rim, Shear, Sums};
use super::rolling::{Forces, rolling_with_slope};
use crate::scalar::{Scalar, smooth_step};
use crate::soil::Soil;
use crate::wheel::Wheel;

/// Relaxation time of the standing contact's internal damping, s: about half critical for a rover's
/// mass on its own static friction (frequency sqrt(g tan phi / hold_displacement), about 100 rad/s).
const HOLD_DAMPING_TIME: f64 = 0.01;

/// Sinkage over which the normal damping builds up, m, so that it starts from zero at touch-down.
const DAMPING_DEPTH: f64 = 0.001;

/// Memory of a standing contact, each in -1..1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold<S = f64> {
    /// Mobilised share of the shear strength, forward positive.
    pub shear: S,
    /// Lean of the pressure towards the side to which the wheel rolls.
    pub lean: S,
}

impl<S: From<f64>> Default for Hold<S> {
    fn default() -> Self {
        Self { shear: S::from(0.0), lean: S::from(0.0) }
    }
}

/// Motion of a wheel relative to the ground at its contact foot.
#[derive(Clone, Copy, Debug)]
pub struct Motion<S = f64> {
    /// Sinkage along the normal, m.
    pub sinkage: S,
    /// Velocity of the wheel centre along the normal, m/s.
    pub normal_velocity: S,
    /// Velocity of the wheel centre along the tangent, m/s.
    pub velocity: S,
    /// Absolute rate of turning, forward positive, rad/s.
    pub spin: S,
    /// Memory of the standing contact.
    pub hold: Hold<S>,
}

/// Partial derivatives of the contact, as far as they are stiff.
#[derive(Clone, Copy, Debug)]
pub struct Slopes<S = f64> {
    /// Of the forces in the tangential velocity.
    pub velocity: Forces<S>,
    /// Of the forces in the spin.
    pub spin: Forces<S>,
    /// Of the forces in `hold.shear`.
    pub shear: Forces<S>,
    /// Of the forces in `hold.lean`.
    pub lean: Forces<S>,
    /// Of the normal force in the normal velocity.
    pub damping: S,
    /// Of the normal force in the sinkage.
    pub stiffness: S,
    /// Of `rate.shear` in the velocity, the spin and itself.
    pub shear_rate: [S; 3],
    /// Of `rate.lean` in the velocity and itself.
    pub lean_rate: [S; 2],
}

/// Forces of a contact, the rates of its memory, and the slopes of both.
#[derive(Clone, Copy, Debug)]
pub struct Touch<S = f64> {
    /// Forces on the wheel, at its centre.
    pub forces: Forces<S>,
    /// Time derivative of [`Motion::hold`], 1/s.
    pub rate: Hold<S>,
    /// Partial derivatives.
    pub slopes: Slopes<S>,
}

/// Forces on a wheel in `motion`. `exit_ratio` is lambda of the exit angle, see [`super::rolling()`].
pub fn touch<S: Scalar>(wheel: &Wheel<S>, soil: &Soil<S>, exit_ratio: S, motion: &Motion<S>) -> Touch<S> {
    let (rate, shear_rate, lean_rate) = hold_rates(wheel, soil, motion);
    let zero = Forces::zero();
    let mut touch = Touch {
        forces: zero,
        rate,
        slopes: Slopes {
            velocity: zero,
            spin: zero,
            shear: zero,
            lean: zero,
            damping: S::from(0.0),
            stiffness: S::from(0.0),
            shear_rate,
            lean_rate,
        },
    };
    if motion.sinkage.value() <= 0.0 {
        return touch;
    }
    let rim_speed = wheel.radius * motion.spin;
    let speed2 = motion.velocity * motion.velocity + rim_speed * rim_speed;
    let relative2 = speed2 / (soil.hold_speed * soil.hold_speed);
    // 1 where the stress integrals hold, 0 at standstill; smooth in V and omega as it is one in their squares.
    let weight = smooth_step(relative2);
    if weight.value() > 0.0 {
        add_rolling(&mut touch, wheel, soil, exit_ratio, motion);
    }
    if weight.value() < 1.0 {
        blend_standing(&mut touch, wheel, soil, exit_ratio, motion, weight);
    }
    add_damping(&mut touch, soil, motion);
    touch
}

/// Dahl's law for both memories, with its partial derivatives.
fn hold_rates<S: Scalar>(wheel: &Wheel<S>, soil: &Soil<S>, motion: &Motion<S>) -> (Hold<S>, [S; 3], [S; 2]) {
    let distance = soil.hold_displacement.recip();
    let creep = wheel.radius * motion.spin - motion.velocity;
    let sign = |x: S| if x.value() < 0.0 { -1.0 } else { 1.0 };
    let (shear, lean) = (motion.hold.shear, motion.hold.lean);
    let shear_rate = (creep - creep.abs() * shear) * distance;
    let lean_rate = (motion.velocity - motion.velocity.abs() * lean) * distance;
    let by_creep = (S::from(1.0) - shear * sign(creep)) * distance;
    let by_velocity = (S::from(1.0) - lean * sign(motion.velocity)) * distance;
    (
        Hold { shear: shear_rate, lean: lean_rate },
        [-by_creep, by_creep * wheel.radius, -(creep.abs() * distance)],
        [by_velocity, -(motion.velocity.abs() * distance)],
    )
}

fn add_rolling<S: Scalar>(
    touch: &mut Touch<S>,
    wheel: &Wheel<S>,
    soil: &Soil<S>,
    exit_ratio: S,
    motion: &Motion<S>,
) {
    let rolling = rolling_with_slope(wheel, soil, exit_ratio, motion.sinkage, motion.velocity, motion.spin);
    touch.forces = rolling.forces;
    let rim_speed = wheel.radius * motion.spin;
    if rim_speed.value() != 0.0 && rolling.by_ratio != Forces::zero() {
        let by_velocity = rim_speed.recip();
        let by_spin = -(motion.velocity / (rim_speed * motion.spin));
        touch.slopes.velocity = rolling.by_ratio.scaled(by_velocity);
        touch.slopes.spin = rolling.by_ratio.scaled(by_spin);
    }
}

/// Blends the standing contact in: `weight` is the share of the rolling one.
fn blend_standing<S: Scalar>(
    touch: &mut Touch<S>,
    wheel: &Wheel<S>,
    soil: &Soil<S>,
    exit_ratio: S,
    motion: &Motion<S>,
    weight: S,
) {
    let rate = touch.rate;
    let shear = motion.hold.shear + rate.shear * HOLD_DAMPING_TIME;
    let lean = motion.hold.lean + rate.lean * HOLD_DAMPING_TIME;
    let standing = Standing::new(wheel, soil, exit_ratio, motion.sinkage);
    let rest = S::from(1.0) - weight;
    touch.forces = standing.forces(shear, lean).mixed(touch.forces, weight);
    let slopes = &mut touch.slopes;
    let by_shear = standing.by_shear(lean).scaled(rest);
    let by_lean = standing.by_lean(shear).scaled(rest);
    // The damping part of the memory turns its rates' slopes into slopes of the forces.
    let [v, w, own] = slopes.shear_rate;
    slopes.shear = by_shear.scaled(own * HOLD_DAMPING_TIME + 1.0);
    let [v_lean, own_lean] = slopes.lean_rate;
    slopes.lean = by_lean.scaled(own_lean * HOLD_DAMPING_TIME + 1.0);
    slopes.velocity = slopes
        .velocity
        .scaled(weight)
        .plus(by_shear.scaled(v * HOLD_DAMPING_TIME))
        .plus(by_lean.scaled(v_lean * HOLD_DAMPING_TIME));
    slopes.spin = slopes.spin.scaled(weight).plus(by_shear.scaled(w * HOLD_DAMPING_TIME));
}

/// Stress integrals of a standing contact: the mean of the forward and the mirrored contact, weighted by
/// its lean, with a uniform share of the strength mobilised.
pub(crate) struct Standing<S> {
    sums: Sums<S>,
    area: S,
    radius: S,
}

impl<S: Scalar> Standing<S> {
    pub(crate) fn new(wheel: &Wheel<S>, soil: &Soil<S>, exit_ratio: S, sinkage: S) -> Self {
        let rim = Rim::new(wheel, soil, exit_ratio, sinkage, Shear::Mobilised(S::from(1.0)));
        let mut sums = Sums::zero();
        super::quadrature::NODES_8.iter().for_each(|&(s, weight)| rim.add(&mut sums, s, weight, weight));
        Self { sums, area: wheel.radius * wheel.width, radius: wheel.radius }
    }

    pub(crate) fn forces(&self, shear: S, lean: S) -> Forces<S> {
        Forces {
            normal: self.area * (self.sums.sigma_cos + shear * lean * self.sums.tau_sin),
            drawbar: self.area * (shear * self.sums.tau_cos - lean * self.sums.sigma_sin),
            torque: self.area * self.radius * shear * self.sums.tau,
        }
    }

    fn by_shear(&self, lean: S) -> Forces<S> {
        Forces {
            normal: self.area * lean * self.sums.tau_sin,
            drawbar: self.area * self.sums.tau_cos,
            torque: self.area * self.radius * self.sums.tau,
        }
    }

    fn by_lean(&self, shear: S) -> Forces<S> {
        Forces {
            normal: self.area * shear * self.sums.tau_sin,
            drawbar: -(self.area * self.sums.sigma_sin),
            torque: S::from(0.0),
        }
    }
}

/// Damping along the normal, which never makes the normal force negative.
fn add_damping<S: Scalar>(touch: &mut Touch<S>, soil: &Soil<S>, motion: &Motion<S>) {
    let coefficient = soil.damping * smooth_step(motion.sinkage / DAMPING_DEPTH);
    // Near n + 1/2, the power of Bekker's own approximation (4.18); only the integrator uses it.
    touch.slopes.stiffness = (soil.exponent + 0.5) * touch.forces.normal.larger(S::from(0.0)) / motion.sinkage;
    let normal = touch.forces.normal - coefficient * motion.normal_velocity;
    if normal.value() > 0.0 {
        touch.forces.normal = normal;
        touch.slopes.damping = -coefficient;
    } else {
        touch.forces.normal = S::from(0.0);
    }
}
