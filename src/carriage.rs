//! A wheel on a carriage: the steady point at a load, a slip and a wheel speed.

use crate::contact::{self, Forces, rolling_sunk};
use crate::effects::{BodyMotion, Effects, ExpressionFailure, Place};
use crate::motor::{self, Drivetrain};
use crate::rover::Rover;
use crate::scalar::{Dual, MapScalar, Scalar};
use crate::soil::Soil;
use crate::vehicle::Environment;
use crate::wheel::Wheel;
use bekker_modeldescription::{Parameters, Unit, Variable, join, parameters};

/// The normal force meets the load within this share of it: far below any measurement, above rounding.
const LOAD_TOLERANCE: f64 = 1e-12;

/// Newton's method in logarithms needs 3 to 6 steps; bisection of 0..r to 1e-12 needs 40.
const MAX_STEPS: usize = 100;

/// A wheel, the soil under it and the effects between them: the part of a rover that a carriage tests.
#[derive(Clone, Debug, PartialEq, MapScalar)]
pub struct Rig<S = f64> {
    /// Gravity, by which unmodelled mass adds to the load.
    pub environment: Environment<S>,
    /// The wheel.
    pub wheel: Wheel<S>,
    /// The soil, the same everywhere.
    pub soil: Soil<S>,
    /// Missing physics, neutral by default.
    pub effects: Effects<S>,
}

parameters! {
    /// What a carriage is set to.
    pub struct SetPoint {
        /// Vertical load on the wheel.
        load: [Unit::NEWTON] = 10.0, 1e-3..=1e6, Signal, "input; a small rover's wheel";
        /// Slip: 1 - V/(r omega) driving, r omega/V - 1 in skid; -1 is a locked wheel.
        slip: [Unit::ONE] = 0.2, -1.0..=1.0, Signal, "input";
        /// Speed of the wheel; negative backward, 0 with slip -1 alone.
        wheel_speed: [Unit::RADIAN_PER_SECOND] = 0.5, -1e4..=1e4, Signal, "input; 5 cm/s at the rim of a wheel of 10 cm";
    }
}

parameters! {
    /// What a carriage measures at a steady point.
    pub struct SteadyPoint {
        /// Drawbar pull as the carriage feels it.
        drawbar_pull: [Unit::NEWTON] = 0.0, -1e9..=1e9, Signal, "steady point";
        /// Torque of the drive as it is recorded, wheel side of the gear, its losses included.
        torque: [Unit::NEWTON_METRE] = 0.0, -1e9..=1e9, Signal, "steady point";
        /// Sinkage of the soil.
        sinkage: [Unit::METRE] = 0.0, 0.0..=10.0, Signal, "steady point";
    }
}

/// Why there is no steady point.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SteadyError {
    /// Slip and wheel speed contradict each other.
    #[error("slip {slip} is impossible at wheel speed {wheel_speed} rad/s (a locked wheel has slip -1 and speed 0)")]
    Impossible {
        /// The slip.
        slip: f64,
        /// The wheel speed, rad/s.
        wheel_speed: f64,
    },
    /// An effect of the user's own gives a value without a meaning.
    #[error(transparent)]
    Effect(#[from] ExpressionFailure),
    /// The wheel sinks to its axle.
    #[error(
        "the soil does not carry {load:.2} N at slip {slip:.3}: the wheel sinks to its axle, where it carries {carried:.2} N"
    )]
    SunkToAxle {
        /// The load, N.
        load: f64,
        /// The slip.
        slip: f64,
        /// Normal force at a sinkage of one radius, N.
        carried: f64,
    },
    /// The normal force does not meet the load to rounding.
    #[error("no sinkage balances {load} N at slip {slip}")]
    NotBalanced {
        /// The load, N.
        load: f64,
        /// The slip.
        slip: f64,
    },
}

impl SteadyError {
    /// Whether the row has no answer on this rig, in contrast to an effect that is defined wrongly.
    pub(crate) fn is_of_the_row(&self) -> bool {
        !matches!(self, Self::Effect(_))
    }
}

