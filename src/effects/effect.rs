//! What an effect is: parameters, hooks into the simulation, and facts about it.

use super::facts::Facts;
use super::place::{BodyMotion, Local, Place};
use super::sensor_lag::RecordingLag;
use super::winding_heat::Warming;
use crate::contact::Forces;
use crate::motor::{Geared, Motor, TorqueRange};
use crate::scalar::{Scalar, lanes};
use crate::signals::{BodySignals, WheelSignals};
use crate::vehicle::Body;
use crate::wheel::Wheel;
use bekker_modeldescription::Parameters;

/// Hooks of an effect into the simulation, and facts about it; the default hooks change nothing.
///
/// At the neutral values of its parameters an effect must change nothing, bit for bit: its hooks return early.
#[lanes]
pub trait Effect<S: Scalar>: Parameters<S> {
    /// What others need to know of the effect.
    fn facts(&self) -> Facts;

    /// Changes wheel and soil at a contact, before the stresses are integrated.
    fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        let _ = (place, local);
    }

    /// Changes how the rim meets the soil, after all effects have changed wheel and soil.
    fn surface(&self, place: &Place<S>, local: &mut Local<S>) {
        let _ = (place, local);
    }

    /// Whether the effect needs [`Place::passes`], the number of wheels that have passed the ground.
    fn counts_passes(&self) -> bool {
        false
    }

    /// Relaxation length (m, more than 0) with which the ground under a wheel follows its slip, where the effect needs
    /// [`Place::dug_slip`]. A wheel has one such slip: of several effects the first one's length holds, those of the library first.
    fn digging_length(&self) -> Option<S> {
        None
    }

    /// Changes the forces of a contact, after the stresses are integrated.
    fn forces(&self, place: &Place<S>, local: &Local<S>, forces: &mut Forces<S>) {
        let _ = (place, local, forces);
    }

    /// The true wheel in place of `wheel`, where they differ.
    fn wheel(&self, wheel: &Wheel<S>) -> Option<Wheel<S>> {
        let _ = wheel;
        None
    }

    /// Changes a true radius back into the one from which slip is computed for the records.
    fn recorded_radius(&self, radius: &mut S) {
        let _ = radius;
    }

    /// Mass at the chassis' centre of mass that the data sheet does not have, kg.
    fn added_mass(&self) -> Option<S> {
        None
    }

    /// Changes the chassis of the data sheet into the true one, apart from [`added_mass`](Self::added_mass).
    fn chassis(&self, body: &mut Body<S>) {
        let _ = body;
    }

    /// Changes the motor of the data sheet into the true one, whose winding is warmer by `winding_rise` (K).
    fn motor(&self, winding_rise: S, motor: &mut Motor<S>) {
        let _ = (winding_rise, motor);
    }

    /// The law by which a winding warms that dissipates `power` (W).
    fn warming(&self, power: S) -> Option<Warming<S>> {
        let _ = power;
        None
    }

    /// True torque over the torque that the drive computes from its current.
    fn torque_gain(&self) -> Option<S> {
        None
    }

    /// Torques that the motor can give at this wheel speed (rad/s), where the effect limits them.
    fn torque_range(&self, motor: &Motor<S>, speed: S) -> Option<TorqueRange<S>> {
        let _ = (motor, speed);
        None
    }

    /// Share of that limit which `torque` (wheel side, N m) takes; over 1 it is out of reach.
    fn share_of_limit(&self, motor: &Motor<S>, speed: S, torque: S) -> Option<S> {
        let _ = (motor, speed, torque);
        None
    }

    /// Torque behind the gear for a `torque` (N m) before it at this wheel speed (rad/s), all on the wheel's side.
    fn gear(&self, speed: S, torque: S) -> Option<Geared<S>> {
        let _ = (speed, torque);
        None
    }

    /// Torque before the gear that gives `torque` behind it: the inverse of [`gear`](Self::gear).
    fn gear_input(&self, speed: S, torque: S) -> Option<S> {
        let _ = (speed, torque);
        None
    }

    /// Friction torque of a drive at this wheel speed (rad/s), wheel side, N m, and its slope in the speed, N m s/rad.
    fn drive_friction(&self, speed: S) -> Option<(S, S)> {
        let _ = speed;
        None
    }

    /// Dry friction of a passive joint turning at `rate` (rad/s): moment over rate, N m s/rad, finite at rest.
    fn joint_friction(&self, rate: S) -> Option<S> {
        let _ = rate;
        None
    }

    /// Horizontal force on the chassis at its reference point, N.
    fn body_force(&self, motion: &BodyMotion<S>) -> Option<S> {
        let _ = motion;
        None
    }

    /// Changes true signals into what is recorded at the same instant; the rover started at `start_x`.
    fn record(&self, start_x: S, body: &mut BodySignals<S>, wheels: &mut [WheelSignals<S>]) {
        let _ = (start_x, body, wheels);
    }

    /// Lag and dead time between the signals and their record.
    fn lag(&self) -> Option<RecordingLag<S>> {
        None
    }
}
