//! Missing physics: a library of effects, each a group of parameters with a neutral value.
//!
//! At its neutral value an effect changes nothing, bit for bit: its hooks return early. Switching one
//! on is setting its parameters, the same act in every door. Whatever concerns one effect stands in its
//! file: parameters, hooks ([`Effect`]), what it has for a memory, and what others need to know of it ([`Facts`]). A new
//! effect is one such file and one line in the table below. What the library lacks a user can add as an expression, see
//! [`custom`], or in Rust from another crate, see [`registered`].

mod bulldozing;
mod centre_of_mass;
mod coulomb_friction;
pub mod custom;
mod drag;
mod effect;
mod exit_angle;
mod facts;
mod flexible_wheel;
mod gear_efficiency;
mod grousers;
mod moisture;
mod multi_pass;
mod payload;
mod pitch_bias;
mod place;
mod radius_scale;
mod rate;
pub mod registered;
mod rim_adhesion;
mod rolling_resistance;
mod sensor_lag;
mod slip_sinkage;
mod slope_strength;
mod soft_patch;
mod suspension_friction;
mod table;
mod tether;
mod torque_scale;
mod tracking_delay;
mod viscous_friction;
mod voltage_limit;
mod winding_heat;

use crate::contact::Forces;
use crate::motor::{Drivetrain, Motor, TorqueRange};
use crate::scalar::{Scalar, lanes};
use crate::signals::{BodySignals, WheelSignals};
use crate::soil::Soil;
use crate::vehicle::Body;
use crate::wheel::Wheel;
use bekker_modeldescription::{Parameters, Variable, join};
use custom::CustomEffects;
use registered::RegisteredEffects;
use std::fmt;
use table::{effects, last_first};

pub use custom::{DefinitionError, EffectDefinition, ExpressionFailure};
pub use effect::Effect;
pub use facts::{Advice, Equipment, Facts, Header, Needs, SOIL_TEST};
pub use multi_pass::Track;
pub use place::{BodyMotion, Local, Place};
pub use registered::{RegisteredEffect, Registrable};
pub(crate) use sensor_lag::Lagged;
pub use sensor_lag::{Delayed, RecordingLag};
pub(crate) use slip_sinkage::Digging;
pub use winding_heat::Warming;

pub use crate::motor::Geared;

effects! {
    /// Slip-sinkage: a wheel sinks deeper with slip.
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
    /// Rolling resistance of the wheel itself: a moment that grows with its load.
    rolling_resistance: RollingResistance,
    /// Delay of the body's motion against the drives, as by another clock.
    tracking_delay: TrackingDelay,
}

impl<S: Scalar> Effects<S> {
    /// What there is to know of the effect `id`; nothing where it is unknown or given as an expression.
    #[must_use]
    pub fn facts_of(&self, id: &str) -> Option<Facts> {
        self.facts().find(|(known, _)| *known == id).map(|(_, facts)| facts)
    }
}

impl Effects {
    /// Adds an effect of the user's own, neutral; one that is there already, with the same definition, stays as it is.
    ///
    /// # Errors
    /// [`DefinitionError`] where the definition is refused or its id taken.
    pub fn add(&mut self, definition: EffectDefinition) -> Result<(), DefinitionError> {
        refuse_taken(&definition.id, self.registered.iter().map(RegisteredEffect::id), "a registered effect")?;
        self.custom.add(definition)
    }

    /// Registers the effect `G` of another crate, neutral, under `id`; see [`registered`]. The id is the first part of its
    /// parameters' names, so it must not be that of other names of a model, which
    /// [`Model::register_effect`](crate::model::Model::register_effect) makes sure of.
    ///
    /// # Errors
    /// [`DefinitionError`] where the id is no name or taken.
    pub fn register<G: Registrable>(&mut self, id: &str, about: &str) -> Result<(), DefinitionError> {
        custom::check_id(id)?;
        refuse_taken(id, self.custom.iter().map(custom::CustomEffect::id), "an effect that is given as an expression")?;
        self.registered.add::<G>(id, about)
    }

    /// Takes over, neutral or not, the effects that `other` has registered and this lacks.
    ///
    /// # Errors
    /// [`DefinitionError::Taken`] where another effect has the id of one of them.
    pub fn register_all_of(&mut self, other: &Self) -> Result<(), DefinitionError> {
        for effect in other.registered.iter() {
            refuse_taken(
                effect.id(),
                self.custom.iter().map(custom::CustomEffect::id),
                "an effect given as an expression",
            )?;
            self.registered.add_copy(effect)?;
        }
        Ok(())
    }

    /// Ids and meanings of the library's effects and of the user's own: what a diagnosis may try.
    #[must_use]
    pub fn list(&self) -> Vec<(String, String)> {
        let custom = self.custom.iter().map(|effect| (effect.id(), effect.definition().about.as_str()));
        let registered = self.registered.iter().map(|effect| (effect.id(), effect.about()));
        let all = EFFECTS.iter().copied().chain(custom).chain(registered);
        all.map(|(id, about)| (id.to_owned(), about.trim().to_owned())).collect()
    }
}

/// Refuses an id that the library has, or one of `others`, who are called `owner` then.
fn refuse_taken<'a>(id: &str, mut others: impl Iterator<Item = &'a str>, owner: &str) -> Result<(), DefinitionError> {
    let taken = |owner: &str| Err(DefinitionError::Taken { id: id.to_owned(), owner: owner.to_owned() });
    if EFFECTS.iter().any(|(known, _)| *known == id) {
        return taken("an effect of the library");
    }
    if others.any(|other| other == id) { taken(owner) } else { Ok(()) }
}