impl Rig {
    /// The steady point at a set-point, see [`steady_point`].
    ///
    /// # Errors
    /// [`SteadyError`] where the wheel sinks to its axle or the inputs contradict each other.
    pub fn at(&self, set: &SetPoint) -> Result<SteadyPoint, SteadyError> {
        steady_point(self, set.load, set.slip, set.wheel_speed)
    }

    /// The wheel, soil and effects of a rover.
    #[must_use]
    pub fn of(rover: &Rover) -> Self {
        Self { environment: rover.environment, wheel: rover.wheel, soil: rover.soil, effects: rover.effects.clone() }
    }
}

impl<S: Scalar> Rig<S> {
    /// Forces at a sinkage, through the same hooks as in the rover's equations of motion; the torque is the drive's as recorded and
    /// the drawbar pull what is left after resistances at the carriage. Also the sinkage of the soil, which a flexible wheel's
    /// outline exceeds.
    fn forces(&self, sinkage: S, velocity: S, spin: S, slip: S) -> Result<(Forces<S>, S), ExpressionFailure> {
        let zero = S::from(0.0);
        let place = Place {
            wheel: 0,
            x: None,
            passes: zero,
            contact_angle: zero,
            slip,
            dug_slip: slip.abs(),
            sinkage,
            normal_velocity: zero,
            velocity,
        };
        let mut sunk = sinkage;
        let (_, mut forces) = self.effects.contact(&place, self.true_wheel(), self.soil, |local| {
            let forces;
            (forces, sunk) = rolling_sunk(&local.wheel, &local.soil, &local.surface, sinkage, velocity, spin);
            forces
        })?;
        forces.torque = motor::torque_behind(&self.effects, spin, forces.torque)?;
        if let Some(gain) = self.effects.torque_gain() {
            forces.torque /= gain;
        }
        forces.drawbar += self.effects.body_force(&BodyMotion { travelled: zero, velocity })?;
        Ok((forces, sunk))
    }

    /// The wheel as it is.
    fn true_wheel(&self) -> Wheel<S> {
        self.effects.wheel(&self.wheel).unwrap_or(self.wheel)
    }

    /// Slip of the true wheel where that of the nominal one is `slip`.
    fn true_slip(&self, velocity: S, spin: S, slip: f64) -> S {
        match self.effects.wheel(&self.wheel) {
            None => S::from(slip),
            Some(wheel) => contact::slip(velocity, wheel.radius * spin),
        }
    }

    /// The load that the soil carries where the carriage is set to `load`.
    fn true_load(&self, load: f64) -> S {
        self.effects.added_mass().map_or(S::from(load), |mass| mass * self.environment.gravity + load)
    }
}

impl<S: Scalar> Parameters<S> for Rig<S> {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
        self.environment.visit(prefix, f);
        self.wheel.visit(&join(prefix, "wheel"), f);
        self.soil.visit(&join(prefix, "soil"), f);
        self.effects.visit(prefix, f);
    }

    fn values(&self, f: &mut dyn FnMut(S)) {
        self.environment.values(f);
        self.wheel.values(f);
        self.soil.values(f);
        self.effects.values(f);
    }
}

/// The steady point where the soil carries `load` (N) at `slip` and `wheel_speed` (rad/s).
///
/// With a dual number the derivatives are exact: they follow from the balance N(z, p) = W by the implicit function
/// theorem, dz/dp = -(dN/dp) / (dN/dz). Second derivatives are not carried.
///
/// # Errors
/// [`SteadyError`] where the wheel sinks to its axle or the inputs contradict each other.
pub fn steady_point<S: Scalar>(
    rig: &Rig<S>,
    load: f64,
    slip: f64,
    wheel_speed: f64,
) -> Result<SteadyPoint<S>, SteadyError> {
    let spin = S::from(wheel_speed);
    let velocity = rig.wheel.radius * carriage_speed_over_radius(slip, wheel_speed)?;
    let (load, slip) = (rig.true_load(load), rig.true_slip(velocity, spin, slip));
    let real = rig.map(&|s| s.value());
    let (sinkage, by_sinkage) = balance(&real, load.value(), slip.value(), velocity.value(), wheel_speed)?;
    let (here, sunk) = rig.forces(S::from(sinkage), velocity, spin, slip)?;
    // The real part of this step is rounding; its derivatives are dz/dp.
    let step = -(here.normal - load) / by_sinkage.forces.normal;
    Ok(SteadyPoint {
        drawbar_pull: here.drawbar + step * by_sinkage.forces.drawbar,
        torque: here.torque + step * by_sinkage.forces.torque,
        sinkage: sunk + step * by_sinkage.sunk,
    })
}

