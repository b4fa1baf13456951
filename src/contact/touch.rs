//! The contact of a moving, turning or standing wheel, with what an implicit integrator needs of it.
//!
//! The stress integrals depend only on the direction of (V, r omega) and have no limit at standstill. So
//! the contact remembers the direction of its last motion as a vector `h = (travel, turn)` that follows
//! the unit vector of v = (V, r omega) over the soil's `hold_displacement` d:
//! h' = (v - h |v|)/d. In steady motion h is that unit vector and the forces are exactly those of the
//! stress integrals, at any speed. At standstill h stays: the contact pushes elastically against a small
//! displacement, up to the sliding friction, so a parked rover rests without creep. In between the forces
//! fade with |h| into those of a symmetric contact, which has a normal force and nothing else.
//!
//! The stresses are taken at e = (d h + t v)/(d + t |v|) with a time t: internal damping of the standing
//! contact, and above the speed d/t (5 cm/s) the direction of motion itself, without lag.

use super::flattened::{Flattening, flattened};
use super::rolling::{Forces, Rolling, norm, rolling_share, slip};
use super::surface::Surface;
use crate::scalar::{LaneAccess, MapScalar, Mask, Scalar, lanes, smooth_step};
use crate::snapshot::Moving;
use crate::soil::Soil;
use crate::wheel::Wheel;

/// Time t of the standing contact's internal damping, s: about half critical for a rover on its own
/// static friction, whose frequency is sqrt(g tan phi / d), near 100 rad/s.
const HOLD_DAMPING_TIME: f64 = 0.01;

/// Sinkage over which the normal damping builds up, m, so that it starts from zero at touch-down.
const DAMPING_DEPTH: f64 = 0.001;

/// Memory of a contact: the direction of its last motion, of length 0 (none) to 1.
#[derive(Clone, Copy, Debug, PartialEq, Moving, LaneAccess, MapScalar)]
pub struct Hold<S = f64> {
    /// Component of the wheel centre's motion along the ground, forward positive.
    pub travel: S,
    /// Component of the rim's motion, turning forward positive.
    pub turn: S,
}

impl<S: From<f64>> Default for Hold<S> {
    fn default() -> Self {
        Self { travel: S::from(0.0), turn: S::from(0.0) }
    }
}

#[lanes]
impl<S: Scalar> Hold<S> {
    /// The same direction with a length of at most 1.
    #[must_use]
    pub fn bounded(self) -> Self {
        let length = norm(self.travel, self.turn);
        let short = length.at_most(S::from(1.0));
        let length = S::select(short, S::from(1.0), length);
        let within = |x: S| S::select(short, x, x / length);
        Self { travel: within(self.travel), turn: within(self.turn) }
    }
}

/// Motion of a wheel relative to the ground at its contact foot.
#[derive(Clone, Copy, Debug)]
pub struct Motion<S = f64> {
    /// Sinkage of the wheel's undeformed outline along the normal, m.
    pub sinkage: S,
    /// Velocity of the wheel centre along the normal, m/s.
    pub normal_velocity: S,
    /// Velocity of the wheel centre along the tangent, m/s.
    pub velocity: S,
    /// Absolute rate of turning, forward positive, rad/s.
    pub spin: S,
    /// Memory of the contact.
    pub hold: Hold<S>,
}

#[lanes]
impl<S: Scalar> Motion<S> {
    /// Slip as far as it is established: that of the direction e, times its length. In motion this is the
    /// slip; at standstill, where slip is 0/0, it stays what the contact remembers, without noise.
    #[must_use]
    pub fn established_slip(&self, wheel: &Wheel<S>, soil: &Soil<S>) -> S {
        let rim_speed = wheel.radius * self.spin;
        let [travel, turn] = self.direction(rim_speed, norm(self.velocity, rim_speed), soil.hold_displacement).0;
        slip(travel, turn) * norm(travel, turn)
    }

    /// The direction e at which the stresses are taken, and 1/(d + t |v|).
    fn direction(&self, rim_speed: S, speed: S, distance: S) -> ([S; 2], S) {
        let scale = (distance + speed * HOLD_DAMPING_TIME).recip();
        let along = |hold: S, velocity: S| (distance * hold + velocity * HOLD_DAMPING_TIME) * scale;
        ([along(self.hold.travel, self.velocity), along(self.hold.turn, rim_speed)], scale)
    }
}

