//! Missing physics: a library of effects, each a group of parameters with a neutral value.
//!
//! At its neutral value an effect changes nothing, bit for bit: its hooks return early. Switching one
//! on is setting its parameters, the same act in every door. A new effect is one file and one line in
//! the table below. What the library lacks a user can add as an expression, see [`custom`].

mod bulldozing;
pub mod custom;
mod drag;
mod drive_friction;
mod effect;
mod exit_angle;
mod flexible_wheel;
mod gear_efficiency;
mod grousers;
mod local_strength;
mod multi_pass;
mod radius_scale;
mod rate;
mod rim_adhesion;
mod sensors;
mod slip_sinkage;
mod suspension_friction;
mod torque_scale;
mod unmodelled_mass;
mod voltage_limit;
mod winding_heat;

use crate::contact::Forces;
use crate::motor::Motor;
use crate::rover::Body;
use crate::scalar::Scalar;
use crate::signals::{BodySignals, WheelSignals};
use crate::wheel::Wheel;
use bekker_modeldescription::{Parameters, Variable, join};
use custom::CustomEffects;

pub use bulldozing::Bulldozing;
pub use custom::{DefinitionError, EffectDefinition, ExpressionFailure};
pub use drag::{Drag, Tether};
pub use drive_friction::{CoulombFriction, ViscousFriction};
pub use effect::{BodyMotion, Effect, Geared, Local, Place};
pub use exit_angle::ExitAngle;
pub use flexible_wheel::FlexibleWheel;
pub use gear_efficiency::GearEfficiency;
pub use grousers::Grousers;
pub use local_strength::{Moisture, SlopeStrength, SoftPatch};
pub use multi_pass::MultiPass;
pub use radius_scale::RadiusScale;
pub use rate::Rate;
pub use rim_adhesion::RimAdhesion;
pub use sensors::{PitchBias, SensorLag};
pub use slip_sinkage::SlipSinkage;
pub use suspension_friction::SuspensionFriction;
pub use torque_scale::TorqueScale;
pub use unmodelled_mass::{CentreOfMass, Payload};
pub use voltage_limit::VoltageLimit;
pub use winding_heat::WindingHeat;