/// Share of the load, 0 to 1, that the soil does not carry at a sinkage of one radius; 0 where there is no steady point for
/// another reason.
pub(crate) fn share_not_carried<S: Scalar>(rig: &Rig<S>, load: f64, slip: f64, wheel_speed: f64) -> S {
    let spin = S::from(wheel_speed);
    let Ok(speed) = carriage_speed_over_radius(slip, wheel_speed) else { return S::from(0.0) };
    let velocity = rig.wheel.radius * speed;
    let (load, slip) = (rig.true_load(load), rig.true_slip(velocity, spin, slip));
    let Ok((forces, _)) = rig.forces(rig.true_wheel().radius, velocity, spin, slip) else { return S::from(0.0) };
    let share = (load - forces.normal) / load;
    if (0.0..=1.0).contains(&share.value()) { share } else { S::from(if share.value() > 1.0 { 1.0 } else { 0.0 }) }
}

/// V/r from the slip i = 1 - V/(r omega) driving, i = r omega/V - 1 in skid.
fn carriage_speed_over_radius(slip: f64, wheel_speed: f64) -> Result<f64, SteadyError> {
    let locked = slip == -1.0 && wheel_speed == 0.0;
    if locked {
        // Any speed: the rim slides fully. One radius a second, forward.
        return Ok(1.0);
    }
    if slip == -1.0 || wheel_speed == 0.0 || !(-1.0..=1.0).contains(&slip) {
        return Err(SteadyError::Impossible { slip, wheel_speed });
    }
    Ok(if slip >= 0.0 { wheel_speed * (1.0 - slip) } else { wheel_speed / (1.0 + slip) })
}

/// Slopes in the sinkage of the wheel's outline.
struct BySinkage {
    forces: Forces,
    /// Of the sinkage of the soil.
    sunk: f64,
}

/// Sinkage of the wheel's outline at which the normal force is `load`, and the slopes in it there.
///
/// Newton's method on ln N over ln z (N is nearly a power of z), kept within a shrinking bracket.
fn balance(rig: &Rig, load: f64, slip: f64, velocity: f64, spin: f64) -> Result<(f64, BySinkage), SteadyError> {
    let lifted = rig.map(&Dual::<1>::from);
    let at = |z: f64| {
        lifted.forces(Dual::<1>::from(z).derivative(0), Dual::from(velocity), Dual::from(spin), Dual::from(slip))
    };
    let (mut low, mut high) = (0.0, rig.true_wheel().radius);
    let carried = rig.forces(high, velocity, spin, slip)?.0.normal;
    if carried.is_nan() || carried < load {
        return Err(SteadyError::SunkToAxle { load, slip, carried });
    }
    // N is about proportional to z^(n + 1/2) (4.18).
    let mut z = high * (load / carried).powf((rig.soil.exponent + 0.5).recip());
    for _ in 0..MAX_STEPS {
        let (forces, sunk) = at(z)?;
        let (normal, slope) = (forces.normal.re, partial(&forces.normal, 0));
        if (normal - load).abs() <= LOAD_TOLERANCE * load || (high - low) <= f64::EPSILON * high {
            let (drawbar, torque) = (partial(&forces.drawbar, 0), partial(&forces.torque, 0));
            return Ok((z, BySinkage { forces: Forces { normal: slope, drawbar, torque }, sunk: partial(&sunk, 0) }));
        }
        if normal < load {
            low = z
        } else {
            high = z
        }
        let next = z * ((load / normal).ln() * normal / (slope * z)).exp();
        z = if next > low && next < high { next } else { 0.5 * (low + high) };
    }
    Err(SteadyError::NotBalanced { load, slip })
}

/// The `k`-th partial derivative.
pub(crate) fn partial<const N: usize>(x: &Dual<N>, k: usize) -> f64 {
    x.eps.0.map_or(0.0, |all| all[k])
}
