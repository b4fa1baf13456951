//! Controllers: they see measurements and a reference, never the true state.
//!
//! | controller | what it does |
//! |---|---|
//! | [`Rtc`] | shares one body force out among the wheels (rough-terrain control, 4.2-4.3) |
//! | [`SpeedRtc`] | the same force distribution, turned into slips and wheel speeds by a model of the soil |
//! | [`VelocityController`] | holds every wheel's speed by itself (the usual rover control, 4.4.1), with given gains or with those of [`TunedVelocity`], which follow from the plant |
//! | [`EqualTorqueController`] | the same torque for all wheels, from the body's speed |
//! | [`SlipController`] | the same slip at all wheels; it receives the true slip ([`Privileged`]), which no rover measures |
//!
//! All know the rover only as [`Nominal`] describes it. Another crate adds its own, see [`registered`].

mod equal_torque;
mod error;
mod nominal;
mod posture;
pub mod registered;
pub mod rtc;
mod slip;
mod tuning;
mod velocity;

pub use equal_torque::{EqualTorque, EqualTorqueController};
pub use error::ControlError;
pub use nominal::{Nominal, NominalLink};
pub use posture::Posture;
pub use registered::{ControlLaw, History, RegisteredLaw};
pub use rtc::{
    Criterion, Footing, Outcome, RoughTerrainControl, Rtc, RtcOptions, Solver, SpeedRoughTerrainControl, SpeedRtc,
    Strength,
};
pub use slip::{Privileged, SlipControl, SlipController};
pub use tuning::{TunedVelocity, soil_slope};
pub use velocity::{VelocityControl, VelocityController};

use crate::signals::{Command, Measurement, Reference};

/// Turns measurements and a reference into a command, once a control period.
pub trait Controller {
    /// The command for the next control period; written into `command`, which gets one value a wheel,
    /// rear to front.
    ///
    /// # Errors
    /// [`ControlError`] where a reading that the law uses is not finite, the number of wheels is not the
    /// controller's, or the law has no finite answer. `command` and the controller's history are then as
    /// they were, so that a caller may hold the last command, and knows that it does.
    fn command(&mut self, measured: &Measurement, goal: &Reference, command: &mut Command) -> Result<(), ControlError>;

    /// Forgets all history.
    fn reset(&mut self);
}
