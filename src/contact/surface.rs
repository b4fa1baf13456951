//! What distinguishes a real rim from a smooth, rigid and perfectly rough one.

use crate::scalar::{MapScalar, Scalar, lanes};
use crate::wheel::Wheel;
use std::f64::consts::FRAC_PI_2;

/// Share of the motion that is travel over which the resistance of the soil ahead turns with the travel's direction. A
/// wheel that spins on the spot pushes nothing; at a slip of 0.9 it meets 0.84 of the resistance, without slip 0.9999.
const TURNING_TRAVEL: f64 = 0.1;

/// Share of the motion that is the rim's over which the lead of the normal force turns with the rim. A wheel that rolls
/// without slip, whose rim has 0.71 of the motion, has 0.999 of the lead.
const TURNING_RIM: f64 = 0.03;

/// How a rim meets the soil, beyond radius and width. The default is the smooth rigid rim of Wong and Reece, on
/// which soil shears on soil.
#[derive(Clone, Copy, Debug, PartialEq, MapScalar)]
pub struct Surface<S = f64> {
    /// lambda of the exit angle theta_2 = -acos(1 - lambda z/r); 0 ends the contact at the bottom of the wheel.
    pub exit_ratio: S,
    /// Radius of the arc in contact over the wheel's radius: above 1 on a wheel that flattens. The rim moves over the
    /// arc at r omega.
    pub arc: S,
    /// Arm at which the shear turns the axle, over the wheel's radius.
    pub arm: S,
    /// Radial compliance C of the wheel, m/N: it flattens by C N under the normal force N, and arc and arm grow with it. The
    /// sinkage of the contact is then that of the undeformed outline.
    pub compliance: S,
    /// Share of the arc's growth by the compliance that the arm has, too.
    pub arm_share: S,
    /// a in the growth 1 + a f/z + b f/r of the arc by a deflection f at the soil's sinkage z.
    pub arc_by_sinkage: S,
    /// b in that growth.
    pub arc_by_load: S,
    /// Radius at which the soil is sheared over that of the arc: above 1 where lugs hold soil between them.
    pub shear_radius: S,
    /// Factor on the cohesion in the shear along the rim.
    pub cohesion_gain: S,
    /// Factor on tan phi in the shear along the rim.
    pub friction_gain: S,
    /// The most shear that the rim transmits, over the soil's strength; 1 on a rim as rough as the soil.
    pub grip: S,
    /// Rounding w of the corner in which the shear meets that limit; 0 is sharp, the smaller of both. With b the share of
    /// its strength that the soil has built up and g the grip, tau over the strength is b (1 + (b/g)^(1/w) - b^(1/w))^(-w):
    /// b where little is built up and g where all is.
    pub rounding: S,
    /// Force of the soil ahead against the wheel's motion, along the ground, N.
    pub resistance: S,
    /// Distance by which the normal force leads the axle in the direction in which the wheel turns, m: the moment of the
    /// load against the turning is this distance times the load.
    pub lead: S,
    /// What the root of the load adds to that distance, m/N^0.5.
    pub lead_by_root: S,
}

/// The moment by which a wheel itself resists its turning.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resisting<S> {
    /// The moment, N m.
    pub(super) moment: S,
    /// Its slope in the normal force, m.
    pub(super) by_normal: S,
    /// Its slope in the rim's component of the direction of motion, N m.
    pub(super) by_turn: S,
}

#[lanes]
impl<S: From<f64>> Default for Surface<S> {
    fn default() -> Self {
        let (zero, one) = (|| S::from(0.0), || S::from(1.0));
        Self {
            exit_ratio: zero(),
            arc: one(),
            arm: one(),
            compliance: zero(),
            arm_share: zero(),
            arc_by_sinkage: one(),
            arc_by_load: zero(),
            shear_radius: one(),
            cohesion_gain: one(),
            friction_gain: one(),
            grip: one(),
            rounding: zero(),
            resistance: zero(),
            lead: zero(),
            lead_by_root: zero(),
        }
    }
}

impl<S: Scalar> Surface<S> {
    /// A smooth rigid rim with this exit ratio.
    #[must_use]
    pub fn smooth(exit_ratio: S) -> Self {
        Self { exit_ratio, ..Self::default() }
    }

    /// The same rim on `wheel` with lugs of `height` (m), sheared at the share `share` of their height (Ding et al. 2011), whose
    /// sides add to the strength: c (1 + 2 h/b) and tan phi (1 + 0.64 (h/b) acot(h/b)) (Bekker 1956).
    #[must_use]
    pub fn with_lugs(mut self, wheel: &Wheel<S>, height: S, share: S) -> Self {
        let slenderness = height / wheel.width;
        let acot = -slenderness.arc_tangent() + FRAC_PI_2;
        self.shear_radius *= share * height / wheel.radius + 1.0;
        self.cohesion_gain *= slenderness * 2.0 + 1.0;
        self.friction_gain *= slenderness * acot * 0.64 + 1.0;
        self
    }

    /// The resistance of the soil ahead at the component `travel` t of the direction of motion, and its slope in it: R t/(t^4 + w^4)^(1/4)
    /// with w = [`TURNING_TRAVEL`].
    pub(super) fn against_travel(&self, travel: S) -> (S, S) {
        const FOURTH: f64 = TURNING_TRAVEL * TURNING_TRAVEL * TURNING_TRAVEL * TURNING_TRAVEL;
        let squared = travel * travel;
        let sum = squared * squared + FOURTH;
        let norm = sum.sqrt().sqrt();
        (self.resistance * travel / norm, self.resistance * FOURTH / (sum * norm))
    }

    /// Whether the normal force leads the axle at all.
    pub(super) fn leads(&self) -> bool {
        !(self.lead.is_exactly(0.0) && self.lead_by_root.is_exactly(0.0))
    }

    /// The moment against the turning under the normal force `normal` at the component `turn` of the direction of motion.
    pub(super) fn resisting(&self, normal: S, turn: S) -> Resisting<S> {
        let squared = turn * turn + TURNING_RIM * TURNING_RIM;
        let norm = squared.sqrt();
        let presses = normal.over(0.0);
        let root = S::select(presses, S::select(presses, normal, S::from(1.0)).sqrt(), S::from(0.0));
        let grown = self.lead_by_root * root;
        let lead = self.lead + grown;
        Resisting {
            moment: normal * (lead * turn / norm),
            by_normal: (lead + grown * 0.5) * turn / norm,
            by_turn: normal * (lead * (TURNING_RIM * TURNING_RIM) / (squared * norm)),
        }
    }
}