/// Partial derivatives of the contact, as far as they are stiff.
#[derive(Clone, Copy, Debug, Moving, LaneAccess)]
pub struct Slopes<S = f64> {
    /// Of the forces in the tangential velocity.
    pub velocity: Forces<S>,
    /// Of the forces in the spin.
    pub spin: Forces<S>,
    /// Of the forces in `hold.travel`.
    pub travel: Forces<S>,
    /// Of the forces in `hold.turn`.
    pub turn: Forces<S>,
    /// Of the normal force in the normal velocity.
    pub damping: S,
    /// Of the normal force in the sinkage.
    pub stiffness: S,
    /// Of the rates of (`hold.travel`, `hold.turn`) in the velocity.
    pub rate_by_velocity: [S; 2],
    /// Of the rates of (`hold.travel`, `hold.turn`) in the spin.
    pub rate_by_spin: [S; 2],
    /// Of each rate in its own component.
    pub rate_own: S,
}

/// Forces of a contact, the rates of its memory, and the slopes of both.
#[derive(Clone, Copy, Debug, Moving, LaneAccess)]
pub struct Touch<S = f64> {
    /// Forces on the wheel, at its centre.
    pub forces: Forces<S>,
    /// Sinkage of the soil, m; that of the undeformed outline less the deflection of the wheel.
    pub sinkage: S,
    /// Time derivative of [`Motion::hold`], 1/s.
    pub rate: Hold<S>,
    /// Partial derivatives.
    pub slopes: Slopes<S>,
}

impl<S> AsMut<Forces<S>> for Touch<S> {
    fn as_mut(&mut self) -> &mut Forces<S> {
        &mut self.forces
    }
}

/// Forces on a wheel in `motion` with this `surface` of its rim.
#[inline(never)]
#[lanes(entry)]
pub fn touch<S: Scalar>(wheel: &Wheel<S>, soil: &Soil<S>, surface: &Surface<S>, motion: &Motion<S>) -> Touch<S> {
    S::wide(|| {
        let distance = soil.hold_displacement;
        let (hold, rim_speed) = (motion.hold, wheel.radius * motion.spin);
        let speed = norm(motion.velocity, rim_speed);
        let moves = speed.over(0.0);
        let safe = S::select(moves, speed, S::from(1.0));
        let zero = S::from(0.0);
        let heading = [S::select(moves, motion.velocity / safe, zero), S::select(moves, rim_speed / safe, zero)];
        let per_distance = distance.recip();
        let rate = Hold {
            travel: (motion.velocity - hold.travel * speed) * per_distance,
            turn: (rim_speed - hold.turn * speed) * per_distance,
        };
        let by = |component: S, own: f64, along: S| (S::from(own) - component * along) * per_distance;
        let mut slopes = Slopes {
            rate_by_velocity: [by(hold.travel, 1.0, heading[0]), by(hold.turn, 0.0, heading[0])],
            rate_by_spin: [
                by(hold.travel, 0.0, heading[1]) * wheel.radius,
                by(hold.turn, 1.0, heading[1]) * wheel.radius,
            ],
            rate_own: -(speed * per_distance),
            ..Slopes::zero()
        };
        let touches = motion.sinkage.over(0.0);
        let none = Touch { forces: Forces::zero(), sinkage: motion.sinkage, rate, slopes };
        if !touches.any() {
            return none;
        }
        let ([travel, turn], scale) = motion.direction(rim_speed, speed, distance);
        let (direction, sinkage) = at_direction(wheel, soil, surface, motion.sinkage, travel, turn);
        slopes.follow(&direction, [travel, turn], heading, (distance * scale, scale * HOLD_DAMPING_TIME), wheel.radius);
        let mut touch = Touch { forces: direction.forces, sinkage, rate, slopes };
        add_damping(&mut touch, soil, surface, motion);
        if touches.all() {
            return touch;
        }
        touch.forces = Forces::select(touches, touch.forces, none.forces);
        touch.sinkage = S::select(touches, touch.sinkage, none.sinkage);
        touch.slopes = touch.slopes.select(touches, &none.slopes);
        touch
    })
}

