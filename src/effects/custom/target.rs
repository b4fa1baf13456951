//! What an effect of the user's own acts on, and which signals its expression sees there.

use crate::effects::Local;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// How the value of the expression changes its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// The target is multiplied by the value; 1 is neutral.
    Factor,
    /// The value is added, in the target's unit; 0 is neutral.
    Add,
}

impl Mode {
    pub(super) fn neutral(self) -> f64 {
        match self {
            Self::Factor => 1.0,
            Self::Add => 0.0,
        }
    }
}

/// Where an expression is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Hook {
    /// Soil and wheel at a contact, before the stresses are integrated.
    Contact,
    /// Forces of a contact, after the stresses are integrated.
    Forces,
    /// Friction of a drive.
    Drive,
    /// Force on the chassis.
    Body,
}

/// A signal of a hook, with the range in which a definition is tried out.
type Signal = (&'static str, f64, f64);

const CONTACT: &[Signal] = &[
    ("wheel", 1.0, 8.0),
    ("x", -10.0, 10.0),
    ("contact_angle", -0.5, 0.5),
    ("slip", -1.0, 1.0),
    ("sinkage", 0.0, 0.05),
    ("normal_velocity", -0.1, 0.1),
    ("velocity", -0.5, 0.5),
];

const FORCES: &[Signal] = &[
    CONTACT[0],
    CONTACT[1],
    CONTACT[2],
    CONTACT[3],
    CONTACT[4],
    CONTACT[5],
    CONTACT[6],
    ("normal_force", 0.0, 500.0),
    ("drawbar_pull", -200.0, 200.0),
    ("torque", -50.0, 50.0),
];

const DRIVE: &[Signal] = &[("speed", -10.0, 10.0)];

const BODY: &[Signal] = &[("travelled", -20.0, 20.0), ("velocity", -0.5, 0.5)];

impl Hook {
    pub fn signals(self) -> &'static [Signal] {
        match self {
            Self::Contact => CONTACT,
            Self::Forces => FORCES,
            Self::Drive => DRIVE,
            Self::Body => BODY,
        }
    }
}

/// One thing that an effect can act on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    Cohesion,
    FrictionAngle,
    CohesiveModulus,
    FrictionalModulus,
    Exponent,
    ShearModulus,
    C1,
    C2,
    Damping,
    Radius,
    Width,
    NormalForce,
    DrawbarPull,
    Torque,
    DriveFriction,
    BodyForce,
}

/// Names of the targets.
pub(super) const TARGETS: &[(&str, Target)] = &[
    ("body.force_x", Target::BodyForce),
    ("contact.normal_force", Target::NormalForce),
    ("contact.drawbar_pull", Target::DrawbarPull),
    ("contact.torque", Target::Torque),
    ("drive.friction", Target::DriveFriction),
    ("soil.cohesion", Target::Cohesion),
    ("soil.friction_angle", Target::FrictionAngle),
    ("soil.k_c", Target::CohesiveModulus),
    ("soil.k_phi", Target::FrictionalModulus),
    ("soil.exponent", Target::Exponent),
    ("soil.shear_modulus", Target::ShearModulus),
    ("soil.c1", Target::C1),
    ("soil.c2", Target::C2),
    ("soil.damping", Target::Damping),
    ("wheel.radius", Target::Radius),
    ("wheel.width", Target::Width),
];

/// Values with which the contact has a meaning.
const POSITIVE: RangeInclusive<f64> = f64::MIN_POSITIVE..=f64::MAX;
const NOT_NEGATIVE: RangeInclusive<f64> = 0.0..=f64::MAX;

impl Target {
    pub fn hook(self) -> Hook {
        match self {
            Self::NormalForce | Self::DrawbarPull | Self::Torque => Hook::Forces,
            Self::DriveFriction => Hook::Drive,
            Self::BodyForce => Hook::Body,
            _ => Hook::Contact,
        }
    }

    /// Whether it is a parameter of soil or wheel, which a factor can change too.
    pub fn is_parameter(self) -> bool {
        self.hook() == Hook::Contact
    }

    /// The parameter of a contact that is meant, and the values that it may take.
    pub fn parameter<S: Scalar>(self, local: &mut Local<S>) -> Option<(&mut S, RangeInclusive<f64>)> {
        let (soil, wheel) = (&mut local.soil, &mut local.wheel);
        Some(match self {
            Self::Cohesion => (&mut soil.cohesion, NOT_NEGATIVE),
            Self::FrictionAngle => (&mut soil.friction_angle, 0.0..=1.5),
            Self::CohesiveModulus => (&mut soil.k_c, NOT_NEGATIVE),
            Self::FrictionalModulus => (&mut soil.k_phi, POSITIVE),
            Self::Exponent => (&mut soil.exponent, POSITIVE),
            Self::ShearModulus => (&mut soil.shear_modulus, POSITIVE),
            Self::C1 => (&mut soil.c1, f64::MIN..=f64::MAX),
            Self::C2 => (&mut soil.c2, f64::MIN..=f64::MAX),
            Self::Damping => (&mut soil.damping, NOT_NEGATIVE),
            Self::Radius => (&mut wheel.radius, POSITIVE),
            Self::Width => (&mut wheel.width, POSITIVE),
            Self::NormalForce | Self::DrawbarPull | Self::Torque | Self::DriveFriction | Self::BodyForce => {
                return None;
            }
        })
    }
}
