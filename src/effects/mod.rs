//! Missing physics: a library of effects, each a group of parameters with a neutral value.
//!
//! At its neutral value an effect changes nothing, bit for bit: its hooks return early. Switching one
//! on is setting its parameters, the same act in every door. A new effect is one file and one line in
//! the table below.

mod bulldozing;
mod drag;
mod drive_friction;
mod exit_angle;
mod flexible_wheel;
mod grousers;
mod local_strength;
mod multi_pass;
mod rate;
mod rim_adhesion;
mod slip_sinkage;
mod voltage_limit;

use crate::contact::{Forces, Surface};
use crate::motor::Motor;
use crate::scalar::Scalar;
use crate::soil::Soil;
use crate::wheel::Wheel;
use bekker_modeldescription::{Parameters, Variable, join};

pub use bulldozing::Bulldozing;
pub use drag::{Drag, Tether};
pub use drive_friction::{CoulombFriction, ViscousFriction};
pub use exit_angle::ExitAngle;
pub use flexible_wheel::FlexibleWheel;
pub use grousers::Grousers;
pub use local_strength::{Moisture, SlopeStrength, SoftPatch};
pub use multi_pass::MultiPass;
pub use rate::Rate;
pub use rim_adhesion::RimAdhesion;
pub use slip_sinkage::SlipSinkage;
pub use voltage_limit::VoltageLimit;

/// Where and how a wheel touches the ground.
#[derive(Clone, Copy, Debug)]
pub struct Place<S = f64> {
    /// Wheel, 0 at the rear.
    pub wheel: usize,
    /// Position of the contact foot along x, m; none on a carriage, whose ground is the same everywhere.
    pub x: Option<S>,
    /// Wheels that have passed this ground, see [`crate::rover::Track`]; 0 where no effect remembers.
    pub passes: S,
    /// Contact angle, uphill positive, rad.
    pub contact_angle: S,
    /// Slip as far as it is established, see [`crate::contact::Motion::established_slip`].
    pub slip: S,
    /// Sinkage of the wheel's undeformed outline, m.
    pub sinkage: S,
    /// Velocity of the wheel centre along the normal, m/s.
    pub normal_velocity: S,
    /// Velocity of the wheel centre along the tangent, m/s.
    pub velocity: S,
}

/// Wheel and soil as one contact sees them; effects may change them.
#[derive(Clone, Copy, Debug)]
pub struct Local<S = f64> {
    /// The wheel.
    pub wheel: Wheel<S>,
    /// The soil under it.
    pub soil: Soil<S>,
    /// How the rim meets the soil.
    pub surface: Surface<S>,
    /// Deflection of the wheel along the normal, m: what the outline sinks deeper than the soil.
    pub deflection: S,
}

impl<S: Scalar> Local<S> {
    /// A smooth rigid wheel.
    #[must_use]
    pub fn new(wheel: Wheel<S>, soil: Soil<S>) -> Self {
        Self { wheel, soil, surface: Surface::default(), deflection: S::from(0.0) }
    }
}

/// Motion of the chassis reference point.
#[derive(Clone, Copy, Debug)]
pub struct BodyMotion<S = f64> {
    /// Position along x since the start, m.
    pub travelled: S,
    /// Velocity along x, m/s.
    pub velocity: S,
}

/// Hooks of an effect into the simulation; the defaults change nothing.
pub trait Effect<S: Scalar>: Parameters<S> {
    /// Changes wheel and soil at a contact, before the stresses are integrated.
    fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        let _ = (place, local);
    }

    /// Changes how the rim meets the soil, after all effects have changed wheel and soil.
    fn surface(&self, place: &Place<S>, local: &mut Local<S>) {
        let _ = (place, local);
    }

    /// Whether the effect needs to know which ground has been passed.
    fn remembers(&self) -> bool {
        false
    }

    /// Changes the forces of a contact, after the stresses are integrated.
    fn forces(&self, place: &Place<S>, local: &Local<S>, forces: &mut Forces<S>) {
        let _ = (place, local, forces);
    }

    /// Friction torque of a drive at this wheel speed, wheel side, and its slope in the speed.
    fn drive_friction(&self, speed: S) -> Option<(S, S)> {
        let _ = speed;
        None
    }

    /// Limits the torque of a motor, wheel side, at this wheel speed; where it limits, the slope in the speed.
    fn motor_torque(&self, motor: &Motor<S>, speed: S, torque: &mut S) -> Option<S> {
        let _ = (motor, speed, torque);
        None
    }

    /// Horizontal force on the chassis at its reference point, N.
    fn body_force(&self, motion: &BodyMotion<S>) -> Option<S> {
        let _ = motion;
        None
    }
}

