//! What the data sheet of a vehicle says: its bodies, its joints and where its wheels sit.

use crate::scalar::{MapScalar, Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

/// Most generalised coordinates of a rover: three of the chassis and five passive joints.
pub const MAX_COORDINATES: usize = 8;

/// Most wheels of a rover.
pub const MAX_WHEELS: usize = 8;

parameters! {
    /// What surrounds the rover.
    pub struct Environment {
        /// Gravity along -z.
        gravity: [Unit::METRE_PER_SECOND2] = 9.81, 0.1..=30.0, Rig, "Earth 9.81, Mars 3.71, Moon 1.62; not stated in the thesis";
    }
}

parameters! {
    /// The chassis: everything of the rover that is not a link.
    pub struct Body {
        /// Mass, the wheels on the chassis included.
        mass: [Unit::KILOGRAM] = 10.0, 0.1..=5000.0, Rig, "Iagnemma 2001, 4.4.1";
        /// Moment of inertia about the centre of mass.
        pitch_inertia: [Unit::KILOGRAM_METRE2] = 0.6, 1e-4..=1e5, Rig, "assumption: a 10 kg box of 0.8 m x 0.2 m";
        /// Centre of mass along x, from the chassis reference point.
        centre_of_mass_x: [Unit::METRE] = 0.0, -5.0..=5.0, Rig, "assumption: midway between the wheels";
        /// Centre of mass along z, from the chassis reference point.
        centre_of_mass_z: [Unit::METRE] = 0.1, -5.0..=5.0, Rig, "assumption: not in the thesis";
        /// Height of the belly between the wheels, from the chassis reference point; touching ground ends a run.
        belly_z: [Unit::METRE] = -0.03, -5.0..=5.0, Rig, "assumption: 7 cm clearance";
    }
}

parameters! {
    /// Where a wheel sits, from the chassis reference point with all joints at zero.
    pub struct Mount {
        /// Wheel centre along x.
        x: [Unit::METRE] = 0.0, -10.0..=10.0, Rig, "vehicle drawing";
        /// Wheel centre along z.
        z: [Unit::METRE] = 0.0, -10.0..=10.0, Rig, "vehicle drawing";
    }
}

parameters! {
    /// A link on a passive joint; positions from the chassis reference point with all joints at zero.
    pub struct LinkParameters {
        /// Joint along x.
        x: [Unit::METRE] = 0.0, -10.0..=10.0, Rig, "vehicle drawing";
        /// Joint along z.
        z: [Unit::METRE] = 0.0, -10.0..=10.0, Rig, "vehicle drawing";
        /// Mass of the link, its wheels included.
        mass: [Unit::KILOGRAM] = 0.5, 0.01..=1000.0, Rig, "vehicle data";
        /// Moment of inertia of the link about its centre of mass.
        inertia: [Unit::KILOGRAM_METRE2] = 0.01, 1e-6..=1e4, Rig, "vehicle data";
        /// Centre of mass along x.
        centre_of_mass_x: [Unit::METRE] = 0.0, -10.0..=10.0, Rig, "vehicle drawing";
        /// Centre of mass along z.
        centre_of_mass_z: [Unit::METRE] = 0.0, -10.0..=10.0, Rig, "vehicle drawing";
        /// Viscous friction of the joint.
        damping: [Unit::NEWTON_METRE_SECOND] = 0.1, 0.0..=1e3, Fixed, "assumption: a plain bearing";
        /// Angle of the joint, to either side of zero, at which it meets its stop; pi is no stop.
        stop: [Unit::RADIAN] = std::f64::consts::PI, 0.0..=std::f64::consts::PI, Fixed, "vehicle drawing";
        /// Stiffness of the stops.
        stop_stiffness: [Unit::NEWTON_METRE_PER_RADIAN] = 100.0, 0.0..=1e6, Fixed, "assumption: the weight of a 6 kg rover bends it by less than 2 degrees";
    }
}

/// Time constant of a stop, s: its damping over its stiffness. A wheel of a 3 kg rover side does not bounce off it.
const STOP_TIME: f64 = 0.02;

/// A joint at its stop at one instant; all zero within the stops.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AtStop<S> {
    /// Moment on the link, nose up, N m.
    pub moment: S,
    /// Its slope against the angle, N m/rad, and against the rate, N m s/rad.
    pub stiffness: S,
    pub damping: S,
    /// Energy stored in the stop, J, and power that it takes for good, W.
    pub energy: S,
    pub loss: S,
}

#[lanes]
impl<S: Scalar> LinkParameters<S> {
    /// The stop as a spring and a damper that push and never pull: M = -k (a - stop) - d a' where the angle a exceeds the stop,
    /// and the mirror image on the other side.
    pub(crate) fn at_stop(&self, angle: S, rate: S) -> AtStop<S> {
        let zero = S::from(0.0);
        let negative = angle.under(0.0);
        let beyond = angle.abs() - self.stop;
        let outward = rate.negative_where(negative);
        let push = self.stop_stiffness * (beyond + outward * STOP_TIME);
        let pushes = beyond.over(0.0) & push.over(0.0);
        let push = S::select(pushes, push, zero);
        let stiffness = S::select(pushes, self.stop_stiffness, zero);
        let compressed = beyond.larger(zero);
        AtStop {
            moment: -push.negative_where(negative),
            stiffness,
            damping: stiffness * STOP_TIME,
            energy: self.stop_stiffness * compressed * compressed * 0.5,
            loss: (push - self.stop_stiffness * compressed) * outward,
        }
    }
}

/// A link and the body that carries its joint.
#[derive(Clone, Copy, Debug, PartialEq, MapScalar)]
pub struct Link<S = f64> {
    /// Body that carries the joint: 0 the chassis, k link k (of a lower number).
    pub parent: usize,
    /// Geometry, mass, friction.
    pub parameters: LinkParameters<S>,
}

/// A wheel's place and the body it sits on.
#[derive(Clone, Copy, Debug, PartialEq, MapScalar)]
pub struct WheelMount<S = f64> {
    /// 0 the chassis, k link k.
    pub body: usize,
    /// Place.
    pub mount: Mount<S>,
}