/// Forces at the direction (travel, turn) of length at most 1, with their slopes in both components
/// (the slope in the spin standing for that in `turn`), and the sinkage of the soil where the undeformed outline sinks by
/// `outline`.
#[lanes]
fn at_direction<S: Scalar>(
    wheel: &Wheel<S>,
    soil: &Soil<S>,
    surface: &Surface<S>,
    outline: S,
    travel: S,
    turn: S,
) -> (Rolling<S>, S) {
    let (length, spin) = (norm(travel, turn), turn / wheel.radius);
    let flat = flattened(&Flattening { wheel, soil, surface, outline, velocity: travel, spin, share: length });
    let (rim, sinkage) = flat.as_ref().map_or((surface, outline), |flat| (&flat.surface, flat.sinkage));
    let (rolling, pressure) = rolling_share(wheel, soil, rim, sinkage, travel, spin, length);
    let symmetric = Forces { normal: pressure, drawbar: S::from(0.0), torque: S::from(0.0) };
    let excess = rolling.forces.plus(symmetric.scaled(S::from(-1.0)));
    let is_there = length.over(0.0);
    let safe = S::select(is_there, length, S::from(1.0));
    let along = |component: S| S::select(is_there, component / safe, S::from(0.0));
    let mut direction = Rolling {
        forces: symmetric.plus(excess.scaled(length)),
        by_velocity: rolling.by_velocity.scaled(length).plus(excess.scaled(along(travel))),
        by_spin: rolling.by_spin.scaled(length / wheel.radius).plus(excess.scaled(along(turn))),
    };
    if let Some(flat) = &flat {
        flat.follow(&mut direction);
    }
    if !surface.resistance.is_exactly(0.0) {
        let (resistance, slope) = surface.against_travel(travel);
        direction.forces.drawbar -= resistance;
        direction.by_velocity.drawbar -= slope;
    }
    if surface.leads() {
        let own = surface.resisting(direction.forces.normal, turn);
        direction.by_velocity.torque += direction.by_velocity.normal * own.by_normal;
        direction.by_spin.torque += direction.by_spin.normal * own.by_normal + own.by_turn;
        direction.forces.torque += own.moment;
    }
    (direction, sinkage)
}

#[lanes]
impl<S: Scalar> Slopes<S> {
    fn zero() -> Self {
        let (zero, none) = (S::from(0.0), Forces::zero());
        Self {
            velocity: none,
            spin: none,
            travel: none,
            turn: none,
            damping: zero,
            stiffness: zero,
            rate_by_velocity: [zero; 2],
            rate_by_spin: [zero; 2],
            rate_own: zero,
        }
    }

    /// Of those with forces, `self` where the mask says so; both have the same rates.
    fn select(self, mask: S::Mask, none: &Self) -> Self {
        Self {
            velocity: Forces::select(mask, self.velocity, none.velocity),
            spin: Forces::select(mask, self.spin, none.spin),
            travel: Forces::select(mask, self.travel, none.travel),
            turn: Forces::select(mask, self.turn, none.turn),
            damping: S::select(mask, self.damping, none.damping),
            stiffness: S::select(mask, self.stiffness, none.stiffness),
            ..self
        }
    }

    /// Chain rule from the direction e to the memory h and the motion v: de = (d dh + t (dv - e d|v|))/(d + t |v|).
    fn follow(&mut self, at: &Rolling<S>, direction: [S; 2], heading: [S; 2], (by_hold, by_motion): (S, S), radius: S) {
        self.travel = at.by_velocity.scaled(by_hold);
        self.turn = at.by_spin.scaled(by_hold);
        let chain = |own: [f64; 2], along: S| {
            at.by_velocity
                .scaled((S::from(own[0]) - direction[0] * along) * by_motion)
                .plus(at.by_spin.scaled((S::from(own[1]) - direction[1] * along) * by_motion))
        };
        self.velocity = chain([1.0, 0.0], heading[0]);
        self.spin = chain([0.0, 1.0], heading[1]).scaled(radius);
    }
}

/// Damping along the normal, which never makes the normal force negative.
#[lanes]
fn add_damping<S: Scalar>(touch: &mut Touch<S>, soil: &Soil<S>, surface: &Surface<S>, motion: &Motion<S>) {
    let coefficient = soil.damping * smooth_step(touch.sinkage / DAMPING_DEPTH);
    let carried = touch.forces.normal.larger(S::from(0.0));
    // Near n + 1/2, the power of Bekker's own approximation (4.18); only the integrator uses it, which keeps its order with any stiffness.
    // What effects add to the dependence on the sinkage (Reece's slip-sinkage) is left out.
    touch.slopes.stiffness = (soil.exponent + 0.5) * carried / touch.sinkage;
    if !surface.compliance.is_exactly(0.0) {
        // The soil's spring with the power n, that of the arc with 1/2 (of a = 1, b = 0), and the wheel's own in line with the first.
        let by_sinkage = soil.exponent * carried / touch.sinkage;
        let by_outline = carried / (motion.sinkage * 2.0);
        touch.slopes.stiffness = (by_sinkage + by_outline) / (surface.compliance * by_sinkage + 1.0);
    }
    let normal = touch.forces.normal - coefficient * motion.normal_velocity;
    let presses = normal.over(0.0);
    touch.forces.normal = S::select(presses, normal, S::from(0.0));
    touch.slopes.damping = S::select(presses, -coefficient, touch.slopes.damping);
}