/// Declares the library: one line an effect.
macro_rules! effects {
    ($($(#[doc = $doc:literal])+ $id:ident: $group:ident,)*) => {
        /// The library of effects. All are present in every rover and neutral by default.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Effects<S = f64> {
            $($(#[doc = $doc])+ pub $id: $group<S>,)*
        }

        impl<S: From<f64>> Default for Effects<S> {
            fn default() -> Self {
                Self { $($id: $group::default(),)* }
            }
        }

        impl<S: Copy> Effects<S> {
            /// The same effects over another scalar.
            #[must_use]
            pub fn map<T>(&self, f: &dyn Fn(S) -> T) -> Effects<T> {
                Effects { $($id: self.$id.map(f),)* }
            }
        }

        impl<S: Scalar> Parameters<S> for Effects<S> {
            fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
                $(self.$id.visit(&join(prefix, stringify!($id)), f);)*
            }

            fn values(&self, f: &mut dyn FnMut(S)) {
                $(self.$id.values(f);)*
            }
        }

        /// Ids and meanings of all effects, in the library's order.
        pub const EFFECTS: &[(&str, &str)] = &[$((stringify!($id), concat!($($doc),+)),)*];

        /// Sums of the hooks over the library.
        impl<S: Scalar> Effects<S> {
            /// What a contact sees of wheel, soil and rim.
            pub(crate) fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
                $(self.$id.contact(place, local);)*
                $(self.$id.surface(place, local);)*
            }

            /// Whether an effect needs to know which ground has been passed.
            pub(crate) fn remember(&self) -> bool {
                false $(|| self.$id.remembers())*
            }

            pub(crate) fn forces(&self, place: &Place<S>, local: &Local<S>, forces: &mut Forces<S>) {
                $(self.$id.forces(place, local, forces);)*
            }

            /// Friction torque of a drive and its slope in the wheel speed.
            pub(crate) fn drive_friction(&self, speed: S) -> (S, S) {
                let mut sum = (S::from(0.0), S::from(0.0));
                $(if let Some((torque, slope)) = self.$id.drive_friction(speed) {
                    sum.0 += torque;
                    sum.1 += slope;
                })*
                sum
            }

            /// Limits `torque`; returns the slope in the wheel speed of the limit that binds, 0 where none does.
            pub(crate) fn motor_torque(&self, motor: &Motor<S>, speed: S, torque: &mut S) -> S {
                let mut slope = S::from(0.0);
                $(if let Some(limited) = self.$id.motor_torque(motor, speed, torque) {
                    slope = limited;
                })*
                slope
            }

            pub(crate) fn body_force(&self, motion: &BodyMotion<S>) -> S {
                let mut sum = S::from(0.0);
                $(if let Some(force) = self.$id.body_force(motion) {
                    sum += force;
                })*
                sum
            }
        }
    };
}

effects! {
    /// Slip-sinkage: the sinkage exponent grows with slip.
    slip_sinkage: SlipSinkage,
    /// Exit angle: the soil rebounds behind the wheel.
    exit_angle: ExitAngle,
    /// Multi-pass: wheels compact the ground for those that follow.
    multi_pass: MultiPass,
    /// Grousers: lugs shear the soil at a larger radius.
    grousers: Grousers,
    /// Bulldozing: the wheel pushes soil ahead.
    bulldozing: Bulldozing,
    /// Flexible wheel: it flattens under its load.
    flexible_wheel: FlexibleWheel,
    /// Rate: the soil resists fast penetration more.
    rate: Rate,
    /// Moisture: the cohesion grows with the water content that each run records.
    moisture: Moisture,
    /// Soft patch: weaker ground around one place.
    soft_patch: SoftPatch,
    /// Slope-dependent strength: the friction angle falls with the slope.
    slope_strength: SlopeStrength,
    /// Dry friction of the drive.
    coulomb_friction: CoulombFriction,
    /// Viscous friction of the drive.
    viscous_friction: ViscousFriction,
    /// Back-EMF against a limited supply voltage.
    voltage_limit: VoltageLimit,
    /// Constant resistance at the chassis.
    drag: Drag,
    /// Resistance growing with the distance travelled.
    tether: Tether,
    /// Adhesion at the rim: it transmits less shear than the soil bears.
    rim_adhesion: RimAdhesion,
}
