//! What the data sheet of a vehicle says: its bodies, its joints and where its wheels sit.

use crate::scalar::MapScalar;
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