/// Declares the library: one line an effect.
macro_rules! effects {
    ($($(#[doc = $doc:literal])+ $id:ident: $group:ident,)*) => {
        /// The library of effects. All are present in every rover and neutral by default.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Effects<S = f64> {
            $($(#[doc = $doc])+ pub $id: $group<S>,)*
            /// The user's own, after those of the library.
            pub custom: CustomEffects<S>,
        }

        impl<S: From<f64>> Default for Effects<S> {
            fn default() -> Self {
                Self { $($id: $group::default(),)* custom: CustomEffects::default() }
            }
        }

        impl<S: Copy> Effects<S> {
            /// The same effects over another scalar.
            #[must_use]
            pub fn map<T>(&self, f: &dyn Fn(S) -> T) -> Effects<T> {
                Effects { $($id: self.$id.map(f),)* custom: self.custom.map(f) }
            }
        }

        impl<S: Scalar> Parameters<S> for Effects<S> {
            fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
                $(self.$id.visit(&join(prefix, stringify!($id)), f);)*
                self.custom.visit(prefix, f);
            }

            fn values(&self, f: &mut dyn FnMut(S)) {
                $(self.$id.values(f);)*
                self.custom.values(f);
            }
        }

        /// Ids and meanings of all effects, in the library's order.
        pub const EFFECTS: &[(&str, &str)] = &[$((stringify!($id), concat!($($doc),+)),)*];

        /// Sums of the hooks over the library and the user's own effects.
        impl<S: Scalar> Effects<S> {
            /// What a contact sees of wheel, soil and rim.
            #[cfg_attr(feature = "batch", inline(always))]
            pub(crate) fn contact(&self, place: &Place<S>, local: &mut Local<S>) -> Result<(), ExpressionFailure> {
                $(self.$id.contact(place, local);)*
                self.custom.contact(place, local)?;
                $(self.$id.surface(place, local);)*
                Ok(())
            }

            /// Whether an effect needs to know which ground has been passed.
            #[cfg_attr(feature = "batch", inline(always))]
            pub(crate) fn remember(&self) -> bool {
                false $(|| self.$id.remembers())*
            }

            #[cfg_attr(feature = "batch", inline(always))]
            pub(crate) fn forces(
                &self,
                place: &Place<S>,
                local: &Local<S>,
                forces: &mut Forces<S>,
            ) -> Result<(), ExpressionFailure> {
                $(self.$id.forces(place, local, forces);)*
                self.custom.forces(place, forces)
            }

            #[cfg_attr(feature = "batch", inline(always))]
            pub(crate) fn wheel(&self, wheel: &mut Wheel<S>) {
                $(self.$id.wheel(wheel);)*
            }

            #[cfg_attr(feature = "batch", inline(always))]
            pub(crate) fn recorded_radius(&self, mut radius: S) -> S {
                $(self.$id.recorded_radius(&mut radius);)*
                radius
            }

            #[cfg_attr(feature = "batch", inline(always))]
            pub(crate) fn chassis(&self, body: &mut Body<S>) {
                $(self.$id.chassis(body);)*
            }

            #[cfg_attr(feature = "batch", inline(always))]
            pub(crate) fn motor(&self, winding_rise: S, motor: &mut Motor<S>) {
                $(self.$id.motor(winding_rise, motor);)*
            }

            /// Product of the gains; `None` where there is none.
            #[cfg_attr(feature = "batch", inline(always))]
            pub(crate) fn torque_gain(&self) -> Option<S> {
                let mut product: Option<S> = None;
                $(if let Some(gain) = self.$id.torque_gain() {
                    product = Some(product.map_or(gain, |before| before * gain));
                })*
                product
            }

            #[cfg_attr(feature = "batch", inline(always))]
            pub(crate) fn joint_friction(&self, rate: S) -> S {
                let mut sum = S::from(0.0);
                $(if let Some(coefficient) = self.$id.joint_friction(rate) {
                    sum += coefficient;
                })*
                sum
            }

            pub(crate) fn record(&self, start_x: S, body: &mut BodySignals<S>, wheels: &mut [WheelSignals<S>]) {
                $(self.$id.record(start_x, body, wheels);)*
            }

            /// Friction torque of a drive and its slope in the wheel speed.
            #[cfg_attr(feature = "batch", inline(always))]
            pub(crate) fn drive_friction(&self, speed: S) -> Result<(S, S), ExpressionFailure> {
                let mut sum = self.custom.drive_friction(speed)?;
                $(if let Some((torque, slope)) = self.$id.drive_friction(speed) {
                    sum.0 += torque;
                    sum.1 += slope;
                })*
                Ok(sum)
            }

            /// Limits `torque`; returns the slope in the wheel speed of the limit that binds, 0 where none does.
            #[cfg_attr(feature = "batch", inline(always))]
            pub(crate) fn motor_torque(&self, motor: &Motor<S>, speed: S, torque: &mut S) -> S {
                let mut slope = S::from(0.0);
                $(if let Some(limited) = self.$id.motor_torque(motor, speed, torque) {
                    slope = limited;
                })*
                slope
            }

            #[cfg_attr(feature = "batch", inline(always))]
            pub(crate) fn body_force(&self, motion: &BodyMotion<S>) -> Result<S, ExpressionFailure> {
                let mut sum = self.custom.body_force(motion)?;
                $(if let Some(force) = self.$id.body_force(motion) {
                    sum += force;
                })*
                Ok(sum)
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
    /// Efficiency of the gear: losses grow with the power that passes it.
    gear_efficiency: GearEfficiency,
    /// A torque constant or current gain that is not that of the data sheet.
    torque_scale: TorqueScale,
    /// Windings that warm up: more resistance, less torque an ampere.
    winding_heat: WindingHeat,
    /// Back-EMF against a limited supply voltage.
    voltage_limit: VoltageLimit,
    /// A wheel radius that is not the nominal one, and the scale of the odometry.
    radius_scale: RadiusScale,
    /// Unmodelled mass at the chassis' centre of mass.
    payload: Payload,
    /// The chassis' centre of mass shifted along x.
    centre_of_mass: CentreOfMass,
    /// A constant error of the recorded pitch.
    pitch_bias: PitchBias,
    /// Constant resistance at the chassis.
    drag: Drag,
    /// Resistance growing with the distance travelled.
    tether: Tether,
    /// Lag and dead time of what is recorded.
    sensor_lag: SensorLag,
    /// Dry friction of the passive joints.
    suspension_friction: SuspensionFriction,
    /// Adhesion at the rim: it transmits less shear than the soil bears.
    rim_adhesion: RimAdhesion,
}

impl Effects {
    /// Adds an effect of the user's own, neutral; one that is there already, with the same definition, stays as it is.
    ///
    /// # Errors
    /// [`DefinitionError`] where the definition is refused or its id taken.
    pub fn add(&mut self, definition: EffectDefinition) -> Result<(), DefinitionError> {
        if EFFECTS.iter().any(|(id, _)| *id == definition.id) {
            let owner = "an effect of the library".to_owned();
            return Err(DefinitionError::Taken { id: definition.id, owner });
        }
        self.custom.add(definition)
    }

    /// Ids and meanings of the library's effects and of the user's own: what a diagnosis may try.
    #[must_use]
    pub fn list(&self) -> Vec<(String, String)> {
        let own = self.custom.iter().map(|effect| (effect.id(), effect.definition().about.as_str()));
        EFFECTS.iter().copied().chain(own).map(|(id, about)| (id.to_owned(), about.trim().to_owned())).collect()
    }
}
